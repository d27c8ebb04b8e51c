"""The same functions inside JAX: mapped over any argument, differentiated, in double precision."""

import jax
import numpy as np
import pytest
import scipy.linalg

import standfast as sf
from people import batch, person_of, random_body, random_gravity, random_stiffness
from standfast import stability


def test_traced_and_plain_calls_agree():
    rng = np.random.default_rng(15)
    cases = [(random_body(rng), random_stiffness(rng, rigid_share=0.2), 9.8) for _ in range(64)]

    def everything(*leaves):
        person = person_of(*leaves)
        return (
            *sf.critical_stiffness(*person),
            sf.stiffness_reserve(*person),
            sf.safety_factor(*person),
        )

    traced = np.column_stack(jax.jit(jax.vmap(everything))(*batch(cases)))
    plain = np.array(
        [
            (*sf.critical_stiffness(*case), sf.stiffness_reserve(*case), sf.safety_factor(*case))
            for case in cases
        ],
        dtype=float,
    )
    np.testing.assert_allclose(traced, plain, rtol=1e-11)


PUBLIC = {
    "critical_stiffness": lambda *person: sf.critical_stiffness(*person).hip,
    "equal_rotation": lambda body, k, g: sf.equal_rotation(body, k.knee, g)[1],
    "hip_ankle_ratio": lambda *person: sf.modes(*person).shapes[2, 0],
    "joint_moments": lambda *person: sf.joint_moments(*person, (0.1, 0.2, 0.3), (1, 2, 3), (4, 5, 6)),  # noqa: E501
    "kinetic_energy": lambda body, k, g: sf.kinetic_energy(body, (0.1, 0.2, 0.3), (1.0, 2.0, 3.0)),
    "load_rounding": lambda *person: stability.load_rounding(*person)[0],
    "inertia_matrix": lambda body, k, g: sf.inertia_matrix(body),
    "modes": lambda *person: sf.modes(*person).eigenvalues,
    "potential_energy": lambda *person: sf.potential_energy(*person, (0.1, 0.2, 0.3)),
    "safety_factor": sf.safety_factor,
    "stability_determinant": sf.stability_determinant,
    "stiffness_matrix": sf.stiffness_matrix,
    "stiffness_reserve": sf.stiffness_reserve,
    "verdict": stability.verdict,
}  # fmt: skip


@pytest.mark.parametrize("name", PUBLIC)
@pytest.mark.parametrize("leaf", range(8))
def test_any_argument_alone_can_be_mapped_over(name, leaf):
    rng = np.random.default_rng(16)
    cases = [(random_body(rng), random_stiffness(rng), random_gravity(rng)) for _ in range(3)]
    leaves = batch(cases)
    fixed = [values[0] for values in leaves]

    def alone(value):
        return PUBLIC[name](*person_of(*fixed[:leaf], value, *fixed[leaf + 1 :]))

    mapped = np.asarray(jax.vmap(alone)(leaves[leaf]))
    plain = np.array([alone(value) for value in leaves[leaf]], dtype=float)
    np.testing.assert_allclose(mapped, plain, rtol=1e-8, atol=1e-9)


@pytest.mark.parametrize("leaf", range(8))
@pytest.mark.parametrize("precision", [np.float16, np.float32])
def test_a_single_precision_argument_is_refused(leaf, precision):
    leaves = list(batch([(sf.Body.edwards2007(), sf.Stiffness(950.0, 2000.0, 738.0), 9.8)]))
    leaves[leaf] = leaves[leaf].astype(precision)
    with pytest.raises(TypeError, match="computes in float64"):
        jax.vmap(lambda *one: stability.verdict(*person_of(*one)))(*leaves)


def test_records_are_pytrees():
    bodies = [sf.Body.edwards2007(), sf.Body.from_height_mass(1.6, 60.0)]
    stacked = jax.tree.map(lambda *leaves: np.stack(leaves), *bodies)
    stiffness = sf.Stiffness(np.array([950.0, 700.0]), 2000.0, 738.0)
    thresholds = jax.vmap(sf.critical_stiffness, in_axes=(0, sf.Stiffness._make((0, None, None))))(
        stacked, stiffness
    )
    for number, body in enumerate(bodies):
        plain = sf.critical_stiffness(
            body, sf.Stiffness(float(stiffness.ankle[number]), 2000.0, 738.0)
        )
        assert float(jax.device_get(thresholds).ankle[number]) == pytest.approx(plain.ankle)


def test_people_can_be_scaled_inside_a_trace():
    def threshold(height, mass):
        body = sf.Body.from_height_mass(height, mass, "de-leva-female")
        return sf.critical_stiffness(body, sf.Stiffness(0.0, 2000.0, 700.0)).ankle

    by_height, by_mass = jax.grad(threshold, argnums=(0, 1))(1.65, 60.0)
    step = 1e-6
    assert float(by_height) == pytest.approx(
        (threshold(1.65 + step, 60.0) - threshold(1.65 - step, 60.0)) / (2 * step), rel=1e-6
    )
    assert float(by_mass) == pytest.approx(
        (threshold(1.65, 60.0 + step) - threshold(1.65, 60.0 - step)) / (2 * step), rel=1e-6
    )


# Central differences of functions whose digits are known to some 1e-13, in steps of 1e-5.
GRADIENT_RTOL = 1e-6
MARGINS = {
    "safety_factor": sf.safety_factor,
    "stiffness_reserve": sf.stiffness_reserve,
    "stability_determinant": sf.stability_determinant,
    "eigenvalue_1": lambda *person: sf.modes(*person).eigenvalues[0],
    "eigenvalue_3": lambda *person: sf.modes(*person).eigenvalues[2],
    "frequency": lambda *person: sf.frequency(sf.modes(*person).eigenvalues[0]),
    "hip_ankle_ratio": lambda *person: sf.modes(*person).shapes[2, 0],
    "critical_ankle_stiffness": lambda *person: sf.critical_stiffness(*person).ankle,
    "critical_hip_stiffness": lambda *person: sf.critical_stiffness(*person).hip,
}
POINTS = [(1100.0, 2000.0, 500.0), (700.0, 1500.0, 300.0), (900.0, 650.0, 260.0)]


@pytest.mark.parametrize("name", MARGINS)
@pytest.mark.parametrize("point", POINTS)
def test_derivatives_are_those_of_differences(name, point):
    """With respect to the three stiffnesses, height and mass."""

    def value(x):
        body = sf.Body.from_height_mass(x[3], x[4], "winter")
        return MARGINS[name](body, sf.Stiffness(x[0], x[1], x[2]), 9.81)

    at = np.array([*point, 1.7, 70.0])
    if not np.isfinite(value(at)):
        pytest.skip("no threshold there")
    slopes = np.asarray(jax.grad(value)(jax.numpy.asarray(at)))
    assert np.isfinite(slopes).all()
    for i, slope in enumerate(slopes):
        step = np.zeros(5)
        step[i] = 1e-5 * at[i]
        rise = (value(at + step) - value(at - step)) / (2.0 * step[i])
        assert slope == pytest.approx(rise, rel=GRADIENT_RTOL, abs=1e-9 * abs(value(at)) / at[i])


@pytest.mark.parametrize("point", POINTS)
def test_derivatives_of_eigenvalues_are_squares_of_their_vectors(point):
    """dλ/dK = v² / vᵀ B v, with B = 1 for the reserve and A for a mode; closed form by LAPACK."""
    body = sf.Body.from_height_mass(1.7, 70.0, "winter")

    def slopes(function):
        return np.asarray(
            jax.grad(lambda k: function(body, sf.Stiffness(*k), 9.81))(jax.numpy.asarray(point))
        )

    c = sf.stiffness_matrix(body, sf.Stiffness(*point), 9.81)
    a = sf.inertia_matrix(body)
    for function, metric in ((sf.stiffness_reserve, np.eye(3)), (MARGINS["eigenvalue_1"], a)):
        _, vectors = scipy.linalg.eigh(c, metric)
        squares = vectors[:, 0] ** 2 / (vectors[:, 0] @ metric @ vectors[:, 0])
        assert slopes(function) == pytest.approx(squares, rel=1e-8)
        assert slopes(function) != pytest.approx(squares * (1.0 + 1e-6), rel=1e-8)


@pytest.mark.parametrize("name", ["safety_factor", "stiffness_reserve", "eigenvalue_1"])
def test_derivatives_beside_a_rigid_joint_are_numbers(name):
    def value(k):
        person = (sf.Body.edwards2007(), sf.Stiffness(k[0], np.inf, k[1]), 9.81)
        return MARGINS[name](*person)

    at = np.array([1100.0, 500.0])
    slopes = np.asarray(jax.grad(value)(jax.numpy.asarray(at)))
    for i, slope in enumerate(slopes):
        step = np.zeros(2)
        step[i] = 1e-5 * at[i]
        rise = (value(at + step) - value(at - step)) / (2.0 * step[i])
        assert slope == pytest.approx(rise, rel=GRADIENT_RTOL)
