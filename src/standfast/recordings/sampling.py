"""The samples of a recording in time: its rate, gaps, and missing samples.

Gaps of up to 0.1 s are filled along a straight line, in which the sway of standing, most of it
below 1 Hz, hardly bends; longer ones, or more than 5 % of all samples, are refused.
"""

from typing import NamedTuple

import numpy as np

from standfast.errors import InputError
from standfast.numerics.arrays import Array
from standfast.recordings.recording import FASTEST, SLOWEST, checked_rate, runs_of

LONGEST_GAP, MOST_MISSING = 0.1, 0.05  # s, share of the samples
UNEVEN = 0.3  # of a step: by what a sample may be off its time
GAP = 1.5  # steps
RATES_DIFFER = 0.01  # relative
ROUND = 1e-4  # a rate within that of one with four digits is that one
ZEROS = 3  # samples of exactly 0, 0 one after the other: what plates write without a load


class Samples(NamedTuple):
    """Evenly spaced samples (n,) of both directions, their rate (Hz), and what was done."""

    ap: Array
    ml: Array
    rate: float
    remarks: list[str]


def evenly(time: Array | None, rate: float, ap: Array, ml: Array, lines: list[int]) -> Samples:
    """Return the samples at even steps, short gaps filled.

    Parameters
    ----------
    time
        s, NaN where it is missing; or None, and ``rate`` says it.
    rate
        Hz; 0 where ``time`` alone says it.
    ap, ml
        NaN where a sample is missing.
    lines
        of the file, for messages; 0 where it has none.

    Raises
    ------
    InputError
        if samples are uneven in time, or too many are missing.
    """
    remarks: list[str] = []
    ap, ml = _without_zeros(ap, ml)
    number = np.array(lines)
    if time is not None:
        timed = np.isfinite(time)
        if timed.sum() < 2:
            raise InputError("the column of time holds no times")
        time, ap, ml, number = time[timed], ap[timed], ml[timed], number[timed]
        place, found = _places(time, number)
        if rate and abs(found / rate - 1.0) > RATES_DIFFER:
            raise InputError(
                f"the column of time says {found:.5g} Hz, and rate={rate:.5g} is given; leave one "
                "away"
            )
        checked_rate("the rate of the column of time", found)
        if place is None:
            said = "samples are not evenly spaced in time, and interpolated to even steps"
            remarks.append(f"{said} of {1e3 / found:.4g} ms")
            there = np.isfinite(ap) & np.isfinite(ml)
            gaps = np.diff(time[there]) * found - 1.0
            _refuse_long(gaps, time[there] - time[0], number[there], found)
            even = np.arange(time[there][0], time[there][-1] + 0.5 / found, 1.0 / found)
            ap, ml = (np.interp(even, time[there], each[there]) for each in (ap, ml))
            return Samples(ap, ml, found, remarks)
        size = int(place[-1]) + 1
        spread = [np.full(size, np.nan) for _ in range(2)]
        spread[0][place], spread[1][place] = ap, ml
        at = np.full(size, -1)
        at[place] = number
        (ap, ml), number, rate = spread, at, found
    return _filled(ap, ml, rate, number, remarks)


def in_seconds(time: Array, unit: float | None) -> tuple[Array, str]:
    """Return times in s; without a unit by their steps, of which ms and s have none in common.

    Of 20 Hz to 10 kHz steps are 0.0001 to 0.05 s, and 0.1 to 50 ms.
    """
    if unit is not None:
        return time * unit, ""
    steps = np.diff(time[np.isfinite(time)])
    step = float(np.median(steps)) if steps.size else 0.0
    if 1e3 / FASTEST <= step <= 1e3 / SLOWEST:
        return time * 1e-3, f"the time, which says no unit, is read as ms: its steps are {step:.4g}"
    return time, ""


def _without_zeros(ap: Array, ml: Array) -> tuple[Array, Array]:
    """Take for missing what plates write where nobody stands: 0, 0, sample after sample."""
    zero = (ap == 0.0) & (ml == 0.0)
    gone = np.zeros(zero.size, dtype=bool)
    for first, length in runs_of(zero):
        gone[first : first + length] = length >= ZEROS
    if gone.all():
        return ap, ml
    return np.where(gone, np.nan, ap), np.where(gone, np.nan, ml)


def _places(time: Array, lines: Array) -> tuple[Array | None, float]:
    """Return the place of each sample among even ones, None if there are no such; and the rate."""
    steps = np.diff(time)
    if (steps < 0.0).any():
        at = int(np.argmax(steps < 0.0)) + 1
        raise InputError(
            f"time goes back in line {lines[at]}, from {time[at - 1]:g} to {time[at]:g} s"
        )
    span = time[-1] - time[0]
    if span == 0.0:
        raise InputError(f"the time is {time[0]:g} s in all samples")
    count = time.size
    # the digits of times may be few: then some are alike, and others one digit apart
    digit = float(steps[steps > 0.0].min()) if (steps == 0.0).any() else 0.0
    even = time[0] + span * np.arange(count) / (count - 1)
    if np.abs(time - even).max() <= max(UNEVEN * span / (count - 1), digit):
        return np.arange(count), _rounded((count - 1) / span)
    if digit:
        at = int(np.argmax(steps == 0.0)) + 1
        raise InputError(f"time stands still in line {lines[at]}, at {time[at]:g} s")
    step = float(np.median(steps))
    ordinary = steps[steps <= GAP * step]
    step = float(ordinary.mean())
    _refuse_long(steps / step - 1.0, time[:-1] - time[0], lines, 1.0 / step)
    if np.abs(ordinary - step).max() > UNEVEN * step:
        return None, _rounded(1.0 / step)
    return np.concatenate([[0], np.cumsum(np.rint(steps / step))]).astype(int), _rounded(1.0 / step)


def _rounded(rate: float) -> float:
    plain = float(f"{rate:.4g}")
    return plain if abs(plain / rate - 1.0) < ROUND else float(rate)


def _filled(ap: Array, ml: Array, rate: float, lines: Array, remarks: list[str]) -> Samples:
    """Cut what is missing at the ends, and fill short gaps."""
    there = np.flatnonzero(np.isfinite(ap) & np.isfinite(ml))
    if there.size < 2:
        raise InputError("it holds no samples of the centre of pressure")
    first, last = int(there[0]), int(there[-1]) + 1
    if cut := ap.size - (last - first):
        remarks.append(f"{_samples(cut)} missing at the ends and left out")
    ap, ml, lines = ap[first:last], ml[first:last], lines[first:last]
    missing = ~(np.isfinite(ap) & np.isfinite(ml))
    runs = runs_of(missing)
    if not runs:
        return Samples(ap, ml, rate, remarks)
    lengths = np.array([length for _, length in runs], float)
    before = np.array([begin - 1 for begin, _ in runs])
    times, lines = (first + before) / rate, lines[before]
    _refuse_long(lengths, times, lines, rate)
    count = int(missing.sum())
    where = f"the first after {times[0]:.4g} s{_line(lines[0])}"
    if count > MOST_MISSING * ap.size:
        raise InputError(
            f"{count:,} of {ap.size:,} samples are missing ({where}); at most "
            f"{100 * MOST_MISSING:g} % are filled"
        )
    places = f"in {len(runs)} places" if len(runs) > 1 else "in one place"
    remarks.append(f"{_samples(count)} missing {places} ({where}) and filled along straight lines")
    at, kept = np.arange(ap.size), ~missing
    ap, ml = (np.interp(at, at[kept], each[kept]) for each in (ap, ml))
    return Samples(ap, ml, rate, remarks)


def _samples(count: int) -> str:
    return "1 sample is" if count == 1 else f"{count:,} samples are"


def _line(number: int) -> str:
    return f", line {number}" if number else ""


def _refuse_long(lengths: Array, starts: Array, lines: Array, rate: float) -> None:
    """Refuse gaps that are too long; ``lengths`` in samples, ``starts`` in s."""
    if lengths.size and lengths.max() > max(LONGEST_GAP * rate, 1.0) + 0.5:
        at = int(np.argmax(lengths))
        raise InputError(
            f"{lengths[at]:,.0f} samples ({lengths[at] / rate:.3g} s) are missing after "
            f"{starts[at]:.4g} s{_line(lines[at])}; up to {LONGEST_GAP:g} s is filled: cut the "
            "recording before or after"
        )
