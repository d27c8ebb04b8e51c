"""Recordings as force plates write them, of made-up sway with known numbers, seeded.

The 99 recordings of Santos & Duarte (PeerJ 4 (2016) e2648) are not part of the project: they lie in
the folder that ``STANDFAST_SWAY`` names, or in ``shared/data/sway`` beside the checkout, and checks
that need them skip where they are absent.
"""

import csv
import os
from pathlib import Path

import numpy as np
import pytest

DATA = Path(os.environ.get("STANDFAST_SWAY", Path(__file__).parents[3] / "shared/data/sway"))
needs_sway = pytest.mark.skipif(not DATA.is_dir(), reason="the recordings of real sway are absent")
RATE, SECONDS = 100.0, 60.0


def sway(seed=1, rate=RATE, seconds=SECONDS):
    """Times (s) and made-up sway (n,) m in both directions: a few millimetres below 1 Hz."""
    random = np.random.default_rng(seed)
    time = np.arange(round(seconds * rate)) / rate
    frequency = np.arange(1, 61) / 60.0
    ap, ml = (
        sum(
            size * np.sin(2.0 * np.pi * (f * time + random.random())) / np.sqrt(f)
            for f in frequency
        )
        for size in (5e-4, 3e-4)
    )
    return time, ap - 0.03, ml + 0.012


def published():
    """CoP (m) by trial, and the numbers that are published of it."""
    with (DATA / "bds_trials.csv").open(encoding="utf-8") as file:
        rows = {row["trial"]: row for row in csv.DictReader(file)}
    with np.load(DATA / "bds_cop_firm.npz") as trials:
        return {name: (trials[name].astype(float) / 100.0, rows[name]) for name in trials}


def table(names, columns, separator=",", decimals=5, comma=False):
    """A table as text."""
    lines = [separator.join(names)] if names else []
    for row in zip(*columns, strict=True):
        numbers = [f"{value:.{decimals}f}" for value in row]
        lines.append(separator.join(n.replace(".", ",") if comma else n for n in numbers))
    return "\n".join(lines) + "\n"


def plate(surface=0.0, load=700.0, **given):
    """Forces (N), moments (N·m) and CoP of a plate whose surface lies at z = ``surface``."""
    time, x, y = sway(**given)
    fx, fy = 5.0 * np.sin(time), 4.0 * np.cos(1.7 * time)
    fz = load + 3.0 * np.sin(9.0 * time)
    mx, my = y * fz - surface * fy, surface * fx - x * fz
    return time, (fx, fy, fz, mx, my, 0.3 * np.sin(time)), (x, y)


def write_two_plates(path):
    """Half of a person on each of two plates, which lie apart by whatever is said of them."""
    time, (_, _, fz, mx, my, _), _ = plate()
    names = ["t (s)", "Fz1 (N)", "Mx1 (Nm)", "My1 (Nm)", "Fz2 (N)", "Mx2 (Nm)", "My2 (Nm)"]
    half = [0.5 * each for each in (fz, mx, my)]
    path.write_text(table(names, [time, *half, *half], decimals=7), encoding="utf-8")
