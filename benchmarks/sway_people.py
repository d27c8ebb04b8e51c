"""Noise, gains and margins of real people, fitted to their recordings on a force plate.

Answers: whose sway do published laws explain with which noise and gains, how far are these people
from falling, and do repeated trials of a person agree. Run as ``python benchmarks/sway_people.py``
(ten minutes on two cores); writes ``results/sway-fit/people.md``. The recordings are the 42 of 14
young people of Santos & Duarte with open eyes on firm ground; the environment variable
``STANDFAST_SWAY`` names their folder, and without them nothing is written. Only what is said of all
of them together leaves the script.

Fixed before any of it was computed: three laws of the ankle; noise and both gains open, the delay
the law's; each trial apart; no filter, because the recordings have been through one at 10 Hz.
"""

import os
import time
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from typing import Any

import numpy as np
from scipy import stats

import standfast as sf
import sway_data
from harness import ROOT

RESULTS = ROOT / "results" / "sway-fit"
LAWS = ("dec-2015", "light-touch-2017", "pasma-2017")
# Gains are told as multiples of m g h, by which people of different size are alike.
NUMBERS = {
    "noise": ("noise over m g h (10⁻³ √s)", 1e3),
    "proportional_gain": ("proportional gain over m g h", 1.0),
    "derivative_gain": ("derivative gain over m g h (s)", 1.0),
    "critical_delay": ("critical delay (s)", 1.0),
    "delay_margin": ("delay margin (s)", 1.0),
    "decay_rate": ("decay rate (1/s)", 1.0),
    "static_gain_margin": ("static gain margin", 1.0),
}
SCALED = ("noise", "proportional_gain", "derivative_gain")
NORMAL = 1.96  # standard errors in half of an interval of 95 %


def main() -> None:
    """Fit all trials by all laws, write the page."""
    if not sway_data.present():
        print(f"no recordings of people in {sway_data.DATA}; STANDFAST_SWAY names their folder")
        return
    began = time.perf_counter()
    trials = sway_data.trials()
    jobs = [(law, *trial) for law in LAWS for trial in trials]
    with ProcessPoolExecutor(os.cpu_count(), mp_context=get_context("spawn")) as pool:
        rows = list(pool.map(fitted, jobs))
    RESULTS.mkdir(parents=True, exist_ok=True)
    page = text(rows)
    (RESULTS / "people.md").write_text(page, encoding="utf-8")
    print(page)
    print(f"{time.perf_counter() - began:.0f} s")


def fitted(job: tuple[str, str, float, float, np.ndarray]) -> dict[str, Any]:
    """Return what a law makes of one trial: (value, low, high) of each number."""
    law, subject, height, mass, cop = job
    body = sf.Body.from_height_mass(height, mass)
    recording = sf.Recording(*cop.T, rate=sway_data.RATE)
    fit = sf.fit_sway(recording, law, body, sway_data.G)
    load = -float(
        np.asarray(sf.stiffness_matrix(body, sf.Stiffness(0.0, 0.0, 0.0), sway_data.G))[0, 0]
    )
    found = {**fit.parameters, **fit.margins}
    return {
        "law": law,
        "subject": subject,
        "reached": fit.explained is not False,
        "open": fit.parameters["proportional_gain"].open[0],
        **{
            name: np.array(found[name][:3]) / (load if name in SCALED else 1.0) * factor
            for name, (_, factor) in NUMBERS.items()
        },
        "off": {name: each.measured / each.model for name, each in fit.measures.items()},
    }


def text(rows: list[dict[str, Any]]) -> str:
    """Return the page."""
    people = len({row["subject"] for row in rows})
    trials = len(rows) // len(LAWS)
    lines = [
        "# Noise, gains and margins of people, fitted to their sway\n",
        "Made by `python benchmarks/sway_people.py`; how it is to be read: "
        "[Sway](../../docs/sway.md); whether the fit finds what is known: "
        f"[made-up people](README.md). {trials} recordings of {people} young people, open eyes, "
        "firm ground, 60 s (Santos & Duarte, PeerJ 4 (2016) e2648, CC BY 4.0); noise, proportional "
        "and derivative gain fitted to SD, mean velocity and mean frequency (AP), the delay being "
        "the law's. A law explains a trial if a person who follows it is further off in 5 % of "
        "recordings or more; three numbers fitted to three measures can all but always give them, "
        "so that this says little for the law.\n",
        "| law | delay (s) | measures reached | proportional gain open below |",
        "|---|---|---|---|",
    ]
    for law in LAWS:
        some = [row for row in rows if row["law"] == law]
        reached = [row for row in some if row["reached"]]
        lines.append(
            f"| {law} | {sf.LAWS[law].delay:g} | {len(reached)} of {len(some)} | "
            f"{sum(row['open'] for row in reached)} of {len(reached)} |"
        )
    for law in LAWS:
        lines += _of_law(law, [row for row in rows if row["law"] == law and row["reached"]])
    return "\n".join(lines) + "\n"


def _of_law(law: str, rows: list[dict[str, Any]]) -> list[str]:
    """Return the table of one law, over the trials that it explains."""
    lines = [
        f"\n## {law}\n",
        "Medians and quartiles over trials. Interval: median of both ends of the 95 % intervals. "
        "Trials: SD between the trials of a person, of logarithms, and what the intervals let "
        "expect; of numbers near 0 the few smallest make them. Agreement: intraclass correlation "
        "ICC(1,1) of logarithms, 95 % interval.\n",
        "| | median (quartiles) | interval | trials, found / expected (%) | agreement |",
        "|---|---|---|---|---|",
    ]
    for name, (words, _) in NUMBERS.items():
        values = np.array([row[name] for row in rows])
        low, middle, high = np.percentile(values[:, 0], [25, 50, 75])
        ends = np.median(values[:, 1:], axis=0)
        positive = np.isfinite(values).all() and (values > 0.0).all()
        found = expected = agreement = "–"
        if positive:
            logs = np.log(values)
            within, icc = _agreement(logs[:, 0], [row["subject"] for row in rows])
            error = np.sqrt(np.mean(((logs[:, 2] - logs[:, 1]) / (2.0 * NORMAL)) ** 2))
            found, expected = f"{100 * within:.0f}", f"{100 * error:.0f}"
            agreement = f"{icc[1]:.2f} ({icc[0]:.2f} to {icc[2]:.2f})"
        lines.append(
            f"| {words} | {middle:.3g} ({low:.3g} to {high:.3g}) | {ends[0]:.3g} to {ends[1]:.3g} "
            f"| {found} / {expected} | {agreement} |"
        )
    return lines


def _agreement(values: np.ndarray, whose: list[str]) -> tuple[float, tuple[float, float, float]]:
    """Return the SD within a person, and ICC(1,1) with its 95 % interval (Shrout & Fleiss 1979).

    Persons of whom one trial is left say nothing and are left out; where numbers of trials differ
    their harmonic mean is taken.
    """
    groups = [values[[w == who for w in whose]] for who in sorted(set(whose))]
    groups = [group for group in groups if group.size > 1]
    total = np.concatenate(groups)
    each = np.array([group.size for group in groups])
    between_free, within_free = len(groups) - 1, total.size - len(groups)
    within = sum(((group - group.mean()) ** 2).sum() for group in groups) / within_free
    means = np.array([group.mean() for group in groups])
    between = (each * (means - total.mean()) ** 2).sum() / between_free
    count = len(groups) / (1.0 / each).sum()
    ratio = between / within
    bounds = [
        ratio / stats.f.ppf(0.975, between_free, within_free),
        ratio,
        ratio * stats.f.ppf(0.975, within_free, between_free),
    ]
    low, middle, high = ((f - 1.0) / (f + count - 1.0) for f in bounds)
    return float(np.sqrt(within)), (float(low), float(middle), float(high))


if __name__ == "__main__":
    main()
