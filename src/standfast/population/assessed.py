"""What was found of single persons: their table, and their strata."""

import csv
import itertools
import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from standfast.files import for_spreadsheets, whole_table
from standfast.parameters import JOINTS
from standfast.population.known import remarks_on_stiffness
from standfast.population.people.classes import (
    BMI_CLASSES,
    HEIGHT_CLASSES,
    UNKNOWN,
    AgeClasses,
    age_class,
    age_classes,
    size_classes,
)
from standfast.population.people.records import People
from standfast.population.people.words import SEXES
from standfast.population.summary.estimators import wilson

HAIR = 1e-9  # is added, so that a value right at a limit lies above it
SHARES = (0.05, 0.5, 0.95)
# How the first line of a table of persons begins, by which it is known again.
HEADER = ",".join(
    (
        "id", "height_m", "mass_kg", "sex", "age",
        *(f"{joint}_stiffness_Nm_rad" for joint in JOINTS),
        *(f"{joint}_threshold_alone_Nm_rad" for joint in JOINTS),
    )
)  # fmt: skip


@dataclass(frozen=True)
class Assessment:
    """What was found of each person; NaN, or an empty word, where stiffness is not known."""

    people: People
    columns: Mapping[str, np.ndarray]  # (persons,) each, by the names of the CSV file's columns
    body_model: str | Mapping[str, str]

    @property
    def judged(self) -> np.ndarray:
        """Who has all three stiffnesses, so that a verdict can be given."""
        return np.asarray(self.columns["stands"] != "")

    @property
    def falls(self) -> np.ndarray:
        """Who does not stand."""
        return np.asarray(self.columns["stands"] == "no")

    @property
    def own(self) -> dict[str, np.ndarray]:
        """The columns of the people's files that stand beside ours."""
        others = self.people.own.items()
        return {name: np.array(v, object) for name, v in others if name not in self.columns}

    @property
    def remarks(self) -> tuple[str, ...]:
        """What was remarked of the people's files, and which of their columns are left out."""
        left = [name for name in self.people.own if name in self.columns]
        words = f"computed anew, not kept as they were: {', '.join(left)}"
        known = {joint: self.columns[f"{joint}_stiffness_Nm_rad"] for joint in JOINTS}
        weak = remarks_on_stiffness(known)
        return (*self.people.remarks, *weak, *([words] if left else []))

    def strata(self, bands: list[int] | None = None) -> dict[str, dict[str, dict[str, Any]]]:
        """Return numbers of all persons, and of each class by sex, age, both, BMI and height.

        ``bands`` are the first ages of own age classes. Fractions are of those with a verdict,
        unweighted, with Wilson's interval of 95 %; quantiles of all.
        """
        everybody = {"all": {"all": self._of(np.ones(len(self.people), bool))}}
        found = {}
        for key, labels in self._labels(age_classes(bands)).items():
            order = list(dict.fromkeys(labels[0]))
            told = {label: self._of(labels[1] == label) for label in order}
            found[key] = {label: each for label, each in told.items() if each["persons"]}
        return everybody | found

    def _labels(self, classes: AgeClasses) -> dict[str, tuple[list[str], np.ndarray]]:
        """Return all classes by kind, in order, and that of each person."""
        people = self.people
        sex = np.array(people.sex, object)
        age = np.array([age_class(each, classes) for each in people.age], object)
        ages = [*(name for _, name in classes), UNKNOWN]
        pairs = [f"{s} {a}" for s, a in itertools.product(SEXES, ages)]
        both = np.array([f"{s} {a}" for s, a in zip(sex, age, strict=True)], object)
        found = {"sex": (list(SEXES), sex), "age": (ages, age), "sex_and_age": (pairs, both)}
        for key, values, limits in (
            ("bmi", people.mass / people.height**2, BMI_CLASSES),
            ("height", people.height, HEIGHT_CLASSES),
        ):
            names = size_classes(limits)
            of_each = np.array(names, object)[np.digitize(values + HAIR, limits)]
            found[key] = (names, of_each)
        return found

    def _of(self, chosen: np.ndarray) -> dict[str, Any]:
        """Return the numbers of some persons."""
        found: dict[str, Any] = {"persons": int(chosen.sum())}
        verdicts = {"": "stands", "_with_feedback": "stands_with_feedback"}
        for suffix, name in verdicts.items():
            if name in self.columns:
                found |= _verdicts(self.columns[name][chosen], suffix)
        of_joints = (f"{joint}_threshold_alone_Nm_rad" for joint in JOINTS)
        of_delay = ("critical_delay_s",) if "critical_delay_s" in self.columns else ()
        for name in ("safety_factor", *of_joints, *of_delay):
            values = self.columns[name][chosen]
            values = values[~np.isnan(values)]
            with np.errstate(invalid="ignore"):  # between infinite ones
                ends = np.quantile(values, SHARES) if values.size else [None] * 3
            for share, value in zip(SHARES, ends, strict=True):
                known = value is not None and math.isfinite(value)
                found[f"{name}_p{100 * share:.0f}"] = float(value) if known else None
        return found


def _verdicts(words: np.ndarray, suffix: str) -> dict[str, Any]:
    """Return how many have a verdict, how many fall, and their fraction with its interval."""
    judged, fall = int((words != "").sum()), int((words == "no").sum())
    names = (f"unstable{end}{suffix}" for end in ("_fraction", "_95_low", "_95_high"))
    values: list[float | None] = [None] * 3
    if judged:
        fraction = wilson(fall, judged)
        values = [fraction.value, *fraction.interval]
    told = dict(zip(names, values, strict=True))
    return {f"judged{suffix}": judged, f"unstable{suffix}": fall, **told}


def write_assessment(assessment: Assessment, path: Path) -> None:
    """Write one line a person, whole or not at all: what was found, then the files' own columns."""
    columns = {**assessment.columns, **assessment.own}
    with whole_table(path, HEADER) as file:
        rows = csv.writer(file, lineterminator="\n")
        rows.writerow(map(for_spreadsheets, columns))
        for row in zip(*columns.values(), strict=True):
            rows.writerow([_entry(value) for value in row])


def _entry(value: Any) -> str:
    """Return a number with the digits that mean something; nothing for what is not known."""
    if isinstance(value, str):
        return for_spreadsheets(value)
    return "" if math.isnan(value) else f"{value:.6g}"
