"""Times of a clock in a recording: ``12:30:05.25``, ``00:05,25``, ``2024-05-01 12:30:05.250``."""

import re
from collections.abc import Sequence
from datetime import date

import numpy as np

from standfast.errors import InputError, shortened
from standfast.numerics.arrays import Array

CLOCK = re.compile(
    r"(?:(?P<date>\d{4}-\d\d-\d\d)[T ]\s*)?(?:(?P<hour>\d{1,3}):)?(?P<minute>\d{1,3}):"
    r"(?P<second>\d{1,2}(?:[.,]\d+)?)",
    re.ASCII,
)
MINUTE, HOUR, DAY = 60.0, 3600.0, 86400.0  # s


def is_clock(entries: Sequence[str]) -> bool:
    """Return whether the first time that is there is one of a clock."""
    first = next((entry for entry in entries if entry), "")
    return CLOCK.fullmatch(first) is not None


def clock_seconds(entries: Sequence[str], lines: Sequence[int], name: str) -> Array:
    """Return seconds from the first midnight on, NaN where nothing stands.

    Two parts are minutes and seconds. Without a date a clock that falls back by more than half a
    day has passed midnight.

    Raises
    ------
    InputError
        if an entry is no time, or all are whole seconds, in which steps of samples do not show.
    """
    first = next((found for found in map(CLOCK.fullmatch, entries) if found), None)
    # whole days from the year 1 on would take digits from the seconds
    start = _day(first) if first and _possible(first) else None
    seconds = np.array([
        _seconds(entry, line, name, start) for entry, line in zip(entries, lines, strict=True)
    ])  # fmt: skip
    there = np.isfinite(seconds)
    if not (seconds[there] % 1.0).any():
        raise InputError(
            f"the clock in {name!r} has whole seconds, in which the rate does not show; say the "
            "samples a second as rate=100"
        )
    if start is not None:
        return seconds
    known = seconds[there]
    fallen_back = np.diff(known, prepend=known[:1]) < -0.5 * DAY
    seconds[there] = known + DAY * np.cumsum(fallen_back)
    return seconds


def _seconds(entry: str, line: int, name: str, start: int | None) -> float:
    if not entry:
        return np.nan
    found = CLOCK.fullmatch(entry)
    day = _day(found) if found and _possible(found) else None
    if found is None or not _possible(found) or (day is None) != (start is None):
        raise InputError(
            f"line {line}, column {name!r}: {shortened(entry)} is no time of a clock as the others "
            "are, hh:mm:ss"
        )
    days = 0 if day is None or start is None else day - start
    minutes = HOUR * int(found["hour"] or 0) + MINUTE * int(found["minute"])
    return DAY * days + minutes + float(found["second"].replace(",", "."))


def _day(found: re.Match[str]) -> int | None:
    """Return the number of a day since the year 1, None without a date."""
    return date.fromisoformat(found["date"]).toordinal() if found["date"] else None


def _possible(found: re.Match[str]) -> bool:
    """Return whether minutes below hours, seconds, and a date are such as there are."""
    try:
        date.fromisoformat(found["date"] or "2000-01-01")
    except ValueError:
        return False
    in_hour = found["hour"] is None or int(found["minute"]) < 60
    return in_hour and float(found["second"].replace(",", ".")) < 60.0
