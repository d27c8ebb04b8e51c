"""Coupled joints: every quantity against LAPACK and fractions, rigid joints included."""

import itertools
import math
from fractions import Fraction

import jax
import mpmath
import numpy as np
import pytest
import scipy.linalg

import standfast as sf
from people import random_body, random_gravity
from standfast.mechanics.matrices import stiffness_rows
from standfast.numerics import bounded
from standfast.parameters import COUPLED_JOINTS, JOINTS
from standfast.stability import rounding, springs
from standfast.stability.exact import exact_threshold

NOMINAL = sf.Body.edwards2007()

# LAPACK's absolute error of an eigenvalue is some roundings of the largest one.
LAPACK = 1e-13
# Relative, of quantities away from 0: a few hundred roundings where K - G cancels.
RTOL = 1e-10


def random_coupled(rng, *, rigid_share=0.2, couplings=1.0):
    """Joints log-uniform from 100 to 10⁴ or rigid, coupled by up to 0.9 of their geometric mean."""
    joints = 10.0 ** rng.uniform(2.0, 4.0, 3)
    share = couplings * rng.uniform(-0.9, 0.9, 3) * (rng.random(3) < 0.8)
    pairs = [(JOINTS.index(one), JOINTS.index(other)) for one, other in COUPLED_JOINTS]
    between = [x * math.sqrt(joints[i] * joints[j]) for x, (i, j) in zip(share, pairs, strict=True)]
    joints[rng.random(3) < rigid_share] = math.inf
    return sf.Stiffness(*joints, *between)


def plain_matrices(body, stiffness, gravity):
    """K, G and A of the joints that are not rigid; K is put together here."""
    ankle, knee, hip, ak, kh, ah = stiffness
    k = np.array([[ankle, ak, ah], [ak, knee, kh], [ah, kh, hip]])
    free = np.flatnonzero(np.isfinite(stiffness.joints))
    keep = np.ix_(free, free)
    load = -sf.stiffness_matrix(body, sf.Stiffness(0.0, 0.0, 0.0), gravity)
    return k[keep], load[keep], sf.inertia_matrix(body)[keep], free


def cases(seed, count, **how):
    rng = np.random.default_rng(seed)
    for _ in range(count):
        yield random_body(rng), random_coupled(rng, **how), random_gravity(rng)


def largest(k, load):
    return np.abs(k).sum() + np.abs(load).sum()


def test_c_is_symmetric_with_couplings_in_their_places():
    K = sf.Stiffness(950.0, 2000.0, 738.0, ankle_knee=30.0, knee_hip=-20.0, ankle_hip=10.0)
    own = sf.stiffness_matrix(NOMINAL, sf.Stiffness(*K.joints), 9.8)
    added = sf.stiffness_matrix(NOMINAL, K, 9.8) - own
    wanted = [[0.0, 30.0, 10.0], [30.0, 0.0, -20.0], [10.0, -20.0, 0.0]]
    np.testing.assert_allclose(added, wanted, atol=1e-12)


@pytest.mark.parametrize(
    ("knee", "ankle_knee", "knee_hip", "threshold"),
    [
        (2000, 0, 0, "949.9"), (2000, 30, 0, "930.9"), (2000, 30, 30, "923.5"),
        (2000, 100, 100, "872.6"), (1000, 0, 0, "1266.0"), (1000, 30, 0, "1209.7"),
        (1000, 30, 30, "1178.6"), (1000, 100, 100, "1022.7"),
    ],
)  # fmt: skip
def test_published_thresholds_of_the_nominal_person(knee, ankle_knee, knee_hip, threshold):
    K = sf.Stiffness(0.0, knee, 738.0, ankle_knee, knee_hip)
    assert f"{sf.critical_stiffness(NOMINAL, K, gravity=9.8).ankle:.1f}" == threshold


def test_the_verdict_is_that_of_the_eigenvalues():
    stable = 0
    for body, stiffness, gravity in cases(1, 4000):
        k, load, _, free = plain_matrices(body, stiffness, gravity)
        least = np.linalg.eigvalsh(k - load)[0] if free.size else math.inf
        assert abs(least) > LAPACK * largest(k, load)
        assert sf.is_stable(body, stiffness, gravity) == (least > 0.0)
        stable += least > 0.0
    assert 500 < stable < 3500


def test_margins_and_modes_are_those_of_lapack():
    seen = np.zeros(4, int)
    for body, stiffness, gravity in cases(2, 1500):
        k, load, inertia, free = plain_matrices(body, stiffness, gravity)
        if not free.size:
            assert sf.safety_factor(body, stiffness, gravity) == math.inf
            continue
        slack = 10.0 * LAPACK * largest(k, load)
        reserve = sf.stiffness_reserve(body, stiffness, gravity)
        assert reserve == pytest.approx(np.linalg.eigvalsh(k - load)[0], abs=slack)
        factor = sf.safety_factor(body, stiffness, gravity)
        if np.linalg.eigvalsh(k)[0] < 0.0:
            assert factor == 0.0
        else:
            least = scipy.linalg.eigh(k, load, eigvals_only=True)[0]
            ill = np.linalg.cond(load) * largest(k, load) / np.linalg.eigvalsh(load)[-1]
            assert factor == pytest.approx(least, rel=1e-9, abs=LAPACK * ill)
        found = sf.modes(body, stiffness, gravity)
        values = scipy.linalg.eigh(k - load, inertia, eigvals_only=True)
        slack = 10.0 * LAPACK * np.abs(values).max() * np.linalg.cond(inertia)
        np.testing.assert_allclose(found.eigenvalues[: free.size], values, atol=slack)
        assert (found.eigenvalues[free.size :] == math.inf).all()
        for number in range(free.size):
            v = found.shapes[free, number]
            residual = (k - load) @ v - found.eigenvalues[number] * (inertia @ v)
            assert np.abs(residual).max() < 1e-9 * largest(k, load) * np.abs(v).max()
        determinant = sf.stability_determinant(body, stiffness, gravity)
        exact = np.linalg.det(k - load)
        if free.size == 3:
            ill = LAPACK * largest(k, load) ** 3
            assert determinant == pytest.approx(exact, rel=RTOL, abs=ill)
        else:
            assert determinant == math.copysign(math.inf, exact)
        seen[free.size] += 1
    assert (seen[1:] > 50).all()


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


MUSCLES = {  # moment arms at ankle, knee, hip, in m
    "gastrocnemius": (0.05, 0.05, 0.0),
    "hamstrings": (0.0, 0.05, 0.08),
    "rectus femoris": (0.0, 0.04, 0.08),
}


@pytest.mark.parametrize("muscle", MUSCLES)
def test_a_muscle_across_two_joints_never_destabilises(muscle):
    rng = np.random.default_rng(10)
    arms = np.array(MUSCLES[muscle])
    for body, stiffness, gravity in cases(11, 300, couplings=0.3):
        k = 10.0 ** rng.uniform(1.0, 5.0) * np.outer(arms, arms)
        added = sf.Stiffness(
            *(own + more for own, more in zip(stiffness.joints, np.diag(k), strict=True)),
            stiffness.ankle_knee + k[0, 1],
            stiffness.knee_hip + k[1, 2],
            stiffness.ankle_hip + k[0, 2],
        )
        before = sf.stiffness_reserve(body, stiffness, gravity)
        after = sf.stiffness_reserve(body, added, gravity)
        if math.isfinite(before):
            scale = sum(own for own in added.joints if math.isfinite(own))
            assert after >= before - LAPACK * scale
        if sf.is_stable(body, stiffness, gravity):
            assert sf.is_stable(body, added, gravity)


def test_the_coupling_of_a_rigid_joint_means_nothing():
    for body, stiffness, gravity in cases(12, 100, rigid_share=0.5):
        rigid = [math.isinf(k) for k in stiffness.joints]
        changes = {
            f"{one}_{other}": 12_345.0
            for one, other in COUPLED_JOINTS
            if rigid[JOINTS.index(one)] or rigid[JOINTS.index(other)]
        }
        other = stiffness._replace(**changes)
        for quantity in (sf.is_stable, sf.stiffness_reserve, sf.safety_factor):
            assert quantity(body, other, gravity) == quantity(body, stiffness, gravity)
        for mine, theirs in zip(
            sf.modes(body, other, gravity), sf.modes(body, stiffness, gravity), strict=True
        ):
            np.testing.assert_array_equal(mine, theirs)


def test_a_joint_of_great_stiffness_is_nearly_rigid():
    K = sf.Stiffness(1100.0, math.inf, 500.0, ankle_knee=80.0, knee_hip=-40.0, ankle_hip=25.0)
    stiff = K._replace(knee=1e12)
    for quantity in (sf.stiffness_reserve, sf.safety_factor):
        assert quantity(NOMINAL, stiff) == pytest.approx(quantity(NOMINAL, K), rel=1e-8)
    limits, exact = (sf.critical_stiffness(NOMINAL, each).joints for each in (stiff, K))
    assert limits == pytest.approx(exact, rel=1e-8)


def test_k_that_is_not_positive_definite_has_no_safety():
    """A lone muscle across two joints, a free joint that is coupled, a coupling beyond both."""
    for K in (
        sf.Stiffness(30.0, 30.0, 700.0, ankle_knee=30.0),
        sf.Stiffness(0.0, 2000.0, 700.0, ankle_hip=10.0),
        sf.Stiffness(1000.0, 2000.0, 700.0, knee_hip=1300.0),
    ):
        assert sf.safety_factor(NOMINAL, K) == 0.0
        assert not sf.is_stable(NOMINAL, K)


def test_without_coupling_both_ways_agree():
    """Couplings that are traced are not known to be 0; the values are those of plain springs."""

    def everything(stiffness):
        return (
            *sf.critical_stiffness(NOMINAL, stiffness, 9.8).joints,
            sf.stiffness_reserve(NOMINAL, stiffness, 9.8),
            sf.safety_factor(NOMINAL, stiffness, 9.8),
            sf.stability_determinant(NOMINAL, stiffness, 9.8),
            *sf.modes(NOMINAL, stiffness, 9.8).eigenvalues,
        )

    rng = np.random.default_rng(13)
    with jax.enable_x64(True):
        traced = jax.jit(everything)
        for _ in range(40):
            K = sf.Stiffness(*random_coupled(rng).joints)
            assert not K.is_coupled
            found = np.array(traced(K))
            np.testing.assert_allclose(found, np.array(everything(K), float), rtol=1e-9)


GRADIENT_RTOL = 1e-6  # central differences in steps of 1e-5
MARGINS = {
    "safety_factor": sf.safety_factor,
    "stiffness_reserve": sf.stiffness_reserve,
    "stability_determinant": sf.stability_determinant,
    "eigenvalue_1": lambda *person: sf.modes(*person).eigenvalues[0],
    "hip_ankle_ratio": lambda *person: sf.modes(*person).shapes[2, 0],
    "critical_ankle_stiffness": lambda *person: sf.critical_stiffness(*person).ankle,
    "critical_knee_stiffness": lambda *person: sf.critical_stiffness(*person).knee,
    "critical_hip_stiffness": lambda *person: sf.critical_stiffness(*person).hip,
}
PERSONS = {
    "stands": (1100.0, 2000.0, 500.0, 30.0, -20.0, 50.0),
    "falls": (700.0, 1500.0, 300.0, 30.0, 20.0, 10.0),
    "rigid knee": (1100.0, math.inf, 500.0, 30.0, 20.0, 50.0),
    "nothing couples": (1100.0, 2000.0, 500.0, 0.0, 0.0, 0.0),
}


@pytest.mark.parametrize("name", MARGINS)
def test_derivatives_are_those_of_differences(name):
    def value(x):
        return MARGINS[name](NOMINAL, sf.Stiffness(*x), 9.8)

    at = np.array(list(PERSONS.values()))
    sizes = 1e-5 * np.maximum(np.where(np.isfinite(at), abs(at), 0.0), 100.0)
    steps = sizes[:, :, None] * np.eye(6)
    with jax.enable_x64(True):  # all at once, and not compiled, which would take longer
        slopes = np.asarray(jax.vmap(jax.grad(value))(at))
        places = np.concatenate([at[:, None] + steps, at[:, None] - steps]).reshape(-1, 6)
        up, down = np.asarray(jax.vmap(value)(places)).reshape(2, *at.shape)
        here = np.asarray(jax.vmap(value)(at))
    assert np.isfinite(slopes).all()
    compared = 0
    for person, i in itertools.product(range(len(at)), range(6)):
        if math.isinf(at[person, i]):
            assert slopes[person, i] == 0.0
        elif math.isfinite(here[person]):
            wanted = (up[person, i] - down[person, i]) / (2.0 * sizes[person, i])
            least = 1e-9 * abs(here[person]) / 100.0
            assert slopes[person, i] == pytest.approx(wanted, rel=GRADIENT_RTOL, abs=least)
            compared += 1
    assert compared >= 11


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


def test_energy_and_moments_are_those_of_k():
    K = sf.Stiffness(900.0, 2000.0, 500.0, ankle_knee=40.0, knee_hip=30.0, ankle_hip=-20.0)
    plain = sf.Stiffness(*K.joints)
    q = (0.1, -0.2, 0.3)
    k = np.array([[0.0, 40.0, -20.0], [40.0, 0.0, 30.0], [-20.0, 30.0, 0.0]])
    more = sf.potential_energy(NOMINAL, K, q, 9.8) - sf.potential_energy(NOMINAL, plain, q, 9.8)
    assert more == pytest.approx(0.5 * np.array(q) @ k @ np.array(q), rel=1e-12)
    motion = (q, (1.0, 2.0, -1.0), (3.0, 0.0, 2.0))
    moments = sf.joint_moments(NOMINAL, K, *motion, 9.8)
    np.testing.assert_allclose(
        moments - sf.joint_moments(NOMINAL, plain, *motion, 9.8), k @ np.array(q), rtol=1e-9
    )
    # near upright they are C q
    small = np.array([1e-7, 2e-7, -1e-7])
    still = sf.joint_moments(NOMINAL, K, tuple(small), (0.0,) * 3, (0.0,) * 3, 9.8)
    np.testing.assert_allclose(still, sf.stiffness_matrix(NOMINAL, K, 9.8) @ small, rtol=1e-9)


def test_the_rows_of_c_trace_as_they_are():
    with jax.enable_x64(True):
        K = sf.Stiffness(900.0, 2000.0, 500.0, 40.0, 30.0, -20.0)
        rows = jax.jit(lambda k: stiffness_rows(NOMINAL, k, 9.8))(K)
    np.testing.assert_allclose(np.array(rows), sf.stiffness_matrix(NOMINAL, K, 9.8), rtol=1e-14)
