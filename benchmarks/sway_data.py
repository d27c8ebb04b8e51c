"""Quiet standing of real people: medians and quartiles of the two public data sets.

Santos & Duarte, PeerJ 4 (2016) e2648 (163 people, "BDS"), and dos Santos et al., PeerJ 5 (2017)
e3626 (49 people, "PDS"), CC BY 4.0; in the folder that ``STANDFAST_SWAY`` names, or in
``shared/data/sway`` beside the checkout. Only what is said here of groups leaves this module, but
for :func:`people` and :func:`trials`, which stay within the script.
"""

import csv
import math
import os
from collections.abc import Iterator
from pathlib import Path

import numpy as np

import standfast as sf
from harness import ROOT
from sway_model import com_of, deviation, mean_frequency, velocity, welch

DATA = Path(os.environ.get("STANDFAST_SWAY", ROOT.parent / "shared/data/sway"))
RATE = 100.0  # Hz, of the recordings
G = 9.81
AGES = ("Young", "Old")
Norms = dict[str, tuple[float, float, float]]


def present() -> bool:
    """Return whether the files are there."""
    names = ("bds_trials.csv", "pds_trials.csv", "bds_cop_firm.npz")
    return all((DATA / name).is_file() for name in names)


def quartiles(values: np.ndarray) -> tuple[float, float, float]:
    """Return lower quartile, median and upper quartile."""
    low, middle, high = np.percentile(values, [25, 50, 75])
    return float(low), float(middle), float(high)


def published(age: str) -> Norms:
    """Return what is published of trials with open eyes on firm ground."""
    joints = list(_rows("pds_trials.csv", vision="Open", surface="Rigid", age_group=age))
    pressure = list(_rows("bds_trials.csv", vision="Open", surface="Firm", age_group=age))
    return {
        **{f"{j} (degrees)": _of(joints, f"{j}_sd_deg", 1.0) for j in ("ankle", "knee", "hip")},
        "area (mm²)": _of(pressure, "cop_area_cm2", 100.0),
        "mean velocity (mm/s)": _of(pressure, "cop_velocity_cm_s", 10.0),
        "mean frequency (Hz)": _of(pressure, "cop_mean_frequency_hz", 1.0),
    }


def recorded() -> tuple[Norms, np.ndarray, np.ndarray, int]:
    """Return measures of the recordings of the young, AP; frequencies; their spectra; trials."""
    rows = list(_rows("bds_trials.csv", vision="Open", surface="Firm", age_group="Young"))
    with np.load(DATA / "bds_cop_firm.npz") as kept:
        rows = [row for row in rows if row["trial"] in kept]
        ap = np.array([kept[row["trial"]][:, 0] for row in rows], float) * 0.01
    com = np.array([_com(x, row) for x, row in zip(ap, rows, strict=True)])
    norms = {
        "CoP (mm)": quartiles(1e3 * deviation(ap)),
        "CoM / CoP": quartiles(deviation(com) / deviation(ap)),
        "frequency (Hz)": quartiles(mean_frequency(ap, RATE)),
        "velocity (mm/s)": quartiles(1e3 * velocity(ap, RATE)),
        "velocity / SD (1/s)": quartiles(velocity(ap, RATE) / deviation(ap)),
    }
    hertz, density = welch(ap, RATE)
    return norms, hertz, density, len({row["subject"] for row in rows})


def trials() -> list[tuple[str, float, float, np.ndarray]]:
    """Return person, height (m), mass (kg) and CoP (n, 2), m, AP first, of the young."""
    rows = list(_rows("bds_trials.csv", vision="Open", surface="Firm", age_group="Young"))
    with np.load(DATA / "bds_cop_firm.npz") as kept:
        return [
            (
                row["subject"],
                0.01 * float(row["height_cm"]),
                float(row["mass_kg"]),
                np.array(kept[row["trial"]], float) * 0.01,
            )
            for row in rows
            if row["trial"] in kept
        ]


def people() -> dict[str, np.ndarray]:
    """Return the 163 people with the median of their trials, open eyes, firm ground; in SI."""
    each: dict[str, list[dict[str, str]]] = {}
    for row in _rows("bds_trials.csv", vision="Open", surface="Firm"):
        each.setdefault(row["subject"], []).append(row)

    def median(name: str, factor: float) -> np.ndarray:
        return np.array([factor * np.median([float(r[name]) for r in x]) for x in each.values()])

    return {
        "age": median("age", 1.0),
        "height": median("height_cm", 0.01),
        "mass": median("mass_kg", 1.0),
        "falls": median("falls_12m", 1.0),
        "old": np.array([x[0]["age_group"] == "Old" for x in each.values()]),
        "area": median("cop_area_cm2", 1e-4),
        "velocity": median("cop_velocity_cm_s", 0.01),
        "frequency": median("cop_mean_frequency_hz", 1.0),
    }


def _rows(file: str, **wanted: str) -> Iterator[dict[str, str]]:
    with (DATA / file).open(encoding="utf-8", newline="") as lines:
        for row in csv.DictReader(lines):
            if all(row[name] == value for name, value in wanted.items()):
                yield row


def _of(rows: list[dict[str, str]], name: str, factor: float) -> tuple[float, float, float]:
    values = np.array([float(row[name] or math.nan) for row in rows])
    return quartiles(factor * values[np.isfinite(values)])


def _com(cop: np.ndarray, row: dict[str, str]) -> np.ndarray:
    """Return the centre of mass by the low-pass ω₀²/(ω₀² + ω²), ω₀² = m g h/J of the person."""
    body = sf.Body.from_height_mass(0.01 * float(row["height_cm"]), float(row["mass_kg"]))
    mass, _, length, com = (np.asarray(part, float) for part in body)
    load = G * float(mass @ (np.concatenate([[0.0], np.cumsum(length)]) + com))
    square = load / float(sf.inertia_matrix(body)[0][0])
    return com_of(cop, square, RATE)
