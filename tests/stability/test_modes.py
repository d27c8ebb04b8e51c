"""Eigenvalues and shapes against mpmath at 50 digits, from the same body, stiffness and gravity."""

import functools
import math

import jax
import mpmath
import numpy as np
import pytest
import scipy.linalg
import scipy.optimize

import standfast as sf
from people import batch, person_of, random_body, random_gravity, random_stiffness
from standfast.mechanics.matrices import second_variation
from standfast.stability.fast import fast_eigenvalues, fast_reserve
from standfast.stability.margins import stiffness_reserve as reserve
from standfast.stability.modes import frequency_of, growth_rate_of, modes
from standfast.stability.springs import verdict

DIGITS = 50
# The promise; measured: 9e-16 at worst, over all kinds below.
EIGENVALUE_RTOL = 1e-12
# λ₁ keeps its relative digits down to this share of the largest eigenvalue.
NEAR_ZERO = 1e-6
# Measured: 4e-11 at worst, for joints of 10⁹ N·m/rad beside joints of 10.
SHAPE_ATOL = 1e-10
# Between 10⁹ and 10¹² N·m/rad the two upper modes mix: 2e-8 at worst. No eigenvalue suffers.
EXTREME_SHAPE_ATOL = 1e-7
CASES = 300
# Measured: 0.16 where all joints are far softer than their loads, 0.002 to 0.05 elsewhere.
MOST_IN_DOUBT = 0.2


def exact_modes(body, stiffness, gravity, *, perturbed=0.0):
    """Ascending eigenvalues and unit shapes (columns) by mpmath, rigid joints struck out."""
    with mpmath.workdps(DIGITS):
        ms, mt, mb = (mpmath.mpf(float(x)) for x in body.segment_mass)
        hs, ht = (mpmath.mpf(float(x)) for x in body.segment_length)
        es, et, eb = (mpmath.mpf(float(x)) for x in body.segment_com)
        g = mpmath.mpf(float(gravity))
        arms = mpmath.matrix([[es, 0, 0], [hs, et, 0], [hs, ht, eb]])
        to_segments = mpmath.matrix([[1, 0, 0], [1, 1, 0], [1, 1, 1]])
        inertias = mpmath.diag([mpmath.mpf(float(x)) for x in body.segment_inertia])
        m = arms.T * mpmath.diag([ms, mt, mb]) * arms + inertias
        loads = mpmath.diag([ms * es + (mt + mb) * hs, mt * et + mb * ht, mb * eb]) * g
        a = to_segments.T * m * to_segments
        c = -to_segments.T * loads * to_segments
        free = [joint for joint in range(3) if math.isfinite(stiffness[joint])]
        for joint in free:
            c[joint, joint] += mpmath.mpf(float(stiffness[joint]))
        a[0, 0] *= 1 + mpmath.mpf(perturbed)
        a = mpmath.matrix([[a[i, j] for j in free] for i in free])
        c = mpmath.matrix([[c[i, j] for j in free] for i in free])
        inverse = mpmath.cholesky(a) ** -1
        values, vectors = mpmath.eigsy(inverse * c * inverse.T)
        vectors = inverse.T * vectors
        shapes = np.zeros((3, len(free)))
        for column in range(len(free)):
            shapes[free, column] = [float(vectors[row, column]) for row in range(len(free))]
        return list(values), shapes / np.linalg.norm(shapes, axis=0)


def usual(rng):
    return random_body(rng), random_stiffness(rng), random_gravity(rng)


def rigid(rng):
    stiffness = random_stiffness(rng, rigid_share=0.5)
    if not np.isfinite(stiffness.joints).any():
        stiffness = stiffness._replace(ankle=800.0)
    return random_body(rng), stiffness, random_gravity(rng)


def stiff(rng):
    return random_body(rng), sf.Stiffness(*10.0 ** rng.uniform(1.0, 9.0, 3)), random_gravity(rng)


def extreme(rng):
    return random_body(rng), sf.Stiffness(*10.0 ** rng.uniform(1.0, 12.0, 3)), random_gravity(rng)


def soft(rng):
    values = rng.uniform(0.0, 200.0, 3) * (rng.random(3) < 0.7)
    return random_body(rng), sf.Stiffness(*values), random_gravity(rng)


def near_zero(rng):
    """λ₁ from a hundredth of the largest eigenvalue down to rounding, on both sides."""
    threshold = math.inf
    while math.isinf(threshold):
        body, stiffness, gravity = usual(rng)
        joint = rng.choice(["ankle", "knee", "hip"])
        threshold = getattr(sf.critical_stiffness(body, stiffness, gravity), joint)
    off = rng.choice([-1.0, 1.0]) * 10.0 ** rng.uniform(-16.0, -2.0)
    return body, stiffness._replace(**{joint: threshold * (1.0 + off)}), gravity


def near_equal(rng):
    """Two eigenvalues as close as a search brings them (a share of 10⁻⁸ and less), then pulled
    apart by a random share of that down to 10⁻¹⁶."""
    body, gravity = random_body(rng), random_gravity(rng)
    pair = rng.integers(2)
    inertia = sf.inertia_matrix(body)
    toppling = sf.stiffness_matrix(body, sf.Stiffness(0.0, 0.0, 0.0), gravity)

    def gap(logs):
        springs = np.diag(np.exp(np.clip(logs, 0.0, 10.0)))
        values = scipy.linalg.eigh(toppling + springs, inertia, eigvals_only=True)
        return (values[pair + 1] - values[pair]) / abs(values).max()

    found = scipy.optimize.minimize(
        gap,
        rng.uniform(4.0, 8.0, 3),
        method="Nelder-Mead",
        options={"xatol": 1e-10, "fatol": 1e-14, "maxfev": 400},
    )
    off = 10.0 ** rng.uniform(-16.0, -3.0, 3) * rng.choice([-1.0, 1.0], 3)
    return body, sf.Stiffness(*(np.exp(np.clip(found.x, 0.0, 10.0)) * (1.0 + off))), gravity


KINDS = {
    "usual": (usual, CASES),
    "rigid": (rigid, CASES),
    "stiff": (stiff, CASES),
    "extreme": (extreme, CASES),
    "soft": (soft, CASES),
    "near_zero": (near_zero, 3 * CASES),
    "near_equal": (near_equal, 30),
}


@functools.cache
def cases_of(kind):
    """Persons of a kind, each with its exact eigenvalues and shapes."""
    make, count = KINDS[kind]
    rng = np.random.default_rng((2007, list(KINDS).index(kind)))
    cases = [make(rng) for _ in range(count)]
    return cases, [exact_modes(*case) for case in cases]


@jax.jit
@jax.vmap
def traced_modes(*leaves):
    person = person_of(*leaves)
    return sf.modes(*person), verdict(*person)


def wrong_eigenvalues(ours, exact):
    """Return the largest relative error of λ₂, λ₃, and of λ₁ where the promise holds for it."""
    worst = 0.0
    for number, value in enumerate(exact):
        if number == 0 and abs(value) <= NEAR_ZERO * abs(exact[-1]):
            continue
        worst = max(worst, float(abs((mpmath.mpf(float(ours[number])) - value) / value)))
    return worst


@pytest.mark.parametrize("kind", KINDS)
def test_eigenvalues_and_shapes_of_plain_and_traced_calls(kind):
    shape_atol = EXTREME_SHAPE_ATOL if kind == "extreme" else SHAPE_ATOL
    cases, exact_ones = cases_of(kind)
    count = len(cases)
    traced, verdicts = traced_modes(*batch(cases))
    for number, (case, (exact, shapes)) in enumerate(zip(cases, exact_ones, strict=True)):
        results = (
            (sf.modes(*case), sf.is_stable(*case)),
            (sf.Modes(*(np.asarray(leaf)[number] for leaf in traced)), verdicts[number]),
        )
        gaps = np.diff([float(value) for value in exact]) / float(max(map(abs, exact)))
        for result, stable in results:
            assert wrong_eigenvalues(result.eigenvalues, exact) <= EIGENVALUE_RTOL
            assert (result.eigenvalues[0] > 0.0) == stable
            assert np.isinf(result.eigenvalues[len(exact) :]).all()
            assert (result.shapes[:, len(exact) :] == 0.0).all()
            for column in range(len(exact)):
                unit = result.shapes[:, column] / np.linalg.norm(result.shapes[:, column])
                off = min(
                    np.abs(unit - shapes[:, column]).max(), np.abs(unit + shapes[:, column]).max()
                )
                # a vector is as well defined as its eigenvalue is apart from its neighbours
                nearest = min(gaps[max(column - 1, 0) : column + 1], default=1.0)
                assert off <= max(shape_atol, 1e-12 / max(nearest, 1e-300))
    if kind == "near_zero":
        assert sum(abs(exact[0]) < 1e-3 * exact[-1] for exact, _ in exact_ones) > count // 2
    if kind == "near_equal":
        gaps = [np.diff(exact).min() / max(map(abs, exact)) for exact, _ in exact_ones]
        assert sum(gap < 1e-4 for gap in gaps) > count // 3


def test_the_oracle_notices_one_perturbed_entry():
    rng = np.random.default_rng(1)
    for _ in range(20):
        case = usual(rng)
        exact, shapes = exact_modes(*case, perturbed=1e-7)
        ours = sf.modes(*case)
        assert wrong_eigenvalues(ours.eigenvalues, exact) > EIGENVALUE_RTOL
        units = ours.shapes / np.linalg.norm(ours.shapes, axis=0)
        assert np.abs(np.abs(units) - np.abs(shapes)).max() > SHAPE_ATOL


def test_shapes_satisfy_the_equations():
    rng = np.random.default_rng(2)
    for _ in range(300):
        case = body, stiffness, gravity = usual(rng)
        a, c = sf.inertia_matrix(body), sf.stiffness_matrix(body, stiffness, gravity)
        values, shapes = sf.modes(*case)
        left, right = c @ shapes, a @ shapes * values
        scale = np.abs(c) @ np.abs(shapes) + np.abs(a) @ np.abs(shapes) * np.abs(values)
        assert (np.abs(left - right) <= 1e-10 * scale.max(axis=0)).all()
        np.testing.assert_array_equal(shapes[0], 1.0)


def test_a_rigid_joint_is_the_limit_of_a_stiff_one():
    body = sf.Body.edwards2007()
    rigid_knee = sf.modes(body, sf.Stiffness(950.0, math.inf, 738.0))
    stiff_knee = sf.modes(body, sf.Stiffness(950.0, 1e12, 738.0))
    np.testing.assert_allclose(stiff_knee.eigenvalues[:2], rigid_knee.eigenvalues[:2], rtol=1e-8)
    np.testing.assert_allclose(stiff_knee.shapes[:, :2], rigid_knee.shapes[:, :2], atol=1e-8)


def test_without_a_flexible_joint_nothing_moves():
    everything_rigid = sf.Stiffness(math.inf, math.inf, math.inf)
    result = sf.modes(sf.Body.edwards2007(), everything_rigid)
    assert np.isposinf(result.eigenvalues).all()
    assert (result.shapes == 0.0).all()


def test_similar_bodies_scale():
    """Twice the size at the same density: mass 8, stiffness 16, λ one half."""
    rng = np.random.default_rng(3)
    for _ in range(50):
        stiffness = random_stiffness(rng)
        small = sf.modes(sf.Body.from_height_mass(1.2, 30.0), stiffness)
        large = sf.modes(
            sf.Body.from_height_mass(2.4, 240.0),
            sf.Stiffness(*(16.0 * k for k in stiffness.joints)),
        )
        np.testing.assert_allclose(large.eigenvalues, small.eigenvalues / 2.0, rtol=1e-12)
        np.testing.assert_allclose(large.shapes, small.shapes, rtol=1e-9, atol=1e-12)


def test_frequency_keeps_the_sign_and_growth_rate_is_zero_when_stable():
    assert frequency_of(math.tau**2) == pytest.approx(1.0)
    assert frequency_of(-(math.tau**2)) == pytest.approx(-1.0)
    assert growth_rate_of(-4.0) == 2.0
    assert growth_rate_of(4.0) == 0.0
    for ankle, sign in ((1200.0, 1.0), (700.0, -1.0)):
        person = (sf.Body.edwards2007(), sf.Stiffness(ankle, 2000.0, 738.0))
        least = float(sf.modes(*person, gravity=9.8).eigenvalues[0])
        assert math.copysign(1.0, least) == sign
        assert sf.frequency(*person, gravity=9.8) == sign * math.sqrt(abs(least)) / math.tau
        assert sf.growth_rate(*person, gravity=9.8) == math.sqrt(max(-least, 0.0))


def test_the_energy_of_the_neutral_mode_vanishes():
    """On the threshold springs and gravity cancel to 32 digits of which float64 keeps 16."""
    body = sf.Body.edwards2007()
    ankle, hip = sf.equal_rotation(body, 1000.0, 9.8)
    x = (433.8432952 + 180.1895424) / (1000.0 - 433.8432952)
    energy = second_variation(body, sf.Stiffness(ankle, 1000.0, hip), 9.8, (1.0, x, 1.0))
    assert energy == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("kind", KINDS)
def test_fast_eigenvalues_are_right_or_uncertain(kind):
    """Also near 0 without any exception: there they are in doubt."""
    cases, exact_ones = cases_of(kind)
    count = len(cases)
    doubts, ignored = 0, 0.0
    for case, (exact, _) in zip(cases, exact_ones, strict=True):
        found, doubt = fast_eigenvalues(*case)
        errors = [
            float(abs((mpmath.mpf(float(ours)) - value) / value)) if value else math.inf
            for ours, value in zip(found.eigenvalues, exact, strict=False)
        ]
        doubts += bool(doubt)
        assert doubt or np.isfinite(case[1]).all()
        if doubt:
            ignored = max(ignored, *errors)
        else:
            assert max(errors) < EIGENVALUE_RTOL
    if kind == "usual":
        assert doubts < 0.2 * count  # these bodies and stiffnesses are more various than people
    if kind == "near_zero":  # the doubt is needed
        assert ignored > 100.0 * EIGENVALUE_RTOL


@jax.jit
@jax.vmap
def fast_and_reference(ankle, knee, hip):
    body = sf.Body.from_height_mass(1.6, 95.0, model="de-leva-female")
    of = (body, sf.Stiffness(ankle, knee, hip), 9.81)
    return fast_eigenvalues(*of), modes(*of).eigenvalues, fast_reserve(*of), reserve(*of)


@pytest.mark.parametrize(("least", "most"), [(-3, 3), (0, 2.5), (0, 5), (2, 4), (0, 9)])
def test_fast_ways_agree_with_the_references(least, most):
    """At many persons, in every manner of falling and standing."""
    rng = np.random.default_rng((2007, int(10 * most)))
    stiffness = (10.0 ** rng.uniform(least, most, 50_000) for _ in range(3))
    (fast, doubt), exact, (low, in_doubt), least_of_c = fast_and_reference(*stiffness)
    errors = np.abs(np.stack(fast.eigenvalues, axis=1) / exact - 1.0)[~np.asarray(doubt)]
    assert errors.max() < EIGENVALUE_RTOL
    assert np.abs(low / least_of_c - 1.0)[~np.asarray(in_doubt)].max() < EIGENVALUE_RTOL
    assert np.mean(doubt) < MOST_IN_DOUBT
    assert np.mean(in_doubt) < MOST_IN_DOUBT
