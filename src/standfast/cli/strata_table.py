"""The table of all strata as a CSV file, as a paper prints it: one line a class of people."""

import csv
import math
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from standfast.cli.population_text import SWAY_PRINTED
from standfast.files import for_spreadsheets, whole_table
from standfast.population.people.classes import STRATA

WORDS = "write a table of all strata, one line a class: persons, fraction unstable, interval"
# How the first lines of both tables begin, by which they are known again.
OF_POPULATION = "stratum,class,unit_of_class,persons_simulated"
OF_ASSESSMENT = "stratum,class,unit_of_class,persons"


def write_strata(rows: Sequence[Mapping[str, Any]], path: Path, header: str) -> None:
    """Write rows of one and the same columns, the first as in ``header``, whole or not at all."""
    with whole_table(path, header) as file:
        table = csv.DictWriter(file, list(rows[0]), lineterminator="\n")
        table.writeheader()
        table.writerows({name: _entry(value) for name, value in row.items()} for row in rows)


def rows_of_population(summary: Mapping[str, Any]) -> Iterator[dict[str, Any]]:
    """Give the table's rows of a population: everybody, then each class of each kind."""
    low, high = summary["unstable_fraction_interval"]
    everybody = {
        "persons": summary["size"], "share": 1.0,
        "unstable_fraction": summary["unstable_fraction"], "interval": [low, high],
    }  # fmt: skip
    borne = summary.get("delay_borne")
    survey = summary["people"].get("survey_interval")
    for key, label, found in [("all", "all", everybody), *_classes(summary["strata"])]:
        row = {
            **_place(key, label),
            "persons_simulated": found["persons"],
            "share_of_persons": found["share"],
            "unstable_fraction": found["unstable_fraction"],
            "unstable_95_low": found["interval"][0],
            "unstable_95_high": found["interval"][1],
            "interval_method": summary["interval_method"],
        }
        if "used" in summary["people"]:
            ends = survey if survey and key == "all" else [None, None]
            row |= {"survey_95_low": ends[0], "survey_95_high": ends[1]}
        if borne is not None:
            of_class = borne["all"] if key == "all" else borne.get(key, {}).get(label)
            for share in borne["all"]:
                row |= _delay_borne(f"delay_borne_by_{share}", of_class and of_class[share])
        for name, sway in summary.get("sway", {}).items():
            row |= _sway(name, sway, key, label)
        yield row


def _delay_borne(name: str, found: Mapping[str, Any] | None) -> dict[str, float | None]:
    """Return a delay that is borne with the ends of its interval; infinity, which JSON has not."""
    columns = (f"{name}_s", f"{name}_95_low_s", f"{name}_95_high_s")
    if found is None:  # of classes by which delays are not told
        return dict.fromkeys(columns)
    told = (found["delay"], *found["delay_interval"])
    return {
        column: math.inf if each is None else each
        for column, each in zip(columns, told, strict=True)
    }


def _sway(name: str, sway: Mapping[str, Any], key: str, label: str) -> dict[str, float | None]:
    """Return median and middle 95 % of a quantity of sway, as it is printed, with the unit."""
    unit, factor = SWAY_PRINTED[sway["unit"]]
    of_class = sway["all"] if key == "all" else sway.get(key, {}).get(label)
    quantiles = (of_class or {}).get("quantiles") or {}
    written = {"mm/s": "mm_s", "°": "deg"}.get(unit, unit)
    shares = {"median": "0.5", "p2.5": "0.025", "p97.5": "0.975"}
    values = {word: quantiles.get(share, {}).get("value") for word, share in shares.items()}
    return {
        f"{name}_{word}_{written}": None if value is None else factor * value
        for word, value in values.items()
    }


def rows_of_assessment(strata: Mapping[str, Any]) -> Iterator[dict[str, Any]]:
    """Give the table's rows of persons who were assessed."""
    for key, label, found in _classes(strata):
        yield {**_place(key, label), **found}


def _classes(strata: Mapping[str, Any]) -> Iterator[tuple[str, str, Mapping[str, Any]]]:
    for key, classes in strata.items():
        for label, found in classes.items():
            yield key, label, found


def _place(key: str, label: str) -> dict[str, str]:
    name, unit = STRATA.get(key, (key, ""))
    return {"stratum": name, "class": label, "unit_of_class": unit}


def _entry(value: Any) -> str:
    """Return a number with the digits that mean something, and nothing for what is not known."""
    if value is None:
        return ""
    if isinstance(value, str):
        return for_spreadsheets(value)
    return str(value) if isinstance(value, int) else f"{value:.6g}"
