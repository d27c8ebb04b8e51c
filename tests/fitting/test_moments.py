"""Expectation and covariance of measures against recordings drawn at random, and derivatives."""

import numpy as np
import pytest

import standfast as sf
from drawn_sway import RATE, centres_of_pressure, recording
from standfast.fitting.family import NOISE, OPEN, Family, points_of
from standfast.fitting.likelihood import Likelihood, Target
from standfast.fitting.measured import sagittal_measures
from standfast.fitting.moments import FREQUENCY, VELOCITY
from standfast.fitting.window import window
from standfast.recordings.measures import cop_spectrum
from standfast.recordings.powers import POWERS, WELCH, WELCH_TIMES_F, integral

MEASURES = ("sd_ap", VELOCITY, FREQUENCY)
DRAWN, PARTS = 1000, 4
# Four standard errors of a mean and of a correlation of so many, beside 1 and 5 % that the
# approximations of slow processes are off.
MEAN_OFF = 4.0 / np.sqrt(DRAWN) + 0.01
CORRELATION_OFF = 4.0 / np.sqrt(DRAWN) + 0.05
# Two and a half standard errors of an SD, 2.2 % each, beside the 4 % that these two laws are off
# at most in results/sway-fit/information.md.
SD_OFF = 0.10
CENTRAL = 1e-6  # of differences of 1e-5
# Of the fit's frequencies, which end at 2.5 times the low-pass; velocity is of the highest.
SHARED = {"sd_ap": 1e-6, VELOCITY: 1e-3, FREQUENCY: 1e-4}
SECONDS = 60.0


def likelihood_of(law, free=OPEN, logarithms=(0.0, 0.0, 0.0), measures=MEASURES):
    law = sf.LAWS[law]
    points = points_of(Family(law, law.body, law.gravity, law.delay, (True,) * 3, free))
    count = round(SECONDS * RATE)
    target = Target(measures, np.array(logarithms), window(count, RATE, 10.0), 10.0)
    return Likelihood(points, target)


def own_point(likelihood):
    """The point of the law itself, with noise of 1."""
    lowest = likelihood.points.lowest
    each = {"proportional_gain": 1.0 - lowest, "feedback_delay": likelihood.points.family.delay}
    return np.log([each.get(name, 1.0) for name in likelihood.points.family.free])


@pytest.mark.parametrize("law", ["dec-2015", "opty-park-2004"])
def test_recordings_drawn_at_random_have_these_moments(law):
    likelihood = likelihood_of(law)
    found = likelihood.moments(own_point(likelihood))
    drawn = np.concatenate([
        centres_of_pressure(
            sf.LAWS[law].person, np.ones(3), seconds=SECONDS, count=DRAWN // PARTS, seed=seed
        )
        for seed in range(PARTS)
    ])  # fmt: skip
    logs = np.log([list(sagittal_measures(recording(cop)).values()) for cop in drawn])
    error = np.sqrt(np.diagonal(found.covariance))
    off = logs.mean(axis=0) - found.mean
    assert (abs(off) < MEAN_OFF * error).all()
    ratio = logs.std(axis=0, ddof=1) / error
    assert (abs(ratio - 1.0) < SD_OFF).all()
    correlation = np.corrcoef(logs.T) - found.covariance / np.outer(error, error)
    assert (abs(correlation) < CORRELATION_OFF).all()
    # each is able to fail: a measure expected 5 % higher or lower, the mean frequency too, ...
    for moved in (np.log(1.05), -np.log(1.05)):
        assert (abs(off + moved) > MEAN_OFF * error).all()
    # ... and a spread 1.2 times as large or small; covariances by 1.3 are noticed of some measure
    for factor in (1.2, 1.0 / 1.2):
        assert (abs(ratio * factor - 1.0) > SD_OFF).all()
    for factor in (1.3, 1.0 / 1.3):
        assert not (abs(ratio * np.sqrt(factor) - 1.0) < SD_OFF).all()


def test_sine_waves_have_the_powers_that_their_weights_say():
    count, made = 3000, window(3000, RATE, 10.0)
    time = np.arange(count) / RATE
    for place in (3, 11, 40, 200, 2000):
        hertz, amplitude = made.hertz[place], 1e-3
        powers = np.zeros(len(POWERS))
        for phase in (0.0, 0.5 * np.pi):  # of both a density makes half each
            wave = amplitude * np.cos(2.0 * np.pi * hertz * time + phase)
            of_welch = cop_spectrum(recording(wave))
            powers += 0.5 * np.array([
                wave.var(ddof=1),
                (np.diff(wave) ** 2).mean() * RATE**2,
                np.trapezoid(of_welch.ap, of_welch.frequency),
                np.trapezoid(of_welch.frequency * of_welch.ap, of_welch.frequency),
            ])  # fmt: skip
        np.testing.assert_allclose(powers, 0.5 * amplitude**2 * made.weight[:, place], rtol=1e-5)


@pytest.mark.parametrize("law", ["dec-2015", "opty-park-2004"])
def test_a_fit_expects_what_a_recording_is_expected_to_show(law):
    likelihood = likelihood_of(law)
    found = likelihood.moments(own_point(likelihood))
    person, variance = sf.LAWS[law].person, np.diagonal(found.covariance)[:2]
    shown, half = (
        sf.expected_sway(
            recording(np.arange(each * RATE) / 1e6), **person, noise=(1, 1, 1), low_pass=10.0
        )
        for each in (SECONDS, 0.5 * SECONDS)
    )
    # the root of a mean square is above the mean logarithm by its variance, a mean velocity by half
    fitted = np.exp(found.mean[:2] + np.array([1.0, 0.5]) * variance)
    assert fitted[0] == pytest.approx(shown.sd_ap, rel=SHARED["sd_ap"])
    assert fitted[1] == pytest.approx(shown.mean_velocity_ap, rel=SHARED[VELOCITY])
    made = likelihood.target.window
    cop = sf.sway_spectrum(**person, noise=(1, 1, 1), frequency=made.hertz).cop
    plain, times_f = (integral(cop * made.weight[k], made.hertz[1]) for k in (WELCH, WELCH_TIMES_F))
    assert times_f / plain == pytest.approx(shown.mean_frequency_ap, rel=SHARED[FREQUENCY])
    # able to fail: of half a minute less of the slowest sway is expected
    assert fitted[0] != pytest.approx(half.sd_ap, rel=1000.0 * SHARED["sd_ap"])


@pytest.mark.parametrize("free", [OPEN, (*OPEN, "feedback_delay"), OPEN[1:]])
def test_slopes_are_those_of_the_values(free):
    likelihood = likelihood_of("dec-2015", free, logarithms=(-5.4, -5.1, -1.3))
    point = own_point(likelihood) + 0.05 * np.arange(len(free))
    slope = likelihood.slope(point)
    for k, step in enumerate(1e-5 * np.eye(len(free))):
        ends = likelihood.residual(point + step), likelihood.residual(point - step)
        difference = (ends[0] - ends[1]) / 2e-5
        np.testing.assert_allclose(slope[:, k], difference, rtol=CENTRAL, atol=1e-7)


def test_two_joints_and_their_sizes_have_slopes_too():
    measures = (*MEASURES, "sd_com", "sd_ankle", "sd_hip")
    likelihood = likelihood_of("opty-park-2004", logarithms=(-5.0,) * 6, measures=measures)
    point = own_point(likelihood)
    slope = likelihood.slope(point)
    for k, step in enumerate(1e-5 * np.eye(3)):
        ends = likelihood.residual(point + step), likelihood.residual(point - step)
        np.testing.assert_allclose(slope[:, k], (ends[0] - ends[1]) / 2e-5, rtol=1e-5, atol=1e-6)


def test_the_noise_is_found_in_closed_form():
    likelihood = likelihood_of("dec-2015", logarithms=(-5.4, -5.1, -1.3))
    point = own_point(likelihood)
    size, noise, error = likelihood.over_noise(point)
    place = OPEN.index(NOISE)
    at = [point + step * np.eye(3)[place] for step in (noise - 0.01, noise, noise + 0.01)]
    sizes = [likelihood.size(each) for each in at]
    assert sizes[1] == pytest.approx(size, abs=1e-9)
    assert sizes[0] == pytest.approx(sizes[2], abs=1e-9)
    assert sizes[0] - sizes[1] == pytest.approx((0.01 / error) ** 2, rel=1e-6)
