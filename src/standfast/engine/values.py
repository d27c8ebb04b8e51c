"""Quantities that are numbers: functions of one person, mapped over a group's axes.

A fast way says itself where it is uncertain; there, at a few points in a hundred or at those with a
rigid joint, the reference follows.
"""

import math
from collections.abc import Callable, Mapping
from functools import lru_cache, partial
from typing import Any

import jax.numpy as jnp
import numpy as np

from standfast.engine.mapping import (
    Inputs,
    along_axis,
    in_whole_vectors,
    map_over_grid,
    map_over_points,
)
from standfast.numerics.arrays import Scalar
from standfast.parameters import COUPLINGS, STIFFNESSES
from standfast.quantities import QUANTITIES, Person, Quantity
from standfast.study.grid import Group, Tile
from standfast.study.study import Study

# Points that are computed by the reference at once.
POINTS = 4096


class Values:
    """Computes the tiles of a group of numbers."""

    def __init__(self, study: Study, group: Group, inputs: Inputs) -> None:
        self.group, self.inputs = group, inputs
        rows = tuple(QUANTITIES[name] for name in group.quantities)
        rigid = any(study.fixed.get(name) == math.inf for name in STIFFNESSES)
        coupled = not inputs.given.isdisjoint(COUPLINGS)
        # a reference that is computed anyway, for another quantity, serves all that share it
        needed = {row.at_point for row in rows if row.fast is None}
        self.fast = tuple(
            number
            for number, row in enumerate(rows)
            if row.fast is not None and row.at_point not in needed and not (rigid or coupled)
        )
        self.on_grid = _on_grid(rows, self.fast, group.axes)
        self.reference = _at_points(tuple(rows[n] for n in self.fast), on_axes=bool(group.axes))
        self.lengths = [len(study.axes[name]) for name in group.axes]
        self.computed_shape = in_whole_vectors(group.chunk_shape)

    def __call__(self, tile: Tile) -> tuple[np.ndarray, ...]:
        """Compute one tile; the arrays may be cut out of wider ones."""
        group = self.group
        starts = group.start(tile)
        at = dict(
            zip(group.axes, map(along_axis, starts, self.computed_shape, self.lengths), strict=True)
        )
        found, flag = self.on_grid(self.inputs.fixed, self.inputs.pieces(at))
        inside = tuple(slice(side) for side in group.chunk_shape)
        values = [np.asarray(each)[inside] for each in found]
        if self.fast:
            alone = flag is None
            uncertain = np.isnan(values[self.fast[0]]) if alone else np.asarray(flag)[inside]
            if uncertain.any():
                for number in self.fast:
                    values[number] = values[number].copy()  # XLA's own cannot be written to
                self._correct([values[n] for n in self.fast], tuple(np.argwhere(uncertain).T), at)
        return tuple(values)

    def _correct(
        self,
        values: list[np.ndarray],
        where: tuple[np.ndarray, ...],
        at: Mapping[str, np.ndarray],
    ) -> None:
        """Compute the uncertain points by the reference, and put them into their places."""
        if not where:
            exact, _ = self.reference(self.inputs.fixed, {})
            for array, value in zip(values, exact, strict=True):
                array[()] = value
            return
        for first in range(0, where[0].size, POINTS):
            batch = tuple(index[first : first + POINTS] for index in where)
            # every batch has one length, so that it compiles once
            padded = [np.resize(index, POINTS) for index in batch]
            points = {
                name: at[name][index] for name, index in zip(self.group.axes, padded, strict=True)
            }
            exact, _ = self.reference(self.inputs.fixed, self.inputs.pieces(points))
            for array, result in zip(values, exact, strict=True):
                array[batch] = np.asarray(result)[: batch[0].size]


# Compiled for each set of quantities and axes; studies that differ in numbers alone share it.
@lru_cache(maxsize=64)
def _on_grid(
    rows: tuple[Quantity, ...], fast: tuple[int, ...], axes: tuple[str, ...]
) -> Callable[..., Any]:
    return map_over_grid(partial(_quantities, rows, fast), axes)


@lru_cache(maxsize=64)
def _at_points(rows: tuple[Quantity, ...], *, on_axes: bool) -> Callable[..., Any]:
    by_reference = partial(_quantities, rows, ())
    return map_over_points(by_reference) if on_axes else map_over_grid(by_reference, ())


def _quantities(
    rows: tuple[Quantity, ...], fast: tuple[int, ...], given: dict[str, Any]
) -> tuple[tuple[Scalar, ...], Scalar]:
    """Return the quantities of one person, those of ``fast`` so, and a flag if any is uncertain.

    Of a single fast quantity NaN is the flag: then XLA makes one loop of all, 1.4 times as fast
    (``results/benchmarks``, "tricks"). It stays within this file.
    """
    person = Person.of(given)
    found: dict[Callable[[Person], Any], Any] = {}
    flag: Scalar = None
    values = []
    for number, row in enumerate(rows):
        find = row.fast if number in fast and row.fast is not None else row.at_point
        if find not in found:
            found[find] = find(person)
            if find is row.fast:
                found[find], uncertain = found[find]
                flag = uncertain if flag is None else flag | uncertain
        values.append(jnp.asarray(row.pick(person, found[find])).astype(row.dtype))
    if len(fast) == 1:
        values[fast[0]] = jnp.where(flag, jnp.nan, values[fast[0]])
        flag = None
    return tuple(values), flag
