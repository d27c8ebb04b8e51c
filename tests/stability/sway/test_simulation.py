"""Covariances of sway against a stochastic simulation in time; the long one is in benchmarks."""

import numpy as np
import pytest

from noise_simulation import recorded
from noisy_people import standing_people
from standfast.stability.delay.persons import all_rightmost
from standfast.stability.sway.density import COP, COP_VELOCITY, PAIRS
from standfast.stability.sway.integral import integrals

PERSONS, PATHS, SECONDS = 4, 60, 12.0
FASTEST = 0.8  # 1/s: of persons who decay faster, 12 s are long
# Standard errors, from 60 paths, that none of some 70 differences may reach: by chance one of a
# thousand seeds would do so. Found with six seeds: 2.7 at most.
MOST = 4.8
# Of the mean difference of the variances of all persons: standard errors, by chance 1 in 15,000.
MOST_TOGETHER = 4.0
# Noise that is stronger by this makes variances 1.08 times as large: it must be noticed.
CHANGED = 1.04


def persons(longest):
    rng = np.random.default_rng(1923)
    standing = standing_people(rng, 1200, longest, rigid_share=0.0)
    people = standing.people
    root, _ = all_rightmost(people.numbers, people.rigid, standing.delay)
    slow_enough = (standing.delay > 0.01) | (longest == 0.0)
    chosen = np.flatnonzero((-root.real > FASTEST) & slow_enough)[:PERSONS]
    assert chosen.size == PERSONS
    return standing[chosen], -root.real[chosen]


def standard_errors(found, standing):
    """Differences over their standard errors, and that of all variances together."""
    exact, sure = integrals((*range(len(PAIRS)), COP, COP_VELOCITY), standing.swaying)
    assert sure.all()
    moments = [found.rotations[:, :, i, j] for i, j in PAIRS] + [found.pressure, found.velocity]
    apart = np.stack(moments) - exact[..., None]  # (rows, persons, paths)
    root = np.sqrt(PATHS)
    each = apart.mean(axis=-1) / (apart.std(axis=-1, ddof=1) / root)
    # joints of a person go together, persons do not
    own = [row for row, (i, j) in enumerate(PAIRS) if i == j]
    of_persons = (apart[own] / exact[own][..., None]).mean(axis=0)
    error = of_persons.std(axis=-1, ddof=1) / root
    together = of_persons.mean(axis=-1).sum() / np.sqrt((error**2).sum())
    return np.abs(each).max(), abs(together)


@pytest.mark.parametrize("longest", [0.0, 0.15])
def test_a_simulation_in_time_has_the_same_moments(longest):
    standing, decay = persons(longest)
    found = recorded(np.random.default_rng(7), standing, decay, SECONDS, PATHS, PATHS)
    largest, together = standard_errors(found, standing)
    assert largest < MOST
    assert together < MOST_TOGETHER
    stronger = standing._replace(noise=CHANGED * standing.noise)
    assert standard_errors(found, stronger)[1] > MOST_TOGETHER
