"""Single persons, one by one: how stiff they would have to be, and how far they are from it."""

import csv
import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from standfast.anthropometry.body import Body
from standfast.engine.mapping import map_over_batch
from standfast.files import for_spreadsheets, whole_file
from standfast.mechanics.joints import Stiffness
from standfast.mechanics.matrices import joint_gravity
from standfast.numerics.arrays import Scalar
from standfast.parameters import GAINS, JOINTS, OWN_BODY, PARAMETERS, STIFFNESSES
from standfast.population.cohort.bodies import (
    Models,
    model_of_sex,
    scaled_body,
    with_own_segments,
)
from standfast.population.cohort.nerves import entries_of, judged
from standfast.population.cohort.persons import load_of
from standfast.population.people.distributions import Distributions, ParameterDistribution
from standfast.population.people.records import People
from standfast.population.people.sections import NERVES
from standfast.stability.margins import safety_factor, stiffness_reserve
from standfast.stability.modes import frequency_of, modes, ratio_to_ankle
from standfast.stability.springs import critical_stiffness, verdict

DELAY = "feedback_delay"
Setting = tuple[Models, float]  # body model of each sex, and gravity
# How the names of columns say units.
UNITS = {"N·m/rad": "Nm_rad", "N·m·s/rad": "Nms_rad", "s": "s"}


@dataclass(frozen=True)
class Assessment:
    """What was found of each person; NaN, or an empty word, where stiffness is not known."""

    people: People
    columns: Mapping[str, np.ndarray]  # (persons,) each, by the names of the CSV file's columns

    @property
    def judged(self) -> np.ndarray:
        """Who has all three stiffnesses, so that a verdict can be given."""
        return np.asarray(self.columns["stands"] != "")

    @property
    def falls(self) -> np.ndarray:
        """Who does not stand."""
        return np.asarray(self.columns["stands"] == "no")


def assess(
    people: People,
    *,
    body_model: str | Mapping[str, str] = "winter",
    gravity: float,
    otherwise: Mapping[str, float] | None = None,
    nerves: Distributions = (),
) -> Assessment:
    """Assess persons one by one; ``otherwise`` is stiffness by joint where it is not known.

    Found are thresholds of each joint alone (the other two rigid) and with the other two as they
    are, safety factor, reserve, frequency, strategy, and what each joint would have to gain: all of
    springs alone. With gains, which people have or ``nerves`` fixes where they have none, follow
    the verdict, critical delay and delay margin with feedback (Distributions that are fixed).
    ``body_model`` is that of all, or of ``female``, ``male`` and ``other``, for whom no own
    segments were measured.
    """
    known = {}
    for joint in JOINTS:
        measured = people.measured.get(f"{joint}_stiffness", np.full(len(people), math.nan))
        instead = (otherwise or {}).get(joint, math.nan)
        known[joint] = np.where(np.isnan(measured), instead, measured)
    setting, size = _bodies(people, body_model, gravity)
    given = np.array([*size.values(), *known.values()])
    names = (*size, *STIFFNESSES)
    found = map_over_batch(_of_one, setting, names)(given)
    told = {joint: ~np.isnan(values) for joint, values in known.items()}
    everything = np.all([*told.values()], axis=0)
    columns: dict[str, np.ndarray] = {
        "id": np.array(people.id, object),
        "height_m": people.height,
        "mass_kg": people.mass,
        "sex": np.array([sex if sex != "unknown" else "" for sex in people.sex], object),
        "age": people.age,
        **{f"{joint}_stiffness_Nm_rad": values for joint, values in known.items()},
        **{f"{joint}_threshold_alone_Nm_rad": found[f"{joint}_alone"] for joint in JOINTS},
    }
    for joint in JOINTS:
        others = np.all([told[other] for other in JOINTS if other != joint], axis=0)
        threshold = np.where(others, found[f"critical_{joint}_stiffness"], math.nan)
        columns[f"{joint}_threshold_Nm_rad"] = threshold
    columns["stands"] = np.where(everything, np.where(found["stable"], "yes", "no"), "")
    for name, unit in (
        ("safety_factor", ""),
        ("stiffness_reserve", "_Nm_rad"),
        ("frequency", "_Hz"),
    ):
        columns[name + unit] = np.where(everything, found[name], math.nan)
    hips_turn_more = np.abs(found["hip_ankle_ratio"]) > 1.0
    columns["strategy"] = np.where(everything, np.where(hips_turn_more, "hip", "ankle"), "")
    columns |= _gains(known, columns)
    fixed = dict(nerves)
    if any(name in fixed or name in people.measured for name in GAINS):
        columns |= _with_feedback(setting, names, given, people, fixed, everything)
    return Assessment(people, columns)


def _bodies(
    people: People, body_model: str | Mapping[str, str], gravity: float
) -> tuple[Setting, dict[str, np.ndarray]]:
    """Return the models and gravity of all, and the numbers that make each one's body."""
    sexes = tuple(dict.fromkeys(people.sex))
    models = tuple(model_of_sex(body_model, sex) for sex in sexes)
    numbers = {"height": people.height, "mass": people.mass}
    if len(set(models)) > 1:
        numbers["stratum"] = np.array([sexes.index(sex) for sex in people.sex], np.float64)
    own = {name: people.measured[name] for name in OWN_BODY if name in people.measured}
    return (models, float(gravity)), {**numbers, **own}


def _body_of(setting: Setting, given: Mapping[str, Scalar]) -> Body:
    scaled = scaled_body(setting[0], given.get("stratum", 0.0), given["height"], given["mass"])
    return with_own_segments(scaled, given)


def _with_feedback(
    setting: Setting,
    of_springs: tuple[str, ...],
    given: np.ndarray,
    people: People,
    fixed: Mapping[str, ParameterDistribution],
    everything: np.ndarray,
) -> dict[str, np.ndarray]:
    """Return damping, delay and gains of each person, and what becomes of them with these.

    A parameter that neither people nor ``fixed`` have is 0; but a delay is then not known.
    """
    names = tuple(name for name in NERVES if name in fixed or name in people.measured)
    size = of_springs[: -len(STIFFNESSES)]
    by_joint = map_over_batch(_loads, setting, size)(given[: len(size)])
    loads = (by_joint["ankle"], by_joint["knee"], by_joint["hip"])
    values = {}
    for name in names:
        own = people.measured.get(name, np.full(len(people), math.nan))
        instead: Any = math.nan
        if name in fixed:
            instead = fixed[name].numbers[0] * load_of(name, fixed[name].relative_to, loads)
        values[name] = np.where(np.isnan(own), instead, own)
    told = np.all([~np.isnan(each) for name, each in values.items() if name != DELAY], axis=0)
    told &= everything
    timed = told & ~np.isnan(values.get(DELAY, np.full(len(people), math.nan)))
    # what is not known is computed with zeros, and not told
    numbers = np.array([*given, *(np.nan_to_num(each) for each in values.values())])
    known = np.where(told, numbers, np.where(np.isnan(numbers), 0.0, numbers))
    known[: len(size)] = given[: len(size)]  # own segments that are not known are scaled
    mapped = map_over_batch(_entries_of_one, setting, (*of_springs, *names))
    found = judged(mapped(known))
    return {
        **{f"{name}_{UNITS[PARAMETERS[name].unit]}": each for name, each in values.items()},
        "stands_with_feedback": np.where(timed, np.where(found.stands, "yes", "no"), ""),
        "critical_delay_s": np.where(told, found.critical_delay, math.nan),
        "delay_margin_s": np.where(timed, found.delay_margin, math.nan),
    }


def _loads(setting: Setting, given: Mapping[str, Scalar]) -> dict[str, Scalar]:
    loads = joint_gravity(_body_of(setting, given), setting[1])[0]
    return dict(zip(JOINTS, loads, strict=True))


def _entries_of_one(setting: Setting, given: Mapping[str, Scalar]) -> dict[str, Scalar]:
    stiffness = Stiffness._make(given[name] for name in STIFFNESSES)
    nerves = {name: given[name] for name in NERVES if name in given}
    return entries_of(_body_of(setting, given), stiffness, setting[1], nerves)


def _gains(
    known: Mapping[str, np.ndarray], columns: Mapping[str, np.ndarray]
) -> dict[str, np.ndarray]:
    """Return what each joint would have to gain so that the person stands, and the least of it."""
    falls, stands = columns["stands"] == "no", columns["stands"] == "yes"
    gains = {}
    for joint, own in known.items():
        # what is rigid cannot gain, and where no stiffness suffices no gain does
        with np.errstate(invalid="ignore"):
            missing = columns[f"{joint}_threshold_Nm_rad"] - own
        gain = np.where(np.isinf(own), math.inf, missing)
        gains[joint] = np.where(falls, gain, np.where(stands, 0.0, math.nan))
    every = np.array(list(gains.values()))
    possible = falls & np.isfinite(every).any(axis=0)
    best = np.argmin(np.where(np.isnan(every), np.inf, every), axis=0)
    return {
        **{f"{joint}_gain_needed_Nm_rad": gain for joint, gain in gains.items()},
        "least_gain_at": np.where(possible, np.array(JOINTS)[best], ""),
    }


def write_assessment(assessment: Assessment, path: Path) -> None:
    """Write one line a person, whole or not at all."""
    with whole_file(path) as partial, partial.open("w", encoding="utf-8", newline="") as file:
        rows = csv.writer(file, lineterminator="\n")
        rows.writerow(assessment.columns)
        for row in zip(*assessment.columns.values(), strict=True):
            rows.writerow([_entry(value) for value in row])


def _of_one(setting: Setting, given: Mapping[str, Scalar]) -> dict[str, Scalar]:
    """Return everything about one person; what depends on an unknown stiffness is without sense."""
    body, gravity = _body_of(setting, given), setting[1]
    stiffness = Stiffness._make(given[name] for name in STIFFNESSES)
    person = (body, stiffness, gravity)
    alone, _, _ = joint_gravity(body, gravity)
    of_modes = modes(*person)
    thresholds = critical_stiffness(*person).joints
    return {
        **{f"{joint}_alone": load for joint, load in zip(JOINTS, alone, strict=True)},
        **{f"critical_{joint}_stiffness": k for joint, k in zip(JOINTS, thresholds, strict=True)},
        "stable": verdict(*person),
        "safety_factor": safety_factor(*person),
        "stiffness_reserve": stiffness_reserve(*person),
        "frequency": frequency_of(of_modes.eigenvalues[0]),
        "hip_ankle_ratio": ratio_to_ankle("hip", stiffness, of_modes),
    }


def _entry(value: Any) -> str:
    """Return a number with the digits that mean something; nothing for what is not known."""
    if isinstance(value, str):
        return for_spreadsheets(value)
    return "" if math.isnan(value) else f"{value:.6g}"
