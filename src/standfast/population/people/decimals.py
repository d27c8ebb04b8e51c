"""Commas in numbers: decimal, or between thousands; what may be either is told apart or refused.

A file separated by semicolons is written where the comma is decimal. In any other the numbers
themselves must say it: ``1,75`` and ``0,912`` only make sense one way, ``1,200,500`` and
``1,200.5`` the other way, and ``1,200`` alone does not tell.
"""

import re
from collections.abc import Iterable
from enum import Enum

# A comma that can only be decimal, and one that can only part thousands.
DECIMAL = re.compile(r"[-+]?(?:\d+,\d{1,2}|0+,\d+|\d+,\d{4,}|\d{4,},\d+)(?:[eE][-+]?\d+)?")
THOUSANDS = re.compile(r"[-+]?\d{1,3}(?:(?:,\d{3})+\.\d+|(?:,\d{3}){2,})")
DECIMAL_AFTER_THOUSANDS = re.compile(r"[-+]?\d{1,3}(?:\.\d{3})+,\d+")
EITHER = re.compile(r"[-+]?[1-9]\d{0,2}[.,]\d{3}")


class Comma(Enum):
    """What a comma in the numbers of a file is."""

    DECIMAL = "decimal"  # seen as such
    ASSUMED = "assumed to be decimal"  # because of semicolons
    THOUSANDS = "between thousands"
    UNKNOWN = "either"


def comma_of(entries: Iterable[str], separator: str) -> Comma:
    """Return what commas are in the numbers of a file."""
    decimal = thousands = False
    for entry in entries:
        if "," in entry:
            decimal |= bool(DECIMAL.fullmatch(entry) or DECIMAL_AFTER_THOUSANDS.fullmatch(entry))
            thousands |= bool(THOUSANDS.fullmatch(entry))
    if decimal != thousands:
        return Comma.DECIMAL if decimal else Comma.THOUSANDS
    return Comma.ASSUMED if separator == ";" else Comma.UNKNOWN


def plain_number(entry: str, comma: Comma) -> str | None:
    """Return a number as Python writes it, what is none as it is, and None if it may be two."""
    if "," not in entry:
        # among decimal commas a point parts thousands, or is a decimal point all the same
        return None if comma is Comma.DECIMAL and EITHER.fullmatch(entry) else entry
    if DECIMAL_AFTER_THOUSANDS.fullmatch(entry):
        return entry.replace(".", "").replace(",", ".")
    if THOUSANDS.fullmatch(entry):
        return entry.replace(",", "")
    if DECIMAL.fullmatch(entry) or comma in (Comma.DECIMAL, Comma.ASSUMED):
        return entry.replace(",", ".")
    if EITHER.fullmatch(entry):
        return entry.replace(",", "") if comma is Comma.THOUSANDS else None
    return entry


def both_readings(entry: str) -> str:
    """Return the two numbers that an entry may be."""
    return f"{re.sub('[.,]', '', entry)} or {entry.replace(',', '.')}"
