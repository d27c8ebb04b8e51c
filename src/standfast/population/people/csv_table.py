"""CSV files of people: columns found by their names, units made SI, every line kept apart."""

import contextlib
import csv
import difflib
import hashlib
import io
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import chain
from pathlib import Path
from typing import TypeAlias

from standfast.errors import InputError
from standfast.files import opened_plainly
from standfast.parameters import DAMPINGS, GAINS, OWN_BODY, PARAMETERS, STIFFNESSES, number_in

# What may have been measured of a person.
MEASURABLE = (*STIFFNESSES, *DAMPINGS, "feedback_delay", *GAINS, *OWN_BODY)
# How a column's name says a unit of SI.
UNITS = {
    "N·m/rad": "{0}_nm_rad {0}_n_m_rad",
    "N·m·s/rad": "{0}_nms_rad {0}_n_m_s_rad",
    "s": "{0}_s",
    "kg": "{0}_kg",
    "kg·m²": "{0}_kgm2 {0}_kg_m2 {0}_kg_m",  # the last of "kg m²"
    "m": "{0}_m",
}

# What a column can hold, with how many of its units are one of SI, and by which names it is known:
# lower case, every bracket, blank and point made "_". ANSUR II gives stature in mm and "weightkg"
# in hectograms; NHANES gives BMXHT in cm and BMXWT in kg.
NAMES: Mapping[tuple[str, float], str] = {
    ("height", 1.0): "height height_m stature_m",
    ("height", 100.0): "height_cm stature_cm bmxht",
    ("height", 1000.0): "height_mm stature_mm stature",
    ("mass", 1.0): "mass mass_kg body_mass body_mass_kg weight_kg body_weight_kg bmxwt",
    ("mass", 10.0): "weightkg",
    ("sex", 1.0): "sex gender riagendr",
    ("age", 1.0): "age age_years years ridageyr",
    ("id", 1.0): "id name subject subjectid subject_id participant seqn",
    ("weight", 1.0): "weight sample_weight wtmec2yr",
    ("pregnant", 1.0): "ridexprg",
    ("feedback_delay", 1000.0): "feedback_delay_ms",
    **{(name, 100.0): f"{name}_cm" for name in OWN_BODY if PARAMETERS[name].unit == "m"},
    **{(name, 1000.0): f"{name}_mm" for name in OWN_BODY if PARAMETERS[name].unit == "m"},
    **{(name, 1.0): f"{name} {UNITS[PARAMETERS[name].unit].format(name)}" for name in MEASURABLE},
}
COLUMNS = {name: holds for holds, names in NAMES.items() for name in names.split()}

# By what it holds, the place of a column in each row, and how many of its units are one of SI.
Columns: TypeAlias = dict[str, tuple[int, float]]


MOST_COLUMNS = 5000

# Comes after the last line, alone in its row unless a quotation mark is open.
END = "\0"


def digest(paths: Sequence[Path]) -> str:
    """Return the SHA-256 of the files' contents, one after the other."""
    digests = [hashlib.sha256(_bytes_of(path)).digest() for path in paths]
    return hashlib.sha256(b"".join(digests)).hexdigest()


@dataclass(frozen=True)
class Table:
    """The recognised columns of one file: text by field, with the line of each row."""

    name: str
    header: tuple[str, ...]
    columns: Columns
    rows: list[tuple[int, dict[str, str]]]
    remarks: tuple[str, ...]


def _bytes_of(path: Path) -> bytes:
    try:
        with opened_plainly(path) as file:
            return file.read()
    except FileNotFoundError:
        raise InputError(f"{path}: there is no such file of people") from None
    except IsADirectoryError:
        raise InputError(f"{path} is a folder; give a CSV file of people") from None
    except OSError as error:
        raise InputError(f"{path} cannot be read: {error.strerror}") from None
    except ValueError:
        raise InputError(f"{str(path)!r} is not the name of a file") from None


def read_table(path: Path) -> Table:
    """Read the columns of one file that are known by name, as text in SI units."""
    raw = _bytes_of(path)
    try:
        text = raw.decode("utf-8-sig")
    except UnicodeDecodeError:
        text = raw.decode("latin-1")
    if not text.strip():
        raise InputError(f"{path} is empty; give a header line and one line a person")
    header_line = text.lstrip().splitlines()[0]
    separator = max(",;\t", key=header_line.count)
    lines = _rows_of(path, text, separator)
    _, _, header = next(lines, (0, 0, []))
    if len(header) > MOST_COLUMNS:
        raise InputError(f"{path} has {len(header):,} columns; at most {MOST_COLUMNS:,} are read")
    columns = _recognised(path, header)
    rows = []
    for first, last, row in lines:
        entries = {}
        for field, (place, factor) in columns.items():
            entry = row[place].strip() if place < len(row) else ""
            if "\n" in entry or "\r" in entry:
                raise InputError(
                    f"{path}, line {first}: a quotation mark opens in this row and closes on line "
                    f"{last} only; close or remove it"
                )
            if separator == ";" and field not in ("id", "sex"):
                entry = entry.replace(",", ".")
            entries[field] = entry if factor == 1.0 else _in_si(entry, factor)
        rows.append((last, entries))
    if not rows:
        raise InputError(f"{path} has a header and no rows; give one line a person")
    return Table(path.name, tuple(header), columns, rows, _misspelt(header, columns))


def _rows_of(path: Path, text: str, separator: str) -> Iterator[tuple[int, int, list[str]]]:
    """Go through the rows that are not empty, each with its first and its last line."""
    if END in text:
        raise InputError(f"{path} is not a CSV file; if it is one in UTF-16, save it as UTF-8")
    lines = csv.reader(chain(io.StringIO(text, newline=""), [END]), delimiter=separator)
    first = 1
    # the module ends a quotation at the end of the file, or at its limit, without a word of it
    with contextlib.suppress(csv.Error):
        for row in lines:
            if row == [END]:
                return
            if row and END in row[-1]:
                break
            if any(entry.strip() for entry in row):
                yield first, lines.line_num, row
            first = lines.line_num + 1
    raise InputError(f"{path}, line {first}: a quotation mark opens in this row and is not closed")


def _recognised(path: Path, header: Sequence[str]) -> Columns:
    """Return the known columns by what they hold."""
    columns: Columns = {}
    for place, name in enumerate(header):
        if (known := COLUMNS.get(_normal(name))) is None:
            continue
        field, factor = known
        if name.strip().lower() == "weightkg" and "stature" not in map(_normal, header):
            factor = 1.0  # hectograms in ANSUR II alone
        if field in columns:
            first = header[columns[field][0]]
            raise InputError(
                f"{path}: the columns {first!r} and {name!r} both hold {field}; keep one"
            )
        columns[field] = (place, factor)
    return columns


def _misspelt(header: Sequence[str], found: Columns) -> tuple[str, ...]:
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
        return repr(number_in(text) / factor)
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
