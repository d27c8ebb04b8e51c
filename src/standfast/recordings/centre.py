"""The centre of pressure out of the columns of a table: measured, or of forces and moments.

notation: Fx … My force (N) and moment (N·m) about the origin of the plate's axes x, y, z.
"""

from collections.abc import Sequence

import numpy as np

from standfast.errors import InputError
from standfast.numerics.arrays import Array
from standfast.recordings.columns import Column, chosen, listed, unit_of
from standfast.recordings.table import Table, numbers_in

WRITE = (
    "name columns COP_AP (mm) and COP_ML (mm), or COPx and COPy, or Fz (N), Mx (N·m) and My (N·m), "
    "or say by ap=… and ml=… which columns, by name or number"
)
AXES = ("x", "y")
OFF_PLATE = 0.2  # of the median load
LIGHTEST = 50.0  # N


def centre_of(
    table: Table,
    found: dict[str, list[Column]],
    ap: str | None,
    ml: str | None,
    unit: str | None,
    surface: float,
) -> tuple[tuple[Array, Array], list[str]]:
    """Return both directions (m, NaN where missing), and what is to be said of the choice."""
    ahead, aside = (None if each is None else each.strip().lower() for each in (ap, ml))
    axis = next((a for a in AXES if ahead == a or (aside in AXES and aside != a)), None)
    if ahead in AXES and ahead == aside:
        raise InputError(f"ap={ahead} and ml={aside} are the same; give one")
    if axis and None not in (ahead, aside) and not {ahead, aside} <= {*AXES}:
        raise InputError(
            f"ap={ahead} and ml={aside}: give two columns, or an axis of the plate alone"
        )
    if axis is None and (ap is not None or ml is not None):
        pair = [
            chosen(name, given, table.names, table.units, "length")
            if given is not None
            else only(found, name)
            for name, given in (("ap", ap), ("ml", ml))
        ]
        return _pair(table, found, pair, unit), []
    if axis is None and ("ap" in found or "ml" in found):
        return _pair(table, found, [only(found, name) for name in ("ap", "ml")], unit), []
    said = [] if axis else [
        "x is taken as anterior-posterior and y as mediolateral, as Santos & Duarte have it; if "
        "the plate lies otherwise write ap=y"
    ]  # fmt: skip
    if "x" in found or "y" in found:
        pair = [only(found, a) for a in AXES]
        both = _pair(table, found, pair, unit)
    else:
        both = _of_moments(table, found, unit, surface)
    return (both[::-1] if axis == "y" else both), said


def only(found: dict[str, list[Column]], holds: str) -> Column | None:
    """Return the only column that holds something; refuse several."""
    several = found.get(holds, [])
    if len(several) > 1 and holds[0] in "FM":
        raise InputError(
            f"{several[0].name!r} and {several[1].name!r} are of two plates, and where they lie to "
            "each other is not known; put the centre of pressure of both into the file, (Fz1 CoP1 "
            "+ Fz2 CoP2)/(Fz1 + Fz2) with each CoP in one frame, as columns COP_AP (mm) and COP_ML "
            "(mm), or keep one plate"
        )
    if len(several) > 1:
        places = " and ".join(f"{c.name!r} (column {c.place + 1})" for c in several[:3])
        raise InputError(
            f"{places} both hold {holds}; keep one in the file, or say by ap=… and ml=… the "
            "numbers of the columns of the centre of pressure"
        )
    return several[0] if several else None


def _pair(
    table: Table, found: dict[str, list[Column]], pair: Sequence[Column | None], unit: str | None
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
    load = loads[0] if len(loads) == 1 else None
    places = [first.place, second.place, *([load.place] if load else [])]
    columns = numbers_in(table, places)
    if load:
        _check_load(columns[2] * (load.unit or 1.0), table)
    return columns[0] * factors[0], columns[1] * factors[1]


def _of_moments(
    table: Table, found: dict[str, list[Column]], unit: str | None, surface: float
) -> tuple[Array, Array]:
    """Return the centre of pressure from forces and moments."""
    wanted = ["Fz", "Mx", "My", *(("Fx", "Fy") if surface else ())]
    columns = {holds: only(found, holds) for holds in wanted}
    missing = [holds for holds, column in columns.items() if column is None]
    if missing:
        some = "Fz" in found or "Mx" in found or "My" in found
        verb = "is" if len(missing) == 1 else "are"
        what = (
            f"{' and '.join(missing)} {verb} missing" if some else "no centre of pressure is there"
        )
        raise InputError(f"{what}; {WRITE} {listed(table.names)}")
    there = {holds: column for holds, column in columns.items() if column is not None}
    numbers = dict(zip(there, numbers_in(table, [c.place for c in there.values()]), strict=True))
    for holds, column in there.items():
        factor = _factor(column, unit, "moment") if holds[0] == "M" else column.unit or 1.0
        numbers[holds] = numbers[holds] * factor
    load = numbers["Fz"]
    _check_load(load, table)
    lean = {axis: surface * numbers[f"F{axis}"] if surface else 0.0 for axis in AXES}
    return (lean["x"] - numbers["My"]) / load, (lean["y"] + numbers["Mx"]) / load


def _check_load(load: Array, table: Table) -> None:
    """Refuse a recording on which nobody stands all the time."""
    there = np.isfinite(load)
    size = np.abs(load[there])
    median = float(np.median(size)) if size.size else 0.0
    if median < LIGHTEST:
        raise InputError(
            f"Fz is {median:.3g} N in the median, so nobody stands on the plate, or it is not in N"
        )
    if size.min() < OFF_PLATE * median:
        at = int(np.flatnonzero(there)[np.argmax(size < OFF_PLATE * median)])
        raise InputError(
            f"Fz falls from {median:.4g} to {abs(load[at]):.3g} N in line {table.lines[at]}: the "
            "person is not on the plate all the time; cut the recording before or after"
        )


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
