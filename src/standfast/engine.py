"""From a tile of a study to arrays: the only place with ``jit`` and ``vmap``.

A quantity is a function of one person and one triple of stiffnesses. It is mapped over the axes
that it depends on, by name and one axis at a time, so that each intermediate result is computed on
its own axes alone: gravity loads on those of the body, the knee's load on body × hip, and so on.
The verdict is the one quantity with a step between: its threshold is computed first, on every axis
but the ankle's, and then costs one comparison a point.
"""

from collections.abc import Callable, Hashable, Mapping
from functools import cache, partial
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from standfast import stability
from standfast.arithmetic import Scalar
from standfast.body import REFERENCE_PEOPLE, Body, Stiffness, rescaled
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
Evaluate = Callable[[Tile], tuple[np.ndarray, ...]]


def evaluator(study: Study) -> Evaluate:
    """Return the function that computes a tile: one array of the chunk's shape a quantity.

    Chunks at the far edges of the grid are computed whole, on repeated last values, so that each
    group compiles once. A chunk of equal verdicts comes as a view of one number.
    """
    inputs = {name: _along(name, values) for name, values in study.axes.items()}
    fixed = {
        name: jax.tree.map(lambda leaf: leaf[0], _along(name, np.array([value])))
        for name, value in study.fixed.items()
    }
    compiled: dict[int, Callable[[dict[str, Any]], tuple[np.ndarray, ...]]] = {}

    def evaluate(tile: Tile) -> tuple[np.ndarray, ...]:
        group = study.groups[tile.group]
        with jax.enable_x64(True):
            if tile.group not in compiled:
                make = _verdicts if group.quantities == ("stable",) else _values
                compiled[tile.group] = make(group, fixed)
            return compiled[tile.group](_pieces(group, tile, inputs))

    return evaluate


def _values(
    group: Group, fixed: Mapping[str, Any]
) -> Callable[[dict[str, Any]], tuple[np.ndarray, ...]]:
    """Compile all quantities of a group into one function of its axes' pieces."""

    def of_one(varying: dict[str, Any]) -> tuple[Scalar, ...]:
        person = _person({**fixed, **varying})
        modes_of = cache(partial(modes, *person))
        return tuple(FUNCTIONS[quantity](person, modes_of) for quantity in group.quantities)

    mapped = jax.jit(_over_axes(of_one, group.axes))
    return lambda pieces: tuple(np.asarray(result) for result in mapped(pieces))


def _verdicts(
    group: Group, fixed: Mapping[str, Any]
) -> Callable[[dict[str, Any]], tuple[np.ndarray, ...]]:
    """Compile the verdict: the ankle's threshold on the other axes, then one comparison a point."""
    others = tuple(name for name in group.axes if name != ANKLE)

    def threshold_of_one(varying: dict[str, Any]) -> Scalar:
        return _critical("ankle", *_person({**fixed, **varying}))

    def compare(pieces: dict[str, Scalar]) -> Scalar:
        return (pieces[ANKLE] > pieces["threshold"]).astype(jnp.uint8)

    for name in reversed(group.axes):
        along = {ANKLE: 0 if name == ANKLE else None, "threshold": 0 if name != ANKLE else None}
        compare = jax.vmap(compare, in_axes=(along,))
    thresholds = jax.jit(_over_axes(threshold_of_one, others))
    compare = jax.jit(compare)

    def verdicts(pieces: dict[str, Any]) -> tuple[np.ndarray, ...]:
        ankle = pieces[ANKLE] if ANKLE in pieces else fixed[ANKLE]
        threshold = np.asarray(thresholds({name: pieces[name] for name in others}))
        lowest, highest = threshold.min(), threshold.max()
        if np.max(ankle) <= lowest or np.min(ankle) > highest:
            one = np.uint8(np.min(ankle) > highest)
            return (np.broadcast_to(one, group.chunk_shape),)
        return (np.asarray(compare({ANKLE: ankle, "threshold": threshold})),)

    return verdicts


def _over_axes(
    function: Callable[[dict[str, Any]], Any], axes: tuple[str, ...]
) -> Callable[[dict[str, Any]], Any]:
    """Map a function of named scalars over its axes, the last one fastest."""
    for mapped in reversed(axes):
        along = {name: 0 if name == mapped else None for name in axes}
        function = jax.vmap(function, in_axes=(along,))
    return function


@cache
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

    mapped = jax.jit(jax.vmap(of_one, in_axes=1))

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


def _pieces(group: Group, tile: Tile, inputs: Mapping[str, Any]) -> dict[str, Any]:
    """Cut a tile's piece out of every axis, repeating the last value beyond its end."""
    pieces = {}
    for name, start, length, count in zip(
        group.axes, group.start(tile), group.chunk_shape, group.shape, strict=True
    ):
        at = np.minimum(np.arange(start, start + length), count - 1)
        pieces[name] = jax.tree.map(lambda leaf, at=at: leaf[at], inputs[name])
    return pieces
