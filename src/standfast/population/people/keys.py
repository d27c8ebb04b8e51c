"""The border of a population's study: what its tables may say, checked key by key."""

import math
import re
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from standfast.errors import InputError, nearest_name, shortened
from standfast.parameters import BODY_MODELS, JOINTS
from standfast.population.people.builtin import PARTITION, POPULATIONS, Subpopulation
from standfast.population.people.classes import checked_bands
from standfast.population.people.decoding import STANDARD_INPUT, digest
from standfast.population.people.distributions import checked_word
from standfast.population.people.sobol import REPLICATES
from standfast.population.people.words import SEXES
from standfast.quantities.of_sway import OF_SWAY
from standfast.study.values import known_keys

# Who gets a body model of its own: the two sexes, and whoever is, or is known to be, neither.
OF_SEX = (*SEXES[:2], "other")
KEYS = (
    "people", "builtin", "sex", "age", "age_bands", "body_model", "proportions", "size", "seed",
    "method",
)  # fmt: skip
# What is chosen by a word: the one that holds where nothing is said, and all.
CHOICES = {
    "proportions": ("fixed", ("fixed", "scattered")),
    "method": ("monte-carlo", ("monte-carlo", "quasi-monte-carlo")),
}
LARGEST_SIZE = 10**11
# What is answered of sway, and what of it where a study with noise does not say.
SWAY = tuple(row.name for row in OF_SWAY)
SWAY_TOLD = tuple(name for name in SWAY if not name.startswith(JOINTS))
LARGEST_QUASI = REPLICATES * 2**32  # Sobol points are numbered with 32 bits


def checked_output(given: Any, *, noisy: bool) -> dict[str, Any]:
    """Check what is answered beside the risk: whether persons are kept, and with noise which sway.

    Without noise there is no key of sway, so that such studies are what they were.
    """
    known_keys("[output]", given, ("persons", "quantities"))
    kept = given.get("persons", False)
    if not isinstance(kept, bool):
        raise InputError(f"output.persons = {kept!r} is not true or false")
    names = given.get("quantities", SWAY_TOLD if noisy else ())
    if not isinstance(names, list | tuple) or not all(isinstance(name, str) for name in names):
        raise InputError(f"output.quantities = {shortened(names)} is not a list of quantities")
    for name in names:
        if name not in SWAY:
            raise InputError(
                f"output.quantities has no {shortened(name)}{nearest_name(name, SWAY)} (of a "
                f"population with noise: {', '.join(SWAY)})"
            )
    if len(set(names)) < len(names):
        raise InputError("output.quantities names a quantity twice")
    if names and not noisy:
        raise InputError(
            f"output.quantities: {names[0]} is of persons with noise; give [noise] ankle = 1.0 "
            "(N·m·√s) or a distribution"
        )
    if noisy and not names:
        raise InputError("output.quantities is an empty list; with [noise] give one or more")
    return {"persons": kept, **({"quantities": list(names)} if noisy else {})}


def checked_population(given: Any, folder: Path) -> tuple[dict[str, Any], tuple[Path, ...]]:
    """Check who is simulated and how many; return all keys, and where the people are.

    Of a file of people the keys hold its name and the hash of its content, not where it lies.
    """
    known_keys("[population]", given, KEYS)
    checked: dict[str, Any] = {}
    files: tuple[Path, ...] = ()
    if ("people" in given) == ("builtin" in given):
        have = "both are given" if "people" in given else "neither is given"
        raise InputError(
            f"[population] needs people (a CSV file) or builtin ({', '.join(POPULATIONS)}), "
            f"one of them; {have}"
        )
    if "people" in given:
        names = given["people"] if isinstance(given["people"], list | tuple) else [given["people"]]
        if STANDARD_INPUT in names:
            raise InputError(
                "population.people = '-' is standard input, which a study that goes on after a "
                "break cannot read again; give a file"
            )
        if not names or not all(isinstance(name, str) and name for name in names):
            raise InputError(
                f"population.people = {given['people']!r} is not the name of a CSV file, "
                "or a list of files to be joined"
            )
        files = tuple(folder / name for name in names)
        checked["people"] = [path.name for path in files]
        checked["people_sha256"] = digest(files)
    else:
        checked["builtin"] = checked_word("population.builtin", given["builtin"], POPULATIONS)
    if "sex" in given:
        known = SEXES[:3] if "people" in checked else SEXES[:2]
        checked["sex"] = checked_word("population.sex", given["sex"], known)
    if "age" in given:
        age_range(given["age"])
        checked["age"] = given["age"]
    if "age_bands" in given:
        if "builtin" in checked:
            raise InputError(
                "population.age_bands needs people of known age in a file; a built-in population "
                "has the age groups of its survey"
            )
        checked["age_bands"] = checked_bands("population.age_bands", given["age_bands"])
    if "builtin" in checked:
        subpopulations_of(checked)
    checked["body_model"] = checked_body_model(
        "population.body_model", given.get("body_model", "winter")
    )
    for key, (default, words) in CHOICES.items():
        checked[key] = checked_word(f"population.{key}", given.get(key, default), words)
    largest = LARGEST_SIZE if checked["method"] == "monte-carlo" else LARGEST_QUASI
    checked["size"] = whole_number("size", given.get("size", 1_000_000), 1, largest)
    checked["seed"] = whole_number("seed", given.get("seed", 0), 0, 2**63 - 1)
    return checked, files


def checked_body_model(where: str, given: Any) -> str | dict[str, str]:
    """Check the body model of all, or a table of one for each sex; ``other`` is winter if left out.

    Who has no sex in the file, or another, gets ``other``.
    """
    if not isinstance(given, Mapping):
        return checked_word(where, given, BODY_MODELS, "models")
    known_keys(where, given, OF_SEX)
    for sex in OF_SEX[:2]:
        if sex not in given:
            raise InputError(f"{where} has no model for {sex}; give female and male, or one model")
    models = {sex: given.get(sex, "winter") for sex in OF_SEX}
    return {
        sex: checked_word(f"{where}.{sex}", m, BODY_MODELS, "models") for sex, m in models.items()
    }


def whole_number(key: str, given: Any, lowest: int, highest: int) -> int:
    """Check a whole number of the table of the population."""
    if isinstance(given, float) and given.is_integer():  # 1e6
        given = int(given)
    if isinstance(given, bool) or not isinstance(given, int) or not lowest <= given <= highest:
        raise InputError(
            f"population.{key} = {given!r} is not a whole number from {lowest} to {highest}"
        )
    return given


def age_range(given: Any, where: str = "population.age") -> tuple[float, float]:
    """Return the ages of "65+" or "20-39": from the first to before the last."""
    match = re.fullmatch(r"(\d{1,3})(?:\+|-(\d{1,3}))", given) if isinstance(given, str) else None
    if match is None or (match[2] is not None and int(match[2]) < int(match[1])):
        raise InputError(f'{where} = {given!r} is not a range of ages; write "65+" or "20-39"')
    return float(match[1]), math.inf if match[2] is None else float(match[2]) + 1.0


def selection(
    sex: str | None, age: str | None, where: str = "population.age"
) -> Callable[[str, float], bool]:
    """Return what tells of sex and age whether a person is wanted; None wants all."""
    lowest, highest = age_range(age, where) if age is not None else (0.0, math.inf)

    def selected(of: str, years: float) -> bool:
        return (sex is None or of == sex) and (age is None or lowest <= years < highest)

    return selected


def subpopulations_of(population: Mapping[str, Any]) -> tuple[Subpopulation, ...]:
    """Return the subpopulations of a built-in population."""
    name, age = population["builtin"], population.get("age")
    rows = POPULATIONS[name]
    ages = tuple(dict.fromkeys(row.age for row in rows))
    if age is not None and age not in ages:
        raise InputError(
            f"population.age = {age!r} is not a group of {name}{nearest_name(age, ages)} "
            f"(groups: {', '.join(ages)})"
        )
    wanted = (age,) if age is not None else PARTITION[name]
    sexes = (population["sex"],) if "sex" in population else ("male", "female")
    return tuple(row for row in rows if row.sex in sexes and row.age in wanted)
