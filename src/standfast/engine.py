"""From a tile of a study to arrays: the only place with ``jit`` and ``vmap``.

A quantity is a function of one person and one triple of stiffnesses. It is mapped over the axes
that it depends on, by name and one axis at a time, so that each intermediate result is computed on
its own axes alone: gravity loads on those of the body, the knee's load on body × hip, and so on.
The verdict is the one quantity with a step between: its threshold is computed first, on every axis
but the ankle's, and then costs one comparison a point.
"""

import math
from collections.abc import Callable, Hashable, Mapping
from dataclasses import dataclass
from functools import cache, lru_cache, partial
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from standfast import stability
from standfast.arithmetic import Scalar
from standfast.body import REFERENCE_PEOPLE, Body, Stiffness, rescaled
from standfast.certainty import (
    SCALING_ROUNDING,
    exact_threshold,
    falling_below,
    in_doubt,
)
from standfast.modes import Modes, frequency, growth_rate, modes, ratio_to_ankle
from standfast.study import JOINTS, Group, Study, Tile

Person = tuple[Body, Stiffness, Scalar]
ModesOf = Callable[[], Modes]

# How each quantity is computed for one person, whose modes are found at most once. ``stable`` is
# the comparison of ``_verdicts``.
FUNCTIONS: Mapping[str, Callable[[Person, ModesOf], Scalar]] = {
    "stability_determinant": lambda person, _: stability.stability_determinant(*person),
    "critical_ankle_stiffness": lambda person, _: _critical("ankle", *person),
    "critical_knee_stiffness": lambda person, _: _critical("knee", *person),
    "critical_hip_stiffness": lambda person, _: _critical("hip", *person),
    "stiffness_reserve": lambda person, _: stability.stiffness_reserve(*person),
    "safety_factor": lambda person, _: stability.safety_factor(*person),
    "eigenvalue_1": lambda _, modes_of: modes_of().eigenvalues[0],
    "eigenvalue_2": lambda _, modes_of: modes_of().eigenvalues[1],
    "eigenvalue_3": lambda _, modes_of: modes_of().eigenvalues[2],
    "frequency": lambda _, modes_of: frequency(modes_of().eigenvalues[0]),
    "growth_rate": lambda _, modes_of: growth_rate(modes_of().eigenvalues[0]),
    "hip_ankle_ratio": lambda person, modes_of: ratio_to_ankle("hip", person[1], modes_of()),
    "knee_ankle_ratio": lambda person, modes_of: ratio_to_ankle("knee", person[1], modes_of()),
}


def _critical(joint: str, body: Body, stiffness: Stiffness, gravity: Scalar) -> Scalar:
    """Return the threshold of a joint, which does not ask for that joint's own stiffness."""
    ankle, knee, hip = stiffness
    if joint == "ankle":
        return stability.critical_ankle_stiffness(body, knee, hip, gravity)
    if joint == "knee":
        return stability.critical_knee_stiffness(body, ankle, hip, gravity)
    return stability.critical_hip_stiffness(body, ankle, knee, gravity)


ANKLE = "ankle_stiffness"

# Without it XLA uses half of the vector registers that many processors have.
COMPILER_OPTIONS = {"xla_cpu_prefer_vector_width": 512}


class Evaluator:
    """Computes the tiles of a study: one array of the chunk's shape a quantity.

    Chunks at the far edges of the grid are computed whole, on repeated last values, so that each
    group compiles once. A chunk of equal verdicts comes as a view of one number.

    Attributes
    ----------
    settled : int
        verdicts so far that rounding could have decided, and exact arithmetic did.
    """

    def __init__(self, study: Study) -> None:
        self.study = study
        self.settled = 0
        self._inputs = {name: _along(name, values) for name, values in study.axes.items()}
        self._fixed = {
            name: jax.tree.map(lambda leaf: leaf[0], _along(name, np.array([value])))
            for name, value in study.fixed.items()
        }
        self._compiled: dict[int, Callable[[Tile], tuple[np.ndarray, ...]]] = {}

    def __call__(self, tile: Tile) -> tuple[np.ndarray, ...]:
        """Compute one tile."""
        with jax.enable_x64(True):
            if tile.group not in self._compiled:
                group = self.study.groups[tile.group]
                make = self._verdicts if group.quantities == ("stable",) else self._values
                self._compiled[tile.group] = make(group)
            return self._compiled[tile.group](tile)

    def _values(self, group: Group) -> Callable[[Tile], tuple[np.ndarray, ...]]:
        """Compile all quantities of a group into one function of its tiles."""

        def of_one(varying: dict[str, Any]) -> tuple[Scalar, ...]:
            person = _person({**self._fixed, **varying})
            modes_of = cache(partial(modes, *person))
            return tuple(FUNCTIONS[quantity](person, modes_of) for quantity in group.quantities)

        mapped = _compiled(_over_axes(of_one, group.axes))

        def values(tile: Tile) -> tuple[np.ndarray, ...]:
            found = mapped(_pieces(self._inputs, group.axes, _places(group, tile)))
            return tuple(np.asarray(result) for result in found)

        return values

    def _verdicts(self, group: Group) -> Callable[[Tile], tuple[np.ndarray, ...]]:
        """Make the function of the verdict's tiles.

        Along the ankle's axis verdicts change once, from falling to standing, at a place that the
        thresholds tell. So a verdict is one comparison of small integers a point, done in NumPy
        about as fast as memory is written; a chunk of equal verdicts is known from the extremes.
        """
        thresholds_at = self._thresholds(group)
        # an ankle of one stiffness is an axis of one value, behind all others
        axis = group.axes.index(ANKLE) if ANKLE in group.axes else len(group.axes)
        length = (*group.chunk_shape, 1)[axis]
        kind = np.uint8 if length < 2**8 else np.uint32
        behind = max(len(group.axes) - 1 - axis, 0)
        steps = np.arange(length, dtype=kind).reshape(-1, *(1,) * behind)

        def verdicts(tile: Tile) -> tuple[np.ndarray, ...]:
            found = thresholds_at(tile.chunk[:axis] + tile.chunk[axis + 1 :])
            start = (*group.start(tile), 0)[axis]
            self.settled += found.settled_within(start, start + length)
            if found.lowest >= start + length or found.highest <= start:
                one = np.uint8(found.highest <= start)
                return (np.broadcast_to(one, group.chunk_shape),)
            falling = np.clip(found.falling - start, 0, length).astype(kind)
            stable = np.empty(group.chunk_shape, np.uint8)
            out = stable.view(bool)
            if axis == len(group.axes):
                out = out[..., None]
            np.greater_equal(steps, np.expand_dims(falling, axis), out=out)
            return (stable,)

        return verdicts

    def _thresholds(self, group: Group) -> Callable[[tuple[int, ...]], "_Thresholds"]:
        """Return the function from a chunk of the other axes to the ankle's thresholds on it.

        They come with the intervals in which the exact ones lie. Where an ankle stiffness of the
        study lies in one too, the threshold is settled in fractions. The last chunks are kept: the
        tiles of a study go through them again and again.
        """
        others = tuple(name for name in group.axes if name != ANKLE)
        ankle = self.study.axes.get(ANKLE, np.array([self.study.fixed.get(ANKLE, math.nan)]))

        def of_one(varying: dict[str, Any]) -> tuple[Scalar, Scalar, Scalar]:
            body, (_, knee, hip), gravity = _person({**self._fixed, **varying})
            low, high = stability.threshold_interval(
                body, knee, hip, gravity, scaling=SCALING_ROUNDING
            )
            return stability.critical_ankle_stiffness(body, knee, hip, gravity), low, high

        mapped = _compiled(_over_axes(of_one, others))
        shape = [n for name, n in zip(group.axes, group.chunk_shape, strict=True) if name in others]

        def thresholds_at(chunk: tuple[int, ...]) -> _Thresholds:
            ends = [len(self.study.axes[name]) for name in others]
            at = dict(zip(others, map(_place, chunk, shape, ends), strict=True))
            found = mapped(_pieces(self._inputs, others, at))
            threshold, low, high = (np.asarray(each) for each in found)
            falling = np.array(np.searchsorted(ankle, threshold, side="right"))
            settled = []
            for index in map(tuple, np.argwhere(in_doubt(ankle, low, high))):
                varying = {
                    name: self.study.axes[name][at[name][i]]
                    for name, i in zip(others, index, strict=True)
                }
                falling[index] = falling_below(
                    ankle, exact_threshold({**self.study.fixed, **varying})
                )
                # values that are repeated beyond the end of an axis are counted once
                if all(i < np.unique(at[name]).size for name, i in zip(others, index, strict=True)):
                    near = (low[index] <= ankle) & (ankle <= high[index])
                    settled.append(np.flatnonzero(near))
            counted = np.sort(np.concatenate([*settled, np.empty(0, np.int64)]))
            return _Thresholds(falling, int(falling.min()), int(falling.max()), counted)

        size = 8 * max(math.prod(shape), 1)
        return lru_cache(maxsize=max(THRESHOLD_BYTES // size, 1))(thresholds_at)


# Thresholds that are kept between tiles.
THRESHOLD_BYTES = 2**26


@dataclass(frozen=True, slots=True, eq=False)
class _Thresholds:
    """How many values of the ankle's axis fall, on a chunk of the other axes.

    ``settled`` holds the places on the ankle's axis of the verdicts that needed exact arithmetic.
    """

    falling: np.ndarray
    lowest: int
    highest: int
    settled: np.ndarray

    def settled_within(self, start: int, stop: int) -> int:
        """Return how many verdicts of some places on the ankle's axis needed exact arithmetic."""
        first, last = np.searchsorted(self.settled, [start, stop])
        return int(last - first)


def _over_axes(
    function: Callable[[dict[str, Any]], Any], axes: tuple[str, ...]
) -> Callable[[dict[str, Any]], Any]:
    """Map a function of named scalars over its axes, the last one fastest."""
    for mapped in reversed(axes):
        along = {name: 0 if name == mapped else None for name in axes}
        function = jax.vmap(function, in_axes=(along,))
    return function


@lru_cache(maxsize=32)
def over_persons(
    function: Callable[[Any, dict[str, Scalar]], dict[str, Scalar]],
    model: Hashable,
    names: tuple[str, ...],
) -> Callable[[np.ndarray], dict[str, np.ndarray]]:
    """Map a function of a model and one person's named numbers over many persons.

    Takes the numbers as an array (names, persons) and gives an array of persons a result. Compiled
    once for each function, model and number of persons.
    """

    def of_one(column: Scalar) -> dict[str, Scalar]:
        return function(model, {name: column[row] for row, name in enumerate(names)})

    mapped = _compiled(jax.vmap(of_one, in_axes=1))

    def evaluate(numbers: np.ndarray) -> dict[str, np.ndarray]:
        with jax.enable_x64(True):
            return {name: np.asarray(values) for name, values in mapped(numbers).items()}

    return evaluate


def _person(parameters: Mapping[str, Any]) -> Person:
    """Make one person, with stiffness and gravity, from parameters by name."""
    body, reference_height, reference_mass = parameters["body_model"]
    height = parameters["height"]
    mass = parameters["mass"] if "mass" in parameters else parameters["bmi"] * height**2
    # a threshold is asked without its own joint, whose stiffness then does not enter
    stiffness = Stiffness._make(parameters.get(joint, jnp.nan) for joint in JOINTS)
    person = rescaled(Body._make(body), height / reference_height, mass / reference_mass)
    return person, stiffness, parameters["gravity"]


def _along(name: str, values: np.ndarray) -> Any:
    """Return the inputs of an axis: its values, or for body models their reference people."""
    if name != "body_model":
        return values
    people = [REFERENCE_PEOPLE[model] for model in values]
    return (
        tuple(np.stack(leaves) for leaves in zip(*(one.body for one in people), strict=True)),
        np.array([one.height for one in people]),
        np.array([one.mass for one in people]),
    )


def _places(group: Group, tile: Tile) -> dict[str, np.ndarray]:
    """Return where on its axes a tile lies, repeating the last place beyond an axis's end."""
    return {
        name: _place(number, length, count)
        for name, number, length, count in zip(
            group.axes, tile.chunk, group.chunk_shape, group.shape, strict=True
        )
    }


def _place(number: int, length: int, count: int) -> np.ndarray:
    """Return the places of a chunk on an axis, repeating the last one beyond its end."""
    return np.minimum(np.arange(number * length, (number + 1) * length), count - 1)


def _pieces(
    inputs: Mapping[str, Any], names: tuple[str, ...], places: Mapping[str, np.ndarray]
) -> dict[str, Any]:
    """Cut a tile's piece out of each axis's inputs."""
    return {
        name: jax.tree.map(lambda leaf, at=places[name]: leaf[at], inputs[name]) for name in names
    }


def _compiled(function: Callable[..., Any]) -> Callable[..., Any]:
    options = COMPILER_OPTIONS if jax.default_backend() == "cpu" else None
    return jax.jit(function, compiler_options=options)
