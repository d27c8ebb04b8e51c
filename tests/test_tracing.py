"""The same functions inside JAX: mapped over any argument, differentiated, in double precision."""

import jax
import numpy as np
import pytest

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
    "verdict_by_minors": stability.verdict_by_minors,
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
