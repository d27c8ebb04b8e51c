"""Coupled joints: every quantity against LAPACK and against what must hold of it."""

import itertools
import math

import jax
import numpy as np
import pytest
import scipy.linalg

import standfast as sf
from coupled_people import cases, largest, plain_matrices, random_coupled
from standfast.mechanics.matrices import stiffness_rows
from standfast.parameters import COUPLED_JOINTS, JOINTS

NOMINAL = sf.Body.edwards2007()

# LAPACK's absolute error of an eigenvalue is some roundings of the largest one.
LAPACK = 1e-13
# Relative, of quantities away from 0: a few hundred roundings where K - G cancels.
RTOL = 1e-10


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
