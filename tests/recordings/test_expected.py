"""What a recording of a model would show: against recordings drawn at random, and plain sums."""

import numpy as np
import pytest
from scipy import signal

import standfast as sf
from recordings import sway
from standfast.recordings.expected import MODELLED
from standfast.recordings.measures import cop_spectrum, mean_and_median

RATE, SECONDS, DRAWN = 50.0, 20.0, 600
# Of 600 recordings a mean scatters by 1 to 3 %; the smallest are 4 standard errors of each.
OF_DRAWN = {"sd": 0.03, "velocity": 0.01, "spectrum": 0.17, "mean": 0.02}
OF_HUM = 1e-3  # what of a hum at 20 Hz is left behind 5 Hz, and at the ends of a recording
EXACT = 1e-8  # of sums of the same numbers in another order, and the sum over frequencies


def recording(rate=RATE, seconds=SECONDS):
    _, ap, ml = sway(rate=rate, seconds=seconds)
    return sf.Recording(ap, ml, rate)


def one_link(law):
    """A, B, C, P, D of a law's ankle, its delay, and m g: plain numbers."""
    person = sf.LAWS[law]
    a = sf.inertia_matrix(person.body)[0, 0]
    k, p, d = (
        person.stiffness.ankle,
        person.feedback.proportional[0, 0],
        person.feedback.derivative[0, 0],
    )
    weight = person.gravity * np.sum(person.body.segment_mass)
    return a, person.damping[0, 0], k, person.load, p, d, person.delay, weight


def drawn(law, seed):
    """Recordings (DRAWN, n) of the CoP of a law's pendulum: steps of 2 ms from a seed, in time.

    q'' from the moment of a step ago; the CoP through a low-pass as recordings have it.
    """
    a, b, k, load, p, d, delay, weight = one_link(law)
    step, warm = 2e-3, 20.0
    count, late = round((warm + SECONDS) / step), round(delay / step)
    random = np.random.default_rng(seed)
    q, v, cop = (np.zeros((count + 1, DRAWN)) for _ in range(3))
    for i in range(count):
        before = max(i - late, 0)
        moment = k * q[i] + b * v[i] + p * q[before] + d * v[before]
        cop[i] = moment / weight
        noise = random.standard_normal(DRAWN) / np.sqrt(step)
        v[i + 1] = v[i] + step * (load * q[i] - moment + noise) / a
        q[i + 1] = q[i] + step * v[i + 1]
    sections = signal.butter(2, 10.0, fs=1.0 / step, output="sos")
    seen = signal.sosfiltfilt(sections, cop[:-1], axis=0)[round(warm / step) :]
    return seen[:: round(1.0 / (step * RATE))].T


def test_it_is_what_recordings_in_time_have_on_the_mean():
    law = "light-touch-2017"
    found = sf.expected_sway(recording(), **sf.LAWS[law].person, noise=(1.0, 0.0, 0.0))
    cop = drawn(law, seed=15)
    ml = recording().ml
    size = np.sqrt((cop.std(axis=1, ddof=1) ** 2).mean())
    assert found.sd_ap == pytest.approx(size, rel=OF_DRAWN["sd"])
    # shorter than the sway itself: over all time it is larger
    covariance = sf.sway_covariance(**sf.LAWS[law].person, noise=(1.0, 0.0, 0.0))
    assert found.ankle_sway < 0.99 * np.sqrt(covariance[0, 0])
    velocity = (np.abs(np.diff(cop)).sum(axis=1) / (SECONDS - 1.0 / RATE)).mean()
    assert found.mean_velocity_ap == pytest.approx(velocity, rel=OF_DRAWN["velocity"])
    spectra = [cop_spectrum(sf.Recording(each, ml, RATE)) for each in cop]
    mean = np.mean([each.ap for each in spectra], axis=0)
    np.testing.assert_array_equal(found.frequency, spectra[0].frequency)
    below = found.frequency < 5.0
    np.testing.assert_allclose(found.density[below], mean[below], rtol=OF_DRAWN["spectrum"])
    frequency, _ = mean_and_median(found.frequency, mean)
    assert found.mean_frequency_ap == pytest.approx(frequency, rel=OF_DRAWN["mean"])
    # able to fail: a delay that is 20 ms longer is another person
    person = sf.LAWS[law].person
    late = person["feedback"]._replace(delay=person["feedback"].delay + 0.02)
    other = sf.expected_sway(recording(), **{**person, "feedback": late}, noise=(1.0, 0.0, 0.0))
    assert other.mean_velocity_ap != pytest.approx(velocity, rel=2.0 * OF_DRAWN["velocity"])


def test_every_measure_is_a_sum_over_pairs_of_samples():
    law = sf.LAWS["dec-2015"]
    rate, seconds = 20.0, 6.0
    found = sf.expected_sway(recording(rate, seconds), **law.person, noise=(1.0, 0.0, 0.0))
    n, size = 120, 60
    # R by an integral over frequencies of its own
    f = np.linspace(0.0, 100.0, 400_001)
    density = sf.sway_spectrum(**law.person, noise=(1.0, 0.0, 0.0), frequency=f).cop
    lags = np.arange(n) / rate
    covariance = np.array([np.trapezoid(density * np.cos(2 * np.pi * f * t), f) for t in lags])
    every = covariance[abs(np.subtract.outer(np.arange(n), np.arange(n)))]
    centred = np.eye(n) - 1.0 / n
    variance = np.trace(centred @ every @ centred) / (n - 1)
    assert found.sd_ap == pytest.approx(np.sqrt(variance), rel=EXACT)
    step = 2.0 * (covariance[0] - covariance[1])
    assert found.mean_velocity_ap == pytest.approx(rate * np.sqrt(2.0 / np.pi * step), rel=EXACT)
    window = signal.get_window("hann", size)
    turned = np.exp(-2j * np.pi * np.outer(np.arange(size // 2 + 1), np.arange(size)) / size)
    read = turned * window @ (np.eye(size) - 1.0 / size)
    power = np.einsum("ki,ij,kj->k", read, every[:size, :size], read.conj()).real
    power *= 2.0 / (rate * np.sum(window**2))
    power[[0, -1]] *= 0.5
    np.testing.assert_allclose(found.density, power, rtol=1e-6, atol=EXACT * power.max())


def test_noise_that_is_not_given_makes_the_sd_the_recordings():
    here = recording()
    law = sf.LAWS["wang-fpd-sto3"]
    found = sf.expected_sway(here, **law.person)
    assert found.sd_ap == pytest.approx(sf.sway_measures(here).sd_ap, rel=EXACT)
    ankle, knee, hip = found.noise
    assert (ankle, knee) == (hip, 0.0)
    again = sf.expected_sway(here, **law.person, noise=found.noise)
    for name in MODELLED:
        assert getattr(again, name) == pytest.approx(getattr(found, name), rel=EXACT)


def test_what_a_low_pass_takes_from_the_recording_needs_no_noise():
    clean, law, cut = recording(), sf.LAWS["dec-2015"], 5.0
    time = np.arange(clean.ap.size) / RATE
    # 20 Hz of as much power as the sway itself: behind 5 Hz a 256th of its size is left
    hum = np.sqrt(2.0) * clean.ap.std() * np.sin(2.0 * np.pi * 20.0 * time)
    noisy = sf.Recording(clean.ap + hum, clean.ml, RATE)
    of_clean, of_noisy, raw = (
        sf.expected_sway(each, **law.person, low_pass=low_pass)
        for each, low_pass in ((clean, cut), (noisy, cut), (noisy, None))
    )
    for each, low_pass in ((clean, cut), (noisy, cut)):
        found = sf.expected_sway(each, **law.person, low_pass=low_pass).sd_ap
        measured = sf.sway_measures(each, low_pass=low_pass).sd_ap
        assert found == pytest.approx(measured, rel=EXACT)
    assert of_noisy.noise[0] == pytest.approx(of_clean.noise[0], rel=OF_HUM)
    # able to fail: of samples as they are the hum counts as sway
    assert raw.noise[0] > 1.3 * of_clean.noise[0]


def test_a_low_pass_is_that_of_the_recording():
    here, law = recording(), sf.LAWS["dec-2015"]
    plain, ten, three = (
        sf.expected_sway(here, **law.person, noise=(1, 0, 0), low_pass=low) for low in (None, 10, 3)
    )
    assert plain.mean_velocity_ap == pytest.approx(ten.mean_velocity_ap, rel=EXACT)
    passed = (1.0 + (ten.frequency / 10.0) ** 4) / (1.0 + (ten.frequency / 3.0) ** 4)
    some = (ten.frequency > 0.2) & (ten.frequency < 5.0)  # a window leaks from below
    np.testing.assert_allclose((three.density / ten.density)[some], passed[some] ** 2, rtol=0.02)
    assert three.mean_velocity_ap < plain.mean_velocity_ap


@pytest.mark.parametrize(
    ("given", "sentence"),
    [
        (sf.LAWS["asai-2009"].person, "the person falls, and so has no sway to compare"),
        (
            {**sf.LAWS["dec-2015"].person, "noise": (0, 1, 1)},
            "no joint that turns has noise, so nothing sways",
        ),
        (
            {
                "body": sf.Body.edwards2007(),
                "stiffness": sf.Stiffness(900.0, np.inf, np.inf),
                "gravity": 9.8,
            },
            "the model's sway does not die out: it is undamped or about to fall",
        ),
        (
            {
                "body": sf.Body.edwards2007(),
                "stiffness": sf.Stiffness(900.0, np.inf, np.inf),
                "gravity": 9.8,
                "damping": (0.1, 0, 0),
            },
            "the model's sway dies out over",
        ),
    ],
)
def test_who_has_no_sway_to_compare_is_told_why(given, sentence):
    with pytest.raises(sf.InputError, match=sentence):
        sf.expected_sway(recording(), **given)


def test_what_is_no_recording_or_no_person_is_refused():
    person = sf.LAWS["dec-2015"].person
    with pytest.raises(sf.InputError, match="recording = 3; give what read_recording returns"):
        sf.expected_sway(3, **person)
    with pytest.raises(sf.InputError, match="stiffness"):
        sf.expected_sway(recording(), **{**person, "stiffness": 900.0})
