"""Real persons from CSV files: checked one by one, every row accounted for."""

from collections.abc import Callable, Collection, Container, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from standfast.errors import InputError
from standfast.parameters import OWN_BODY, PARAMETERS
from standfast.population.people.checking import Wanted, checked_person
from standfast.population.people.csv_table import MEASURABLE, Table, hint, read_table
from standfast.population.people.joining import (
    added_by_id,
    ids_of_several_files,
    joined,
    own_names,
    repeated_ids,
)
from standfast.population.people.own_segments import whose_segments, without_some_segments
from standfast.population.people.remarks import remarks_on


@dataclass(frozen=True, slots=True)
class Rejection:
    """A row that is not used: where it stands and why."""

    file: str
    line: int
    reason: str

    def __str__(self) -> str:
        return f"{self.file}, line {self.line}: {self.reason}"


@dataclass(frozen=True)
class People:
    """Persons with height (m), mass (kg) and, NaN or "unknown" where not told, all the rest."""

    id: tuple[str, ...]
    height: np.ndarray
    mass: np.ndarray
    sex: tuple[str, ...]
    age: np.ndarray
    weight: np.ndarray
    measured: Mapping[str, np.ndarray]  # stiffness, damping, delay, gains, by parameter
    own: Mapping[str, tuple[str, ...]]  # columns that are not recognised, where they are kept
    rejected: tuple[Rejection, ...]
    not_selected: int
    remarks: tuple[str, ...]

    def __len__(self) -> int:
        return len(self.height)

    @property
    def effective_size(self) -> float:
        """Kish's effective sample size of the weights, (Σw)² / Σw²."""
        return float(self.weight.sum() ** 2 / (self.weight**2).sum())

    def at(self, rows: np.ndarray) -> "People":
        """Return some of the persons, in a given order."""
        return replace(
            self,
            id=tuple(self.id[row] for row in rows),
            height=self.height[rows],
            mass=self.mass[rows],
            sex=tuple(self.sex[row] for row in rows),
            age=self.age[rows],
            weight=self.weight[rows],
            measured={name: values[rows] for name, values in self.measured.items()},
            own={name: tuple(each[row] for row in rows) for name, each in self.own.items()},
        )


def read_people(
    paths: str | Path | Sequence[str | Path],
    *,
    strict: bool = False,
    needed: Sequence[str] = (),
    selected: Callable[[str, float], bool] | None = None,
    selected_by: Collection[str] = ("sex", "age"),
    keep_own: bool = False,
) -> People:
    """Read persons from CSV or Excel files, each row checked.

    Files with height and mass hold persons, one after the other; further files add columns to them,
    joined by id. Separators may be commas, semicolons, tabs or ``|``, decimals be written with a
    point or a comma; text may be UTF-8, or UTF-16 with its mark. Of ``.xlsx`` the first sheet is
    read, by pandas. Columns are known by their names, which say the unit: ``height`` (m),
    ``height_cm``, ``height_in``, ``mass`` (kg), ``weight_lb`` and so on. A sex or an age that
    cannot be read, or that nobody has, is taken as unknown, which is told in ``remarks``.

    Parameters
    ----------
    paths
        one file, or several; ``-`` is standard input.
    strict
        stop at the first row that cannot be used, or whose sex or age cannot be read.
    needed
        measured parameters without which a person is not used, as ``"ankle_stiffness"``.
    selected
        tells from sex and age (years, NaN if not known) whether a person is wanted.
    selected_by
        by which of ``"sex"`` and ``"age"`` it goes: who has it unreadable is rejected then.
    keep_own
        keep the columns that are not recognised, as text.

    Returns
    -------
    People: height (m), mass (kg), sex, age (years) and what was measured (SI units), arrays of
    (persons,) each; and every row that could not be used, with its line and reason.

    Raises
    ------
    InputError
        if a file or a column is missing, no row can be used, ids do not join, or with ``strict``
        for the first row that cannot be used.

    Examples
    --------
    >>> import standfast as sf
    >>> people = sf.read_people("people.csv")
    >>> people.height, len(people.rejected)
    (array([1.62, 1.78, 1.7 ]), 0)
    """
    if isinstance(paths, str | Path):
        paths = [paths]
    tables = [read_table(Path(path), keep_own=keep_own) for path in paths]
    if not tables:
        raise InputError("no file of people is given")
    readable = ("sex", "age") if strict else selected_by if selected is not None else ()
    return _people_in(tables, strict, Wanted(needed, selected, readable))


def _people_in(tables: Sequence[Table], strict: bool, wanted: Wanted) -> People:
    """Read persons from tables."""
    holders = [table for table in tables if {"height", "mass"} <= set(table.columns)]
    columns = {field for table in tables for field in table.columns}
    columns, remark = without_some_segments(columns)
    added = added_by_id(tables, holders)
    _check_columns(tables[0], holders, columns, wanted.needed)
    found = _Sorted([], [], [], 0)
    for table in holders:
        for number, (line, row) in enumerate(table.rows):
            own = dict(zip(table.own_names, table.own[number], strict=True))
            whole = joined(row, own, added)
            try:
                _require_plain(table.refused.get(line, whole.refused))
                person = checked_person(whole.row, columns, wanted)
            except InputError as error:
                found.reject(Rejection(table.name, line, str(error)), strict)
            else:
                name = whole.row.get("id") or str(line)
                found.add(person, {"id": name, "file": table.name, "line": line}, whole.own)
    if not found.persons:
        raise InputError(_nobody(tables[0], found.rejected, found.not_selected))
    return _people(tables, columns, found, own_names(holders, tables), remark)


@dataclass
class _Sorted:
    """Rows as they are sorted into persons, rejected ones, and those of another sex or age."""

    persons: list[dict[str, object]]
    own: list[Mapping[str, str]]
    rejected: list[Rejection]
    not_selected: int

    def reject(self, row: Rejection, strict: bool) -> None:
        """Take a row that cannot be used, or stop at it."""
        if strict:
            raise InputError(f"{row} (--strict)") from None
        self.rejected.append(row)

    def add(
        self,
        person: dict[str, object] | None,
        place: Mapping[str, object],
        own: Mapping[str, str],
    ) -> None:
        """Take a checked person, None for one who is not selected."""
        if person is None:
            self.not_selected += 1
        else:
            self.persons.append({**person, **place})
            self.own.append(own)


def _people(
    tables: Sequence[Table],
    columns: Container[str],
    found: _Sorted,
    own: Sequence[str],
    remark: tuple[str, ...],
) -> People:
    """Put checked persons together, column by column."""
    persons = found.persons

    def column(name: str) -> np.ndarray:
        return np.array([person[name] for person in persons], np.float64)

    weight = column("weight")
    if not weight.sum() > 0.0:
        raise InputError(f"{tables[0].name}: the weights of all usable rows are 0")
    remarks = [f"{table.name}: {each}" for table in tables for each in table.remarks]
    remarks += [f"{tables[0].name}: {each}" for each in remark]
    remarks += whose_segments(column(OWN_BODY[0])) if OWN_BODY[0] in columns else []
    remarks += [each for table in tables for each in repeated_ids(table)]
    remarks += ids_of_several_files([t for t in tables if {"height", "mass"} <= set(t.columns)])
    remarks += remarks_on(persons)
    return People(
        tuple(str(person["id"]) for person in persons),
        column("height"),
        column("mass"),
        tuple(str(person["sex"]) for person in persons),
        column("age"),
        weight,
        {name: column(name) for name in MEASURABLE if name in columns},
        {name: tuple(each.get(name, "") for each in found.own) for name in own},
        tuple(found.rejected),
        found.not_selected,
        tuple(remarks),
    )


def _check_columns(
    first: Table, holders: Sequence[Table], columns: Container[str], needed: Collection[str]
) -> None:
    """Refuse files without height and mass, or without a measured parameter that is needed."""
    if not holders:
        lacking = next(field for field in ("height", "mass") if field not in first.columns)
        raise InputError(f"{first.name} has no column of {lacking}{hint(first, lacking)}")
    for name in needed:
        if name not in columns:
            whose = "that joint" if PARAMETERS[name].section == "stiffness" else "it"
            raise InputError(
                f"{first.name} has no column {name}, which the law of {whose} measures"
            )


def _require_plain(refused: str) -> None:
    """Refuse a row of which something can be read in two ways."""
    if refused:
        raise InputError(refused)


def _nobody(table: Table, rejected: Sequence[Rejection], not_selected: int) -> str:
    sentence = f"{table.name} has no usable row: {len(rejected)} rejected"
    if rejected:
        sentence += f", the first on line {rejected[0].line}: {rejected[0].reason}"
    if not_selected:
        sentence += f"; {not_selected} of another sex or age"
    if any("centimetres" in each.reason for each in rejected):
        sentence += "; if the column is in centimetres, name it height_cm"
    return sentence
