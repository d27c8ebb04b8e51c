"""From the text of a recording to its table: separator, lines before it, names, units, rows."""

import contextlib
import csv
import re
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from standfast.errors import InputError, shortened
from standfast.numerics.arrays import Array
from standfast.parameters import number_in
from standfast.population.people.decimals import Comma, both_readings, comma_of, plain_number
from standfast.recordings.columns import are_units
from standfast.recordings.recording import ENOUGH, SHORTEST

# How many columns are known by names and units.
Knows = Callable[[Sequence[str], Sequence[str]], int]
SEPARATORS = ("\t", ";", "|", ",", " ")  # the last: any number of blanks
PLAINLY = re.compile(r"[-+0-9.eE\n]*", re.ASCII)  # numbers without commas
NUMBER = re.compile(r"[-+]?[\d.,]*\d[\d.,]*(?:[eE][-+]?\d+)?", re.ASCII)
# How programs write that there is no number.
NOTHING = {
    "", ".", "-", "--", "nan", "-nan", "+nan", "na", "n/a", "#n/a", "null", "none", "nil",
    "inf", "-inf", "+inf", "#div/0!", "#num!", "#value!", "1.#ind", "-1.#ind", "1.#qnan",
}  # fmt: skip
TRIED = 200  # lines in the middle by which the separator is found
MOST_ABOVE = 2000  # lines before the table
RATE = re.compile(r"(?:(?:\b|sample|frame|_)rate\b|freq\w*|\bhz\b)", re.IGNORECASE)
FILTER = re.compile(r"filter|cut|pass|multiple", re.IGNORECASE)
OF_PLATES = re.compile(r"plate|platform|force|moment|cop\b", re.IGNORECASE)
ONE_NUMBER = re.compile(r"(?<![\w.,])\d+(?:[.,]\d+)?(?![\w]*\d)")


@dataclass(frozen=True)
class Table:
    """Names and units of the columns, and the rows as text with their lines.

    ``names`` are the numbers of the columns, from 1, where no line has names; ``groups`` what the
    line above them says of each, as of several plates with columns of the same names.
    """

    separator: str
    names: tuple[str, ...]
    units: tuple[str, ...]
    groups: tuple[str, ...]
    above: tuple[str, ...]
    rows: list[list[str]]
    lines: list[int]
    remarks: tuple[str, ...]


def table_of(text: str, knows: Knows) -> Table:
    """Find the table in a text; ``knows`` says how many columns it knows by names and units.

    Raises
    ------
    InputError
        if there is none.
    """
    lines = re.split(r"\r\n|\n|\r", text)
    separator, width, numeric = _separator(lines, knows)
    start = 0
    while not _is_first(_cells(lines[start], separator), width, numeric):
        start += 1
        if start > MOST_ABOVE or start == len(lines):
            raise InputError(f"no table of numbers begins in its first {start:,} lines")
    while start and _is_nothing(_cells(lines[start - 1], separator), width):
        start -= 1
    above = [_cells(line, separator) for line in lines[:start]]
    names, units, groups = _names(above, width, knows)
    if names and 2 * len(names) <= width and separator == ",":
        raise InputError(
            f"rows have {width} entries under {len(names)} names; are decimal commas not in "
            "quotes? separate the columns by tabs or semicolons"
        )
    rows, places, remarks = _rows(lines, start, separator, width)
    return Table(
        separator,
        tuple(names) or tuple(str(n) for n in range(1, width + 1)),
        tuple(units),
        tuple(groups),
        tuple(lines[:start]),
        rows,
        places,
        tuple(remarks),
    )


def numbers_in(table: Table, places: Sequence[int]) -> list[Array]:
    """Return columns as numbers, NaN where there is none.

    Raises
    ------
    InputError
        if an entry is no number, or may be two.
    """
    entries = [entries_in(table, place) for place in places]
    # most recordings: plain numbers throughout, read at once, in a third of the time
    if all(PLAINLY.fullmatch("\n".join(column)) for column in entries):
        with contextlib.suppress(ValueError):
            return [np.array([*map(float, column)]) for column in entries]
    comma = comma_of((each for column in entries for each in column), table.separator)
    if comma is Comma.UNKNOWN and not any("." in each for column in entries for each in column):
        comma = Comma.ASSUMED  # without one decimal point: no one stands whose sway has no decimals
    return [
        np.array([
            _number(table, row, place, entry, comma) for row, entry in enumerate(column)
        ])
        for place, column in zip(places, entries, strict=True)
    ]  # fmt: skip


def entries_in(table: Table, place: int) -> list[str]:
    """Return a column as text, empty where a row is too short."""
    return [row[place].strip() if place < len(row) else "" for row in table.rows]


def rate_above(table: Table) -> float | None:
    """Return the rate (Hz) that the lines above a table say, if they say one.

    As ``Sampling rate: 100 Hz``, or alone in the line after ``Devices`` (Vicon).
    """
    said = set()
    for before, line in zip(("", *table.above), table.above, strict=False):
        alone = _letters(before) == "devices"
        if alone or (RATE.search(line) and not FILTER.search(line)):
            found = ONE_NUMBER.findall(line)
            said |= {float(found[0].replace(",", "."))} if len(found) == 1 else set()
    return said.pop() if len(said) == 1 else None


def _letters(line: str) -> str:
    """Return the letters of a line in lower case."""
    return re.sub(r"[^a-z]+", "", line.lower())


def _cells(line: str, separator: str) -> list[str]:
    """Split a line."""
    if '"' in line:
        try:
            return next(csv.reader([line], delimiter=separator, skipinitialspace=True), [])
        except csv.Error:
            return [line]
    return line.split() if separator == " " else line.split(separator)


def _is_number(cell: str) -> bool:
    return NUMBER.fullmatch(cell.strip()) is not None


def _is_first(cells: Sequence[str], width: int, numeric: Sequence[int]) -> bool:
    """Return whether a line is one of the table, which has numbers in some columns."""
    if len(cells) != width:
        return False
    there = [cells[place].strip() for place in numeric]
    known = all(_is_number(cell) or cell.lower() in NOTHING for cell in there)
    return known and any(map(_is_number, there))


def _is_nothing(cells: Sequence[str], width: int) -> bool:
    """Return whether a line is one of the table in which all is missing."""
    return len(cells) == width and all(cell.strip().lower() in NOTHING for cell in cells)


def _separator(lines: Sequence[str], knows: Knows) -> tuple[str, int, list[int]]:
    """Return what separates the columns, how many there are, and which of them hold numbers.

    That by which most lines in the middle have numbers in the same columns.
    """
    filled = [line for line in lines if line.strip()]
    middle = filled[max(0, (len(filled) - TRIED) // 2) :][:TRIED]
    best: tuple[int, str, tuple[int, ...], int] = (1, "", (), 0)
    for separator in SEPARATORS:
        forms: Counter[tuple[int, tuple[int, ...]]] = Counter()
        for line in middle:
            cells = _cells(line, separator)
            numeric = tuple(place for place, cell in enumerate(cells) if _is_number(cell))
            forms[len(cells), numeric] += len(cells) > 1 and bool(numeric)
        (width, numeric), count = forms.most_common(1)[0] if forms else ((0, ()), 0)
        # of equally good ones the first: "0,1;0,2" is in two columns
        if count > best[0]:
            best = (count, separator, numeric, width)
    if best[0] < 2 and any(_is_one_sample(filled, each, knows) for each in SEPARATORS):
        raise InputError(
            f"it holds one sample; sway needs {SHORTEST:g} s of samples at the least, and its "
            f"frequencies {ENOUGH:g} s"
        )
    if best[0] < 2:
        raise InputError(
            "it holds no table of numbers in two or more columns; give a CSV or text file with a "
            "line of names, as time (s), COP_AP (mm), COP_ML (mm), and a line a sample"
        )
    _, separator, numeric, width = best
    return separator, width, list(numeric)


def _is_one_sample(filled: Sequence[str], separator: str, knows: Knows) -> bool:
    """Return whether a line of good names is followed by numbers; several would be a table."""
    rows = [[cell.strip() for cell in _cells(line, separator)] for line in filled]
    named = next((place for place, cells in enumerate(rows) if knows(cells, []) > 1), len(rows))
    return any(any(map(_is_number, cells)) for cells in rows[named + 1 :])


def _names(
    above: Sequence[Sequence[str]], width: int, knows: Knows
) -> tuple[list[str], list[str], list[str]]:
    """Return the names of the columns, the units in a line below them, and groups in one above.

    Units and groups are empty where there are none. The names are the line nearest to the table of
    which the most columns are known, else the nearest of words.
    """
    best: tuple[int, list[str], list[str], list[str]] = (0, [], [], [])
    nearest: tuple[list[str], list[str]] | None = None
    units: list[str] = []
    last = above[-40:]
    for place, cells in reversed([*enumerate(last)]):
        plain = [cell.strip() for cell in cells]
        if sum(map(bool, plain)) < 2 or any(map(_is_number, plain)):
            continue
        if are_units(plain) and not units and nearest is None:
            units = plain
            continue
        below = units if nearest is None else []
        nearest = nearest or (plain, below)
        known = knows(plain, below)
        if known > best[0]:
            best = (known, plain, below, _groups(last[place - 1], width) if place else [])
    if best[0]:
        return best[1], best[2], best[3]
    if nearest and len(nearest[0]) >= 0.5 * width:
        return nearest[0], nearest[1], []
    return [], units, []


def _groups(cells: Sequence[str], width: int) -> list[str]:
    """Return what a line says of the columns that follow each of its words, if it is of plates."""
    words = [cell.strip() for cell in cells]
    if len(words) > width or not any(map(OF_PLATES.search, words)):
        return []
    groups, group = [], ""
    for word in words:
        group = word or group
        groups.append(group)
    return groups + [group] * (width - len(groups))


def _rows(
    lines: Sequence[str], start: int, separator: str, width: int
) -> tuple[list[list[str]], list[int], list[str]]:
    """Return the rows up to the end of the table, and the lines that they stand on."""
    rows, places, remarks = [], [], []
    blank = False
    for number, line in enumerate(lines[start:], start + 1):
        cells = _cells(line, separator)
        if not line.strip():
            blank = True
            continue
        if (blank or len(cells) != width) and _are_words(cells):
            if any(each.strip() for each in lines[number:]):
                remarks.append(f"what follows from line {number} on is not read")
            break
        if len(cells) > width and any(cell.strip() for cell in cells[width:]):
            raise InputError(
                f"line {number} has {len(cells)} entries, and the others {width}; is a decimal "
                "comma not in quotes?"
            )
        rows.append(cells)
        places.append(number)
        blank = False
    if len(rows) > 1 and len(rows[-1]) < width:
        remarks.append(f"line {places[-1]}, the last, is cut off and left out")
        rows, places = rows[:-1], places[:-1]
    return rows, places, remarks


def _are_words(cells: Sequence[str]) -> bool:
    """Return whether a line has no number, and says more than that nothing is there."""
    return not any(map(_is_number, cells)) and any(
        cell.strip().lower() not in NOTHING for cell in cells
    )


def _number(table: Table, row: int, place: int, entry: str, comma: Comma) -> float:
    if entry.lower() in NOTHING:
        return np.nan
    plain = plain_number(entry, comma)
    where = f"line {table.lines[row]}, column {table.names[place]!r}"
    if plain is None:
        raise InputError(
            f"{where}: {entry!r} may be {both_readings(entry)}; write decimals with a point"
        )
    try:
        return number_in(plain)
    except ValueError:
        raise InputError(f"{where}: {shortened(entry)} is no number") from None
