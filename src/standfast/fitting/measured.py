"""What is known of a person's sway: measures of a recording, or a table's numbers; checked here."""

import math
from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from standfast.errors import InputError, nearest_name, shortened
from standfast.fitting.likelihood import Target
from standfast.fitting.moments import FREQUENCY, MADE_OF, VELOCITY
from standfast.fitting.window import window
from standfast.numerics.arrays import TURN
from standfast.parameters import JOINTS
from standfast.recordings.measures import cop_spectrum, mean_and_median, sway_measures
from standfast.recordings.recording import SHORTEST, Recording, checked_rate
from standfast.stability.sway.density import LOW_PASS

ANGLE, LENGTH = "rad", "m"
# Between what a measure of a person who stands lies; beyond, the unit is wrong.
POSSIBLE: Mapping[str, tuple[float, float, str]] = {
    "sd_ap": (1e-4, 0.1, LENGTH),
    VELOCITY: (2e-4, 1.0, "m/s"),
    FREQUENCY: (0.01, 5.0, "Hz"),
    "sd_com": (5e-5, 0.1, LENGTH),
    "sd_ankle": (5e-5, 0.15, ANGLE),
    "sd_knee": (5e-5, 0.3, ANGLE),
    "sd_hip": (5e-5, 0.3, ANGLE),
}
LONGEST = 1200.0  # s
USUAL = {"duration": 60.0, "rate": 100.0}  # of published tables: s, Hz


class Measured(NamedTuple):
    """Measures by name, in SI, and how they were recorded."""

    values: Mapping[str, float]
    samples: int
    rate: float
    low_pass: float

    @property
    def target(self) -> Target:
        """The measures as a likelihood takes them."""
        names = tuple(name for name in MADE_OF if name in self.values)
        return Target(
            names,
            np.log([self.values[name] for name in names]),
            window(self.samples, self.rate, self.low_pass),
            self.low_pass,
        )


def checked_measures(
    measured: Any, duration: Any, rate: Any, low_pass: Any, joints: tuple[str, ...]
) -> Measured:
    """Return what :func:`.fit.fit_sway` is given of a person.

    Raises
    ------
    InputError
        if it is neither a recording nor measures by name, or a number is out of range.
    """
    cut = _number("low_pass", LOW_PASS / TURN if low_pass is None else low_pass)
    if isinstance(measured, Recording):
        for name, given in (("duration", duration), ("rate", rate)):
            if given is not None:
                raise InputError(
                    f"{name} = {shortened(given)} beside a recording, which has its own"
                )
        _check_window(measured.ap.size / measured.rate, measured.rate, cut)
        values = sagittal_measures(measured, low_pass=low_pass)
        _check(values, joints)
        return Measured(values, measured.ap.size, measured.rate, cut)
    if not isinstance(measured, Mapping):
        raise InputError(
            f"measured = {shortened(measured)}; give a Recording, or measures by name in SI, "
            'as {"sd_ap": 0.004, "mean_velocity_ap": 0.006, "mean_frequency_ap": 0.23}'
        )
    values = {name: _number(name, value) for name, value in measured.items()}
    _check(values, joints)
    per_second = checked_rate("rate", USUAL["rate"] if rate is None else rate)
    seconds = USUAL["duration"] if duration is None else _number("duration", duration)
    _check_window(seconds, per_second, cut)
    return Measured(values, round(seconds * per_second), per_second, cut)


def may_be(name: str, joints: tuple[str, ...]) -> bool:
    """Return whether a law with these joints has a measure: a rigid joint has no angle."""
    joint = name.removeprefix("sd_")
    return joint not in JOINTS or joint in joints


def _check_window(seconds: float, per_second: float, low_pass: float) -> None:
    if not SHORTEST <= seconds <= LONGEST:
        raise InputError(f"duration = {seconds:g} s is outside of {SHORTEST:g} to {LONGEST:g} s")
    if not 1.0 <= low_pass < 0.5 * per_second:
        raise InputError(
            f"low_pass = {low_pass:g} Hz is not between 1 Hz and half of the rate "
            f"({per_second:g} Hz)"
        )


def sagittal_measures(recording: Recording, *, low_pass: float | None = None) -> dict[str, float]:
    """Return SD, mean velocity and mean frequency of the anterior-posterior CoP (m, m/s, Hz).

    They are those of :class:`.measures.SwayMeasures`; the frequency is of this direction alone.
    """
    of_both = sway_measures(recording, low_pass=low_pass)
    hertz, density, _ = cop_spectrum(recording, low_pass=low_pass)
    frequency, _ = mean_and_median(hertz, density)
    return {
        "sd_ap": of_both.sd_ap,
        VELOCITY: of_both.mean_velocity_ap,
        FREQUENCY: frequency,
    }


def _number(name: str, given: Any) -> float:
    try:
        value = float(given)
    except (TypeError, ValueError):
        value = math.nan
    if not math.isfinite(value):
        raise InputError(f"{name} = {shortened(given)} is not a number")
    return value


def _check(values: Mapping[str, float], joints: tuple[str, ...]) -> None:
    """Refuse measures of what is not there, and what no person who stands has."""
    for name, value in values.items():
        if name not in POSSIBLE:
            raise InputError(
                f"{name} is not a measure that can be fitted{nearest_name(name, POSSIBLE)} "
                f"(they are {', '.join(POSSIBLE)})"
            )
        low, high, unit = POSSIBLE[name]
        if not low <= value <= high:
            raise InputError(
                f"{name} = {value:g} {unit} is outside of {low:g} to {high:g} {unit}, between "
                "which people are; is the unit right?"
            )
        if not may_be(name, joints):
            joint = name.removeprefix("sd_")
            raise InputError(f"{name} is given, but the law holds the {joint} rigid")
    if not values:
        raise InputError(f"measured holds nothing; the measures are {', '.join(POSSIBLE)}")
    if len(joints) == 1 and {"sd_com", "sd_ankle"} <= set(values):
        raise InputError(
            "sd_com and sd_ankle are one motion in a law of the ankle alone; give one of them"
        )
