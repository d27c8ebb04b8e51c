"""A population whose answers are known, and how often the intervals about ours hold them.

Only the ankle bends, and its stiffness over the load is normal: who falls is known exactly, and so
is the multiple of the load with which nine in ten stand.
"""

from collections.abc import Iterator

import numpy as np
from scipy.stats import norm

from populations import GOOD, RIGID, changed, counted, events, law, of
from standfast.population.cohort.histograms import bin_edges
from standfast.population.people.study import PopulationStudy
from standfast.population.summary.estimators import Distribution, Estimate, fraction

MEAN, SD = 1.2, 0.3
POSITIVE = norm.sf(0.0, MEAN, SD)
FALL = (norm.cdf(1.0, MEAN, SD) - norm.cdf(0.0, MEAN, SD)) / POSITIVE
NINE_IN_TEN = 1.0 / norm.ppf(0.1 * POSITIVE + norm.cdf(0.0, MEAN, SD), MEAN, SD)


def just_ankles(**population: object) -> PopulationStudy:
    """Falls where x of a normal law is below 1: the fraction is known exactly."""
    content = changed("stiffness.knee", RIGID, GOOD)
    content["stiffness"]["hip"] = RIGID
    content["stiffness"]["ankle"] = law("normal", "single_joint_critical", mean=MEAN, sd=SD)
    return of(content, **population)


def estimates(method: str, size: int, seeds: int) -> Iterator[tuple[Estimate, Estimate]]:
    """Yield of each seed who falls and the multiple for nine in ten, with their intervals."""
    for seed in range(seeds):
        found = counted(just_ankles(method=method, size=size, seed=seed))
        counts = np.array([each.required[0, 1] for each in found])
        yield fraction(*events(found)), Distribution(bin_edges(), counts).quantile(0.9)


def holds(estimate: Estimate, truth: float, width: float = 1.0) -> bool:
    """Whether an interval, made wider or narrower about its value, holds the truth."""
    low, value, high = estimate.low, estimate.value, estimate.high
    return value - width * (value - low) <= truth <= value + width * (high - value)
