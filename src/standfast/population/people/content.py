"""What a population's study says, checked table by table, in its canonical form."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from standfast.errors import InputError
from standfast.parameters import STANDARD_GRAVITY, STIFFNESSES, checked_number
from standfast.population.people.keys import checked_output, checked_population
from standfast.population.people.sections import (
    SECTIONS,
    canonical_nerves,
    checked_nerves,
    checked_stiffness,
    is_noisy,
    refuse_measured,
)
from standfast.study.values import checked_title, known_keys

MOST_KEPT = 10**8  # persons stored one by one


def checked_content(
    content: Mapping[str, Any], folder: Path
) -> tuple[dict[str, Any], tuple[Path, ...]]:
    """Return what a study says in canonical form, and where its people are; or refuse it."""
    if isinstance(content, Mapping) and "body" in content and "population" not in content:
        raise InputError("this is the study of a sweep; run: standfast sweep")
    tables = ("title", "gravity", "population", "stiffness", *SECTIONS, "output")
    known_keys("study", content, tables)
    title = checked_title(content)
    gravity = content.get("gravity", STANDARD_GRAVITY)
    if isinstance(gravity, list | tuple | Mapping):
        raise InputError("gravity is one number in a population, without list or range")
    if "population" not in content:
        raise InputError("[population] is missing: say people or builtin, and size")
    if "stiffness" not in content:
        raise InputError("[stiffness.ankle], [stiffness.knee] and [stiffness.hip] are missing")
    distributions, correlation = checked_stiffness(content["stiffness"])
    nerves = checked_nerves(content)
    springs = tuple(zip(STIFFNESSES, distributions.values(), strict=True))
    if "builtin" in content["population"]:
        refuse_measured(springs + nerves)
    output = checked_output(content.get("output", {}), noisy=is_noisy(nerves))
    population, files = checked_population(content["population"], folder)
    if output["persons"] and population["size"] > MOST_KEPT:
        raise InputError(
            f"output.persons keeps at most {MOST_KEPT:,} persons, "
            f"and population.size is {population['size']:,}"
        )
    stiffness: dict[str, Any] = {k: each.canonical() for k, each in distributions.items()}
    checked = {
        "title": title,
        "gravity": checked_number("gravity", gravity),
        "population": population,
        "stiffness": {**stiffness, "correlation": [list(row) for row in correlation]},
        **canonical_nerves(nerves),
        "output": output,
    }
    return checked, files
