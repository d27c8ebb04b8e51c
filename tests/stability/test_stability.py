"""The verdict and its margins against minors, LAPACK and exact rational arithmetic."""

import itertools
import math
from fractions import Fraction

import jax
import mpmath
import numpy as np
import pytest
import scipy.linalg
from hypothesis import given, settings
from hypothesis import strategies as st

import standfast as sf
from minors import stands_by_minors
from people import person_of, random_body, random_gravity, random_stiffness
from standfast.parameters import JOINTS
from standfast.stability import rounding, springs

CASES = 1_000_000
PARTS = 8
# LAPACK's error is some ulp of the largest eigenvalue: closer to 0 it cannot tell the sign.
LAPACK_DOUBT = 1e-13
EXACT_CASES = 12_000
ULPS = 4


def million(part: int):
    """An eighth of the million: bodies of all models, rigid joints in every combination."""
    rng = np.random.default_rng((2007, part))
    size = CASES // PARTS
    people = [random_body(rng) for _ in range(1000)]
    bodies = tuple(
        np.stack(leaf)[rng.integers(1000, size=size)] for leaf in zip(*people, strict=True)
    )
    stiffness = 10.0 ** rng.uniform(2.0, 4.0, (3, size))
    stiffness[rng.random((3, size)) < 0.15] = math.inf
    return (*bodies, *stiffness, rng.uniform(1.6, 15.0, size))


@jax.jit
@jax.vmap
def evaluate(*leaves):
    body, stiffness, gravity = person_of(*leaves)
    return (
        springs.verdict(body, stiffness, gravity),
        sf.inertia_matrix(body),
        sf.stiffness_matrix(body, stiffness, gravity),
    )


def lapack_signs(a, c, rigid):
    """Smallest and largest eigenvalue by LAPACK, all matrices at once, rigid joints struck out.

    C v = λ A v becomes L⁻¹C L⁻ᵀ w = λ w with A = L Lᵀ, as LAPACK's own generalized driver does.
    """
    lowest, highest = np.full(len(a), np.inf), np.full(len(a), np.inf)
    for pattern in itertools.product((False, True), repeat=3):
        free = [joint for joint in range(3) if not pattern[joint]]
        rows = np.flatnonzero((rigid == pattern).all(axis=1))
        if free and rows.size:
            keep = np.ix_(rows, free, free)
            root = np.linalg.cholesky(a[keep])
            half = np.linalg.solve(root, c[keep])
            values = np.linalg.eigvalsh(np.linalg.solve(root, half.transpose(0, 2, 1)))
            lowest[rows], highest[rows] = values[:, 0], np.abs(values).max(axis=1)
    return lowest, highest


@pytest.mark.parametrize("part", range(PARTS))
def test_carried_load_verdict_is_that_of_minors_and_of_lapack(part):
    leaves = million(part)
    verdict, a, c = (np.array(result) for result in evaluate(*leaves))
    rigid = np.isinf(np.column_stack(leaves[4:7]))
    lowest, highest = lapack_signs(a, c, rigid)
    clear = np.isinf(lowest) | (np.abs(lowest) > LAPACK_DOUBT * highest)
    assert clear.mean() > 0.9999
    np.testing.assert_array_equal(verdict[clear], lowest[clear] > 0.0)
    np.testing.assert_array_equal(verdict[clear], stands_by_minors(c)[clear])
    assert 0.2 < verdict.mean() < 0.8
    # calls of one person, in NumPy, say the same
    for number in range(0, CASES // PARTS, 500):
        person = person_of(*(leaf[number] for leaf in leaves))
        assert sf.is_stable(*person) == verdict[number]
    # the oracle can fail: one entry of C wrong by a hundredth
    c[:, 0, 1] *= 1.01
    c[:, 1, 0] *= 1.01
    sample = slice(0, 3000)
    wrong, _ = lapack_signs(a[sample], c[sample], rigid[sample])
    assert (verdict[sample] != (wrong > 0.0)).any()
    assert (verdict[sample] != stands_by_minors(c[sample])).any()


def exact_loads(body, stiffness, gravity):
    """L1, L2, L3 in rational arithmetic; None below a joint that fails."""
    ms, mt, mb = map(Fraction, body.segment_mass)
    hs, ht = map(Fraction, body.segment_length)
    es, et, eb = map(Fraction, body.segment_com)
    g = Fraction(gravity)
    loads = [g * mb * eb]
    for own, joint in (
        (g * (mt * et + mb * ht), stiffness.hip),
        (g * (ms * es + (mt + mb) * hs), stiffness.knee),
    ):
        load = loads[0]
        if load is None or (math.isfinite(joint) and Fraction(joint) <= load):
            loads.insert(0, None)
        elif math.isinf(joint):
            loads.insert(0, own + load)
        else:
            loads.insert(0, own + load * Fraction(joint) / (Fraction(joint) - load))
    return loads


def exact_gravity(body, gravity):
    """G1, G2, G3, the gravity part of C, as fractions."""
    g = Fraction(gravity)
    ms, mt, mb = map(Fraction, body.segment_mass)
    hs, ht = map(Fraction, body.segment_length)
    es, et, eb = map(Fraction, body.segment_com)
    shank, thigh, upper = g * (ms * es + (mt + mb) * hs), g * (mt * et + mb * ht), g * mb * eb
    return shank + thigh + upper, thigh + upper, upper


def exact_verdict(body, stiffness, gravity):
    """Sylvester's criterion in rational arithmetic, rigid joints struck out."""
    sums = exact_gravity(body, gravity)
    free = [n for n in range(3) if math.isfinite(stiffness[n])]
    c = [[(Fraction(stiffness[i]) if i == j else 0) - sums[max(i, j)] for j in free] for i in free]
    # elimination without pivoting meets the ratios of the leading minors
    for n in range(len(c)):
        if c[n][n] <= 0:
            return False
        for i in range(n + 1, len(c)):
            factor = c[i][n] / c[n][n]
            c[i] = [x - factor * y for x, y in zip(c[i], c[n], strict=True)]
    return True


def exact_threshold(body, stiffness, gravity, joint):
    """The joint's threshold as a fraction: det C is linear in its stiffness."""

    def determinant(k):
        sums = exact_gravity(body, gravity)
        springs = stiffness._replace(**{joint: k}).joints
        free = [n for n, spring in enumerate(springs) if math.isfinite(spring)]
        springs = [Fraction(s) if math.isfinite(s) else None for s in springs]
        c = [[(springs[i] if i == j else 0) - sums[max(i, j)] for j in free] for i in free]
        if len(c) == 1:
            return c[0][0]
        if len(c) == 2:
            return c[0][0] * c[1][1] - c[0][1] ** 2
        (c11, c12, c13), (_, c22, c23), (_, _, c33) = c
        return (
            c11 * (c22 * c33 - c23**2)
            - c12 * (c12 * c33 - c23 * c13)
            + c13 * (c12 * c23 - c22 * c13)
        )

    at_zero = determinant(Fraction(0))
    return -at_zero / (determinant(Fraction(1)) - at_zero)


def exact_case(number: int):
    """Body, stiffness, gravity, and the distance to a joint's threshold in ulp (None if random).

    Every third case is put within 4 ulp of the exact threshold of one joint.
    """
    rng = np.random.default_rng((7, number))
    while True:
        body, gravity = random_body(rng), random_gravity(rng)
        stiffness = sf.Stiffness(*10.0 ** rng.uniform(2.3, 4.0, 3))
        if number % 2:
            stiffness = stiffness._replace(**{rng.choice(["ankle", "knee", "hip"]): math.inf})
        if number % 3:
            return body, stiffness, gravity, None
        joint = rng.choice([name for name in JOINTS if math.isfinite(getattr(stiffness, name))])
        if math.isinf(getattr(sf.critical_stiffness(body, stiffness, gravity), joint)):
            continue
        exact = exact_threshold(body, stiffness, gravity, joint)
        nearest = float(exact)
        at = nearest + rng.integers(1 - ULPS, ULPS) * np.spacing(nearest)
        distance = abs(Fraction(at) - exact) / Fraction(np.spacing(nearest))
        return body, stiffness._replace(**{joint: float(at)}), gravity, float(distance)


@pytest.fixture(scope="module")
def exact_cases():
    return [exact_case(number) for number in range(EXACT_CASES)]


def test_verdict_differs_from_exact_arithmetic_only_within_the_stated_bound(exact_cases):
    wrong = near = caught = 0
    for number, (body, stiffness, gravity, ulps) in enumerate(exact_cases):
        exact = exact_verdict(body, stiffness, gravity)
        certain = sf.verdict_is_certain(body, stiffness, gravity)
        if ulps is None:
            # the bound is not an excuse: away from the threshold everything is certain
            assert certain
        else:
            near += ulps <= ULPS
        if sf.is_stable(body, stiffness, gravity) != exact:
            wrong += 1
            assert not certain
        if number % 40 == 1:
            # the oracle can fail: the upper body a tenth too heavy
            heavier = body._replace(segment_mass=body.segment_mass * [1.0, 1.0, 1.1])
            caught += exact_verdict(heavier, stiffness, gravity) != exact
    assert near >= EXACT_CASES // 3
    assert wrong > 100  # the cases do probe rounding
    assert caught > 5


def test_the_rounding_bound_of_the_loads_is_honest_and_tight(exact_cases):
    largest = 0.0
    for body, stiffness, gravity, _ in exact_cases:
        ours = springs.carried_loads(body, stiffness, gravity)
        bounds = rounding.load_rounding(body, stiffness, gravity)
        for load, bound, exact in zip(
            ours, bounds, exact_loads(body, stiffness, gravity), strict=True
        ):
            if exact is None or math.isinf(bound):
                continue
            used = float(abs(Fraction(float(load)) - exact)) / bound
            assert used <= 1.0
            largest = max(largest, used)
    # a bound ten times smaller would be broken, so the check above can fail
    assert largest > 0.1


def test_the_determinant_is_the_product_of_the_margins():
    rng = np.random.default_rng(11)
    for _ in range(300):
        body, stiffness, gravity = random_body(rng), random_stiffness(rng), random_gravity(rng)
        loads = springs.carried_loads(body, stiffness, gravity)
        if not np.isfinite(loads).all():
            continue
        c = sf.stiffness_matrix(body, stiffness, gravity)
        product = math.prod(k - load for k, load in zip(stiffness.joints, loads, strict=True))
        scale = 1e-13 * abs(np.prod(np.abs(c).sum(axis=1)))
        ours = sf.stability_determinant(body, stiffness, gravity)
        assert ours == pytest.approx(np.linalg.det(c), abs=scale)
        assert ours == pytest.approx(product, rel=1e-9, abs=scale)


def test_the_determinant_of_a_rigid_joint_is_infinite_with_the_sign_of_the_rest():
    body = sf.Body.edwards2007()
    assert sf.stability_determinant(body, sf.Stiffness(math.inf, 2000.0, 738.0)) == math.inf
    assert sf.stability_determinant(body, sf.Stiffness(700.0, math.inf, math.inf)) == -math.inf


def test_each_critical_stiffness_switches_the_verdict():
    rng = np.random.default_rng(12)
    switched = 0
    for _ in range(500):
        body, gravity = random_body(rng), random_gravity(rng)
        stiffness = random_stiffness(rng, rigid_share=0.2)
        limits = sf.critical_stiffness(body, stiffness, gravity).joints
        for joint, threshold in zip(JOINTS, limits, strict=True):
            if math.isinf(threshold):
                assert not sf.is_stable(body, stiffness._replace(**{joint: 1e12}), gravity)
                continue
            switched += 1
            above = stiffness._replace(**{joint: threshold * (1.0 + 1e-9)})
            below = stiffness._replace(**{joint: threshold * (1.0 - 1e-9)})
            assert sf.is_stable(body, above, gravity)
            assert not sf.is_stable(body, below, gravity)
    assert switched > 300


def test_reserve_is_the_smallest_eigenvalue_of_c():
    rng = np.random.default_rng(13)
    noticed = 0
    for _ in range(500):
        body, gravity = random_body(rng), random_gravity(rng)
        stiffness = random_stiffness(rng, rigid_share=0.2)
        free = np.flatnonzero(np.isfinite(stiffness.joints))
        reserve = sf.stiffness_reserve(body, stiffness, gravity)
        if free.size == 0:
            assert reserve == math.inf
            continue
        c = sf.stiffness_matrix(body, stiffness, gravity)[np.ix_(free, free)]
        expected = scipy.linalg.eigvalsh(c)
        close = 1e-13 * np.abs(expected).max()
        assert reserve == pytest.approx(expected[0], abs=close)
        c[0, 0] *= 1.0 + 1e-6  # the oracle can fail
        noticed += abs(reserve - scipy.linalg.eigvalsh(c)[0]) > close
        assert (reserve > 0.0) == sf.is_stable(body, stiffness, gravity)
    assert noticed > 300


def test_safety_factor_is_the_smallest_eigenvalue_of_springs_against_gravity():
    rng = np.random.default_rng(14)
    noticed = 0
    for _ in range(500):
        body, gravity = random_body(rng), random_gravity(rng)
        stiffness = random_stiffness(rng, rigid_share=0.2)
        free = np.flatnonzero(np.isfinite(stiffness.joints))
        factor = sf.safety_factor(body, stiffness, gravity)
        if free.size == 0:
            assert factor == math.inf
            continue
        keep = np.ix_(free, free)
        springs = np.diag(np.array(stiffness.joints)[free])
        load = -sf.stiffness_matrix(body, sf.Stiffness(0.0, 0.0, 0.0), gravity)[keep]
        expected = scipy.linalg.eigh(springs, load, eigvals_only=True)[0]
        assert factor == pytest.approx(expected, rel=1e-10)
        load[0, 0] *= 1.0 + 1e-6  # the oracle can fail
        wrong = scipy.linalg.eigh(springs, load, eigvals_only=True)[0]
        noticed += abs(wrong / expected - 1.0) > 1e-10
        assert (factor > 1.0) == sf.is_stable(body, stiffness, gravity)
        divided = sf.Stiffness(*(k / factor for k in stiffness.joints))
        assert sf.stiffness_reserve(body, divided, gravity) == pytest.approx(0.0, abs=1e-9)
    assert noticed > 400


# Measured: 6e-16 at worst.
SAFETY_RTOL = 5e-15


def test_safety_factor_has_all_its_digits():
    """Against the largest eigenvalue of K^-1/2 G K^-1/2 to 40 digits."""
    rng = np.random.default_rng(15)
    exact = mpmath.MPContext()
    exact.dps = 40
    worst = 0
    for _ in range(200):
        body, gravity = random_body(rng), random_gravity(rng)
        stiffness = random_stiffness(rng, rigid_share=0.0)
        (ms, mt, mb), (hs, ht), (es, et, eb), g = (
            [exact.mpf(float(number)) for number in np.atleast_1d(numbers)]
            for numbers in (body.segment_mass, body.segment_length, body.segment_com, gravity)
        )
        thigh, upper = g[0] * (mt * et + mb * ht), g[0] * mb * eb
        loads = [g[0] * (ms * es + (mt + mb) * hs) + thigh + upper, thigh + upper, upper]
        roots = [exact.sqrt(exact.mpf(float(k))) for k in stiffness.joints]
        matrix = exact.matrix(3, 3)
        for i in range(3):
            for j in range(3):
                matrix[i, j] = loads[max(i, j)] / (roots[i] * roots[j])
        expected = 1 / max(exact.eigsy(matrix, eigvals_only=True))
        factor = exact.mpf(float(sf.safety_factor(body, stiffness, gravity)))
        assert abs(factor / expected - 1) < SAFETY_RTOL
        matrix[2, 2] *= 1 + exact.mpf(10) ** -9  # the oracle can fail
        worst = max(worst, abs(factor * max(exact.eigsy(matrix, eigvals_only=True)) - 1))
    assert worst > SAFETY_RTOL


def test_a_free_joint_has_no_safety():
    body = sf.Body.edwards2007()
    stiffness = sf.Stiffness(0.0, math.inf, 500.0)
    assert sf.safety_factor(body, stiffness) == pytest.approx(0.0, abs=1e-15)
    assert not sf.is_stable(body, stiffness)


stiffnesses = st.floats(0.0, 1e5) | st.just(math.inf)
people = st.builds(
    lambda height, bmi, model: sf.Body.from_height_mass(height, bmi * height**2, model),
    st.floats(1.0, 2.2),
    st.floats(6.0, 130.0),
    st.sampled_from(sf.BODY_MODELS),
)


@settings(max_examples=300, deadline=None, derandomize=True)
@given(
    people, st.tuples(stiffnesses, stiffnesses, stiffnesses), st.tuples(*[st.floats(1.0, 10.0)] * 3)
)
def test_stiffening_never_destabilises(body, values, factors):
    softer = sf.Stiffness(*values)
    stiffer = sf.Stiffness(*(k * factor for k, factor in zip(values, factors, strict=True)))
    assert sf.is_stable(body, stiffer) or not sf.is_stable(body, softer)
    assert sf.stiffness_reserve(body, stiffer) >= sf.stiffness_reserve(body, softer) - 1e-9


@settings(max_examples=200, deadline=None, derandomize=True)
@given(people, st.floats(100.0, 3000.0))
def test_the_rigid_limit_is_the_inverted_pendulum(body, ankle):
    heights = np.array([0.0, body.segment_length[0], body.segment_length.sum()]) + body.segment_com
    toppling = 9.8 * float(body.segment_mass @ heights)
    pendulum = sf.Stiffness(ankle, math.inf, math.inf)
    assert sf.critical_stiffness(body, pendulum, 9.8).ankle == pytest.approx(toppling, rel=1e-14)
    omega2 = (ankle - toppling) / float(sf.inertia_matrix(body)[0, 0])
    assert sf.modes(body, pendulum, 9.8).eigenvalues[0] == pytest.approx(
        omega2, rel=1e-9, abs=1e-10
    )


@settings(max_examples=100, deadline=None, derandomize=True)
@given(people, st.tuples(stiffnesses, stiffnesses, stiffnesses), st.floats(0.5, 2.0))
def test_stiffness_in_proportion_to_weight_leaves_the_verdict(body, values, heavier):
    """Twice the mass needs twice the stiffness and then has the same safety factor."""
    heavy = body._replace(segment_mass=body.segment_mass * heavier)
    factor = sf.safety_factor(body, sf.Stiffness(*values))
    scaled = sf.safety_factor(heavy, sf.Stiffness(*(k * heavier for k in values)))
    assert scaled == pytest.approx(factor, rel=1e-12, abs=1e-12)
