"""Planes of ankle × hip stiffness: one for every value of a study's other axes."""

import itertools
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from standfast.anthropometry.body import REFERENCE_PEOPLE, Body, body_of
from standfast.errors import InputError
from standfast.study.study import Study

ANKLE, KNEE, HIP = "ankle_stiffness", "knee_stiffness", "hip_stiffness"
PLANE_AXES = (ANKLE, HIP)


@dataclass(frozen=True, slots=True)
class Plane:
    """One plane of ankle × hip: the values of all other parameters."""

    body: Body
    gravity: float
    knee: float
    values: Mapping[str, Any]  # of the other axes, by name
    index: Mapping[str, int]


def planes_of(study: Study, only: Mapping[str, set[int]] | None = None) -> Iterator[Plane]:
    """Go through the planes of ankle × hip of a study, in its order.

    ``only`` keeps those whose index along an axis is in a set.
    """
    others = [name for name in study.axes if name not in PLANE_AXES]
    kept = only or {}
    ranges = (
        [i for i in range(len(study.axes[name])) if i in kept.get(name, {i})] for name in others
    )
    for index in itertools.product(*ranges):
        yield plane_at(study, dict(zip(others, index, strict=True)))


def plane_at(study: Study, index: Mapping[str, int]) -> Plane:
    """Return the plane of ankle × hip at an index of the other axes."""
    values = {name: study.axes[name][i] for name, i in index.items()}
    given = {**study.fixed, **values}
    numbers = {name: float(value) for name, value in given.items() if name != "body_model"}
    return Plane(
        body_of({**numbers, "body_model": REFERENCE_PEOPLE[str(given["body_model"])]}),
        numbers["gravity"],
        numbers.get(KNEE, np.nan),
        values,
        index,
    )


def has_plane(study: Study) -> bool:
    """Return whether ankle and hip are axes of a study, each with two finite values or more."""
    return all(name in study.axes and finite(study.axes[name]).size > 1 for name in PLANE_AXES)


def require_plane(study: Study) -> None:
    """Refuse a study without a plane of ankle × hip.

    Raises
    ------
    InputError
        if ankle or hip is not an axis with two finite values or more.
    """
    if has_plane(study):
        return
    name = next(n for n in PLANE_AXES if n not in study.axes or finite(study.axes[n]).size < 2)
    curves = "thresholds are curves over ankle and hip stiffness"
    if name not in study.axes:
        raise InputError(
            f"{curves}, and {name} is no axis of this study; give it a list or a range"
        )
    raise InputError(f"{curves}, and {name} has fewer than two finite values in this study")


def finite(values: np.ndarray) -> np.ndarray:
    """Return the values of an axis without the infinite one, of a rigid joint."""
    kept: np.ndarray = values[np.isfinite(values)]
    return kept
