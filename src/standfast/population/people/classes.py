"""The classes that people are told apart by: age bands, height and BMI, with their units."""

import itertools
import math
from collections.abc import Mapping, Sequence
from typing import Any

from standfast.errors import InputError
from standfast.population.people.builtin import AGE_CLASSES
from standfast.population.people.words import AGE

# Edges of the classes of height (m) and, after the World Health Organization, of BMI (kg/m²); the
# fine bins of the risk map fall on all of them.
HEIGHT_CLASSES = (1.55, 1.65, 1.75, 1.85)
BMI_CLASSES = (18.5, 25.0, 30.0, 35.0, 40.0)
# How tables and screens call what strata are by, and the units of their classes.
STRATA = {
    "sex": ("sex", ""),
    "age": ("age", "years"),
    "sex_and_age": ("sex and age", "years"),
    "bmi": ("BMI", "kg/m²"),
    "height": ("height", "m"),
}
UNKNOWN = "unknown"

# The first age of each class, and what it is called.
AgeClasses = tuple[tuple[float, str], ...]


def checked_bands(where: str, given: Any) -> list[int]:
    """Check the ages at which bands begin: whole years, rising."""
    whole = isinstance(given, list | tuple) and all(
        isinstance(age, int | float) and not isinstance(age, bool) and float(age).is_integer()
        for age in given
    )
    if not whole or not given or not all(0 <= age <= AGE.highest for age in given):
        raise InputError(
            f"{where} = {given!r} is no list of whole years from 0 to {AGE.highest:g}; "
            "write the first age of each band, as [18, 30, 45, 65]"
        )
    if any(later <= age for age, later in itertools.pairwise(given)):
        raise InputError(f"{where} = {given!r} does not rise; write each age once, as [18, 30, 65]")
    return [int(age) for age in given]


def age_classes(bands: Sequence[int] | None) -> AgeClasses:
    """Return the age classes that bands make, with those below the first; or the usual ones."""
    if bands is None:
        return AGE_CLASSES
    below = [(0.0, f"under {bands[0]}")] if bands[0] > 0 else []
    between = [
        (float(age), f"{age}-{later - 1}" if later - 1 > age else f"{age}")
        for age, later in itertools.pairwise(bands)
    ]
    return (*below, *between, (float(bands[-1]), f"{bands[-1]}+"))


def age_classes_of(population: Mapping[str, Any]) -> AgeClasses:
    """Return the age classes of a study's people."""
    bands = population.get("age_bands")
    return age_classes(None if bands is None else checked_bands("population.age_bands", bands))


def age_class(age: float, classes: AgeClasses) -> str:
    """Return what the class of an age is called."""
    if math.isnan(age):
        return UNKNOWN
    return next(name for start, name in reversed(classes) if age >= start)


def size_classes(limits: Sequence[float]) -> list[str]:
    """Return what the classes between limits, below the first and from the last, are called."""
    inner = [f"{low:g} to {high:g}" for low, high in itertools.pairwise(limits)]
    return [f"below {limits[0]:g}", *inner, f"{limits[-1]:g} and more"]
