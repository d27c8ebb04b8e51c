"""Which slice of a study a figure shows, as a user names it: ``gravity=1.62``."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from standfast.errors import InputError, nearest_name, shortened
from standfast.parameters import PARAMETERS, number_in
from standfast.study.study import Study

# Sections of a study whose keys tell a parameter alone: ankle is the ankle's stiffness.
SHORT = ("", "body", "stiffness", "feedback")

# What an axis is told apart by, relative; values nearer than that are the same.
SAME = 1e-9


def short_names() -> dict[str, str]:
    """Return the names by which a parameter may be called: its own, and those of a study."""
    names = {row.name: row.name for row in PARAMETERS.values()}
    for row in PARAMETERS.values():
        if row.key:
            names.setdefault(row.place, row.name)
        if row.key and row.section in SHORT:
            names.setdefault(row.key, row.name)
    return names


def full_name(where: str, given: str) -> str:
    """Return the parameter that a user means; refuse what is none."""
    names = short_names()
    if not isinstance(given, str) or given not in names:
        raise InputError(f"{where}: {shortened(given)} is no parameter{nearest_name(given, names)}")
    return names[given]


def in_a_file_name(name: str, value: Any) -> str:
    """Name a value in the name of a file: ``gravity-1.62``, ``knee-rigid``."""
    key = PARAMETERS[name].key
    head = key if key and short_names().get(key) == name else name
    if isinstance(value, str):
        return f"{head}-{value}"
    return f"{head}-rigid" if np.isinf(value) else f"{head}-{float(value):.12g}".replace("+", "")


def value_in(where: str, name: str, given: Any) -> float | str:
    """Return a value of a parameter, a number or a word; ``rigid`` is infinite."""
    row = PARAMETERS[name]
    if row.choices:
        if given not in row.choices:
            raise InputError(
                f"{where}: {name} = {shortened(given)} is not known"
                f"{nearest_name(given, row.choices)} ({', '.join(row.choices)})"
            )
        return str(given)
    if row.or_rigid and given == "rigid":
        return math.inf
    try:
        number = number_in(given) if isinstance(given, str) else float(given)
    except (TypeError, ValueError):
        number = math.nan
    if math.isnan(number):
        raise InputError(f"{where}: {name} = {shortened(given)} is not a number in {row.unit}")
    return number


@dataclass(frozen=True)
class Slice:
    """Places on some axes of a study, and what is to be said of them."""

    index: Mapping[str, int]
    remarks: Sequence[str] = field(default=())


def slice_of(studies: Sequence[Study], at: Mapping[str, Any] | None, where: str = "at") -> Slice:
    """Return the places on the grid nearest to some values; studies share their grid there.

    Raises
    ------
    InputError
        for a name that is no parameter or no axis, and a value beyond its axis.
    """
    if at is not None and not isinstance(at, Mapping):
        raise InputError(f'{where} = {shortened(at)}; give values by name, as {{"gravity": 1.62}}')
    index: dict[str, int] = {}
    remarks: list[str] = []
    for given, wanted in (at or {}).items():
        name = full_name(where, str(given))
        value = value_in(where, name, wanted)
        having = [study for study in studies if name in study.axes]
        if not having:
            raise InputError(f"{where}: {_no_axis(studies[0], name)}")
        axis = having[0].axes[name]
        if any(not np.array_equal(study.axes[name], axis) for study in having):
            raise InputError(f"{where}: {name} has other values in each file; give one file")
        index[name] = place = nearest_place(where, name, axis, value)
        if not _same(axis[place], value):
            unit = PARAMETERS[name].unit
            remarks.append(
                f"{name} = {value:g} is not on the grid; drawn at the nearest, "
                f"{axis[place]:.6g} {unit}"
            )
    return Slice(index, tuple(remarks))


def nearest_place(where: str, name: str, axis: np.ndarray, value: float | str) -> int:
    """Return the place of an axis that is nearest to a value; refuse one beyond its ends."""
    if isinstance(value, str):
        if value not in axis:
            raise InputError(f"{where}: {name} {value} is not in the file ({', '.join(axis)})")
        return int(np.flatnonzero(axis == value)[0])
    if math.isinf(value) and value in axis:
        return int(np.flatnonzero(axis == value)[0])
    low, high = axis[0], axis[np.isfinite(axis)][-1] if np.isfinite(axis).any() else axis[-1]
    if value == math.inf:
        word = "rigid" if PARAMETERS[name].or_rigid else "inf"
        raise InputError(
            f"{where}: {name} = {word} is not on its axis, {low:g} to {high:g} "
            f"{PARAMETERS[name].unit}"
        )
    if not low * (1.0 - SAME) <= value <= high * (1.0 + SAME) and not _same(low, value):
        rigid = " or inf" if np.isinf(axis[-1]) else ""
        raise InputError(
            f"{where}: {name} = {value:g} is beyond its axis, {low:g} to {high:g}{rigid} "
            f"{PARAMETERS[name].unit}"
        )
    return int(np.argmin(np.abs(axis - value)))


def _same(one: Any, other: Any) -> bool:
    return bool(one == other) or (
        not isinstance(other, str) and math.isclose(one, other, rel_tol=SAME)
    )


def _no_axis(study: Study, name: str) -> str:
    axes = f"axes: {', '.join(study.axes) or 'none'}"
    if name in study.fixed:
        value, unit = study.fixed[name], PARAMETERS[name].unit
        words = value if isinstance(value, str) else f"{value:g} {unit}"
        return f"{name} is no axis of this file, in which it is {words} throughout ({axes})"
    return f"{name} is no axis of this file ({axes})"
