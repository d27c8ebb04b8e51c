"""Entries of a row become one number in SI each, or refuse the row."""

import contextlib
from collections.abc import Mapping, Sequence

from standfast.errors import InputError
from standfast.parameters import PARAMETERS, Parameter, number_in
from standfast.population.people.decimals import Comma, both_readings, plain_number
from standfast.population.people.words import AGE, is_nothing

# What height or mass in two units may differ by, relative, as both are rounded.
ALIKE = 0.01
WEIGHT = Parameter("weight", "", "1", "weight of the record", 0.0, 1e12)
RANGES: Mapping[str, Parameter] = {**PARAMETERS, "age": AGE, "weight": WEIGHT}
IN_WORDS = {"m": "metres", "kg": "kilograms"}


def number_of(
    header: Sequence[str],
    holds: str,
    places: Sequence[tuple[int, float]],
    entries: Sequence[str],
    comma: Comma,
) -> str:
    """Return what a row has of a field, in SI; refuse what may be two numbers, or is two."""
    found: list[tuple[str, str]] = []  # the column's name, and the number in SI
    for (place, factor), entry in zip(places, entries, strict=True):
        if (plain := _plain(entry, comma, RANGES.get(holds), factor)) is None:
            raise InputError(
                f"the column {header[place]!r} has {entry!r}, which may be "
                f"{both_readings(entry)}; write one of them"
            )
        if len(places) == 1 or not is_nothing(plain):
            _check_unit(header[place], holds, factor, plain)
            found.append((header[place], plain if factor == 1.0 else _in_si(plain, factor)))
    if len(found) < 2:
        return found[0][1] if found else ""
    try:
        values = [number_in(number) for _, number in found]
    except ValueError:  # what is no number is refused by its own words
        return next(number for _, number in found if not _is_number(number))
    if not max(values) - min(values) <= ALIKE * max(map(abs, values)):
        told = " and ".join(f"{number_in(each):.4g} in {name!r}" for name, each in found)
        unit = PARAMETERS[holds].unit
        raise InputError(f"two of {holds}: {told}, made {unit}; they differ by more than 1 %")
    return found[0][1]


def _check_unit(name: str, holds: str, factor: float, entry: str) -> None:
    """Refuse a number that nobody has in the column's unit, and that would be right in SI."""
    row = RANGES.get(holds)
    if row is None or factor == 1.0 or row.unit not in IN_WORDS or not _is_number(entry):
        return
    number = number_in(entry)
    possible = row.lowest <= number / factor <= row.highest
    if row.lowest <= number <= row.highest and not possible:
        raise InputError(
            f"{entry} in the column {name!r} looks like {IN_WORDS[row.unit]}; write "
            f"{number * factor:.4g}, or name the column {holds}_{row.unit}"
        )


def _is_number(text: str) -> bool:
    with contextlib.suppress(ValueError):
        number_in(text)
        return True
    return False


def _plain(entry: str, comma: Comma, row: Parameter | None, factor: float) -> str | None:
    """Return :func:`.plain_number`; of two numbers that one which alone is in the range."""
    plain = plain_number(entry, comma)
    if plain is not None or row is None:
        return plain
    possible = [
        number
        for number in both_readings(entry).split(" or ")
        if row.lowest <= float(number) / factor <= row.highest
    ]
    return possible[0] if len(possible) == 1 else None


def _in_si(text: str, factor: float) -> str:
    """Turn a number into SI, and leave what is none to be refused with its own words."""
    try:
        return repr(number_in(text) / factor)
    except ValueError:
        return text
