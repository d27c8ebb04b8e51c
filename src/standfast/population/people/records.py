"""Real persons from CSV files: checked one by one, every row accounted for."""

import math
from collections.abc import Callable, Container, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from standfast.errors import InputError
from standfast.parameters import OWN_BODY, PARAMETERS, Parameter, checked_number, number_in
from standfast.population.people.csv_table import MEASURABLE, Table, hint, read_table
from standfast.population.people.own_segments import (
    check_body,
    whose_segments,
    without_some_segments,
)

SEXES = ("male", "female", "unknown")
ADULT = 18
SEX_WORDS = dict.fromkeys(("male", "m", "man"), "male")
SEX_WORDS |= dict.fromkeys(("female", "f", "woman", "w"), "female")
SEX_WORDS |= dict.fromkeys(("unknown", "other", "na", "nan", "none", "n/a", "", "."), "unknown")
NHANES_SEX = {1.0: "male", 2.0: "female"}
NOTHING = ("", ".", "na", "nan", "none")
AGE = Parameter("age", "", "years", "age", 0.0, 130.0)
WEIGHT = Parameter("weight", "", "1", "weight of the record", 0.0, 1e12)


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
        )


def read_people(
    paths: Sequence[Path],
    *,
    strict: bool = False,
    needed: Sequence[str] = (),
    selected: Callable[[str, float], bool] | None = None,
) -> People:
    """Read persons from CSV files.

    Files with height and mass hold persons, one after the other; further files add columns to them,
    joined by id. Refused if a file or a column is missing, no row can be used, or ids do not join.
    Separators may be commas, semicolons (with decimal commas) or tabs. ``strict`` stops at the
    first row that cannot be used; ``needed`` are measured parameters without which none is used;
    ``selected`` tells from sex and age whether a person belongs to the population.
    """
    tables = [read_table(path) for path in paths]
    holders = [table for table in tables if {"height", "mass"} <= set(table.columns)]
    added = _by_id(tables, holders)
    columns = {field for table in tables for field in table.columns}
    columns, remark = without_some_segments(columns)
    _check_columns(tables[0], holders, columns, needed)
    persons: list[dict[str, object]] = []
    rejected: list[Rejection] = []
    not_selected = 0
    for table in holders:
        for line, row in table.rows:
            joined = _joined(row, added)
            try:
                person = _checked_person(joined, columns, needed, selected)
            except InputError as error:
                rejection = Rejection(table.name, line, str(error))
                if strict:
                    raise InputError(f"{rejection} (--strict)") from None
                rejected.append(rejection)
                continue
            if person is None:
                not_selected += 1
            else:
                persons.append({**person, "id": joined.get("id") or str(line)})
    if not persons:
        raise InputError(_nobody(tables[0], rejected, not_selected))
    return _people(tables, columns, persons, tuple(rejected), not_selected, remark)


def _joined(
    row: Mapping[str, str], added: Sequence[Mapping[str, Mapping[str, str]]]
) -> dict[str, str]:
    """Return a row with what files of more columns have under its id; its own entries prevail."""
    joined = dict(row)
    for more in added:
        key = _plain_id(row["id"])
        own = {field: entry for field, entry in joined.items() if entry}
        joined = {**joined, **(more.get(key, {}) if key else {}), **own}
    return joined


def _people(
    tables: Sequence[Table],
    columns: Container[str],
    persons: Sequence[Mapping[str, object]],
    rejected: tuple[Rejection, ...],
    not_selected: int,
    remark: tuple[str, ...],
) -> People:
    """Put checked persons together, column by column."""

    def column(name: str) -> np.ndarray:
        return np.array([person[name] for person in persons], np.float64)

    weight = column("weight")
    if not weight.sum() > 0.0:
        raise InputError(f"{tables[0].name}: the weights of all usable rows are 0")
    remarks = [f"{table.name}: {each}" for table in tables for each in table.remarks]
    remarks += [f"{tables[0].name}: {each}" for each in remark]
    remarks += whose_segments(column(OWN_BODY[0])) if OWN_BODY[0] in columns else []
    if children := int((column("age") < ADULT).sum()):
        remarks.append(f"{children:,} are under {ADULT} years, and the body models are of adults")
    return People(
        tuple(str(person["id"]) for person in persons),
        column("height"),
        column("mass"),
        tuple(str(person["sex"]) for person in persons),
        column("age"),
        weight,
        {name: column(name) for name in MEASURABLE if name in columns},
        rejected,
        not_selected,
        tuple(remarks),
    )


def _by_id(tables: Sequence[Table], holders: Sequence[Table]) -> list[dict[str, dict[str, str]]]:
    """Return the rows, by id, of the files that only add columns."""
    others = [table for table in tables if table not in holders]
    if not holders or not others:
        return []
    ids = set()
    for table in tables:
        if "id" not in table.columns:
            raise InputError(
                f"{', '.join(t.name for t in tables)} cannot be joined: {table.name} has no column "
                "of ids (id, subject, SEQN)"
            )
        if table in holders:
            ids |= {_plain_id(row["id"]) for _, row in table.rows}
    added = []
    for table in others:
        rows: dict[str, dict[str, str]] = {}
        for line, row in table.rows:
            if (key := _plain_id(row["id"])) in rows:
                raise InputError(f"{table.name}, line {line}: the id {row['id']!r} is there twice")
            rows[key] = row
        if not ids & set(rows):
            raise InputError(f"{table.name} has no id that {holders[0].name} has")
        added.append(rows)
    return added


def _check_columns(
    first: Table, holders: Sequence[Table], columns: Container[str], needed: Sequence[str]
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


def _number(entry: str, name: str, row: Parameter) -> float:
    try:
        number: float | str = number_in(entry)
    except ValueError:
        number = entry
    return checked_number(name, number, row=row)


def _checked_person(
    row: Mapping[str, str],
    columns: Container[str],
    needed: Sequence[str],
    selected: Callable[[str, float], bool] | None,
) -> dict[str, object] | None:
    """Check one person; None if not of those selected."""
    sex, age = _sex(row.get("sex", "")), _optional(row.get("age", ""), "age", AGE)
    if selected is not None and not selected(sex, age):
        return None
    person: dict[str, object] = {"sex": sex, "age": age}
    for field in ("height", "mass"):
        if row[field].lower() in NOTHING:
            raise InputError(f"no {field}")
        person[field] = _number(row[field], field, PARAMETERS[field])
    if row.get("pregnant", "") in ("1", "1.0"):
        raise InputError("pregnant, for which no body model holds")
    weight = row.get("weight")
    if "weight" in columns and weight is None:
        raise InputError("no weight: the id is in no file of weights")
    person["weight"] = 1.0 if weight is None else _number(weight, "weight", WEIGHT)
    for name in MEASURABLE:
        if name in columns:
            entry = row.get(name, "")
            if name in needed and entry.lower() in NOTHING:
                raise InputError(f"no {name}")
            person[name] = _optional(entry, name, PARAMETERS[name])
    check_body(person)
    return person


def _optional(entry: str, name: str, row: Parameter) -> float:
    return math.nan if entry.lower() in NOTHING else _number(entry, name, row)


def _sex(entry: str) -> str:
    word = entry.lower()
    if word in SEX_WORDS:
        return SEX_WORDS[word]
    try:
        return NHANES_SEX[number_in(word)]
    except (ValueError, KeyError):
        raise InputError(
            f"sex = {entry!r} is not known; write male or female, or leave it empty"
        ) from None


def _plain_id(entry: str) -> str:
    """Return an id as text; 93703.0 and 93703 are one person."""
    return entry.removesuffix(".0")


def _nobody(table: Table, rejected: Sequence[Rejection], not_selected: int) -> str:
    sentence = f"{table.name} has no usable row: {len(rejected)} rejected"
    if rejected:
        sentence += f", the first on line {rejected[0].line}: {rejected[0].reason}"
    if not_selected:
        sentence += f"; {not_selected} of another sex or age"
    if any("centimetres" in each.reason for each in rejected):
        sentence += "; if the column is in centimetres, name it height_cm"
    return sentence
