"""What three measures of 60 s tell of noise and gains, beside what the whole spectrum would.

Answers: how right are expectation and covariance of the measures that ``sf.fit_sway`` rests on; and
how much would Whittle's likelihood, of the spectrum from 1/60 to 10 Hz, know beyond the measures?
Run as ``python benchmarks/sway_information.py`` (two minutes); writes
``results/sway-fit/information.md``. Standard errors are those of Fisher's information, of the laws
on their own bodies; recordings are drawn from the spectra (``tests/helpers/drawn_sway.py``) by H
written out there, and measured as any.
"""

import sys

import numpy as np

import standfast as sf
from harness import ROOT

sys.path.insert(0, str(ROOT / "tests" / "helpers"))

from drawn_sway import RATE, centres_of_pressure, recording
from standfast.fitting.family import DELAY, OPEN, Family, points_of
from standfast.fitting.likelihood import Likelihood, Target
from standfast.fitting.measured import sagittal_measures
from standfast.fitting.moments import FREQUENCY, VELOCITY
from standfast.fitting.window import window
from standfast.stability.sway.responses import responses

RESULTS = ROOT / "results" / "sway-fit" / "information.md"
LAWS = ("dec-2015", "light-touch-2017", "pasma-2017")
DRAWN_LAWS = (*LAWS, "opty-park-2004", "wang-pd-sto3", "wang-fpd-sto3")
SECONDS, DRAWN, LOW_PASS = 60.0, 1000, 10.0
NOISE = 0.1  # N·m·√s: nothing that is told depends on it
PARTS = 10  # that they are drawn in
MEASURES = ("sd_ap", VELOCITY, FREQUENCY)
WORDS = ("SD", "mean velocity", "mean frequency")
BAND = (1.0 / SECONDS, LOW_PASS)  # Hz


def main() -> None:
    """Compute both tables and write the page."""
    lines = [
        "# What the measures of sway tell\n",
        "Made by `python benchmarks/sway_information.py` (seeded).\n",
        "## Expectation and spread of the measures\n",
        f"Of each law {DRAWN:,} recordings of {SECONDS:g} s, noise at all free joints. First: how "
        "far the mean logarithm is from the one expected, in standard deviations of one recording "
        f"(by chance up to {2.0 / np.sqrt(DRAWN):.2f} in 95 of 100). Second: expected over found "
        f"standard deviation (by chance {200.0 / np.sqrt(2 * DRAWN):.0f} % off).\n",
        "| law | " + " | ".join(WORDS) + " |",
        "|---|---|---|---|",
    ]
    for name in DRAWN_LAWS:
        found = likelihood_of(name, OPEN)
        moments = found.moments(own_point(found))
        error = np.sqrt(np.diagonal(moments.covariance))
        parts = (
            centres_of_pressure(
                sf.LAWS[name].person,
                np.full(3, NOISE),
                seconds=SECONDS,
                count=DRAWN // PARTS,
                seed=part,
            )
            for part in range(PARTS)
        )
        logs = np.log(
            [list(sagittal_measures(recording(cop)).values()) for cops in parts for cop in cops]
        )
        spread = logs.std(axis=0, ddof=1)
        off, ratio = (logs.mean(axis=0) - moments.mean) / spread, error / spread
        cells = (f"{a:+.2f}, {b:.2f}" for a, b in zip(off, ratio, strict=True))
        lines.append(f"| {name} | {' | '.join(cells)} |")
    lines += [
        "\n## Standard errors, measures / whole spectrum\n",
        "In %, of one recording. The proportional gain is counted from the least that holds the "
        "person up. Where the delay is open too the measures have no standard errors.\n",
        "| law | noise | proportional gain above the least | derivative gain | delay, spectrum |",
        "|---|---|---|---|---|",
    ]
    for name in LAWS:
        measures = by_measures(name)
        spectrum, late = by_spectrum(name, OPEN), by_spectrum(name, (*OPEN, DELAY))
        pairs = (f"{100 * a:.1f} / {100 * b:.1f}" for a, b in zip(measures, spectrum, strict=True))
        lines.append(f"| {name} | {' | '.join(pairs)} | {100 * late[-1]:.1f} |")
    RESULTS.parent.mkdir(parents=True, exist_ok=True)
    RESULTS.write_text("\n".join(lines) + "\n", encoding="utf-8")
    print("\n".join(lines))


def likelihood_of(name: str, free: tuple[str, ...]) -> Likelihood:
    """Return the likelihood of a law on its own body; of which measures is of no matter."""
    law = sf.LAWS[name]
    points = points_of(Family(law, law.body, law.gravity, law.delay, (True,) * 3, free))
    made = window(round(SECONDS * RATE), RATE, LOW_PASS)
    return Likelihood(points, Target(MEASURES, np.zeros(3), made, LOW_PASS))


def own_point(likelihood: Likelihood) -> np.ndarray:
    """Return the point of the law itself, with some noise."""
    points = likelihood.points
    each = {"noise": NOISE, "proportional_gain": 1.0 - points.lowest, DELAY: points.family.delay}
    return np.log([each.get(name, 1.0) for name in points.family.free])


def by_measures(name: str) -> np.ndarray:
    """Return standard errors by μ'ᵀ C⁻¹ μ' + tr(C⁻¹ C' C⁻¹ C')/2 of mean and covariance."""
    likelihood = likelihood_of(name, OPEN)
    found = likelihood.moments(own_point(likelihood))
    of_means = found.mean_slope @ np.linalg.solve(found.covariance, found.mean_slope.T)
    turned = np.linalg.solve(found.covariance, found.covariance_slope)
    of_covariance = 0.5 * np.einsum("iab,jba->ij", turned, turned)
    return np.sqrt(np.diagonal(np.linalg.inv(of_means + of_covariance)))


def by_spectrum(name: str, free: tuple[str, ...]) -> np.ndarray:
    """Return standard errors by T ∫ (d log S) (d log S)ᵀ df."""
    likelihood = likelihood_of(name, free)
    candidate = likelihood.points.candidate(own_point(likelihood))
    hertz = likelihood.target.window.hertz
    some = (hertz > BAND[0]) & (hertz < BAND[1])
    response, slope = responses(
        candidate.swaying,
        likelihood.points.rigid[:, 0],
        2.0 * np.pi * hertz[some],
        ("cop",),
        candidate.changes,
    )
    weighed = candidate.swaying.noise * response[0].conj()
    size = (weighed * response[0]).real.sum(axis=0)
    rows = 2.0 * (slope[:, 0] * weighed).real.sum(axis=1) / size
    rows = np.concatenate([np.full((1, some.sum()), 2.0), rows])
    return np.sqrt(np.diagonal(np.linalg.inv(SECONDS * hertz[1] * rows @ rows.T)))


if __name__ == "__main__":
    main()
