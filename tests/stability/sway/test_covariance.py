"""Covariances of sway against Lyapunov's equation, the delay Lyapunov matrix and closed forms."""

import math

import numpy as np
import pytest

import standfast as sf
from delay_people import random_persons
from standfast.mechanics.links import OneLink
from standfast.stability.delay.persons import all_crossings
from standfast.stability.sway.density import COM, COP, COP_VELOCITY, PAIRS
from standfast.stability.sway.integral import integral
from standfast.stability.sway.persons import swaying_of, variance
from sway_oracles import first_order, with_delay, without_delay

FEEDING_BACK = ("diagonal", "full", "one channel", "ankle only")
# What is promised of a covariance, relative to the deviations. Worst found of 1,000: 6e-11.
PROMISED = 1e-9
# The delay Lyapunov matrix is good to 1e-9 while τ times the fastest rate stays below this.
ORACLE_HOLDS = 3.0


def standing_people(rng, size, delays):
    """Persons who stand at their delays: numbers, rigid joints, delays, noise."""
    people = random_persons(rng, size, kinds=FEEDING_BACK)
    stand = all_crossings(people.numbers, people.rigid).stable_each(delays)
    return people[np.flatnonzero(stand)], delays[stand]


VARIANCES = [row for row, (i, j) in enumerate(PAIRS) if i == j]


def variances(people, delays, noise, **how):
    ones = np.ones((3, delays.size))
    swaying = swaying_of(people.numbers, people.rigid, delays, noise, ones, ones[0])
    stands = np.ones(delays.size, bool)
    return {row: variance(row, swaying, stands, **how)[0] for row in VARIANCES}


def largest_difference(people, delays, noise, oracle):
    found = variances(people, delays, noise)
    worst = 0.0
    for number in range(delays.size):
        free = np.flatnonzero(people.free[:, number])
        exact = oracle(people.matrices(number), noise[free, number], delays[number])
        for place, joint in enumerate(free):
            row = PAIRS.index((joint, joint))
            worst = max(worst, abs(found[row][number] / exact[place, place] - 1.0))
    return worst


def test_solves_lyapunovs_equation_without_delay():
    rng = np.random.default_rng(151)
    people, delays = standing_people(rng, 800, np.zeros(800))
    assert delays.size > 250
    noise = rng.uniform(0.2, 2.0, (3, delays.size))
    worst = largest_difference(people, delays, noise, lambda m, s, _: without_delay(m, s))
    assert worst < PROMISED


def test_agrees_with_the_delay_lyapunov_matrix():
    rng = np.random.default_rng(152)
    people, delays = standing_people(rng, 1500, rng.uniform(0.0, 0.1, 1500))
    fastest = np.array([
        np.abs(np.linalg.eigvals(first_order(people.matrices(n))[0])).max()
        for n in range(delays.size)
    ])  # fmt: skip
    chosen = np.flatnonzero(fastest * delays < ORACLE_HOLDS)
    assert chosen.size > 200
    people, delays = people[chosen], delays[chosen]
    noise = rng.uniform(0.2, 2.0, (3, delays.size))
    assert largest_difference(people, delays, noise, with_delay) < PROMISED


def test_the_oracle_notices_a_changed_gain():
    rng = np.random.default_rng(153)
    people, delays = standing_people(rng, 40, rng.uniform(0.0, 0.02, 40))
    noise = rng.uniform(0.2, 2.0, (3, delays.size))
    people.numbers[3] *= 1.0 + 1e-5

    def of_others(matrices, sigma, delay):
        return with_delay(
            matrices / np.array([1, 1, 1, 1.0 + 1e-5, 1])[:, None, None], sigma, delay
        )

    assert largest_difference(people, delays, noise, of_others) > PROMISED


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
        found, sure = integral(row, swaying)
        assert sure.all()
        assert found[0] == pytest.approx(np.trapezoid(density, hertz), rel=1e-5)
    fast, _ = integral(COP_VELOCITY, swaying)
    speed = np.trapezoid((2.0 * np.pi * hertz) ** 2 * spectrum.cop, hertz)
    assert fast[0] == pytest.approx(speed, rel=1e-4)


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


@pytest.mark.parametrize("frequency", [[], -1.0, math.inf, [[1.0]]])
def test_wrong_frequencies_are_refused(frequency):
    of, more = person()
    with pytest.raises(sf.InputError, match="frequency"):
        sf.sway_spectrum(*of, **more, frequency=frequency)


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
