"""A recording of the centre of pressure, and what a recording of standing must be."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from standfast.errors import InputError, shortened
from standfast.numerics.arrays import Array

SHORTEST = 5.0  # s
# Windows of 30 s, half overlapping: three of them.
ENOUGH = 60.0
SLOWEST, FASTEST = 20.0, 10_000.0  # Hz
# Root mean square distance from the mean (m): no one who stands is outside of the first limits; by
# their published areas nearly all of 1,930 trials of Santos & Duarte, eyes closed on foam too, are
# inside of the second.
POSSIBLE, USUAL = (1e-4, 0.1), (8e-4, 0.03)
NOISY = 150.0  # Hz; faster, differences of samples are mostly the plate's noise
JUMP = 2.0  # m/s
ONE_LINE = 1.0 - 1e-9  # correlation: beyond, rounding decides the ellipse's area
STUCK = 1.0  # s
LENGTHS = {"m": 1.0, "mm": 1e-3, "micrometres": 1e-6}


@dataclass(frozen=True, eq=False)
class Recording:
    """The centre of pressure of a person who stands on a force plate, evenly sampled.

    Attributes
    ----------
    ap, ml : (n,), m
        anterior-posterior and mediolateral, about any origin.
    rate : Hz
    name
        what tables and figures call it.
    remarks
        what is to be known of how it was read, and of what is unusual in it.

    Raises
    ------
    InputError
        if it is no recording of quiet standing: shorter than 5 s, slower than 20 Hz, with missing
        samples, without any motion, or with a motion of metres or micrometres.

    Examples
    --------
    >>> import numpy as np
    >>> import standfast as sf
    >>> t = np.arange(6000) / 100                       # s
    >>> ap = 0.004 * np.sin(2 * np.pi * 0.25 * t)       # m
    >>> ml = 0.002 * np.cos(2 * np.pi * 0.25 * t)
    >>> recording = sf.Recording(ap, ml, rate=100.0)
    >>> recording.duration
    59.99
    """

    ap: Array
    ml: Array
    rate: float
    name: str = ""
    remarks: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        ap, ml = _column("ap", self.ap), _column("ml", self.ml)
        if ap.size != ml.size:
            raise InputError(f"ap has {ap.size} samples and ml {ml.size}; give as many of both")
        rate = checked_rate("rate", self.rate)
        _check_duration(ap.size, rate)
        _check_motion(ap, ml)
        said = (*self.remarks, *_unusual(ap, ml, rate))
        object.__setattr__(self, "ap", ap)
        object.__setattr__(self, "ml", ml)
        object.__setattr__(self, "rate", rate)
        object.__setattr__(self, "remarks", tuple(dict.fromkeys(said)))

    @property
    def duration(self) -> float:
        """From the first to the last sample (s)."""
        return float(self.ap.size - 1) / self.rate

    @property
    def time(self) -> Array:
        """Of each sample, from 0 (s)."""
        times: Array = np.arange(self.ap.size) / self.rate
        return times


def checked_recording(given: Any) -> Recording:
    """Return what must be a recording.

    Raises
    ------
    InputError
        if it is none.
    """
    if not isinstance(given, Recording):
        raise InputError(
            f"recording = {shortened(given)}; give what read_recording returns, or a Recording"
        )
    return given


def checked_rate(where: str, given: Any) -> float:
    """Return a rate (Hz) at which velocities mean something.

    Raises
    ------
    InputError
        if it is none.
    """
    try:
        rate = float(given)
    except (TypeError, ValueError):
        raise InputError(f"{where} = {shortened(given)} is not a number of Hz") from None
    if not SLOWEST <= rate <= FASTEST:
        slow = "; velocities need 20 Hz or more" if 0.0 < rate < SLOWEST else ""
        raise InputError(
            f"{where} = {rate:.4g} Hz is outside of {SLOWEST:g} to {FASTEST:,.0f} Hz{slow}"
        )
    return rate


def _column(name: str, given: Any) -> Array:
    try:
        found: Array = np.array(given, dtype=np.float64)
    except (TypeError, ValueError):
        raise InputError(f"{name} = {shortened(given)} is not a row of numbers (m)") from None
    if found.ndim != 1:
        raise InputError(f"{name} has the shape {found.shape}; give one number a sample (m)")
    if missing := int((~np.isfinite(found)).sum()):
        raise InputError(f"{name} has {missing} samples that are no numbers")
    found.setflags(write=False)
    return found


def _check_duration(count: int, rate: float) -> None:
    if count / rate < SHORTEST:
        raise InputError(
            f"it is {count / rate:.3g} s long ({count:,} samples at {rate:.6g} Hz); sway needs "
            f"{SHORTEST:g} s at the least, and its frequencies {ENOUGH:g} s"
        )


def _check_motion(ap: Array, ml: Array) -> None:
    for name, column in (("anterior-posterior", ap), ("mediolateral", ml)):
        if (column == column[0]).all():
            raise InputError(f"the {name} centre of pressure is the same in all samples")
    with np.errstate(over="ignore", invalid="ignore"):  # of what no plate measures
        distance = float(np.hypot(ap.std(), ml.std()))
    if not POSSIBLE[0] <= distance <= POSSIBLE[1]:
        raise InputError(
            f"the centre of pressure moves by {_in_words(distance)} about its mean, and that of a "
            f"person who stands by some millimetres; is the unit right, and is it one person who "
            "stands all the time?"
        )
    if abs(np.corrcoef(ap, ml)[0, 1]) > ONE_LINE:
        raise InputError("both directions are the same motion; are two columns the same?")


def _in_words(length: float) -> str:
    unit = "m" if length >= 1.0 else "mm" if length >= POSSIBLE[0] else "micrometres"
    return f"{length / LENGTHS[unit]:.3g} {unit}"


def _unusual(ap: Array, ml: Array, rate: float) -> list[str]:
    """Say what does not forbid a recording, but must be known of it."""
    said = []
    seconds = ap.size / rate
    if seconds < ENOUGH * (1.0 - 1e-3):
        said.append(
            f"it is {seconds:.3g} s long; frequencies need {ENOUGH:g} s (windows of "
            f"{window_of(ap.size, rate) / rate:.3g} s instead of 30 s), and area and SD grow with "
            "the duration: compare with others of this length alone"
        )
    distance = float(np.hypot(ap.std(), ml.std()))
    if not USUAL[0] <= distance <= USUAL[1]:
        said.append(
            f"the centre of pressure moves by {_in_words(distance)} about its mean, which is "
            f"{'little' if distance < USUAL[0] else 'much'}; is the unit right?"
        )
    if rate > NOISY:
        said.append(
            f"at {rate:.6g} Hz path and velocity hold much of the plate's noise unless a low-pass "
            "is used (low_pass=10); the published ones are at 100 Hz"
        )
    steps = np.hypot(np.diff(ap), np.diff(ml))
    at = int(np.argmax(steps))
    if steps[at] * rate > JUMP:
        said.append(
            f"the centre of pressure jumps by {_in_words(float(steps[at]))} at {at / rate:.4g} s, "
            "which path and velocity hold"
        )
    if stuck := _longest_run(steps == 0.0):
        first, length = stuck
        if length / rate >= STUCK:
            said.append(
                f"the centre of pressure does not change for {length / rate:.3g} s from "
                f"{first / rate:.4g} s on"
            )
    return said


def _longest_run(where: Array) -> tuple[int, int] | None:
    runs = runs_of(where)
    return max(runs, key=lambda run: run[1]) if runs else None


def runs_of(where: Array) -> Sequence[tuple[int, int]]:
    """Return first place and length of each run of true values."""
    edges = np.diff(np.concatenate([[False], where, [False]]).astype(np.int8))
    first, after = np.flatnonzero(edges == 1), np.flatnonzero(edges == -1)
    return [(int(a), int(b - a)) for a, b in zip(first, after, strict=True)]


def window_of(count: int, rate: float) -> int:
    """Return the samples of a window of spectra: 30 s, or half of a shorter recording."""
    return int(min(round(0.5 * ENOUGH * rate), count // 2))
