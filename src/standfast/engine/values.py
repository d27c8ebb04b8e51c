"""Quantities that are numbers: one function of one person each, mapped over a group's axes.

Eigenvalues and the stiffness reserve have a quick way, which says itself where it is in doubt;
there, at a few points in a hundred or at those with a rigid joint, the accurate way follows.
"""

import math
from collections.abc import Callable, Mapping
from functools import cache, lru_cache, partial
from typing import Any

import jax.numpy as jnp
import numpy as np
from jax import lax

from standfast import stability
from standfast.arithmetic import Scalar
from standfast.body import Body, Stiffness
from standfast.engine.mapping import (
    Inputs,
    Person,
    along_axis,
    in_whole_vectors,
    over_axes,
    over_points,
    person,
)
from standfast.engine.memory import Recycled
from standfast.modes import (
    Modes,
    frequency,
    growth_rate,
    modes,
    quick_eigenvalues,
    quick_reserve,
    ratio_to_ankle,
    sum_of_eigenvalues,
)
from standfast.study import JOINTS, Group, Study, Tile

ModesOf = Callable[[], Modes]

# How each quantity is computed for one person, whose modes are found at most once.
FUNCTIONS: Mapping[str, Callable[[Person, ModesOf], Scalar]] = {
    "stability_determinant": lambda one, _: stability.stability_determinant(*one),
    "critical_ankle_stiffness": lambda one, _: critical("ankle", *one),
    "critical_knee_stiffness": lambda one, _: critical("knee", *one),
    "critical_hip_stiffness": lambda one, _: critical("hip", *one),
    "stiffness_reserve": lambda one, _: stability.stiffness_reserve(*one),
    "safety_factor": lambda one, _: stability.safety_factor(*one),
    "eigenvalue_1": lambda _, modes_of: modes_of().eigenvalues[0],
    "eigenvalue_2": lambda _, modes_of: modes_of().eigenvalues[1],
    "eigenvalue_3": lambda _, modes_of: modes_of().eigenvalues[2],
    "frequency": lambda _, modes_of: frequency(modes_of().eigenvalues[0]),
    "growth_rate": lambda _, modes_of: growth_rate(modes_of().eigenvalues[0]),
    "hip_ankle_ratio": lambda one, modes_of: ratio_to_ankle("hip", one[1], modes_of()),
    "knee_ankle_ratio": lambda one, modes_of: ratio_to_ankle("knee", one[1], modes_of()),
}
OF_EIGENVALUES = {"eigenvalue_1", "eigenvalue_2", "eigenvalue_3", "frequency", "growth_rate"}
OF_RESERVE = {"stiffness_reserve"}
OF_SHAPES = {"hip_ankle_ratio", "knee_ankle_ratio"}

# Points that are computed the accurate way at once.
POINTS = 4096


def critical(joint: str, body: Body, stiffness: Stiffness, gravity: Scalar) -> Scalar:
    """Return the threshold of a joint, which does not ask for that joint's own stiffness."""
    ankle, knee, hip = stiffness
    if joint == "ankle":
        return stability.critical_ankle_stiffness(body, knee, hip, gravity)
    if joint == "knee":
        return stability.critical_knee_stiffness(body, ankle, hip, gravity)
    return stability.critical_hip_stiffness(body, ankle, knee, gravity)


def _accurately(quantities: tuple[str, ...], parameters: dict[str, Any]) -> tuple[Scalar, ...]:
    """Return the quantities of one person."""
    one = person(parameters)
    modes_of = cache(partial(modes, *one))
    return tuple(FUNCTIONS[quantity](one, modes_of) for quantity in quantities)


def _two_eigenvalues(wanted: tuple[str, ...], parameters: dict[str, Any]) -> Scalar:
    """Return the two smaller eigenvalues of one person as a complex number; NaN if in doubt.

    The third is the rest of their sum: where it is smaller than they are, that is in doubt too.
    """
    low, middle, high, doubt = quick_eigenvalues(*person(parameters))
    if "eigenvalue_3" in wanted:
        doubt = doubt | (abs(low) + abs(middle) > abs(high))
    return lax.complex(jnp.where(doubt, jnp.nan, low), jnp.where(doubt, jnp.nan, middle))


def _quickly(quantities: tuple[str, ...], parameters: dict[str, Any]) -> tuple[Scalar, ...]:
    """Return the quantities of one person, of eigenvalues the quick way: NaN if in doubt.

    XLA on processors makes a loop for each array that it gives, and computes anew in each what they
    share: for several quantities two eigenvalues are computed before, in one array.
    """
    one = person(parameters)
    if "two_eigenvalues" in parameters:
        two = parameters["two_eigenvalues"]
        three = [two.real, two.imag, sum_of_eigenvalues(*one) - two.imag - two.real]
    else:
        *roots, in_doubt = quick_eigenvalues(*one)
        three = [jnp.where(in_doubt, jnp.nan, root) for root in roots]
    quick = jnp.stack(three)

    def value(quantity: str) -> Scalar:
        if quantity in OF_RESERVE:
            reserve, doubt = quick_reserve(*one)
            return jnp.where(doubt, jnp.nan, reserve)
        return FUNCTIONS[quantity](one, lambda: Modes(quick, jnp.nan))

    return tuple(value(quantity) for quantity in quantities)


# Compiled for each set of quantities and axes; studies that differ in numbers alone share it.
@lru_cache(maxsize=64)
def _compiled(
    way: Callable[[tuple[str, ...], dict[str, Any]], Any],
    quantities: tuple[str, ...],
    axes: tuple[str, ...] | None,
) -> Callable[..., Any]:
    of_one = partial(way, quantities)
    return over_points(of_one) if axes is None else over_axes(of_one, axes)


class Values:
    """Computes the tiles of a group of numbers."""

    def __init__(self, study: Study, group: Group, inputs: Inputs) -> None:
        self.group, self.inputs = group, inputs
        wanted = set(group.quantities)
        # with a rigid joint all is in doubt
        rigid = any(study.fixed.get(joint) == math.inf for joint in JOINTS)
        in_quick_way = wanted & (OF_EIGENVALUES | OF_RESERVE)
        self.quick = bool(in_quick_way) and not (wanted & OF_SHAPES or rigid)
        self.in_two_steps = self.quick and len(wanted & OF_EIGENVALUES) > 1
        # one quantity of each kind that may be in doubt
        self.doubtful = [
            next(i for i, name in enumerate(group.quantities) if name in kind)
            for kind in (OF_EIGENVALUES, OF_RESERVE)
            if self.quick and wanted & kind
        ]
        way = _quickly if self.quick else _accurately
        self.on_grid = _compiled(way, group.quantities, group.axes)
        self.memory = Recycled(group.chunk_shape, np.float64)
        self.lengths = [len(study.axes[name]) for name in group.axes]
        self.computed_shape = in_whole_vectors(group.chunk_shape)

    def __call__(self, tile: Tile) -> tuple[np.ndarray, ...]:
        """Compute one tile; the arrays may be cut out of wider ones."""
        group = self.group
        starts = group.start(tile)
        at = dict(
            zip(group.axes, map(along_axis, starts, self.computed_shape, self.lengths), strict=True)
        )
        fixed, pieces = self.inputs.fixed, self.inputs.pieces(at)
        known = {}
        if self.in_two_steps:
            two = _compiled(_two_eigenvalues, group.quantities, group.axes)(fixed, pieces, {})
            known["two_eigenvalues"] = two
        found = self.on_grid(fixed, pieces, known)
        inside = tuple(slice(side) for side in group.chunk_shape)
        results = tuple(np.asarray(values)[inside] for values in found)
        # a single NaN shows in the smallest value, which is found sooner than it is looked for
        doubtful = [results[i] for i in self.doubtful if np.isnan(results[i].min())]
        if not doubtful:
            return results
        values = tuple(self.memory.take() for _ in results)
        for array, result in zip(values, results, strict=True):
            np.copyto(array, result)
        where = np.logical_or.reduce([np.isnan(result) for result in doubtful])
        self._correct(values, tuple(np.argwhere(where).T), at)
        return values

    def _correct(
        self,
        values: tuple[np.ndarray, ...],
        where: tuple[np.ndarray, ...],
        at: Mapping[str, np.ndarray],
    ) -> None:
        """Compute the points in doubt the accurate way, and put them into their places."""
        if not where:
            exact = _compiled(_accurately, self.group.quantities, ())(self.inputs.fixed, {}, {})
            for array, value in zip(values, exact, strict=True):
                array[()] = value
            return
        accurate = _compiled(_accurately, self.group.quantities, None)
        for first in range(0, where[0].size, POINTS):
            batch = tuple(index[first : first + POINTS] for index in where)
            # every batch has one length, so that it compiles once
            padded = [np.resize(index, POINTS) for index in batch]
            points = {
                name: at[name][index] for name, index in zip(self.group.axes, padded, strict=True)
            }
            exact = accurate(self.inputs.fixed, self.inputs.pieces(points))
            for array, result in zip(values, exact, strict=True):
                array[batch] = np.asarray(result)[: batch[0].size]
