"""Words in files of people: sexes, ages such as ``80+``, and the ways to say that nothing is known.

Kept apart from :mod:`.records`, which says what a person must have.
"""

import math
import re

from standfast.errors import InputError
from standfast.parameters import Parameter, checked_number, number_in

SEXES = ("male", "female", "other", "unknown")
NOTHING = (
    "", ".", "-", "–", "?", "na", "n/a", "#n/a", "nan", "none", "null", "missing", "unknown",
)  # fmt: skip
SEX_WORDS = dict.fromkeys(("male", "m", "man", "männlich", "mann"), "male")
SEX_WORDS |= dict.fromkeys(("female", "f", "woman", "w", "weiblich", "frau"), "female")
OTHER = (
    "other", "o", "x", "d", "divers", "diverse", "nonbinary", "non-binary", "non binary", "nb",
    "intersex", "third", "inter",
)  # fmt: skip
SEX_WORDS |= dict.fromkeys(OTHER, "other")
SEX_WORDS |= dict.fromkeys(NOTHING, "unknown")
# As ISO/IEC 5218 and NHANES number them.
SEX_NUMBERS = {0.0: "unknown", 1.0: "male", 2.0: "female", 9.0: "unknown"}
AGE = Parameter("age", "", "years", "age", 0.0, 130.0)
# Ages that a survey does not tell exactly, as 80+, >=85, 90 and over; the number is the lowest.
TOP_CODED = re.compile(
    r"(?:(?:>=|≥|=>|>|over|from)\s*(\d{1,3}(?:\.\d+)?)"
    r"|(\d{1,3}(?:\.\d+)?)\s*(?:y|yrs?|years)?\s*(?:\+|plus|(?:and|or|&)\s*(?:over|older|more|above|up)))"
    r"\s*(?:y|yrs?|years)?\s*(?:old|of age)?",
    re.IGNORECASE,
)
WITH_UNIT = re.compile(
    r"(\d{1,3}(?:\.\d+)?)\s*(?:y|yrs?|years?)(?:\s*(?:old|of age))?", re.IGNORECASE
)
CLASS_OF_AGES = re.compile(r"\d{1,3}\s*(?:-|–|to|<)\s*\d{1,3}")


def is_nothing(entry: str) -> bool:
    """Return whether an entry says that nothing is known."""
    return entry.lower() in NOTHING


def sex_of(entry: str) -> str:
    """Return which of SEXES an entry says, by word or number; refuse any other."""
    word = entry.lower()
    if word in SEX_WORDS:
        return SEX_WORDS[word]
    try:
        return SEX_NUMBERS[number_in(word)]
    except (ValueError, KeyError):
        raise InputError(
            f"sex = {entry!r} is not known; write male, female or other, or leave it empty"
        ) from None


def is_numbered(entry: str) -> bool:
    """Return whether a sex is given by its number."""
    return entry.removesuffix(".0") in ("0", "1", "2", "9")


def is_top_coded(entry: str) -> bool:
    """Return whether an age is told by its lowest value alone."""
    return TOP_CODED.fullmatch(entry) is not None


def age_of(entry: str) -> float:
    """Return an age in years, the lowest of such as ``80+``; NaN if it is not known."""
    if is_nothing(entry):
        return math.nan
    top = TOP_CODED.fullmatch(entry)
    years = WITH_UNIT.fullmatch(entry)
    if top or years:
        found = (top[1] or top[2]) if top else (years[1] if years else "")
        return checked_number("age", float(found), row=AGE)
    if CLASS_OF_AGES.fullmatch(entry):
        raise InputError(f"age = {entry!r} is a class of ages; give years, or leave it empty")
    try:
        number: float | str = number_in(entry)
    except ValueError:
        number = entry
    return checked_number("age", number, row=AGE)
