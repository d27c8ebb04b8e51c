"""Covariances of sway against Lyapunov's equation, the delay Lyapunov matrix and closed forms."""

import math

import numpy as np
import pytest

import standfast as sf
from noisy_people import VARIANCES, standing_people
from standfast.mechanics.links import OneLink
from standfast.stability.sway.density import COM, COP, COP_TIMES_OMEGA, COP_VELOCITY, PAIRS
from standfast.stability.sway.integral import integrals
from standfast.stability.sway.persons import swaying_of
from sway_oracles import fastest, with_delay, without_delay
from sway_responses import by_responses

# What is promised of a covariance, relative to the deviations. Worst found of 1,000: 6e-11.
PROMISED = 1e-9
# The delay Lyapunov matrix is good to 1e-9 while τ times the fastest rate stays below this.
ORACLE_HOLDS = 3.0
SOME = 4  # persons whose responses take a second


def largest_difference(standing, oracle):
    found, sure = integrals(VARIANCES, standing.swaying)
    assert sure.all()
    worst = 0.0
    for number, delay in enumerate(standing.delay):
        free = np.flatnonzero(standing.people.free[:, number])
        matrices = standing.people.matrices(number)
        exact = oracle(matrices, standing.noise[free, number], delay).diagonal()
        worst = max(worst, abs(found[free, number] / exact - 1.0).max())
    return worst


def test_solves_lyapunovs_equation_without_delay():
    standing = standing_people(np.random.default_rng(151), 800, 0.0)
    assert standing.delay.size > 250
    assert largest_difference(standing, lambda m, s, _: without_delay(m, s)) < PROMISED


def test_agrees_with_the_delay_lyapunov_matrix():
    standing = standing_people(np.random.default_rng(152), 1500, 0.1)
    chosen = np.flatnonzero(fastest(standing.people) * standing.delay < ORACLE_HOLDS)
    assert chosen.size > 200
    assert largest_difference(standing[chosen], with_delay) < PROMISED


def test_agrees_with_responses_in_time():
    # of delays that the delay Lyapunov matrix has no digits for too
    standing = standing_people(np.random.default_rng(155), 120, 0.3)
    longest = np.argsort(standing.delay)[-SOME:]
    assert largest_difference(standing[longest], by_responses) < PROMISED


@pytest.mark.parametrize("oracle_of", [with_delay, by_responses])
def test_the_oracles_notice_a_changed_gain(oracle_of):
    standing = standing_people(np.random.default_rng(153), 40, 0.02)[slice(0, SOME)]
    standing.people.numbers[3] *= 1.0 + 1e-5

    def of_others(matrices, sigma, delay):
        return oracle_of(matrices / np.array([1, 1, 1, 1.0 + 1e-5, 1])[:, None, None], sigma, delay)

    assert largest_difference(standing, of_others) > PROMISED


def test_rows_together_are_rows_alone():
    swaying = standing_people(np.random.default_rng(154), 60, 0.1).swaying
    rows = (*range(len(PAIRS)), COM, COP, COP_VELOCITY, COP_TIMES_OMEGA)
    deviations = np.sqrt(integrals(VARIANCES, swaying)[0])
    sizes = np.stack([deviations[i] * deviations[j] for i, j in PAIRS])
    sizes = np.concatenate([sizes, integrals(rows[len(PAIRS) :], swaying)[0]])
    together, _ = integrals(rows, swaying, sizes=sizes)
    for place, row in enumerate(rows):
        alone, _ = integrals((row,), swaying, sizes=sizes[place][None])
        assert (abs(together[place] - alone[0]) <= 2.0 * PROMISED * sizes[place]).all()


@pytest.mark.parametrize(("stiffness", "damping"), [(900.0, 40.0), (750.0, 5.0), (5000.0, 300.0)])
def test_one_joint_is_the_closed_form(stiffness, damping):
    body = OneLink(78.2, 73.4, 743.2).body(9.81)
    found = sf.sway_covariance(
        body, sf.Stiffness(stiffness, math.inf, math.inf), 9.81,
        damping=(damping, 0.0, 0.0), noise=(2.0, 1.0, 1.0),
    )  # fmt: skip
    exact = 2.0**2 / (2.0 * damping * (stiffness - 743.2))
    assert found[0, 0] == pytest.approx(exact, rel=1e-9)
    assert not found[1:].any()
    assert not found[:, 1:].any()


def person(**changes):
    given = {
        "body": sf.Body.edwards2007(), "stiffness": sf.Stiffness(700.0, 2500.0, 900.0),
        "gravity": 9.81, "damping": (50.0, 30.0, 30.0), "noise": (1.0, 0.5, 0.3),
        "feedback": sf.Feedback((500.0, 0.0, 50.0), (25.0, 0.0, 5.0), 0.12),
    }  # fmt: skip
    given |= changes
    return (given.pop("body"), given.pop("stiffness"), given.pop("gravity")), given


def test_noise_twice_as_strong_makes_four_times_the_variance():
    of, more = person()
    twice = {**more, "noise": tuple(2.0 * each for each in more["noise"])}
    np.testing.assert_allclose(
        sf.sway_covariance(*of, **twice), 4.0 * sf.sway_covariance(*of, **more), rtol=1e-9
    )


def test_noises_of_the_joints_add_up():
    of, more = person()
    apart = [
        sf.sway_covariance(*of, **{**more, "noise": tuple(np.eye(3)[k] * more["noise"][k])})
        for k in range(3)
    ]
    np.testing.assert_allclose(sum(apart), sf.sway_covariance(*of, **more), rtol=1e-8)


def test_a_covariance_is_symmetric_and_positive_definite():
    of, more = person()
    found = sf.sway_covariance(*of, **more)
    assert (found == found.T).all()
    assert np.linalg.eigvalsh(found)[0] > 0.0


def test_sway_grows_as_the_threshold_comes_near():
    limit = sf.critical_stiffness(sf.Body.edwards2007(), sf.Stiffness(0, 2500, 700), 9.81).ankle
    sway = []
    for above in (100.0, 10.0, 1.0, 0.1):
        of, more = person(stiffness=sf.Stiffness(limit + above, 2500.0, 700.0), feedback=None)
        sway.append(math.sqrt(sf.sway_covariance(*of, **more)[0, 0]))
    assert sway == sorted(sway)
    # as the root of 1 over what is left, near the threshold
    assert sway[3] / sway[2] == pytest.approx(math.sqrt(10.0), rel=1e-2)


def test_who_falls_sways_without_bounds_and_who_is_rigid_not_at_all():
    of, more = person(stiffness=sf.Stiffness(100.0, math.inf, 700.0), feedback=None)
    found = sf.sway_covariance(*of, **more)
    assert np.isinf(found[[0, 0, 2], [0, 2, 2]]).all()
    assert not found[1].any()
    of, more = person(stiffness=sf.Stiffness(math.inf, math.inf, math.inf), feedback=None)
    assert not sf.sway_covariance(*of, **more).any()


def test_a_spectrum_adds_up_to_the_variance():
    of, more = person()
    hertz = np.concatenate([[0.0], np.geomspace(1e-4, 1e3, 40001)])
    spectrum = sf.sway_spectrum(*of, **more, frequency=hertz)
    variances = np.diag(sf.sway_covariance(*of, **more))
    for joint, exact in zip(("ankle", "knee", "hip"), variances, strict=True):
        total = np.trapezoid(getattr(spectrum, joint), hertz)
        assert total == pytest.approx(exact, rel=1e-5)  # of the trapezoids


def test_rows_of_com_and_cop_are_the_integrals_of_their_spectra():
    of, more = person()
    hertz = np.concatenate([[0.0], np.geomspace(1e-4, 1e3, 40001)])
    spectrum = sf.sway_spectrum(*of, **more, frequency=hertz)
    body, stiffness, gravity = of
    loads = np.array(sf.stiffness_matrix(body, sf.Stiffness(0, 0, 0), gravity))[0]
    weight = float(np.sum(body.segment_mass)) * gravity
    numbers = np.array([
        sf.inertia_matrix(body), np.diag(more["damping"]),
        sf.stiffness_matrix(body, stiffness, gravity),
        more["feedback"].proportional, more["feedback"].derivative,
    ])[..., None]  # fmt: skip
    swaying = swaying_of(
        numbers, np.zeros((3, 1), bool), np.array([0.12]), np.array(more["noise"])[:, None],
        -loads[:, None], np.array([weight]),
    )  # fmt: skip
    for row, density in ((COM, spectrum.com), (COP, spectrum.cop)):
        found, sure = integrals((row,), swaying)
        assert sure.all()
        assert found[0, 0] == pytest.approx(np.trapezoid(density, hertz), rel=1e-5)
    fast, _ = integrals((COP_VELOCITY,), swaying)
    speed = np.trapezoid((2.0 * np.pi * hertz) ** 2 * spectrum.cop, hertz)
    assert fast[0, 0] == pytest.approx(speed, rel=1e-4)


def test_the_centre_of_pressure_swings_about_the_centre_of_mass():
    # of noise at the ankle itself the pressure is without it
    of, more = person(noise=(0.0, 0.5, 0.3))
    hertz = np.array([0.01, 0.02])
    spectrum = sf.sway_spectrum(*of, **more, frequency=hertz)
    # who moves slowly holds the body's weight with the pressure below it
    np.testing.assert_allclose(spectrum.cop, spectrum.com, rtol=0.02)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"noise": (1.0, 2.0)}, "three numbers"),
        ({"noise": (1.0, -1.0, 1.0)}, "knee_noise"),
        ({"noise": (1.0, math.nan, 1.0)}, "knee_noise"),
    ],
)
def test_wrong_noise_is_refused_by_name(change, words):
    of, more = person(**change)
    with pytest.raises(sf.InputError, match=words):
        sf.sway_covariance(*of, **more)


@pytest.mark.parametrize(
    "frequency",
    [[], "fast", [[1.0], [1.0, 2.0]], None, -1.0, math.inf, math.nan, [[1.0]], 1.1e4, 1e100],
)
def test_wrong_frequencies_are_refused(frequency):
    of, more = person()
    with pytest.raises(sf.InputError, match="frequency"):
        sf.sway_spectrum(*of, **more, frequency=frequency)


def test_at_the_ends_of_the_frequencies_a_spectrum_is_a_number():
    of, more = person()
    spectrum = sf.sway_spectrum(*of, **more, frequency=[0.0, 1e4])
    assert np.isfinite(spectrum).all()
    assert spectrum.ankle[0] > spectrum.ankle[1] > 0.0


def test_whom_nothing_damps_has_no_spectrum_as_it_has_no_covariance():
    stiff = sf.Stiffness(1500.0, 3000.0, 900.0)
    of, more = person(stiffness=stiff, feedback=None, damping=(30.0, 0.0, 0.0))
    sf.sway_spectrum(*of, **more, frequency=1.0)
    of, more = person(stiffness=stiff, feedback=None, damping=None)
    assert sf.is_stable(*of)
    assert np.isinf(sf.sway_covariance(*of, **more)).all()
    with pytest.raises(sf.InputError, match="nothing damps"):
        sf.sway_spectrum(*of, **more, frequency=1.0)
    rigid, more = person(stiffness=sf.Stiffness(*(3 * [math.inf])), feedback=None, damping=None)
    assert (sf.sway_spectrum(*rigid, **more, frequency=1.0).ankle == 0.0).all()


def test_who_falls_has_no_spectrum():
    of, more = person(stiffness=sf.Stiffness(100.0, math.inf, 700.0), feedback=None)
    with pytest.raises(sf.InputError, match="falls"):
        sf.sway_spectrum(*of, **more, frequency=1.0)


@pytest.mark.parametrize(("damping", "feedback", "finite"), [
    (None, None, False),
    ((0, 5, 0), None, True),
    (None, sf.Feedback((300, 0, 0), (0, 0, 0), 0.0), False),
    (None, sf.Feedback((-100, 0, 0), (0, 0, 0), 0.02), True),
])  # fmt: skip
def test_what_nothing_damps_sways_without_bounds(damping, feedback, finite):
    body = sf.Body.from_height_mass(1.753, 75.3, "edwards2007")
    person = body, sf.Stiffness(1500.0, 2000.0, math.inf)
    found = sf.sway_covariance(*person, damping=damping, feedback=feedback)
    assert np.isfinite(found[:2, :2]).all() == finite
    assert not found[2].any()
