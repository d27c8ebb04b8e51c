"""Files of people: columns found by their names, units made SI, every line kept apart."""

import difflib
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TypeAlias

from standfast.errors import InputError
from standfast.parameters import (
    DAMPINGS,
    GAINS,
    NOISES,
    OWN_BODY,
    PARAMETERS,
    STIFFNESSES,
)
from standfast.population.people.decimals import comma_of
from standfast.population.people.decoding import Row, called, text_of
from standfast.population.people.entries import number_of
from standfast.population.people.words import is_numbered

# What may have been measured of a person.
MEASURABLE = (*STIFFNESSES, *DAMPINGS, "feedback_delay", *GAINS, *NOISES, *OWN_BODY)
# How a column's name says a unit of SI.
UNITS = {
    "N·m/rad": "{0}_nm_rad {0}_n_m_rad",
    "N·m·s/rad": "{0}_nms_rad {0}_n_m_s_rad",
    "s": "{0}_s",
    "N·m·√s": "{0}_nm_sqrt_s {0}_n_m_s",  # the last of "N·m·√s"
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
    ("height", 1.0 / 0.0254): "height_in height_inch height_inches stature_in stature_inches",
    ("height", 1.0 / 0.3048): "height_ft height_feet",
    ("mass", 1.0): "mass mass_kg body_mass body_mass_kg weight_kg body_weight_kg bmxwt",
    ("mass", 10.0): "weightkg",
    ("mass", 1000.0): "mass_g weight_g body_mass_g",
    ("mass", 1.0 / 0.45359237): "mass_lb mass_lbs mass_pounds weight_lb weight_lbs weight_pounds "
    "body_mass_lb body_mass_lbs body_weight_lb body_weight_lbs",
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

# By what it holds, the places of its columns in each row, with how many of its units are one of SI:
# several of height or mass, if each is in another unit.
Columns: TypeAlias = dict[str, list[tuple[int, float]]]


MOST_COLUMNS = 5000
# What is no number.
WORDS = ("id", "sex", "pregnant")


@dataclass(frozen=True)
class Table:
    """The recognised columns of one file: text by field, with the line of each row.

    ``own`` holds the columns that are not recognised, of each row; ``refused`` what of a row can be
    read in two ways, by its line.
    """

    name: str
    header: tuple[str, ...]
    columns: Columns
    rows: list[tuple[int, dict[str, str]]]
    remarks: tuple[str, ...]
    own_names: tuple[str, ...] = ()
    own: list[tuple[str, ...]] = field(default_factory=list)
    refused: dict[int, str] = field(default_factory=dict)


def read_table(path: Path, *, keep_own: bool = False) -> Table:
    """Read the columns of one file that are known by name, as text in SI units.

    ``keep_own`` keeps all other columns too.
    """
    text = text_of(path)
    name = called(path)
    _, _, header = next(text.rows, (0, 0, []))
    if len(header) > MOST_COLUMNS:
        raise InputError(f"{path} has {len(header):,} columns; at most {MOST_COLUMNS:,} are read")
    columns = _recognised(path, header)
    lines = list(text.rows)
    if not lines:
        raise InputError(f"{path} has a header and no rows; give one line a person")
    entries = [_entries(path, columns, *line) for line in lines]
    numbers = [f for f in columns if f not in WORDS]
    comma = comma_of((each for row in entries for f in numbers for each in row[f]), text.separator)
    refused = _too_long(header, lines)
    rows = []
    for (_, last, _), row in zip(lines, entries, strict=True):
        plain = {f: row[f][0] for f in columns if f in WORDS}
        for f in numbers:
            try:
                plain[f] = number_of(header, f, columns[f], row[f], comma)
            except InputError as error:
                plain[f] = row[f][0]
                refused.setdefault(last, str(error))
        rows.append((last, plain))
    taken = {place for places in columns.values() for place, _ in places}
    own = [n for n in range(len(header)) if n not in taken and header[n].strip()] * keep_own
    return Table(
        name,
        tuple(header),
        columns,
        rows,
        (
            *text.remarks,
            *_misspelt(header, columns),
            *_numbered_sex(header, columns, [row for _, row in rows]),
        ),
        _each_once([header[n].strip() for n in own]),
        [tuple(row[n].strip() if n < len(row) else "" for n in own) for _, _, row in lines],
        refused,
    )


def _entries(
    path: Path, columns: Columns, first: int, last: int, row: Sequence[str]
) -> dict[str, list[str]]:
    """Return the recognised entries of a row, as they stand there."""
    entries = {
        f: [row[n].strip() if n < len(row) else "" for n, _ in places]
        for f, places in columns.items()
    }
    if any("\n" in entry or "\r" in entry for each in entries.values() for entry in each):
        raise InputError(
            f"{path}, line {first}: a quotation mark opens in this row and closes on line "
            f"{last} only; close or remove it"
        )
    return entries


def _too_long(header: Sequence[str], lines: Sequence[Row]) -> dict[int, str]:
    """Refuse rows with more entries than columns: what of them stands where is not known."""
    return {
        last: f"{len(row)} entries under {len(header)} columns; is a decimal comma not in quotes?"
        for _, last, row in lines
        if any(entry.strip() for entry in row[len(header) :])
    }


def _each_once(names: Sequence[str]) -> tuple[str, ...]:
    """Return names of which those that are there again are numbered."""
    told: list[str] = []
    for name in names:
        again = sum(each == name for each in names[: len(told)])
        told.append(f"{name} ({again + 1})" if again else name)
    return tuple(told)


def _recognised(path: Path, header: Sequence[str]) -> Columns:
    """Return the known columns by what they hold."""
    columns: Columns = {}
    for place, name in enumerate(header):
        if (known := COLUMNS.get(_normal(name))) is None:
            continue
        field, factor = known
        if name.strip().lower() == "weightkg" and "stature" not in map(_normal, header):
            factor = 1.0  # hectograms in ANSUR II alone
        for other, of_other in columns.get(field, []):
            if field not in ("height", "mass") or factor == of_other:
                raise InputError(
                    f"{path}: the columns {header[other]!r} and {name!r} both hold {field}; "
                    "keep one"
                )
        columns.setdefault(field, []).append((place, factor))
    return columns


def _misspelt(header: Sequence[str], found: Columns) -> tuple[str, ...]:
    """Say which columns are not used although their names are nearly those of a missing one."""
    remarks = []
    for name in header:
        near = difflib.get_close_matches(_normal(name), COLUMNS, n=1, cutoff=0.85)
        if near and _normal(name) not in COLUMNS and COLUMNS[near[0]][0] not in found:
            remarks.append(f"the column {name!r} is not used; did you mean {near[0]!r}?")
    return tuple(remarks)


def _numbered_sex(
    header: Sequence[str], columns: Columns, rows: Sequence[Mapping[str, str]]
) -> tuple[str, ...]:
    """Say how numbers are read as a sex, but where NHANES is known by the column's name."""
    if "sex" not in columns or _normal(header[columns["sex"][0][0]]) == "riagendr":
        return ()
    numbers = {row["sex"].removesuffix(".0") for row in rows if is_numbered(row["sex"])}
    if not numbers:
        return ()
    words = "sex is given by numbers: 1 is read as male and 2 as female"
    if unknown := sorted(numbers & {"0", "9"}):
        words += f", {' and '.join(unknown)} as not known"
    if "0" in numbers and "2" not in numbers:
        words += "; there is no 2, so if 0 is a sex here write words"
    return (words,)


def _normal(name: str) -> str:
    return re.sub(r"[^a-z0-9]+", "_", name.strip().lower()).strip("_")


def hint(table: Table, field: str) -> str:
    """Say by which names a column is known, and what is there instead."""
    known = sorted(name for name, (holds, _) in COLUMNS.items() if holds == field)
    words = f" (known names: {', '.join(known)}; columns there: {', '.join(table.header[:12])}"
    words += ", …)" if len(table.header) > 12 else ")"
    if field == "mass" and "weight" in table.columns:
        words += "; 'weight' is read as the weight of the record, name body mass 'mass_kg'"
    return words
