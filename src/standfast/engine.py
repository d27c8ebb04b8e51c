"""From a tile of a study to arrays: the only place with ``jit`` and ``vmap``.

A quantity is a function of one person and one triple of stiffnesses. It is mapped over the axes
that it depends on, by name and one axis at a time, so that each intermediate result is computed on
its own axes alone: gravity loads on those of the body, the knee's load on body × hip, and so on.
The verdict is the one quantity with a step between: its threshold is computed first, on every axis
but the ankle's, and then costs one comparison a point.
"""

from collections.abc import Callable, Mapping
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from standfast import stability
from standfast.arithmetic import Scalar
from standfast.body import REFERENCE_PEOPLE, Body, Stiffness, rescaled
from standfast.modes import frequency, growth_rate, hip_ankle_ratio, knee_ankle_ratio, modes
from standfast.study import JOINTS, Group, Study, Tile

Person = tuple[Body, Stiffness, Scalar]


def _eigenvalue(number: int) -> Callable[[Body, Stiffness, Scalar], Scalar]:
    return lambda *person: modes(*person).eigenvalues[number]


def _frequency(*person: Any) -> Scalar:
    return frequency(modes(*person).eigenvalues[0])


def _growth_rate(*person: Any) -> Scalar:
    return growth_rate(modes(*person).eigenvalues[0])


def _critical(joint: str) -> Callable[[Body, Stiffness, Scalar], Scalar]:
    """Return the threshold of a joint, which does not ask for that joint's own stiffness."""

    def threshold(body: Body, stiffness: Stiffness, gravity: Scalar) -> Scalar:
        ankle, knee, hip = stiffness
        if joint == "ankle":
            return stability.critical_ankle_stiffness(body, knee, hip, gravity)
        if joint == "knee":
            return stability.critical_knee_stiffness(body, ankle, hip, gravity)
        return stability.critical_hip_stiffness(body, ankle, knee, gravity)

    return threshold


# How each quantity is computed for one person; ``stable`` is the comparison of ``_verdicts``.
FUNCTIONS: Mapping[str, Callable[[Body, Stiffness, Scalar], Scalar]] = {
    "stability_determinant": stability.stability_determinant,
    "critical_ankle_stiffness": _critical("ankle"),
    "critical_knee_stiffness": _critical("knee"),
    "critical_hip_stiffness": _critical("hip"),
    "stiffness_reserve": stability.stiffness_reserve,
    "safety_factor": stability.safety_factor,
    "eigenvalue_1": _eigenvalue(0),
    "eigenvalue_2": _eigenvalue(1),
    "eigenvalue_3": _eigenvalue(2),
    "frequency": _frequency,
    "growth_rate": _growth_rate,
    "hip_ankle_ratio": hip_ankle_ratio,
    "knee_ankle_ratio": knee_ankle_ratio,
}

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
        return tuple(FUNCTIONS[quantity](*person) for quantity in group.quantities)

    mapped = jax.jit(_over_axes(of_one, group.axes))
    return lambda pieces: tuple(np.asarray(result) for result in mapped(pieces))


def _verdicts(
    group: Group, fixed: Mapping[str, Any]
) -> Callable[[dict[str, Any]], tuple[np.ndarray, ...]]:
    """Compile the verdict: the ankle's threshold on the other axes, then one comparison a point."""
    others = tuple(name for name in group.axes if name != ANKLE)

    def threshold_of_one(varying: dict[str, Any]) -> Scalar:
        return FUNCTIONS["critical_ankle_stiffness"](*_person({**fixed, **varying}))

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
