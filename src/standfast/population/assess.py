"""Single persons, one by one: how stiff they would have to be, and how far they are from it."""

import csv
import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from standfast.arithmetic import Scalar
from standfast.body import REFERENCE_PEOPLE, Stiffness, rescaled
from standfast.dynamics import joint_gravity
from standfast.engine import over_persons
from standfast.modes import frequency, modes, ratio_to_ankle
from standfast.population.laws import JOINTS
from standfast.population.people import People
from standfast.stability import (
    critical_ankle_stiffness,
    critical_hip_stiffness,
    critical_knee_stiffness,
    safety_factor,
    stiffness_reserve,
    verdict,
)


@dataclass(frozen=True, slots=True)
class Setting:
    """What is the same for everyone."""

    body_model: str
    gravity: float


@dataclass(frozen=True)
class Assessment:
    """What was found of each person; NaN, or an empty word, where stiffness is not known.

    ``columns`` holds arrays (persons,) by the names of the CSV file's columns.
    """

    people: People
    columns: Mapping[str, np.ndarray]

    @property
    def judged(self) -> np.ndarray:
        """Who has all three stiffnesses, so that a verdict can be given."""
        known: np.ndarray = self.columns["stands"] != ""
        return known

    @property
    def falls(self) -> np.ndarray:
        """Who does not stand."""
        fallen: np.ndarray = self.columns["stands"] == "no"
        return fallen


def assess(
    people: People,
    *,
    body_model: str = "winter",
    gravity: float,
    otherwise: Mapping[str, float] | None = None,
) -> Assessment:
    """Assess persons one by one.

    Parameters
    ----------
    people
        from :func:`standfast.population.read_people`, with measured stiffnesses where known.
    body_model, gravity
        proportions of the segments, and m/s².
    otherwise
        stiffness by joint for those of whom it is not known.

    Returns
    -------
    Assessment: thresholds of each joint alone (the other two rigid) and with the other two as they
    are, safety factor, reserve, frequency, strategy, and what each joint would have to gain.
    """
    known = {
        f"{joint}_stiffness": _known(people, joint, (otherwise or {}).get(joint, math.nan))
        for joint in JOINTS
    }
    given = np.array([people.height, people.mass, *known.values()])
    setting = Setting(body_model, float(gravity))
    found = over_persons(_of_one, setting, ("height", "mass", *known))(given)
    ankle, knee, hip = (np.isfinite(values) | np.isinf(values) for values in known.values())
    everything = ankle & knee & hip
    columns: dict[str, np.ndarray] = {
        "id": np.array(people.id, object),
        "height_m": people.height,
        "mass_kg": people.mass,
        "sex": np.array([sex if sex != "unknown" else "" for sex in people.sex], object),
        "age": people.age,
        **{f"{name}_Nm_rad": values for name, values in known.items()},
    }
    for joint in JOINTS:
        columns[f"{joint}_threshold_alone_Nm_rad"] = found[f"{joint}_alone"]
    for joint, others in zip(JOINTS, (knee & hip, ankle & hip, ankle & knee), strict=True):
        columns[f"{joint}_threshold_Nm_rad"] = np.where(
            others, found[f"critical_{joint}_stiffness"], math.nan
        )
    stands = np.where(found["stable"], "yes", "no")
    columns["stands"] = np.where(everything, stands, "")
    for name, column in (
        ("safety_factor", "safety_factor"),
        ("stiffness_reserve", "stiffness_reserve_Nm_rad"),
        ("frequency", "frequency_Hz"),
    ):
        columns[column] = np.where(everything, found[name], math.nan)
    hips_turn_more = np.abs(found["hip_ankle_ratio"]) > 1.0
    columns["strategy"] = np.where(everything, np.where(hips_turn_more, "hip", "ankle"), "")
    gains = {}
    for joint in JOINTS:
        own, threshold = known[f"{joint}_stiffness"], columns[f"{joint}_threshold_Nm_rad"]
        # what is rigid cannot gain, and where no stiffness suffices no gain does
        with np.errstate(invalid="ignore"):
            gain = np.where(np.isinf(own), math.inf, threshold - own)
        gain = np.where(columns["stands"] == "no", gain, np.where(everything, 0.0, math.nan))
        columns[f"{joint}_gain_needed_Nm_rad"] = gains[joint] = gain
    all_gains = np.array(list(gains.values()))
    possible = (columns["stands"] == "no") & np.isfinite(all_gains).any(axis=0)
    best = np.argmin(np.where(np.isnan(all_gains), np.inf, all_gains), axis=0)
    columns["least_gain_at"] = np.where(possible, np.array(JOINTS)[best], "")
    return Assessment(people, columns)


def write_assessment(assessment: Assessment, path: Path) -> None:
    """Write one line a person, whole or not at all."""
    partial = path.with_name(f".{path.name}.partial")
    try:
        with partial.open("w", encoding="utf-8", newline="") as file:
            rows = csv.writer(file, lineterminator="\n")
            rows.writerow(assessment.columns)
            for row in zip(*assessment.columns.values(), strict=True):
                rows.writerow([_cell(value) for value in row])
        partial.replace(path)
    finally:
        partial.unlink(missing_ok=True)


def _of_one(setting: Setting, given: Mapping[str, Scalar]) -> dict[str, Scalar]:
    """Return everything about one person; what depends on an unknown stiffness is without sense."""
    reference = REFERENCE_PEOPLE[setting.body_model]
    body = rescaled(
        reference.body, given["height"] / reference.height, given["mass"] / reference.mass
    )
    gravity = setting.gravity
    ankle, knee, hip = stiffness = Stiffness._make(given[f"{joint}_stiffness"] for joint in JOINTS)
    alone, _, _ = joint_gravity(body, gravity)
    of_modes = modes(body, stiffness, gravity)
    return {
        **{f"{joint}_alone": load for joint, load in zip(JOINTS, alone, strict=True)},
        "critical_ankle_stiffness": critical_ankle_stiffness(body, knee, hip, gravity),
        "critical_knee_stiffness": critical_knee_stiffness(body, ankle, hip, gravity),
        "critical_hip_stiffness": critical_hip_stiffness(body, ankle, knee, gravity),
        "stable": verdict(body, stiffness, gravity),
        "safety_factor": safety_factor(body, stiffness, gravity),
        "stiffness_reserve": stiffness_reserve(body, stiffness, gravity),
        "frequency": frequency(of_modes.eigenvalues[0]),
        "hip_ankle_ratio": ratio_to_ankle("hip", stiffness, of_modes),
    }


def _known(people: People, joint: str, otherwise: float) -> np.ndarray:
    """Return a joint's stiffness of each person, or what is taken where it is not known."""
    measured = people.stiffness.get(f"{joint}_stiffness", np.full(len(people), math.nan))
    known: np.ndarray = np.where(np.isnan(measured), otherwise, measured)
    return known


def _cell(value: Any) -> str:
    """Return a number with the digits that mean something; nothing for what is not known."""
    if isinstance(value, str):
        return value
    return "" if math.isnan(value) else f"{value:.6g}"
