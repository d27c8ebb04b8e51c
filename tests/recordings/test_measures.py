"""Measures of sway against other ways to get them, and against the published numbers."""

import math

import numpy as np
import pytest
from scipy import stats

import standfast as sf
from recordings import needs_sway, published
from standfast.recordings.measures import MEASURES, cop_spectrum, ellipse_factor

# Largest difference of our numbers from the published, relative, as measured 1e-8, 1.7e-4, 0.8 %;
# the published velocity divides by n samples, not by the n − 1 steps between them.
AREA, VELOCITY, FREQUENCY = 1e-6, 2e-4, 0.01
SAMPLED = 1e-3  # a circle's circumference as a polygon, and its frequency by windows


@needs_sway
def test_the_99_published_recordings():
    for name, (cop, row) in published().items():
        found = sf.sway_measures(sf.Recording(*cop.T, 100.0))
        area = float(row["cop_area_cm2"]) * 1e-4
        velocity = float(row["cop_velocity_cm_s"]) * 1e-2
        assert found.area == pytest.approx(area, rel=AREA), name
        assert found.mean_velocity == pytest.approx(velocity, rel=VELOCITY), name
        assert found.mean_velocity * 5999 / 6000 == pytest.approx(velocity, rel=1e-6), name
        frequency = float(row["cop_mean_frequency_hz"])
        assert found.mean_frequency == pytest.approx(frequency, rel=FREQUENCY), name


def test_a_circle_has_its_radius_its_circumference_and_its_frequency():
    radius, hertz, rate, seconds = 5e-3, 0.5, 100.0, 120.0
    time = np.arange(round(rate * seconds) + 1) / rate
    turn = 2.0 * np.pi * hertz * time
    found = sf.sway_measures(
        sf.Recording(0.04 + radius * np.cos(turn), radius * np.sin(turn), rate)
    )
    assert found.path == pytest.approx(2.0 * np.pi * radius * hertz * seconds, rel=SAMPLED)
    assert found.mean_velocity == pytest.approx(2.0 * np.pi * radius * hertz, rel=SAMPLED)
    assert found.mean_velocity_ap == pytest.approx(4.0 * radius * hertz, rel=SAMPLED)
    assert found.mean_velocity_ml == pytest.approx(4.0 * radius * hertz, rel=SAMPLED)
    assert found.range_ap == pytest.approx(2.0 * radius, rel=1e-12)
    assert found.range_ml == pytest.approx(2.0 * radius, rel=1e-12)
    assert found.sd_ap == pytest.approx(radius / math.sqrt(2.0), rel=SAMPLED)
    # of many samples 2 F(0.95; 2, ∞) is the quantile of χ² with two degrees of freedom
    area = np.pi * radius**2 / 2.0 * stats.chi2.ppf(0.95, 2)
    assert found.area == pytest.approx(area, rel=SAMPLED)
    assert found.mean_frequency == pytest.approx(hertz, rel=SAMPLED)
    # half of a line that a window makes three frequencies wide
    assert found.median_frequency == pytest.approx(hertz, abs=1.0 / 30.0)


def band_noise(random, low, high, rate, count):
    """White noise between two frequencies (Hz), of variance 1."""
    spectrum = np.zeros(count // 2 + 1, dtype=complex)
    hertz = np.fft.rfftfreq(count, 1.0 / rate)
    inside = (hertz >= low) & (hertz <= high)
    spectrum[inside] = random.normal(size=(2, inside.sum())).T @ [1.0, 1.0j]
    made = np.fft.irfft(spectrum, count)
    return made / made.std()


def test_a_gaussian_process_of_known_spectrum():
    """Band-limited white noise in both directions, an hour long."""
    random, rate, seconds = np.random.default_rng(7), 50.0, 3600.0
    bands = {"ap": (0.2, 1.0, 6e-3), "ml": (0.4, 1.6, 3e-3)}
    noise = {
        name: size * band_noise(random, low, high, rate, round(rate * seconds))
        for name, (low, high, size) in bands.items()
    }
    recording = sf.Recording(noise["ap"], noise["ml"], rate)
    found = sf.sway_measures(recording)
    sampling = 0.03  # of 3,600 s · 0.8 Hz: about 1.9 % in a variance, less in what is compared
    for name, (low, high, size) in bands.items():
        assert getattr(found, f"sd_{name}") == pytest.approx(size, rel=1e-3)
        # SD of the velocity from the second moment of the band; E|v| of a Gaussian √(2/π) of it
        moment = (high**3 - low**3) / (3.0 * (high - low))
        speed = math.sqrt(2.0 / math.pi) * 2.0 * math.pi * size * math.sqrt(moment)
        assert getattr(found, f"mean_velocity_{name}") == pytest.approx(speed, rel=sampling)
        density = getattr(cop_spectrum(recording), name)
        inside = np.mean(density[round(30 * low) + 2 : round(30 * high) - 2])
        assert inside == pytest.approx(size**2 / (high - low), rel=sampling)
        assert np.trapezoid(density, dx=1.0 / 30.0) == pytest.approx(size**2, rel=sampling)
    powers = {name: size**2 for name, (_, _, size) in bands.items()}
    middle = {name: 0.5 * (low + high) for name, (low, high, _) in bands.items()}
    mean = sum(powers[n] * middle[n] for n in bands) / sum(powers.values())
    assert found.mean_frequency == pytest.approx(mean, rel=sampling)
    # up to f lie 36 (f − 0.2)/0.8 + 9 (f − 0.4)/1.2 of 45 mm²
    median = (22.5 + 36 * 0.25 + 9 / 3) / (45 + 7.5)
    assert found.median_frequency == pytest.approx(median, rel=sampling)


@pytest.mark.parametrize("count", [5, 12, 60])
def test_a_further_sample_lies_in_the_ellipse_19_times_of_20(count):
    random, draws = np.random.default_rng(count), 40_000
    mixing = np.array([[2.0, 0.0], [1.5, 0.7]])
    points = random.normal(size=(draws, count + 1, 2)) @ mixing.T
    seen, further = points[:, :-1], points[:, -1]
    off = seen - seen.mean(axis=1, keepdims=True)
    covariance = off.transpose(0, 2, 1) @ off / (count - 1)
    away = further - seen.mean(axis=1)
    square = (away * np.linalg.solve(covariance, away[..., None])[..., 0]).sum(axis=1)
    spread = math.sqrt(0.95 * 0.05 / draws)
    assert np.mean(square <= ellipse_factor(count)) == pytest.approx(0.95, abs=4.0 * spread)
    if count < 60:  # an ellipse by χ² would hold too few
        assert np.mean(square <= stats.chi2.ppf(0.95, 2)) < 0.95 - 10.0 * spread


def test_the_factor_of_the_ellipse_is_that_of_fishers_distribution():
    for n in (3, 10, 500, 6000, 10**6):
        other = 2 * (n - 1) * (n + 1) / (n * (n - 2)) * stats.f.ppf(0.95, 2, n - 2)
        assert ellipse_factor(n) == pytest.approx(other, rel=1e-9)


def test_the_low_pass_halves_its_frequency_and_leaves_slow_sway():
    rate, time = 100.0, np.arange(6001) / 100.0
    slow, fast = (np.sin(2.0 * np.pi * f * time) for f in (0.5, 10.0))
    random = np.random.default_rng(1)
    aside = 1e-3 * random.normal(size=time.size)
    for wave, left in ((slow, 1.0), (fast, 0.5)):
        recording = sf.Recording(5e-3 * wave, aside, rate)
        plain, found = sf.sway_measures(recording), sf.sway_measures(recording, low_pass=10.0)
        assert found.sd_ap == pytest.approx(left * plain.sd_ap, rel=5e-3)


def test_every_measure_has_its_row():
    assert tuple(MEASURES) == sf.SwayMeasures._fields


def test_turned_by_a_right_angle_only_the_directions_change_places():
    random = np.random.default_rng(3)
    ap, ml = np.cumsum(random.normal(size=(2, 3000)) * [[3e-4], [1e-4]], axis=1)
    one = sf.sway_measures(sf.Recording(ap, ml, 50.0))
    other = sf.sway_measures(sf.Recording(ml, -ap, 50.0))
    for name in ("area", "path", "mean_velocity", "mean_frequency", "median_frequency"):
        assert getattr(one, name) == pytest.approx(getattr(other, name), rel=1e-9)
    for name in ("sd", "range", "mean_velocity"):
        assert getattr(one, f"{name}_ap") == pytest.approx(getattr(other, f"{name}_ml"), rel=1e-9)


@pytest.mark.parametrize("low_pass", [0.0, -1.0, 50.0, math.nan, "ten"])
def test_a_low_pass_beyond_half_of_the_rate_is_refused(low_pass):
    random = np.random.default_rng(3)
    recording = sf.Recording(*(2e-3 * random.normal(size=(2, 1000))), 100.0)
    with pytest.raises(sf.InputError, match=r"low_pass = .* is not between 0 and half of the rate"):
        sf.sway_measures(recording, low_pass=low_pass)
    with pytest.raises(sf.InputError, match="give what read_recording returns"):
        sf.sway_measures(recording.ap)
