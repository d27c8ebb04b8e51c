"""Real persons from CSV files: columns by name, units made SI, every odd row accounted for."""

import csv
import hashlib
import io
import math
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from standfast.quantities import PARAMETERS, InputError, Parameter, checked_number

SEXES = ("male", "female", "unknown")
STIFFNESS_FIELDS = ("ankle_stiffness", "knee_stiffness", "hip_stiffness")

# Column names, lower case and with every bracket, blank and point made "_", to what they hold and
# the factor to SI. ANSUR II gives stature in mm and its "weightkg" in hectograms; NHANES gives
# BMXHT in cm and BMXWT in kg.
COLUMNS: Mapping[str, tuple[str, float]] = {
    "height": ("height", 1.0),
    "height_m": ("height", 1.0),
    "height_cm": ("height", 0.01),
    "height_mm": ("height", 0.001),
    "stature": ("height", 0.001),
    "stature_m": ("height", 1.0),
    "stature_cm": ("height", 0.01),
    "stature_mm": ("height", 0.001),
    "bmxht": ("height", 0.01),
    "mass": ("mass", 1.0),
    "mass_kg": ("mass", 1.0),
    "body_mass": ("mass", 1.0),
    "body_mass_kg": ("mass", 1.0),
    "weight_kg": ("mass", 1.0),
    "body_weight_kg": ("mass", 1.0),
    "weightkg": ("mass", 0.1),
    "bmxwt": ("mass", 1.0),
    "sex": ("sex", 1.0),
    "gender": ("sex", 1.0),
    "riagendr": ("sex", 1.0),
    "age": ("age", 1.0),
    "age_years": ("age", 1.0),
    "ridageyr": ("age", 1.0),
    "id": ("id", 1.0),
    "subject": ("id", 1.0),
    "subjectid": ("id", 1.0),
    "subject_id": ("id", 1.0),
    "participant": ("id", 1.0),
    "seqn": ("id", 1.0),
    "weight": ("weight", 1.0),
    "sample_weight": ("weight", 1.0),
    "wtmec2yr": ("weight", 1.0),
    "ridexprg": ("pregnant", 1.0),
    **{name: (name, 1.0) for name in STIFFNESS_FIELDS},
    **{f"{name}_nm_rad": (name, 1.0) for name in STIFFNESS_FIELDS},
}
SEX_WORDS = {"male": "male", "m": "male", "man": "male", "female": "female", "f": "female"}
SEX_WORDS |= {"woman": "female", "w": "female", "": "unknown", ".": "unknown"}
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
    stiffness: Mapping[str, np.ndarray]
    rejected: tuple[Rejection, ...]
    not_selected: int

    def __len__(self) -> int:
        return len(self.height)

    @property
    def effective_size(self) -> float:
        """Kish's effective sample size of the weights, (Σw)² / Σw²."""
        return float(self.weight.sum() ** 2 / (self.weight**2).sum())

    def at(self, rows: np.ndarray) -> "People":
        """Return some of the persons, in a given order."""
        return People(
            tuple(self.id[row] for row in rows),
            self.height[rows],
            self.mass[rows],
            tuple(self.sex[row] for row in rows),
            self.age[rows],
            self.weight[rows],
            {joint: values[rows] for joint, values in self.stiffness.items()},
            self.rejected,
            self.not_selected,
        )


def read_people(
    paths: Sequence[Path],
    *,
    strict: bool = False,
    needed: Iterable[str] = (),
    selected: Callable[[str, float], bool] | None = None,
) -> People:
    """Read persons from a CSV file, with more columns from other files joined by id.

    Parameters
    ----------
    paths
        the file with height and mass first; every file with a header line. Separators may be
        commas, semicolons (with decimal commas) or tabs.
    strict
        stop at the first row that cannot be used, instead of leaving it out.
    needed
        measured stiffnesses without which a row is not used.
    selected
        tells from sex and age whether a person belongs to the population.

    Raises
    ------
    InputError
        if a file is missing, empty, without the columns, or without one usable row.
    """
    needed = tuple(needed)
    first, others = _checked_tables(paths, needed)
    more = [{_plain_id(row["id"]): row for _, row in table.rows} for table in others]
    persons: list[dict[str, object]] = []
    rejected: list[Rejection] = []
    not_selected = 0
    for line, row in first.rows:
        joined = dict(row)
        for table in more:
            joined = {**table.get(_plain_id(row["id"]), {}), **joined}
        try:
            sex, age = _sex(joined.get("sex", "")), _optional(joined.get("age", ""), "age", AGE)
            if selected is not None and not selected(sex, age):
                not_selected += 1
                continue
            person = {**_checked_person(joined, needed), "sex": sex, "age": age}
        except InputError as error:
            rejection = Rejection(first.name, line, str(error))
            if strict:
                raise InputError(f"{rejection} (--strict)") from None
            rejected.append(rejection)
            continue
        person["id"] = joined.get("id") or str(line)
        persons.append(person)
    if not persons:
        raise InputError(_nobody(first, rejected, not_selected))

    def column(name: str) -> np.ndarray:
        return np.array([person[name] for person in persons], np.float64)

    weight = column("weight")
    if not weight.sum() > 0.0:
        raise InputError(f"{first.name}: the weights of all usable rows are 0")
    return People(
        tuple(str(person["id"]) for person in persons),
        column("height"),
        column("mass"),
        tuple(str(person["sex"]) for person in persons),
        column("age"),
        weight,
        {name: column(name) for name in STIFFNESS_FIELDS if name in first.columns},
        tuple(rejected),
        not_selected,
    )


def _checked_tables(
    paths: Sequence[Path], needed: Sequence[str]
) -> tuple["_Table", list["_Table"]]:
    """Read all files and refuse them if a column is missing."""
    first, *others = (_read_table(path) for path in paths)
    for field in ("height", "mass"):
        if field not in first.columns:
            raise InputError(f"{first.name} has no column of {field}{_hint(first, field)}")
    for joint in needed:
        if joint not in first.columns:
            raise InputError(
                f"{first.name} has no column {joint}, which the law of that joint measures"
            )
    if others and any("id" not in table.columns for table in (first, *others)):
        raise InputError(
            f"{', '.join(str(path) for path in paths)} cannot be joined: each needs a column of "
            "ids (id, subject, SEQN)"
        )
    return first, others


def digest(paths: Sequence[Path]) -> str:
    """Return the SHA-256 of the files' contents, one after the other."""
    total = hashlib.sha256()
    for path in paths:
        total.update(hashlib.sha256(_bytes_of(path)).digest())
    return total.hexdigest()


@dataclass(frozen=True)
class _Table:
    """The recognised columns of one file: text by field, with the line of each row."""

    name: str
    header: tuple[str, ...]
    columns: Mapping[str, str]
    rows: list[tuple[int, dict[str, str]]]


def _bytes_of(path: Path) -> bytes:
    try:
        return path.read_bytes()
    except FileNotFoundError:
        raise InputError(f"{path}: there is no such file of people") from None
    except IsADirectoryError:
        raise InputError(f"{path} is a folder; give a CSV file of people") from None
    except OSError as error:
        raise InputError(f"{path} cannot be read: {error.strerror}") from None


def _read_table(path: Path) -> _Table:
    raw = _bytes_of(path)
    try:
        text = raw.decode("utf-8-sig")
    except UnicodeDecodeError:
        text = raw.decode("latin-1")
    if not text.strip():
        raise InputError(f"{path} is empty; give a header line and one line a person")
    header_line = text.lstrip().splitlines()[0]
    separator = max(",;\t", key=header_line.count)
    lines = csv.reader(io.StringIO(text, newline=""), delimiter=separator)
    try:
        header = next(row for row in lines if row)
        places: dict[int, str] = {}
        factors: dict[str, float] = {}
        columns: dict[str, str] = {}
        for place, name in enumerate(header):
            if (known := COLUMNS.get(_normal(name))) is None:
                continue
            field, factor = known
            if field in columns:
                raise InputError(
                    f"{path}: the columns {columns[field]!r} and {name!r} both hold {field}; "
                    "keep one"
                )
            columns[field], places[place], factors[field] = name, field, factor
        rows = []
        for row in lines:
            if not any(cell.strip() for cell in row):
                continue
            cells = {
                field: row[place].strip() if place < len(row) else ""
                for place, field in places.items()
            }
            for field, factor in factors.items():
                if separator == ";" and field not in ("id", "sex"):
                    cells[field] = cells[field].replace(",", ".")
                if factor != 1.0:
                    cells[field] = _in_si(cells[field], factor)
            rows.append((lines.line_num, cells))
    except csv.Error as error:
        raise InputError(f"{path} is not a CSV file: line {lines.line_num}, {error}") from None
    if not rows:
        raise InputError(f"{path} has a header and no rows; give one line a person")
    return _Table(path.name, tuple(header), columns, rows)


def _normal(name: str) -> str:
    return re.sub(r"[^a-z0-9]+", "_", name.strip().lower()).strip("_")


def _in_si(cell: str, factor: float) -> str:
    """Turn a number into SI, and leave what is none to be refused with its own words."""
    try:
        return repr(float(cell) * factor)
    except ValueError:
        return cell


def _number(cell: str, name: str, row: Parameter) -> float:
    try:
        number: float | str = float(cell)
    except ValueError:
        number = cell
    return checked_number(name, number, row=row)


def _checked_person(row: Mapping[str, str], needed: Sequence[str]) -> dict[str, object]:
    """Check one person; the reason for refusing it names the column and the value."""
    person: dict[str, object] = {}
    for field in ("height", "mass"):
        if row[field].lower() in NOTHING:
            raise InputError(f"no {field}")
        person[field] = _number(row[field], field, PARAMETERS[field])
    if row.get("pregnant", "") in ("1", "1.0"):
        raise InputError("pregnant, for which no body model holds")
    weight = row.get("weight")
    person["weight"] = 1.0 if weight is None else _number(weight, "weight", WEIGHT)
    for joint in STIFFNESS_FIELDS:
        cell = row.get(joint, "")
        if joint in needed and cell.lower() in NOTHING:
            raise InputError(f"no {joint}")
        person[joint] = _optional(cell, joint, PARAMETERS[joint])
    return person


def _optional(cell: str, name: str, row: Parameter) -> float:
    return math.nan if cell.lower() in NOTHING else _number(cell, name, row)


def _sex(cell: str) -> str:
    word = cell.lower()
    if word in SEX_WORDS:
        return SEX_WORDS[word]
    try:
        return NHANES_SEX[float(word)]
    except (ValueError, KeyError):
        raise InputError(
            f"sex = {cell!r} is not known; write male or female, or leave it empty"
        ) from None


def _plain_id(cell: str) -> str:
    """Return an id as text; 93703.0 and 93703 are one person."""
    return cell.removesuffix(".0")


def _hint(table: _Table, field: str) -> str:
    known = sorted(name for name, (holds, _) in COLUMNS.items() if holds == field)
    hint = f" (known names: {', '.join(known)}; columns there: {', '.join(table.header[:12])}"
    hint += ", …)" if len(table.header) > 12 else ")"
    if field == "mass" and "weight" in table.columns:
        hint += "; 'weight' is read as the weight of the record, name body mass 'mass_kg'"
    return hint


def _nobody(table: _Table, rejected: Sequence[Rejection], not_selected: int) -> str:
    sentence = f"{table.name} has no usable row: {len(rejected)} rejected"
    if rejected:
        sentence += f", the first on line {rejected[0].line}: {rejected[0].reason}"
    if not_selected:
        sentence += f"; {not_selected} of another sex or age"
    if any("centimetres" in each.reason for each in rejected):
        sentence += "; if the column is in centimetres, name it height_cm"
    return sentence
