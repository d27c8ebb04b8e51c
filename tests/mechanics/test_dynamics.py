"""A, C and the nonlinear equations against a symbolic Lagrangian, MuJoCo and calculus."""

import math

import jax
import mujoco
import numpy as np
import pytest
import sympy

import standfast as sf
from people import random_body, random_gravity, random_stiffness
from standfast.mechanics import matrices

# MuJoCo works in double precision too; its own sums differ from ours by some ulp.
MULTIBODY_RTOL = 1e-12
# Derivatives by JAX are exact but for rounding of sums as large as the largest entry.
CALCULUS_RTOL = 1e-12
PERTURBATION = 1e-9


def symbolic_model():
    """Symbols, and A and C of a Lagrangian written from the positions of the centres of mass."""
    m, i, e = (
        sympy.symbols(f"{letter}_s {letter}_t {letter}_b", positive=True) for letter in "mIe"
    )
    h = sympy.symbols("h_s h_t", positive=True)
    k = sympy.symbols("K_a K_k K_h", positive=True)
    g = sympy.Symbol("g", positive=True)
    t = sympy.Symbol("t")
    q = [sympy.Function(name)(t) for name in ("q_a", "q_k", "q_h")]
    phi = [sum(q[: n + 1]) for n in range(3)]

    forward, up = sympy.S.Zero, sympy.S.Zero
    kinetic, potential = sympy.S.Zero, sympy.S.Zero
    for n in range(3):
        x = forward + e[n] * sympy.sin(phi[n])
        z = up + e[n] * sympy.cos(phi[n])
        kinetic += m[n] * (x.diff(t) ** 2 + z.diff(t) ** 2) / 2 + i[n] * phi[n].diff(t) ** 2 / 2
        potential += m[n] * g * z + k[n] * q[n] ** 2 / 2
        if n < 2:
            forward += h[n] * sympy.sin(phi[n])
            up += h[n] * sympy.cos(phi[n])
    rest = dict.fromkeys(q, 0)
    rates = [angle.diff(t) for angle in q]
    a = sympy.Matrix(3, 3, lambda r, c: kinetic.diff(rates[r], rates[c]).subs(rest))
    c = sympy.Matrix(3, 3, lambda r, c: potential.diff(q[r], q[c]).subs(rest))
    return sf.Body._make((m, i, h, e)), sf.Stiffness._make(k), g, a, c


def test_a_and_c_are_exactly_those_of_a_symbolic_lagrangian():
    body, stiffness, g, a, c = symbolic_model()
    ours_a = sympy.Matrix(sf.inertia_matrix(body))
    ours_c = sympy.Matrix(sf.stiffness_matrix(body, stiffness, g))
    assert (ours_a - a).applyfunc(sympy.expand) == sympy.zeros(3, 3)
    assert (ours_c - c).applyfunc(sympy.expand) == sympy.zeros(3, 3)
    # the oracle can fail
    ours_a[1, 2] += PERTURBATION
    assert (ours_a - a).applyfunc(sympy.expand) != sympy.zeros(3, 3)


def multibody(body: sf.Body, stiffness: sf.Stiffness, gravity: float):
    """The same person in MuJoCo: three hinges about the medio-lateral axis."""

    def link(n, inner):
        below = "0" if n == 0 else repr(float(body.segment_length[n - 1]))
        inertia = repr(float(body.segment_inertia[n]))
        return (
            f'<body pos="0 0 {below}">'
            f'<joint type="hinge" axis="0 1 0" stiffness="{float(stiffness[n])!r}"/>'
            f'<inertial pos="0 0 {float(body.segment_com[n])!r}" '
            f'mass="{float(body.segment_mass[n])!r}" diaginertia="{inertia} {inertia} {inertia}"/>'
            f"{inner}</body>"
        )

    tree = link(0, link(1, link(2, "")))
    model = mujoco.MjModel.from_xml_string(
        f'<mujoco><compiler angle="radian"/><option gravity="0 0 {-gravity!r}"/>'
        f"<worldbody>{tree}</worldbody></mujoco>"
    )
    return model, mujoco.MjData(model)


def multibody_matrices(body, stiffness, gravity):
    """A and C from MuJoCo, without differences: gravity's moment on a joint turned by 90° is its
    column of C exactly, because the sine of the segments above it is 1."""
    model, data = multibody(body, stiffness, gravity)
    mujoco.mj_forward(model, data)
    a = np.zeros((3, 3))
    mujoco.mj_fullM(model, data, a)
    columns = []
    for joint in range(3):
        data.qpos[:] = 0.0
        data.qpos[joint] = math.pi / 2
        mujoco.mj_forward(model, data)
        springs = np.zeros(3)
        springs[joint] = -data.qfrc_passive[joint] / (math.pi / 2)
        columns.append(data.qfrc_bias + springs)
    return a, np.column_stack(columns)


@pytest.mark.parametrize("model", sf.BODY_MODELS)
def test_a_and_c_are_those_of_an_independent_multibody_program(model):
    rng = np.random.default_rng(20070425)
    for _ in range(50):
        body, stiffness = random_body(rng, model), random_stiffness(rng)
        gravity = random_gravity(rng)
        a, c = multibody_matrices(body, stiffness, gravity)
        ours_a = sf.inertia_matrix(body)
        ours_c = sf.stiffness_matrix(body, stiffness, gravity)
        np.testing.assert_allclose(ours_a, a, rtol=MULTIBODY_RTOL, atol=0)
        # the diagonal is a difference, so its error scales with what is subtracted
        scale = MULTIBODY_RTOL * (np.abs(ours_c) + np.diag(stiffness.joints))
        assert (np.abs(ours_c - c) <= scale).all()


@pytest.mark.parametrize("entry", [(0, 0), (1, 2)])
def test_the_multibody_oracle_notices_one_perturbed_entry(entry):
    rng = np.random.default_rng(1)
    body, stiffness = random_body(rng), random_stiffness(rng)
    a, c = multibody_matrices(body, stiffness, 9.8)
    for ours, theirs in (
        (sf.inertia_matrix(body), a),
        (sf.stiffness_matrix(body, stiffness, 9.8), c),
    ):
        ours[entry] *= 1.0 + PERTURBATION
        with pytest.raises(AssertionError):
            np.testing.assert_allclose(ours, theirs, rtol=MULTIBODY_RTOL, atol=0)


def test_a_and_c_are_the_second_derivatives_of_the_energies():
    rng = np.random.default_rng(3)
    upright = np.zeros(3)
    for _ in range(5):
        body, stiffness = random_body(rng), random_stiffness(rng)
        a = jax.hessian(lambda rates, body=body: sf.kinetic_energy(body, upright, rates))(upright)
        c = jax.hessian(lambda q, body=body, k=stiffness: sf.potential_energy(body, k, q, 9.8))(
            upright
        )
        largest = CALCULUS_RTOL * max(np.abs(a).max(), np.abs(c).max())
        np.testing.assert_allclose(sf.inertia_matrix(body), a, rtol=0, atol=largest)
        ours = sf.stiffness_matrix(body, stiffness, 9.8)
        np.testing.assert_allclose(ours, c, rtol=0, atol=largest)
        ours[0, 2] *= 1.0 + PERTURBATION  # the oracle can fail
        assert np.abs(ours - c).max() > largest
        np.testing.assert_allclose(sf.potential_energy(body, stiffness, upright, 9.8), 0.0, atol=0)


def test_joint_moments_are_lagranges_equations_of_the_energies():
    rng = np.random.default_rng(4)
    for _ in range(10):
        body, stiffness = random_body(rng), random_stiffness(rng)
        q, rates, turning = rng.uniform(-1.5, 1.5, (3, 3))

        def kinetic(angles, velocity, body=body):
            return sf.kinetic_energy(body, angles, velocity)

        momentum = jax.grad(kinetic, argnums=1)
        _, change = jax.jvp(momentum, (q, rates), (rates, turning))
        expected = (
            change
            - jax.grad(kinetic)(q, rates)
            + jax.grad(lambda angles: sf.potential_energy(body, stiffness, angles, 9.8))(q)  # noqa: B023
        )
        ours = sf.joint_moments(body, stiffness, q, rates, turning, 9.8)
        close = 1e-11 * np.abs(expected).max()
        np.testing.assert_allclose(ours, expected, rtol=0, atol=close)
        # the oracle can fail: the thigh's inertia off by one part in a thousand
        wrong = body._replace(segment_inertia=body.segment_inertia * [1.0, 1.001, 1.0])
        assert (
            np.abs(sf.joint_moments(wrong, stiffness, q, rates, turning, 9.8) - ours).max() > close
        )


def test_joint_moments_are_those_of_the_multibody_program_at_large_angles():
    rng = np.random.default_rng(5)
    for _ in range(20):
        body, stiffness = random_body(rng), random_stiffness(rng)
        model, data = multibody(body, stiffness, 9.8)
        data.qpos[:], data.qvel[:] = rng.uniform(-2.0, 2.0, (2, 3))
        mujoco.mj_forward(model, data)
        free = sf.joint_moments(body, stiffness, data.qpos, data.qvel, data.qacc, 9.8)
        effort = np.abs(data.qfrc_bias).max() + np.abs(data.qfrc_passive).max()
        np.testing.assert_allclose(free, 0.0, atol=1e-11 * effort)


def test_linearised_equations_of_motion_are_a_and_c():
    body, stiffness = sf.Body.edwards2007(), sf.Stiffness(950.0, 2000.0, 738.0)
    rest = np.zeros(3)

    def moments(q, turning):
        return sf.joint_moments(body, stiffness, q, rest, turning, 9.8)

    by_rotation, by_acceleration = jax.jacobian(moments, argnums=(0, 1))(rest, rest)
    np.testing.assert_allclose(by_acceleration, sf.inertia_matrix(body), rtol=CALCULUS_RTOL)
    np.testing.assert_allclose(
        by_rotation, sf.stiffness_matrix(body, stiffness, 9.8), rtol=CALCULUS_RTOL
    )


def test_second_variation_is_the_quadratic_form_of_c():
    rng = np.random.default_rng(6)
    for _ in range(200):
        body, stiffness, q = random_body(rng), random_stiffness(rng), rng.normal(size=3)
        c = sf.stiffness_matrix(body, stiffness, 9.8)
        scale = np.abs(q) @ np.abs(c) @ np.abs(q)
        ours = matrices.second_variation(body, stiffness, 9.8, q)
        assert ours == pytest.approx(q @ c @ q, abs=1e-13 * scale)


def test_a_rigid_joint_stores_nothing_and_does_not_turn():
    body = sf.Body.edwards2007()
    rigid = sf.Stiffness(950.0, math.inf, 738.0)
    free = sf.Stiffness(950.0, 0.0, 738.0)
    still = (0.1, 0.0, 0.05)
    assert sf.potential_energy(body, rigid, still, 9.8) == sf.potential_energy(
        body, free, still, 9.8
    )
    np.testing.assert_array_equal(
        sf.joint_moments(body, rigid, still, (0, 0, 0), (0, 0, 0), 9.8),
        sf.joint_moments(body, free, still, (0, 0, 0), (0, 0, 0), 9.8),
    )
    turned = (0.1, 0.01, 0.05)
    assert sf.potential_energy(body, rigid, turned, 9.8) == math.inf
    assert sf.joint_moments(body, rigid, turned, (0, 0, 0), (0, 0, 0), 9.8)[1] == math.inf


def test_single_precision_is_refused():
    body = sf.Body.edwards2007()
    with pytest.raises(sf.InputError, match="was given float32"):
        jax.vmap(lambda ankle: sf.modes(body, sf.Stiffness(ankle, 2000.0, 738.0)).eigenvalues)(
            np.float32([900.0, 1000.0])
        )
