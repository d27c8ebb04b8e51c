"""Where the sliders of the page begin, end and stand at the start."""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from standfast.errors import InputError
from standfast.parameters import OWN_BODY, PARAMETERS, SEGMENT_PARAMETERS, Parameter
from standfast.study.study import Study
from standfast.study.values import check_complete

# What a slider spans where no study says it: people, and what is looked at of them. A typed number
# may reach as far as the table of parameters does. By name, else by section and unit.
SPANS = {
    "gravity": (1.0, 20.0),
    "height": (1.0, 2.2),
    "mass": (20.0, 160.0),
    "bmi": (12.0, 50.0),
    "ankle_stiffness": (0.0, 2000.0),
    "knee_stiffness": (0.0, 5000.0),
    "hip_stiffness": (0.0, 1500.0),
    "feedback_delay": (0.0, 0.5),
    "damping": (0.0, 100.0),
    "stiffness": (-300.0, 300.0),  # that couple joints
    "feedback.proportional": (-500.0, 1500.0),
    "feedback.derivative": (-150.0, 450.0),
    "noise": (0.0, 5.0),
}
STEPS = 200  # of a slider from end to end, about
OWN = "own"  # who is measured segment by segment, among the models of a body
SCALED = ("height", "mass", "bmi", "body_model")  # of a body that is not measured
SIZES = ("mass", "bmi")  # a body has one of them


def span_of(row: Parameter, axis: np.ndarray | None, start: float) -> tuple[float, float, float]:
    """Return the ends of a slider, those of the study's axis if it has one, and its step."""
    low, high = SPANS[row.name] if row.name in SPANS else SPANS[row.section]
    if axis is not None and np.isfinite(axis).sum() > 1:
        finite = axis[np.isfinite(axis)]
        low, high = float(finite[0]), float(finite[-1])
    if math.isfinite(start):
        low, high = min(low, start), max(high, start)
    return low, high, round_step((high - low) / STEPS)


def round_step(size: float) -> float:
    """Return the largest of 1, 2 and 5 times a power of ten that is no longer than a size."""
    power = math.floor(math.log10(size) + 1e-9)
    digit = next(d for d in (5, 2, 1) if d * 10.0**power <= size * (1.0 + 1e-9))
    return float(f"{digit}e{power}")


def start_of(
    study: Study,
    person: Mapping[str, float | str],
    *,
    stops: Mapping[str, np.ndarray] | None = None,
) -> dict[str, float | str]:
    """Return the value of each parameter with which the page opens.

    What a study fixes; the middle of what varies; the defaults of what it leaves out; and before
    all of these what is said of a ``person``, by name and checked one by one.

    Parameters
    ----------
    stops
        of an atlas the values of its axes, of which the nearest is taken.

    Raises
    ------
    InputError
        if a person has a parameter that cannot be chosen, or no such body can be.
    """
    own = not study.parameters.keys().isdisjoint(OWN_BODY)
    start: dict[str, float | str] = {
        row.name: row.default
        for row in PARAMETERS.values()
        if stops is None and row.default is not None and not (own and row.section == "body")
    }
    start |= study.fixed
    start |= {name: _middle(axis) for name, axis in (stops or study.axes).items()}
    if own and stops is None:
        _refuse_varying_segments(study)
    given = _sized_as(start, person)
    for name, value in given.items():
        if own and name not in study.axes and PARAMETERS[name].section.startswith("body"):
            raise InputError(
                f"--person: {name} is not for a body of measured segments "
                f"({', '.join(SEGMENT_PARAMETERS)})"
            )
        if stops is None and name in OWN_BODY:
            raise InputError(
                f"--person: {name} is of measured segments; give a study with all of them, or "
                "height, mass and body_model"
            )
        if stops is None:
            start[name] = value
        elif name in stops:
            start[name] = _nearest(name, stops[name], value)
        elif value != start.get(name):
            raise InputError(f"--person: {name} is no axis of the atlas (axes: {', '.join(stops)})")
    if stops is None:
        check_complete(start)
        if own:
            start["body_model"] = OWN
    return start


def _middle(axis: np.ndarray) -> Any:
    """Return the value in the middle of an axis, as the figures take it."""
    finite = axis if axis.dtype.kind not in "fi" else axis[np.isfinite(axis)]
    found = finite if len(finite) else axis
    return found[len(found) // 2].item()


def _sized_as(
    start: Mapping[str, Any], person: Mapping[str, float | str]
) -> dict[str, float | str]:
    """Say a person's mass as a BMI, or the other way round, if the page has the other."""
    given = dict(person)
    both = [name for name in SIZES if name in given]
    if len(both) > 1:
        raise InputError("--person: give mass or bmi, one of them")
    for name in both:
        other = SIZES[1 - SIZES.index(name)]
        if name not in start and other in start:
            square = float(given.get("height", start["height"])) ** 2
            value = float(given.pop(name))
            given[other] = value / square if other == "bmi" else value * square
    return given


def _nearest(name: str, axis: np.ndarray, value: float | str) -> Any:
    """Return the value of an axis that is nearest to a person's; refuse one beyond its ends."""
    from_axis = axis.tolist()
    if value in from_axis:
        return value
    row = PARAMETERS[name]
    finite = axis[np.isfinite(axis)] if not row.choices else axis
    if isinstance(value, str) or math.isinf(value) or not finite[0] <= value <= finite[-1]:
        words = from_axis if row.choices else [f"{v:g}" for v in (axis[0], axis[-1])]
        between = ", ".join(words) if row.choices else " to ".join(words)
        said = value if isinstance(value, str) else f"{value:g}"
        raise InputError(f"--person: {name} = {said} is not on its axis ({between})")
    return finite[int(np.argmin(np.abs(finite - value)))].item()


def _refuse_varying_segments(study: Study) -> None:
    """Refuse a study in which a body's own segments vary, which the page has no sliders for."""
    varying = [name for name in OWN_BODY if name in study.axes]
    if varying:
        raise InputError(
            f"{', '.join(varying)} vary in the study, and the page has no sliders for segments; "
            "sweep the study, and explore the atlas"
        )
