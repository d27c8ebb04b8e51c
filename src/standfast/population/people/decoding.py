"""From the bytes of a file of people to rows of text: encodings, separators, spreadsheets."""

import codecs
import contextlib
import csv
import hashlib
import io
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import chain
from pathlib import Path
from typing import Any

from standfast.errors import InputError
from standfast.files import nearest_file, opened_plainly

STANDARD_INPUT = "-"
# How files begin that say how they are written.
MARKS = (
    (b"\xff\xfe\x00\x00", "utf-32"),
    (b"\x00\x00\xfe\xff", "utf-32"),
    (b"\xff\xfe", "utf-16"),
    (b"\xfe\xff", "utf-16"),
    (b"\xef\xbb\xbf", "utf-8-sig"),
)
# Letters of the bytes of Windows (cp1252), and of Latin-1 where that has none.
WINDOWS = "".join(bytes([n]).decode("cp1252", "ignore") or chr(n) for n in range(256))
ZIPPED, OLD_EXCEL = b"PK\x03\x04", b"\xd0\xcf\x11\xe0"
SEPARATORS = ",;\t|"
# Comes after the last line, alone in its row unless a quotation mark is open.
END = "\0"

# A row, with the first and the last line that it stands on.
Row = tuple[int, int, list[str]]


@dataclass(frozen=True)
class Text:
    """A file as rows of text that are not empty; ``separator`` is "" in a spreadsheet."""

    separator: str
    rows: Iterator[Row]
    remarks: tuple[str, ...] = ()


def digest(paths: Sequence[Path]) -> str:
    """Return the SHA-256 of the files' contents, one after the other."""
    digests = [hashlib.sha256(bytes_of(path)).digest() for path in paths]
    return hashlib.sha256(b"".join(digests)).hexdigest()


def bytes_of(path: Path, of: str = "people") -> bytes:
    """Return what is in a file, or comes through standard input; messages say ``of`` what it is."""
    if str(path) == STANDARD_INPUT:
        with open(0, "rb", closefd=False) as stream:  # a number, not a path
            return stream.read()
    try:
        with opened_plainly(path) as file:
            return file.read()
    except FileNotFoundError:
        near = nearest_file(path, path.suffix or ".csv")
        raise InputError(f"{path}: there is no such file of {of}{near}") from None
    except IsADirectoryError:
        raise InputError(f"{path} is a folder; give a CSV file of {of}") from None
    except OSError as error:
        raise InputError(f"{path} cannot be read: {error.strerror}") from None
    except ValueError:
        raise InputError(f"{str(path)!r} is not the name of a file") from None


def called(path: Path) -> str:
    """Return what messages call a file."""
    return "standard input" if str(path) == STANDARD_INPUT else path.name


def text_of(path: Path) -> Text:
    """Read a CSV file or the first sheet of an Excel file.

    Raises
    ------
    InputError
        if it cannot be read, is empty, or is of another kind.
    """
    raw = bytes_of(path)
    name = path if str(path) != STANDARD_INPUT else called(path)
    if raw.startswith(ZIPPED):
        return _spreadsheet(str(name), raw)
    if raw.startswith(OLD_EXCEL):
        raise InputError(f"{name} is a file of old Excel; save it as .xlsx or as CSV")
    text = decoded(str(name), raw)
    if not text.strip():
        raise InputError(f"{name} is empty; give a header line and one line a person")
    header_line = text.lstrip().splitlines()[0]
    # the first line of files that Excel is to open says the separator
    told = re.fullmatch(r'"?sep=(.)"?', header_line, re.IGNORECASE)
    separator = told[1] if told else max(SEPARATORS, key=header_line.count)
    rows = _rows_of(str(name), text, separator)
    if told:
        next(rows)
    return Text(separator, rows)


def decoded(name: str, raw: bytes) -> str:
    """Return bytes as text: by the mark they begin with, else UTF-8, else the letters of Windows.

    Raises
    ------
    InputError
        if they begin with a mark and do not go on so.
    """
    for mark, encoding in MARKS:
        if raw.startswith(mark):
            try:
                return raw.decode(encoding)
            except UnicodeDecodeError:
                raise InputError(
                    f"{name} begins as a file in {encoding.upper()} and is none; save it as UTF-8"
                ) from None
    try:
        return raw.decode("utf-8")
    except UnicodeDecodeError:
        return codecs.charmap_decode(raw, "strict", WINDOWS)[0]


def _rows_of(name: str, text: str, separator: str) -> Iterator[Row]:
    """Go through the rows that are not empty, each with its first and its last line."""
    if END in text:
        raise InputError(f"{name} is not a CSV file; if it is one in UTF-16, save it as UTF-8")
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
    raise InputError(f"{name}, line {first}: a quotation mark opens in this row and is not closed")


def _spreadsheet(name: str, raw: bytes) -> Text:
    """Read the first sheet of an Excel file; its cells as text, lines are its rows."""
    try:
        import pandas as pd  # noqa: PLC0415 # an extra

        sheets = pd.read_excel(
            io.BytesIO(raw), sheet_name=None, header=None, dtype=object, engine="openpyxl",
            keep_default_na=False,
        )  # fmt: skip
    except ImportError:
        raise InputError(
            f"{name} is an Excel file, which needs pandas and openpyxl: install "
            "'standfast[excel]', or save it as CSV"
        ) from None
    except Exception as error:  # whatever else is zipped, or broken
        raise InputError(f"{name} is not a file of Excel that can be read ({error})") from None
    (title, first), *others = sheets.items()
    rows = [[_cell(value) for value in row] for row in first.itertuples(index=False)]
    filled = [(n, n, row) for n, row in enumerate(rows, 1) if any(entry.strip() for entry in row)]
    if not filled:
        raise InputError(f"{name} is empty; give a header line and one line a person")
    left = [str(sheet) for sheet, content in others if not content.empty]
    remarks = (f"of its sheets {title!r} is read, not {', '.join(left)}",) if left else ()
    return Text("", iter(filled), remarks)


def _cell(value: Any) -> str:
    if value is None or value != value:  # noqa: PLR0124 # NaN, of whichever library
        return ""
    if isinstance(value, float) and value.is_integer():
        return str(int(value))
    return str(value)
