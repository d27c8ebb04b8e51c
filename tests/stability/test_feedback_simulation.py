"""Nonlinear simulation in time falls or stands as the verdict says; 200 cases in benchmarks."""

import numpy as np
import pytest

import standfast as sf
from delay_simulation import GRAVITY, amplitudes, falls, random_cases

SEED = 20078
CASES = 8
AWAY = 1.0  # 1/s: so that some seconds tell


@pytest.fixture(scope="module")
def cases():
    return random_cases(np.random.default_rng(SEED), CASES, AWAY)


@pytest.fixture(scope="module")
def simulated(cases):
    return amplitudes(*cases)


def test_simulations_fall_or_stand_as_the_verdict_says(cases, simulated):
    chosen, _decay = cases
    verdicts = np.array([
        sf.is_stable(body, stiffness, GRAVITY, damping=damping, feedback=feedback)
        for body, stiffness, damping, feedback in chosen
    ])  # fmt: skip
    assert verdicts.sum() == CASES // 2
    assert np.array_equal(falls(simulated), ~verdicts)


def test_what_stands_dies_out_at_its_decay_rate(cases, simulated):
    """Also how fast is right: over the last halves of the simulations, within a third."""
    _chosen, decay = cases
    stands = np.flatnonzero(decay > 0.0)
    late, early = simulated[15:20].max(axis=0)[stands], simulated[5:10].max(axis=0)[stands]
    # those windows lie half of the time apart, and 7 time constants are the whole
    assert np.median(np.log(early / late)) == pytest.approx(3.5, rel=1.0 / 3.0)


def test_with_their_feedback_turned_round_those_who_stand_fall(cases, simulated):
    chosen, decay = cases
    turned = [
        (
            *rest,
            feedback._replace(proportional=-feedback.proportional, derivative=-feedback.derivative),
        )
        for *rest, feedback in chosen
    ]
    found = falls(amplitudes(turned, decay))
    assert (found[decay > 0.0] == 1.0).all()
