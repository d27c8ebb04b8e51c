"""The model with published gains against people who stand quietly on a force plate.

Answers: which of the published laws gives the sway of 212 real people, by which definition of the
centre of pressure, with which spectrum; and whether margins tell who fell. Run as
``python benchmarks/sway_study.py`` (about a minute); writes ``results/sway/``. Where the data are
comes from the environment variable ``STANDFAST_SWAY``; without them nothing is written.

Fixed before any of it was computed:

- Laws: all of ``sf.LAWS`` that stand, on their own body, gains as published.
- Noise: white, of one strength at all free joints (beside it: at the ankle alone). It is fitted to
  one number, the median SD of the ankle over 60 s of the young with open eyes. All else follows.
- 68 recordings of 60 s are drawn of each law and measured by the very formulas of the data.
- "Fits" is: the model's median lies between the quartiles of the people's trials.
- Spectra are told apart by the mean of |log10(model/people)| over 0.1 to 5 Hz in equal steps of
  log f, in dB; once as fitted, once with the level free.
"""

import csv
import sys
from collections.abc import Iterable
from typing import Any

import numpy as np
from scipy import stats

import standfast as sf
import sway_data
import sway_falls
from harness import ROOT
from sway_figures import draw_falls, draw_measures, draw_spectra
from sway_model import (
    JOINTS,
    WINDOW,
    com_of,
    deviation,
    mean_frequency,
    person_of,
    recordings,
    slope,
    spectrum,
    velocity,
    welch,
)
from sway_text import Recorded, medians, page

RESULTS = ROOT / "results" / "sway"
SEED = 2016
RATE = 100.0
DEGREES = 180.0 / np.pi
DEFINITIONS = ("control", "total")
BAND = (0.1, 5.0)  # Hz
SLOPES = ((0.05, 0.5), (1.5, 5.0))  # Hz
CHECKED = np.geomspace(1e-3, 50.0, 400)  # Hz


def main() -> None:
    """Compute all, write tables, figures and the page."""
    if not sway_data.present():
        print(f"no recordings of people in {sway_data.DATA}; STANDFAST_SWAY names their folder")
        return
    norms = {age: sway_data.published(age) for age in sway_data.AGES}
    measured, hertz, density, subjects = sway_data.recorded()
    people = np.percentile(density, [25, 50, 75], axis=0)
    rows, spectra = [], {}
    for name, law in sf.LAWS.items():
        if not sf.is_stable(**law.person):
            continue
        for where in ("all", "ankle") if len(law.joints) > 1 else ("all",):
            measures, drawn = of_law(name, where, norms["Young"]["ankle (degrees)"][1])
            for definition in DEFINITIONS:
                off, shape = distance(hertz, drawn[definition], people[1])
                rows.append({
                    "law": name, "noise at": where, "definition": definition,
                    **measures["both"], **measures[definition],
                    "spectrum off (dB)": off, "its shape off (dB)": shape,
                    **{f"slope, {a:g}-{b:g} Hz": slope(hertz, drawn[definition], a, b)
                       for a, b in SLOPES},
                })  # fmt: skip
                spectra[name, where, definition] = drawn[definition]
    given = sway_data.people()
    predictors, out = sway_falls.margins(given)
    falls = list(areas(given, predictors))
    RESULTS.mkdir(parents=True, exist_ok=True)
    write_norms(norms, measured)
    table("measures.csv", rows)
    shown = (hertz > 0.0) & (hertz <= 10.0)
    write_spectra(hertz, people, spectra)
    table("falls.csv", falls)
    draw_measures(RESULTS / "sway-measures", rows, norms["Young"], measured)
    draw_spectra(RESULTS / "sway-spectra", hertz[shown], people[:, shown], spectra, shown)
    draw_falls(RESULTS / "sway-falls", falls)
    slopes = [slope(hertz, people[1], a, b) for a, b in SLOPES]
    measured_of = Recorded(measured, len(density), subjects, slopes)
    text = page(rows, norms, measured_of, falls, out, margins(given, predictors), worst_density())
    (RESULTS / "README.md").write_text(text, encoding="utf-8")


def of_law(
    name: str, where: str, ankle: float
) -> tuple[dict[str, dict[str, float]], dict[str, np.ndarray]]:
    """Return medians of the drawn recordings of a law, and median spectra by definition."""
    person = person_of(**sf.LAWS[name].person)
    noise = np.ones(len(person.joints))
    noise[1:] = where == "all"
    drawn = recordings(person, noise, rate=RATE, seed=SEED)
    strength = ankle / DEGREES / float(np.median(deviation(drawn["ankle"])))
    drawn = {reading: strength * samples for reading, samples in drawn.items()}
    found: dict[str, dict[str, float]] = {
        "both": {
            "noise (N·m·√s)": strength,
            **{
                f"{j} (degrees)": DEGREES * float(np.median(deviation(drawn[j])))
                for j in person.joints
            },
        }
    }
    found["both"].update({f"{j} (degrees)": 0.0 for j in JOINTS if j not in person.joints})
    medians = {}
    square = float(person.gravity[0, 0] / person.inertia[0, 0])
    for definition in DEFINITIONS:
        cop = drawn[definition]
        spread, speed = deviation(cop), velocity(cop, RATE)
        found[definition] = {
            "CoP (mm)": 1e3 * float(np.median(spread)),
            "CoM / CoP": float(np.median(deviation(com_of(cop, square, RATE)) / spread)),
            "true CoM / CoP": float(np.median(deviation(drawn["com"]) / spread)),
            "frequency (Hz)": float(np.median(mean_frequency(cop, RATE))),
            "velocity (mm/s)": 1e3 * float(np.median(speed)),
            "velocity / SD (1/s)": float(np.median(speed / spread)),
        }
        medians[definition] = np.median(welch(cop, RATE)[1], axis=0)
    return found, medians


def distance(hertz: np.ndarray, model: np.ndarray, people: np.ndarray) -> tuple[float, float]:
    """Return how far two spectra are apart in dB, as they are and with the level free."""
    at = np.geomspace(*BAND, 100)
    some = hertz > 0.0
    apart = np.interp(np.log(at), np.log(hertz[some]), 10.0 * np.log10(model / people)[some])
    return float(abs(apart).mean()), float(abs(apart - np.median(apart)).mean())


def areas(given: dict[str, np.ndarray], predictors: dict[str, np.ndarray]) -> Iterable[Any]:
    """Yield the AUC of every predictor in every group."""
    fell, old = given["falls"] >= 1.0, given["old"]
    groups = (("old", old), ("young", ~old), ("all", np.ones_like(old)))
    for group, inside in groups:
        for name, values in predictors.items():
            area, low, high = sway_falls.auc(values[inside], fell[inside])
            yield {
                "group": group, "people": int(inside.sum()), "fell": int(fell[inside].sum()),
                "predictor": name, "AUC": area, "low": low, "high": high,
            }  # fmt: skip


def margins(given: dict[str, np.ndarray], predictors: dict[str, np.ndarray]) -> str:
    """Return what margins people have, in words, of the law and fit that stand for all."""
    factor, delay = (-predictors[f"{name}, dec-2015, gain"] for name in sway_falls.MARGINS[:2])
    fell, old = given["falls"] >= 1.0, given["old"]
    groups = {
        "young, did not fall": ~old & ~fell,
        "young, fell": ~old & fell,
        "old, did not fall": old & ~fell,
        "old, fell": old & fell,
    }
    alike = float(stats.spearmanr(delay, given["frequency"]).statistic)
    return medians([(name, factor[who], delay[who]) for name, who in groups.items()], alike)


def worst_density() -> float:
    """Return how far the package's densities are from this script's, relative, of all laws."""
    worst = 0.0
    for law in sf.LAWS.values():
        if not sf.is_stable(**law.person):
            continue
        person = person_of(**law.person)
        own = spectrum(person, CHECKED, np.ones(len(person.joints)))
        theirs = sf.sway_spectrum(**law.person, frequency=CHECKED)
        pairs = [(own[j], getattr(theirs, j)) for j in person.joints]
        pairs += [(own["com"], theirs.com), (own["control"], theirs.cop)]
        worst = max(worst, *(float(abs(a / b - 1.0).max()) for a, b in pairs))
    return worst


def write_spectra(
    hertz: np.ndarray, people: np.ndarray, spectra: dict[tuple[str, str, str], np.ndarray]
) -> None:
    """Write spectra up to 10 Hz, noise at all joints, about evenly in log f."""
    kept = np.unique(np.geomspace(1, 10 * WINDOW, 80).round().astype(int))
    names = [key for key in spectra if key[1] == "all"]
    columns = [hertz[kept], *people[:, kept], *(spectra[key][kept] for key in names)]
    heads = ["frequency (Hz)", *(f"people {q} (m²/Hz)" for q in ("p25", "median", "p75"))]
    heads += [f"{law} {definition} (m²/Hz)" for law, _, definition in names]
    rows = zip(*columns, strict=True)
    table("spectra.csv", [dict(zip(heads, map(float, row), strict=True)) for row in rows])


def write_norms(norms: dict[str, sway_data.Norms], measured: sway_data.Norms) -> None:
    """Write medians and quartiles of people."""
    rows = [
        {"group": age, "source": source, "measure": name, "p25": low, "median": mid, "p75": high}
        for age, source, given in (
            *((age, "published, both directions", norms[age]) for age in sway_data.AGES),
            ("Young", "recordings, AP", measured),
        )
        for name, (low, mid, high) in given.items()
    ]
    table("norms.csv", rows)


def table(name: str, rows: list[dict[str, Any]]) -> None:
    """Write a table; numbers with five digits."""
    with (RESULTS / name).open("w", encoding="utf-8", newline="") as lines:
        writer = csv.DictWriter(lines, list(rows[0]), lineterminator="\n")
        writer.writeheader()
        for row in rows:
            writer.writerow({
                key: f"{value:.5g}" if isinstance(value, float) else value
                for key, value in row.items()
            })  # fmt: skip


if __name__ == "__main__":
    sys.exit(main())
