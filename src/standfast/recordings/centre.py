"""The centre of pressure out of the columns of a table: measured, or of forces and moments.

notation: Fx … My force (N) and moment (N·m) about the origin of the plate's axes x, y, z.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from standfast.errors import InputError
from standfast.numerics.arrays import Array
from standfast.recordings.columns import Column, chosen, in_ground_frame, listed, unit_of
from standfast.recordings.plates import Choice, Plate, names_read, person_on
from standfast.recordings.table import Table, numbers_in

WRITE = (
    "name columns COP_AP (mm) and COP_ML (mm), or COPx and COPy, or Fz (N), Mx (N·m) and My (N·m), "
    "or say by ap=… and ml=… which columns, by name or number"
)
AXES = ("x", "y")
DIRECTIONS = ("ap", "ml")
Found = dict[str, list[Column]]


class Wanted(NamedTuple):
    """What a user says of the centre of pressure: columns or an axis, unit, surface (m), plates."""

    ap: str | None
    ml: str | None
    unit: str | None
    surface: float
    choice: Choice


def centre_of(table: Table, found: Found, wanted: Wanted) -> tuple[tuple[Array, Array], list[str]]:
    """Return both directions (m, NaN where missing), and what is to be said of the choice."""
    ap, ml, unit = wanted[:3]
    up = in_ground_frame(each for columns in found.values() for each in columns)
    floor = ("x", "z") if up else AXES
    ahead, aside = (None if each is None else each.strip().lower() for each in (ap, ml))
    axis = next((a for a in floor if ahead == a or (aside in floor and aside != a)), None)
    if ahead in floor and ahead == aside:
        raise InputError(f"ap={ahead} and ml={aside} are the same; give one")
    if axis and None not in (ahead, aside) and not {ahead, aside} <= {*floor}:
        raise InputError(
            f"ap={ahead} and ml={aside}: give two columns, or an axis of the plate alone"
        )
    if up and "y" in (ahead, aside):
        raise InputError("ap=y or ml=y: y points up in this file; give x or z")
    if axis is None and (ap is not None or ml is not None):
        pair = [
            chosen(name, given, table.names, table.units, "length")
            if given is not None
            else only(found.get(name, []), name)
            for name, given in (("ap", ap), ("ml", ml))
        ]
        if wanted.choice != Choice():
            raise InputError(
                "plate=… beside ap=… and ml=…, which name the columns of one centre of pressure; "
                "leave one away"
            )
        return _pair(table, found, pair, unit), _not_used(wanted)
    if axis is None and not {*DIRECTIONS}.isdisjoint(found):
        return _of_plates(table, found, DIRECTIONS, wanted)
    said = [] if axis else [
        f"x is taken as anterior-posterior and {floor[1]} as mediolateral, as "
        f"{'OpenSim has' if up else 'Santos & Duarte have'} it; if the plate lies otherwise write "
        f"ap={floor[1]}"
    ]  # fmt: skip
    both, more = _of_plates(table, found, AXES, wanted)
    return (both[::-1] if axis == floor[1] else both), [*said, *more]


def only(several: Sequence[Column], holds: str) -> Column | None:
    """Return the only column that holds something; refuse several."""
    if len(several) > 1:
        places = " and ".join(f"{c.name!r} (column {c.place + 1})" for c in several[:3])
        raise InputError(
            f"{places} both hold {holds}; keep one in the file, or say by ap=… and ml=… the "
            "numbers of the columns of the centre of pressure"
        )
    return several[0] if several else None


def _of_plates(
    table: Table, found: Found, axes: tuple[str, str], wanted: Wanted
) -> tuple[tuple[Array, Array], list[str]]:
    """Return the centre of pressure along two axes, of one plate or of all."""
    held = (*axes, "Fx", "Fy", "Fz", "Mx", "My")
    measured = not {*axes}.isdisjoint(found)
    there = {
        c.plate for holds in (axes if measured else ("Mx", "My")) for c in found.get(holds, [])
    }
    named = {c.plate for holds in held for c in found.get(holds, [])} - {""}
    if there == {"", *named} and len(named) == 1 and not wanted.choice.alone:
        raise InputError(
            f"columns of plate {max(named)} stand beside such that name no plate, and whether "
            "these are of another plate or of all is not clear; number both, as COPx1 and COPx2, "
            "or say by ap=… and ml=… which columns are of the person"
        )
    if "" not in there:  # no sum, so that all plates with a load count
        there |= {c.plate for c in found.get("Fz", [])} - ({""} if there else set())
    names = names_read(there, wanted.choice)
    own = {
        name: {
            holds: only([c for c in found.get(holds, []) if c.plate == name], holds)
            for holds in held
        }
        for name in names or [""]
    }
    if measured and len(own) == 1:
        (columns,) = own.values()
        loads: Found = {"Fz": [load]} if (load := columns["Fz"]) else found
        pair = [columns[axis] for axis in axes]
        return _pair(table, loads, pair, wanted.unit), _not_used(wanted)
    plates = [
        _loaded(table, name, columns, axes, wanted.unit)
        if measured
        else _of_moments(table, name, columns, wanted)
        for name, columns in own.items()
    ]
    first, second, said = person_on(
        plates,
        wanted.choice,
        lambda at: f"in line {table.lines[at]}",
        one_frame=in_ground_frame(c for columns in own.values() for c in columns.values() if c),
    )
    return (first, second), [*said, *(_not_used(wanted) if measured else [])]


def _not_used(wanted: Wanted) -> list[str]:
    """Say that a height means nothing where the centre of pressure is in the file."""
    if not wanted.surface:
        return []
    return [f"surface={wanted.surface:g} is not used, as the centre of pressure is in the file"]


def _pair(
    table: Table, found: Found, pair: Sequence[Column | None], unit: str | None
) -> tuple[Array, Array]:
    """Return two columns of the centre of pressure; a load beside them tells who steps off."""
    first, second = pair
    if first is None or second is None:
        there = first or second
        alone = f"{there.name!r} is alone" if there else "no column is of the centre of pressure"
        raise InputError(f"{alone}; {WRITE} {listed(table.names)}")
    if first.place == second.place:
        raise InputError(f"both directions are the column {first.name!r}; give two")
    factors = [_factor(column, unit, "length") for column in (first, second)]
    loads = found.get("Fz", [])
    if len(loads) != 1:
        x, y = numbers_in(table, [first.place, second.place])
        return factors[0] * x, factors[1] * y
    load, x, y = numbers_in(table, [loads[0].place, first.place, second.place])
    nothing = (load == 0.0) & (x == 0.0) & (y == 0.0)  # nothing was measured there
    x, y = (np.where(nothing, np.nan, f * each) for f, each in zip(factors, (x, y), strict=True))
    plate = Plate("", (loads[0].unit or 1.0) * load, load * x, load * y)
    person_on([plate], Choice(), lambda at: f"in line {table.lines[at]}")
    return x, y


def _loaded(
    table: Table,
    name: str,
    columns: dict[str, Column | None],
    axes: Sequence[str],
    unit: str | None,
) -> Plate:
    """Return a plate of which the centre of pressure and the load are there."""
    load, first, second = _there(table, name, columns, ("Fz", *axes))
    x, y = (_factor(column, unit, "length") for column in (first, second))
    numbers = numbers_in(table, [load.place, first.place, second.place])
    force = (load.unit or 1.0) * numbers[0]
    # without a load, some programs write no centre of pressure, which then does not count
    each = (
        np.where(force == 0.0, 0.0, force * f * n) for f, n in zip((x, y), numbers[1:], strict=True)
    )
    return Plate(name, force, *each)


def _of_moments(
    table: Table, name: str, columns: dict[str, Column | None], wanted: Wanted
) -> Plate:
    """Return a plate from its forces and moments: Fz x = d Fx − My, Fz y = d Fy + Mx."""
    d = wanted.surface
    some = _there(table, name, columns, ("Fz", "Mx", "My", *(("Fx", "Fy") if d else ())))
    factors = [
        _factor(column, wanted.unit, "moment") if place in (1, 2) else column.unit or 1.0
        for place, column in enumerate(some)
    ]
    columns_of = numbers_in(table, [column.place for column in some])
    numbers = [f * each for f, each in zip(factors, columns_of, strict=True)]
    load, mx, my = numbers[:3]
    fx, fy = numbers[3:] if d else (0.0, 0.0)
    return Plate(name, load, d * fx - my, d * fy + mx)


def _there(
    table: Table, name: str, columns: dict[str, Column | None], wanted: Sequence[str]
) -> list[Column]:
    """Return the columns that are wanted of a plate; say which are missing."""
    found = [columns[holds] for holds in wanted]
    missing = [holds for holds, column in zip(wanted, found, strict=True) if column is None]
    if missing:
        of = f" of plate {name}" if name else ""
        verb = "is" if len(missing) == 1 else "are"
        some = any(columns.values())
        what = (
            f"{' and '.join(missing)}{of} {verb} missing"
            if some
            else "no centre of pressure is there"
        )
        raise InputError(f"{what}; {WRITE} {listed(table.names)}")
    return [column for column in found if column is not None]


def _factor(column: Column, unit: str | None, kind: str) -> float:
    """Return how many SI units one of a column is, by its name or by the option."""
    if unit is not None:
        factor = unit_of("unit", unit, kind)
        if column.unit is not None and factor != column.unit:
            raise InputError(f"unit={unit} is not what the column {column.name!r} says")
        return factor
    if column.unit is None:
        write = "unit=Nm or unit=Nmm" if kind == "moment" else "unit=m, unit=cm or unit=mm"
        raise InputError(f"the column {column.name!r} says no unit; write {write}")
    return column.unit
