"""Planes of two axes of a study; on those of ankle × hip stiffness the limit of springs alone.

With springs alone the limit of standing over ankle and hip is one falling curve, in closed form.
"""

import itertools
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from standfast.anthropometry.body import Body, named_body
from standfast.errors import InputError
from standfast.mechanics.joints import NO_COUPLING
from standfast.parameters import COUPLINGS, PARAMETERS
from standfast.stability.springs import critical_ankle_stiffness, critical_hip_stiffness
from standfast.study.study import Study

ANKLE, KNEE, HIP = "ankle_stiffness", "knee_stiffness", "hip_stiffness"
PLANE_AXES = (ANKLE, HIP)
DELAY = "feedback_delay"

# A plane is drawn of axes with at least so many finite values; fewer are curves side by side.
LEAST_SIDE = 8


@dataclass(frozen=True, slots=True)
class Plane:
    """One plane of ankle × hip: the person, and the values of a study's other axes by name."""

    body: Body
    gravity: float
    knee: float
    couplings: tuple[float, float, float] = NO_COUPLING
    values: Mapping[str, Any] = field(default_factory=dict)
    index: Mapping[str, int] = field(default_factory=dict)

    def critical_hips(self, ankles: np.ndarray) -> np.ndarray:
        """Return the hip stiffness at which the person just stands, for each ankle stiffness."""
        hips: np.ndarray = critical_hip_stiffness(
            self.body, ankles, self.knee, self.gravity, self.couplings
        )
        return hips

    def critical_ankles(self, hips: np.ndarray) -> np.ndarray:
        """Return the ankle stiffness at which the person just stands, for each hip stiffness."""
        ankles: np.ndarray = critical_ankle_stiffness(
            self.body, self.knee, hips, self.gravity, self.couplings
        )
        return ankles

    def limit_of_standing(
        self, ankles: np.ndarray, hips: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Return the exact limit between the ends of both axes: ankle and hip (N·m/rad).

        The curve is taken at every finite value of both, so that both of its steep ends are
        followed.
        """
        ankles, hips = finite(ankles), finite(hips)
        ankle = np.concatenate([self.critical_ankles(hips), ankles])
        hip = np.concatenate([hips, self.critical_hips(ankles)])
        inside = (ankle >= ankles[0]) & (ankle <= ankles[-1]) & (hip >= hips[0]) & (hip <= hips[-1])
        order = np.lexsort((-hip[inside], ankle[inside]))
        return ankle[inside][order], hip[inside][order]


def planes_of(study: Study) -> Iterator[Plane]:
    """Go through the planes of ankle × hip of a study, in its order."""
    others = [name for name in study.axes_of("stable") if name not in PLANE_AXES]
    for index in itertools.product(*(range(len(study.axes[name])) for name in others)):
        yield plane_at(study, dict(zip(others, index, strict=True)))


def plane_at(study: Study, index: Mapping[str, int]) -> Plane:
    """Return the plane of ankle × hip at an index of the other axes."""
    values = {name: study.axes[name][i] for name, i in index.items()}
    given = {**study.fixed, **values}
    numbers = {name: float(value) for name, value in given.items() if name != "body_model"}
    body = named_body(given)
    ankle_knee, knee_hip, ankle_hip = (numbers.get(name, 0.0) for name in COUPLINGS)
    knee, couplings = numbers.get(KNEE, np.nan), (ankle_knee, knee_hip, ankle_hip)
    return Plane(body, numbers["gravity"], knee, couplings, values, index)


def axes_of_plane(study: Study, dims: Iterable[str]) -> tuple[str, str] | None:
    """Choose the two axes of a plane among ``dims``, the horizontal one first; None if none fit.

    Ankle and hip where the limit has a closed form; else the two longest axes, the delay only
    where no third is long enough. The delay runs horizontally, other axes in the order of the table
    of parameters.
    """
    own = list(dims)
    if set(PLANE_AXES) <= set(own) and has_closed_form(study):
        return PLANE_AXES
    sizes = {name: finite(study.axes[name]).size for name in own if not PARAMETERS[name].choices}
    long = [name for name, size in sizes.items() if size >= LEAST_SIDE]
    chosen = sorted(long, key=lambda name: (name == DELAY, -sizes[name]))[:2]
    order = list(PARAMETERS)
    chosen.sort(key=lambda name: (name != DELAY, order.index(name)))
    return (chosen[0], chosen[1]) if len(chosen) == 2 else None


def axis_of_curves(dims: Iterable[str], plane: tuple[str, str]) -> str | None:
    """Choose the axis whose values are curves on one plane: delay, knee, model, or the first."""
    left = [name for name in dims if name not in plane]
    return next((name for name in (DELAY, KNEE, "body_model", *left) if name in left), None)


def has_closed_form(study: Study) -> bool:
    """Return whether springs alone decide, over ankle and hip with two finite values or more."""
    return not study.has_gains and all(
        name in study.axes and finite(study.axes[name]).size > 1 for name in PLANE_AXES
    )


def require_closed_form(study: Study) -> None:
    """Refuse a study without a plane of ankle × hip, or with feedback."""
    if study.has_gains:
        raise InputError(
            "with feedback the limit of standing has no closed form; sweep the study, "
            "and ask for the thresholds of the file"
        )
    curves = "thresholds are curves over ankle and hip stiffness"
    for name in PLANE_AXES:
        if name not in study.axes:
            raise InputError(
                f"{curves}, and {name} is no axis of this study; give it a list or a range"
            )
        if finite(study.axes[name]).size < 2:
            raise InputError(f"{curves}, and {name} has fewer than two finite values in this study")


def is_log(study: Study, axis: str) -> bool:
    """Return whether the values of an axis rise by factors, not by steps."""
    values = finite(study.axes[axis])
    if values.size < 3 or values[0] <= 0.0:
        return False
    steps, factors = np.diff(values), values[1:] / values[:-1]
    even = np.ptp(steps) <= 1e-6 * steps.max()
    return bool(not even and np.ptp(np.log(factors)) <= 1e-6 * np.log(factors).max())


def finite(values: np.ndarray) -> np.ndarray:
    """Return the values of an axis without the infinite one, of a rigid joint."""
    kept: np.ndarray = values[np.isfinite(values)]
    return kept
