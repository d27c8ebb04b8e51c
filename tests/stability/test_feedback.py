"""The functions of one person with feedback: closed forms, other ways, and each other."""

import dataclasses
import math

import numpy as np
import pytest
import scipy.linalg

import standfast as sf
from delay_oracles import rightmost_by_collocation, unstable_by_argument
from people import random_body
from standfast.stability import feedback as feedbacks
from standfast.stability.delay.persons import all_crossings

SEED = 20076
EQUAL = 1e-9
UNSTABLE_MODES = (2.88, 7.93, 22.5)  # 1/s, of the person of 2007 without stiffness
SAMPLED_GAINS = 150
G = 9.8


def matrices_of(body, stiffness, damping, feedback):
    """A, B, C, P, D of the free joints."""
    whole = np.array([
        np.asarray(sf.inertia_matrix(body)), np.diag(damping),
        np.asarray(sf.stiffness_matrix(body, stiffness, G)),
        feedback.proportional, feedback.derivative,
    ])  # fmt: skip
    free = np.isfinite(stiffness.joints)
    return whole[:, free][:, :, free]


def random_case(rng, *, rigid=()):
    body = random_body(rng)
    load = -np.asarray(sf.stiffness_matrix(body, sf.Stiffness(0.0, 0.0, 0.0), G))
    joints = np.array([0.5 * load[0, 0], 2000.0, 800.0]) * rng.uniform(0.5, 1.5, 3)
    joints[list(rigid)] = math.inf
    stiffness = sf.Stiffness(*joints, knee_hip=0.0 if rigid else 20.0)
    p = rng.uniform(-0.1, 0.1, (3, 3)) * load[2, 2]
    d = rng.uniform(-0.03, 0.03, (3, 3)) * load[2, 2]
    p[0, 0] += rng.uniform(0.6, 1.2) * load[0, 0]
    d[0, 0] += rng.uniform(0.1, 0.4) * load[0, 0]
    damping = rng.uniform(5.0, 30.0, 3)
    return body, stiffness, damping, sf.Feedback(p, d, rng.uniform(0.0, 0.3))


def test_one_free_joint_is_a_quadratic():
    """J² ω⁴ + (B² − D² − 2 J C) ω² + C² − P² = 0; the larger ω² destabilises."""
    rng = np.random.default_rng(SEED)
    seen = 0
    for _ in range(200):
        body, stiffness, damping, feedback = random_case(rng, rigid=(1, 2))
        j, b, c, p, d = matrices_of(body, stiffness, damping, feedback)[:, 0, 0]
        x = np.roots([j**2, b**2 - d**2 - 2 * j * c, c**2 - p**2])
        omegas = sorted(math.sqrt(v.real) for v in x if abs(v.imag) < 1e-9 and v.real > 0.0)
        known = []
        for number, omega in enumerate(reversed(omegas)):
            z = -(c - j * omega**2 + 1j * b * omega) / (p + 1j * d * omega)
            theta = float(-np.angle(z) % math.tau)
            way = 1 if number == 0 else -1
            known += [((theta + math.tau * k) / omega, omega, way) for k in range(50)]
        known = sorted(each for each in known if each[0] <= 1.0)
        found = sf.delay_crossings(body, stiffness, G, damping=damping, feedback=feedback)
        assert [each[2] for each in found] == [each[2] for each in known]
        assert np.allclose(found, known, rtol=EQUAL, atol=0.0) or not known
        seen += len(known)
    assert seen > 100


@pytest.mark.parametrize("rigid", [(), (1,), (2,), (1, 2), (0,)])
def test_counts_roots_and_verdicts_agree(rigid):
    rng = np.random.default_rng(SEED)
    verdicts = set()
    for _ in range(8):
        body, stiffness, damping, feedback = random_case(rng, rigid=rigid)
        given = {"damping": damping, "feedback": feedback}
        matrices = matrices_of(body, stiffness, damping, feedback)
        root = sf.rightmost_root(body, stiffness, G, **given)
        known = rightmost_by_collocation(matrices, feedback.delay)
        assert abs(root - known) < EQUAL * (1.0 + abs(known))
        count = sf.unstable_roots(body, stiffness, G, **given)
        assert count == unstable_by_argument(matrices, feedback.delay)
        stands = sf.is_stable(body, stiffness, G, **given)
        assert stands == (count == 0) == (root.real < 0.0)
        verdicts.add(stands)
        critical = sf.critical_delay(body, stiffness, G, **given)
        if 0.0 < critical < math.inf:
            for factor, lost in ((1.0 - 1e-6, False), (1.0 + 1e-6, True)):
                beside = feedback._replace(delay=critical * factor)
                assert sf.is_stable(body, stiffness, G, damping=damping, feedback=beside) != lost
    assert verdicts or rigid


def test_the_critical_delay_is_the_first_crossing_to_the_right():
    rng = np.random.default_rng(SEED)
    for _ in range(20):
        body, stiffness, damping, feedback = random_case(rng)
        given = {"damping": damping, "feedback": feedback}
        crossings = sf.delay_crossings(body, stiffness, G, **given, longest=2.0)
        assert crossings == sorted(crossings)
        undelayed = sf.unstable_roots(
            body, stiffness, G, damping=damping, feedback=feedback._replace(delay=0.0)
        )
        critical = sf.critical_delay(body, stiffness, G, **given)
        to_right = [delay for delay, _, way in crossings if way > 0]
        if undelayed:
            assert critical == 0.0
        elif to_right:
            assert critical == to_right[0]
        for delay in (0.05, 0.3, 1.7):
            passed = 2 * sum(way for when, _, way in crossings if when < delay)
            count = sf.unstable_roots(
                body, stiffness, G, damping=damping, feedback=feedback._replace(delay=delay)
            )
            assert count == undelayed + passed


def test_without_gains_it_is_the_verdict_of_springs():
    rng = np.random.default_rng(SEED)
    for _ in range(50):
        body, stiffness, damping, _ = random_case(rng)
        stiffness = stiffness._replace(ankle=stiffness.ankle * rng.uniform(1.0, 4.0))
        alone = sf.is_stable(body, stiffness, G)
        for b in (None, damping):
            for feedback in (None, sf.Feedback((0.0, 0.0, 0.0), delay=0.2)):
                found = sf.is_stable(body, stiffness, G, damping=b, feedback=feedback)
                assert found == alone
        none = sf.Feedback((0.0, 0.0, 0.0))
        assert sf.critical_delay(body, stiffness, G, feedback=none) == (math.inf if alone else 0.0)


def test_unstable_modes_of_the_person_of_2007():
    body, slack = sf.Body.edwards2007(), sf.Stiffness(0.0, 0.0, 0.0)
    none = sf.Feedback((0.0, 0.0, 0.0))
    assert sf.unstable_roots(body, slack, G, feedback=none) == 3
    root = sf.rightmost_root(body, slack, G, feedback=none)
    assert root == pytest.approx(UNSTABLE_MODES[2], abs=0.05)
    rates = np.sqrt(-np.asarray(sf.modes(body, slack, G).eigenvalues))[::-1]
    assert rates == pytest.approx(UNSTABLE_MODES, abs=0.05)
    # τ < √2 / rate, of one mode alone: 0.1 s can hold the first two of them, not the third
    longest = math.sqrt(2.0) / np.array(UNSTABLE_MODES)
    assert ((longest > 0.1) == [True, True, False]).all()


def test_at_a_tenth_of_a_second_feedback_alone_does_not_hold_three_joints():
    body, slack = sf.Body.edwards2007(), sf.Stiffness(0.0, 0.0, 0.0)
    a, g = np.asarray(sf.inertia_matrix(body)), -np.asarray(sf.stiffness_matrix(body, slack, G))
    rng = np.random.default_rng(SEED)
    _, shapes = scipy.linalg.eigh(g, a)
    rates = np.sqrt(scipy.linalg.eigvalsh(g, a))
    numbers = np.zeros((5, 3, 3, SAMPLED_GAINS))
    numbers[0], numbers[2] = a[..., None], -g[..., None]
    for number in range(SAMPLED_GAINS):
        # gains of each mode around the corner that bears the longest delay, mixed a little
        p = rates**2 * (1.0 + 10.0 ** rng.uniform(-1.0, 0.5, 3))
        d = rates**2 * rng.uniform(0.02, 0.2, 3)
        for place, gains in ((3, p), (4, d)):
            mixed = a @ shapes @ np.diag(gains) @ shapes.T @ a
            numbers[place, ..., number] = mixed * (1.0 + rng.normal(0.0, 0.01, (3, 3)))
    table = all_crossings(numbers, np.zeros((3, SAMPLED_GAINS), bool))
    stands = table.stable_at(np.array([0.03, 0.1]))[~table.uncertain]
    assert len(stands) > 0.95 * SAMPLED_GAINS
    assert stands[:, 0].mean() > 0.1
    assert not stands[:, 1].any()
    # where knee and hip are held, one slow mode is left
    ankle = sf.Feedback((1000.0, 0.0, 0.0), (300.0, 0.0, 0.0), 0.1)
    stiff = sf.Stiffness(0.0, math.inf, math.inf)
    assert sf.is_stable(body, stiff, G, damping=(10.0, 10.0, 10.0), feedback=ankle)


def test_what_rounding_leaves_open_is_no_verdict(monkeypatch):
    """Two equal joints that do not touch cross at once; here a table is said to be doubtful."""
    body, stiffness = sf.Body.edwards2007(), sf.Stiffness(900.0, 2000.0, 738.0)
    feedback = sf.Feedback((300.0, 0.0, 0.0), (50.0, 0.0, 0.0), 0.1)
    table = feedbacks.all_crossings

    def doubtful(numbers, rigid):
        return dataclasses.replace(table(numbers, rigid), uncertain=np.ones(1, bool))

    monkeypatch.setattr(feedbacks, "all_crossings", doubtful)
    for function in (sf.is_stable, sf.critical_delay, sf.unstable_roots, sf.delay_crossings):
        with pytest.raises(ArithmeticError, match="rounding"):
            function(body, stiffness, G, feedback=feedback)


def test_a_root_at_zero_does_not_stand():
    """K + P = mgh exactly: it is neutral at every delay, which is sure."""
    body, rigid = sf.Body.edwards2007(), math.inf
    load = -float(sf.stiffness_matrix(body, sf.Stiffness(0.0, rigid, rigid), G)[0][0])
    feedback = sf.Feedback((load, 0.0, 0.0), (100.0, 0.0, 0.0), 0.1)
    slack = sf.Stiffness(0.0, rigid, rigid)
    assert not sf.is_stable(body, slack, G, feedback=feedback)
    assert sf.critical_delay(body, slack, G, feedback=feedback) == 0.0
