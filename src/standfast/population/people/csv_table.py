"""CSV files of people: columns found by their names, units made SI, every line kept apart."""

import csv
import difflib
import hashlib
import io
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from standfast.errors import InputError
from standfast.parameters import STIFFNESSES

# Column names, lower case and with every bracket, blank and point made "_", to what they hold and
# how many of its units are one of SI. ANSUR II gives stature in mm and "weightkg" in hectograms;
# NHANES gives BMXHT in cm and BMXWT in kg.
COLUMNS: Mapping[str, tuple[str, float]] = {
    "height": ("height", 1.0),
    "height_m": ("height", 1.0),
    "height_cm": ("height", 100.0),
    "height_mm": ("height", 1000.0),
    "stature": ("height", 1000.0),
    "stature_m": ("height", 1.0),
    "stature_cm": ("height", 100.0),
    "stature_mm": ("height", 1000.0),
    "bmxht": ("height", 100.0),
    "mass": ("mass", 1.0),
    "mass_kg": ("mass", 1.0),
    "body_mass": ("mass", 1.0),
    "body_mass_kg": ("mass", 1.0),
    "weight_kg": ("mass", 1.0),
    "body_weight_kg": ("mass", 1.0),
    "weightkg": ("mass", 10.0),
    "bmxwt": ("mass", 1.0),
    "sex": ("sex", 1.0),
    "gender": ("sex", 1.0),
    "riagendr": ("sex", 1.0),
    "age": ("age", 1.0),
    "age_years": ("age", 1.0),
    "years": ("age", 1.0),
    "ridageyr": ("age", 1.0),
    "id": ("id", 1.0),
    "name": ("id", 1.0),
    "subject": ("id", 1.0),
    "subjectid": ("id", 1.0),
    "subject_id": ("id", 1.0),
    "participant": ("id", 1.0),
    "seqn": ("id", 1.0),
    "weight": ("weight", 1.0),
    "sample_weight": ("weight", 1.0),
    "wtmec2yr": ("weight", 1.0),
    "ridexprg": ("pregnant", 1.0),
    **{name: (name, 1.0) for name in STIFFNESSES},
    **{f"{name}_{unit}": (name, 1.0) for name in STIFFNESSES for unit in ("nm_rad", "n_m_rad")},
}


def digest(paths: Sequence[Path]) -> str:
    """Return the SHA-256 of the files' contents, one after the other."""
    total = hashlib.sha256()
    for path in paths:
        total.update(hashlib.sha256(_bytes_of(path)).digest())
    return total.hexdigest()


@dataclass(frozen=True)
class Table:
    """The recognised columns of one file: text by field, with the line of each row."""

    name: str
    header: tuple[str, ...]
    columns: Mapping[str, str]
    rows: list[tuple[int, dict[str, str]]]
    remarks: tuple[str, ...]


def _bytes_of(path: Path) -> bytes:
    try:
        return path.read_bytes()
    except FileNotFoundError:
        raise InputError(f"{path}: there is no such file of people") from None
    except IsADirectoryError:
        raise InputError(f"{path} is a folder; give a CSV file of people") from None
    except OSError as error:
        raise InputError(f"{path} cannot be read: {error.strerror}") from None
    except ValueError:
        raise InputError(f"{str(path)!r} is not the name of a file") from None


def read_table(path: Path) -> Table:
    """Read the columns of one file that are known by name, as text in SI units.

    Raises
    ------
    InputError
        if the file is missing, empty, no CSV, or has two columns for one thing.
    """
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
        columns, places, factors = _recognised(path, header)
        rows = []
        for row in lines:
            if not any(entry.strip() for entry in row):
                continue
            entries = {
                field: row[place].strip() if place < len(row) else ""
                for place, field in places.items()
            }
            for field, factor in factors.items():
                if separator == ";" and field not in ("id", "sex"):
                    entries[field] = entries[field].replace(",", ".")
                if factor != 1.0:
                    entries[field] = _in_si(entries[field], factor)
            rows.append((lines.line_num, entries))
    except csv.Error as error:
        raise InputError(f"{path} is not a CSV file: line {lines.line_num}, {error}") from None
    if not rows:
        raise InputError(f"{path} has a header and no rows; give one line a person")
    return Table(path.name, tuple(header), columns, rows, _misspelt(header, columns))


def _recognised(
    path: Path, header: Sequence[str]
) -> tuple[dict[str, str], dict[int, str], dict[str, float]]:
    """Return the known columns: name and factor to SI by field, field by place."""
    places: dict[int, str] = {}
    factors: dict[str, float] = {}
    columns: dict[str, str] = {}
    for place, name in enumerate(header):
        if (known := COLUMNS.get(_normal(name))) is None:
            continue
        field, factor = known
        if name.strip().lower() == "weightkg" and "stature" not in map(_normal, header):
            factor = 1.0  # hectograms in ANSUR II alone
        if field in columns:
            raise InputError(
                f"{path}: the columns {columns[field]!r} and {name!r} both hold {field}; keep one"
            )
        columns[field], places[place], factors[field] = name, field, factor
    return columns, places, factors


def _misspelt(header: Sequence[str], found: Mapping[str, str]) -> tuple[str, ...]:
    """Say which columns are not used although their names are nearly those of a missing one."""
    remarks = []
    for name in header:
        near = difflib.get_close_matches(_normal(name), COLUMNS, n=1, cutoff=0.85)
        if near and _normal(name) not in COLUMNS and COLUMNS[near[0]][0] not in found:
            remarks.append(f"the column {name!r} is not used; did you mean {near[0]!r}?")
    return tuple(remarks)


def _normal(name: str) -> str:
    return re.sub(r"[^a-z0-9]+", "_", name.strip().lower()).strip("_")


def _in_si(text: str, factor: float) -> str:
    """Turn a number into SI, and leave what is none to be refused with its own words."""
    try:
        return repr(float(text) / factor)
    except ValueError:
        return text


def hint(table: Table, field: str) -> str:
    """Say by which names a column is known, and what is there instead."""
    known = sorted(name for name, (holds, _) in COLUMNS.items() if holds == field)
    words = f" (known names: {', '.join(known)}; columns there: {', '.join(table.header[:12])}"
    words += ", …)" if len(table.header) > 12 else ")"
    if field == "mass" and "weight" in table.columns:
        words += "; 'weight' is read as the weight of the record, name body mass 'mass_kg'"
    return words
