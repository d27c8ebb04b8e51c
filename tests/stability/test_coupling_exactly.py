"""Coupled joints against fractions and 50 digits: thresholds, bounds of rounding, eigenvalues."""

import itertools
import math
from fractions import Fraction

import mpmath
import numpy as np
import pytest

import standfast as sf
from coupled_people import cases, random_coupled
from people import random_body, random_gravity
from standfast.numerics import bounded
from standfast.parameters import COUPLED_JOINTS, JOINTS
from standfast.stability import rounding, springs
from standfast.stability.exact import exact_threshold

NOMINAL = sf.Body.edwards2007()

# Relative, of quantities away from 0: a few hundred roundings where K - G cancels.
RTOL = 1e-10


def fractions_of(body, stiffness, gravity):
    """K - G of all joints in fractions; a rigid joint has None on the diagonal."""
    ms, mt, mb = map(Fraction, map(float, body.segment_mass))
    hs, ht = map(Fraction, map(float, body.segment_length))
    es, et, eb = map(Fraction, map(float, body.segment_com))
    g = Fraction(gravity)
    g3 = g * mb * eb
    g2 = g3 + g * (mt * et + mb * ht)
    g1 = g2 + g * (ms * es + (mt + mb) * hs)
    ankle, knee, hip = (None if math.isinf(k) else Fraction(k) for k in stiffness.joints)
    ak, kh, ah = map(Fraction, stiffness.couplings)
    return [
        [None if ankle is None else ankle - g1, ak - g2, ah - g3],
        [ak - g2, None if knee is None else knee - g2, kh - g3],
        [ah - g3, kh - g3, None if hip is None else hip - g3],
    ], (g1, g2, g3)


def determinant_of(c, joints):
    """Leibniz's sum over some rows and columns."""
    total = Fraction(0)
    for order in itertools.permutations(range(len(joints))):
        turns = sum(a > b for a, b in itertools.combinations(order, 2))
        columns = (joints[n] for n in order)
        total += (-1) ** turns * math.prod(c[i][j] for i, j in zip(joints, columns, strict=True))
    return total


def exact_thresholds(body, stiffness, gravity):
    """Each joint's threshold by Cramer's rule: det of the rest, and of all without its spring."""
    c, own = fractions_of(body, stiffness, gravity)
    found = []
    for joint in range(3):
        rest = [i for i in range(3) if i != joint and c[i][i] is not None]
        minors = [determinant_of(c, rest[:size]) for size in range(1, len(rest) + 1)]
        if not all(minor > 0 for minor in minors):
            found.append(None)
            continue
        without = [list(row) for row in c]
        without[joint][joint] = -own[joint]
        found.append(-determinant_of(without, [joint, *rest]) / determinant_of(c, rest))
    return found


def test_thresholds_are_those_of_fractions():
    finite = 0
    for body, stiffness, gravity in cases(3, 1500):
        limits = sf.critical_stiffness(body, stiffness, gravity)
        assert limits.couplings == stiffness.couplings
        exact = exact_thresholds(body, stiffness, gravity)
        for limit, threshold in zip(limits.joints, exact, strict=True):
            if threshold is None:
                assert limit == math.inf
            else:
                finite += 1
                # close to where nothing helps, a threshold runs away and with it its error
                assert limit == pytest.approx(float(threshold), rel=RTOL)
    assert finite > 1500


@pytest.mark.parametrize("coupling", [0.0, 30.0])
def test_a_threshold_beyond_all_stiffnesses_is_a_number(coupling):
    """One rounding above what the knee carries, it hands nearly everything down."""
    K = sf.Stiffness(1000.0, 2000.0, 500.0, ankle_knee=coupling)
    load = float(springs.carried_loads(NOMINAL, K, 9.8)[1])
    limit = sf.critical_stiffness(NOMINAL, K._replace(knee=np.nextafter(load, 1e9)), 9.8).ankle
    assert isinstance(limit, float)
    assert 1e12 < limit < math.inf


def test_one_wrong_entry_would_be_noticed():
    wrong = 0
    for body, stiffness, gravity in cases(4, 50, rigid_share=0.0):
        other = stiffness._replace(knee_hip=stiffness.knee_hip + 1e-3)
        exact = exact_thresholds(body, stiffness, gravity)
        limits = sf.critical_stiffness(body, other, gravity).joints
        pairs = zip(limits, exact, strict=True)
        wrong += any(t is not None and k != pytest.approx(float(t), rel=RTOL) for k, t in pairs)
    assert wrong > 20


def near(body, stiffness, gravity, rng):
    """The same person with the ankle within a few roundings of its threshold."""
    threshold = exact_thresholds(body, stiffness, gravity)[0]
    if threshold is None or math.isinf(stiffness.ankle):
        return stiffness, threshold
    ulps = int(rng.integers(-6, 7))
    ankle = float(threshold)
    for _ in range(abs(ulps)):
        ankle = float(np.nextafter(ankle, math.copysign(math.inf, ulps)))
    return stiffness._replace(ankle=ankle), threshold


def test_bounds_of_rounding_hold_and_are_close():
    """The exact threshold lies between the ends; a verdict called certain is the exact one."""
    rng = np.random.default_rng(5)
    certain = within = 0
    widths = []
    for body, far, gravity in cases(6, 1500):
        stiffness, threshold = near(body, far, gravity, rng)
        place, low, high = rounding.threshold_interval(
            body, stiffness.knee, stiffness.hip, gravity, stiffness.couplings
        )
        assert low <= place <= high
        if threshold is None:
            assert high == math.inf
            continue
        assert low <= threshold <= high
        widths.append(float(high - low) / float(threshold))
        bound = rounding.load_rounding(body, stiffness, gravity)[0]
        assert abs(Fraction(float(place)) - threshold) <= Fraction(float(bound))
        exact = stiffness.ankle > threshold
        if rounding.verdict_is_certain(body, stiffness, gravity):
            certain += 1
            assert sf.is_stable(body, stiffness, gravity) == exact
        within += sf.is_stable(body, stiffness, gravity) != exact
    assert within > 3  # some are wrong, and none of these is called certain
    assert certain > 100
    assert np.median(widths) < 1e-13


def test_knee_and_hip_that_just_hold_or_fail_are_in_doubt():
    """Their own margins cross 0 in steps of rounding; whatever is not in doubt is right."""
    doubts = checked = 0
    for body, far, gravity in cases(7, 150, rigid_share=0.0):
        _, own = fractions_of(body, far, gravity)
        for joint in ("knee", "hip"):
            limit = springs.carried_loads(body, far, gravity)[JOINTS.index(joint)]
            if math.isinf(limit):
                continue
            for ulps in range(-4, 5):
                k = float(limit) * (1.0 + ulps * 2.0**-52)
                stiffness = far._replace(**{joint: k})
                threshold = exact_thresholds(body, stiffness, gravity)[0]
                place, low, high = rounding.threshold_interval(
                    body, stiffness.knee, stiffness.hip, gravity, stiffness.couplings
                )
                if low == math.inf:
                    assert threshold is None
                elif (low, high) == (0.0, math.inf):
                    doubts += 1
                else:
                    assert threshold is not None
                    assert low <= threshold <= high
                assert low <= place <= high
                checked += 1
        assert own[0] > own[1] > own[2]
    assert checked > 500
    assert doubts > 200


def test_bounded_numbers_hold_what_they_promise():
    rng = np.random.default_rng(8)
    operations = {
        bounded.plus: lambda x, y: x + y,
        bounded.minus: lambda x, y: x - y,
        bounded.times: lambda x, y: x * y,
        bounded.over: lambda x, y: x / y,
    }
    for _ in range(2000):
        exact = [Fraction(float(v)) for v in rng.normal(size=2) * 10.0 ** rng.uniform(-3, 3, 2)]
        off = [v * Fraction(float(rng.uniform(-1e-3, 1e-3))) for v in exact]
        numbers = []
        for v, d in zip(exact, off, strict=True):
            value = float(v + d)
            error = float(abs(Fraction(value) - v)) * (1.0 + 1e-12)
            numbers.append(bounded.Bounded(np.float64(value), np.float64(error)))
        for operation, plain in operations.items():
            found = operation(*numbers)
            assert abs(Fraction(float(found.value)) - plain(*exact)) <= Fraction(float(found.error))


def test_exact_thresholds_of_a_study_are_those_of_cramers_rule():
    rng = np.random.default_rng(9)
    for _ in range(50):
        stiffness = random_coupled(rng)
        given = {
            "body_model": "edwards2007", "height": 1.753, "mass": 75.3, "gravity": 9.8,
            **{f"{joint}_stiffness": k for joint, k in zip(JOINTS, stiffness.joints, strict=True)},
            **{
                f"{one}_{other}_stiffness": k
                for (one, other), k in zip(COUPLED_JOINTS, stiffness.couplings, strict=True)
            },
        }  # fmt: skip
        assert exact_threshold(given) == exact_thresholds(NOMINAL, stiffness, 9.8)[0]


def test_eigenvalues_near_zero_and_near_each_other_have_their_digits():
    """Against 50 digits, with couplings up to the largest that are allowed."""
    exact = mpmath.MPContext()
    exact.dps = 50
    rng = np.random.default_rng(14)
    for number in range(60):
        body, gravity = random_body(rng), random_gravity(rng)
        K = random_coupled(rng, rigid_share=0.0)
        if number % 2:
            K = sf.Stiffness(*(1e5 * rng.uniform(1.1, 3.0, 3)), *rng.uniform(-5e4, 5e4, 3))
        ankle = sf.critical_stiffness(body, K, gravity).ankle
        if math.isfinite(ankle) and ankle < 1e9:
            K = K._replace(ankle=ankle * (1.0 + 10.0 ** rng.uniform(-12.0, -3.0)))
        c, _ = fractions_of(body, K, gravity)
        c = exact.matrix([[exact.mpf(x.numerator) / x.denominator for x in row] for row in c])
        a = exact.matrix(exact_inertia(exact, body))
        inverse = exact.inverse(exact.cholesky(a))
        values = sorted(exact.eigsy(inverse * c * inverse.T, eigvals_only=True))
        found = sf.modes(body, K, gravity).eigenvalues
        for mine, true in zip(found, values, strict=True):
            assert abs(exact.mpf(float(mine)) - true) <= 1e-12 * abs(true) + 1e-22


def exact_inertia(exact, body):
    """Tᵀ M T of the listed numbers, in many digits."""
    ms, mt, mb = (exact.mpf(float(x)) for x in body.segment_mass)
    i_s, i_t, i_b = (exact.mpf(float(x)) for x in body.segment_inertia)
    hs, ht = (exact.mpf(float(x)) for x in body.segment_length)
    es, et, eb = (exact.mpf(float(x)) for x in body.segment_com)
    m = [
        [i_s + ms * es**2 + (mt + mb) * hs**2, (mt * et + mb * ht) * hs, mb * hs * eb],
        [(mt * et + mb * ht) * hs, i_t + mt * et**2 + mb * ht**2, mb * ht * eb],
        [mb * hs * eb, mb * ht * eb, i_b + mb * eb**2],
    ]
    return [
        [sum(m[k][n] for k in range(i, 3) for n in range(j, 3)) for j in range(3)] for i in range(3)
    ]
