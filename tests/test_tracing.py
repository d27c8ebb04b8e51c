"""The same functions inside JAX: mapped over any argument, differentiated, in double precision."""

from functools import lru_cache, partial

import jax
import numpy as np
import pytest
import scipy.linalg

import standfast as sf
from people import batch, person_of, random_body, random_gravity, random_stiffness
from standfast.parameters import JOINTS
from standfast.stability import rounding, springs


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
    "frequency": sf.frequency,
    "growth_rate": sf.growth_rate,
    "is_stable": sf.is_stable,
    "equal_rotation": lambda body, k, g: sf.equal_rotation(body, k.knee, g)[1],
    "hip_ankle_ratio": lambda *person: sf.modes(*person).shapes[2, 0],
    "joint_moments": lambda body, k, g: sf.joint_moments(body, k, (0.1, 0.2, 0.3), (1, 2, 3), (4, 5, 6), g),  # noqa: E501
    "kinetic_energy": lambda body, k, g: sf.kinetic_energy(body, (0.1, 0.2, 0.3), (1.0, 2.0, 3.0)),
    "load_rounding": lambda *person: rounding.load_rounding(*person)[0],
    "inertia_matrix": lambda body, k, g: sf.inertia_matrix(body),
    "modes": lambda *person: sf.modes(*person).eigenvalues,
    "potential_energy": lambda body, k, g: sf.potential_energy(body, k, (0.1, 0.2, 0.3), g),
    "safety_factor": sf.safety_factor,
    "stability_determinant": sf.stability_determinant,
    "stiffness_matrix": sf.stiffness_matrix,
    "stiffness_reserve": sf.stiffness_reserve,
    "verdict": springs.verdict,
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
    with pytest.raises(sf.InputError, match="computes in float64"):
        jax.vmap(lambda *one: springs.verdict(*person_of(*one)))(*leaves)


def test_what_cannot_be_traced_says_so():
    """Crossings and certain verdicts follow paths that depend on values."""
    feedback = sf.Feedback((600.0, 0.0, 0.0), (150.0, 0.0, 0.0), 0.1)
    body = sf.Body.edwards2007()
    functions = {
        "is_stable": sf.is_stable,
        "critical_delay": sf.critical_delay,
        "delay_crossings": sf.delay_crossings,
        "unstable_roots": sf.unstable_roots,
        "rightmost_root": sf.rightmost_root,
        "sway_covariance": sf.sway_covariance,
        "sway_spectrum": partial(sf.sway_spectrum, frequency=1.0),
    }
    for name, function in functions.items():
        words = f"{name} with damping or feedback is not for jax.vmap, jax.jit or jax.grad"

        def along_ankle(ankle, function=function):
            return function(body, sf.Stiffness(ankle, 2000.0, 700.0), feedback=feedback)

        def along_delay(delay, function=function):
            late = feedback._replace(delay=delay)
            return function(body, sf.Stiffness(500.0, 2000.0, 700.0), feedback=late)

        for along, values in (along_ankle, [450.0, 900.0]), (along_delay, [0.1, 0.2]):
            with pytest.raises(sf.InputError, match=words):
                jax.vmap(along)(np.array(values))
    with pytest.raises(sf.InputError, match="verdict_is_certain is not for jax"):
        jax.vmap(lambda k: sf.verdict_is_certain(body, sf.Stiffness(k, 2000.0, 700.0)))(
            np.array([450.0, 900.0])
        )


def test_a_plain_verdict_is_a_plain_bool():
    assert sf.is_stable(sf.Body.edwards2007(), sf.Stiffness(1200.0, 2000.0, 700.0)) is True
    verdicts = jax.vmap(
        lambda ankle: sf.is_stable(sf.Body.edwards2007(), sf.Stiffness(ankle, 2000.0, 700.0))
    )(np.array([700.0, 1200.0]))
    assert verdicts.dtype == bool
    assert verdicts.tolist() == [False, True]


def test_records_are_pytrees():
    bodies = [sf.Body.edwards2007(), sf.Body.from_height_mass(1.6, 60.0)]
    stacked = jax.tree.map(lambda *leaves: np.stack(leaves), *bodies)
    stiffness = sf.Stiffness(np.array([950.0, 700.0]), 2000.0, 738.0)
    thresholds = jax.vmap(sf.critical_stiffness, in_axes=(0, sf.Stiffness._make((0, *[None] * 5))))(
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


# Central differences of functions whose digits are known to some 1e-13, in steps of 1e-5; where a
# joint is free the difference is one-sided, of second order too.
GRADIENT_RTOL = 1e-6
STEP = 1e-5
MARGINS = {
    "safety_factor": sf.safety_factor,
    "stiffness_reserve": sf.stiffness_reserve,
    "stability_determinant": sf.stability_determinant,
    "eigenvalue_1": lambda *person: sf.modes(*person).eigenvalues[0],
    "eigenvalue_2": lambda *person: sf.modes(*person).eigenvalues[1],
    "eigenvalue_3": lambda *person: sf.modes(*person).eigenvalues[2],
    "frequency": sf.frequency,
    "growth_rate": sf.growth_rate,
    "hip_ankle_ratio": lambda *person: sf.modes(*person).shapes[2, 0],
    "knee_ankle_ratio": lambda *person: sf.modes(*person).shapes[1, 0],
    "critical_ankle_stiffness": lambda *person: sf.critical_stiffness(*person).ankle,
    "critical_knee_stiffness": lambda *person: sf.critical_stiffness(*person).knee,
    "critical_hip_stiffness": lambda *person: sf.critical_stiffness(*person).hip,
}
PERSONS = {
    "stands": (1100.0, 2000.0, 500.0),
    "falls by the ankle": (700.0, 1500.0, 300.0),
    "falls by the knee": (900.0, 650.0, 260.0),
    "rigid ankle": (np.inf, 2000.0, 500.0),
    "rigid knee": (1100.0, np.inf, 500.0),
    "rigid hip": (1100.0, 2000.0, np.inf),
    "rigid ankle and knee": (np.inf, np.inf, 500.0),
    "free ankle": (0.0, 2000.0, 500.0),
    "free knee": (1100.0, 0.0, 500.0),
    "free hip": (1100.0, 2000.0, 0.0),
}


def value_at(name, x):
    """A margin at three stiffnesses, height and mass."""
    body = sf.Body.from_height_mass(x[3], x[4], "winter")
    return MARGINS[name](body, sf.Stiffness(x[0], x[1], x[2]), 9.81)


PLACES = {name: np.array([*springs, 1.7, 70.0]) for name, springs in PERSONS.items()}


@lru_cache
def slopes_of(name):
    """By person; of all at once, and not compiled, which would take longer than it saves."""
    slopes = jax.vmap(jax.grad(partial(value_at, name)))(np.stack(list(PLACES.values())))
    return dict(zip(PLACES, np.asarray(slopes), strict=True))


def difference(name, at, i):
    """The slope along one number, from values of plain calls."""

    def beside(steps):
        return value_at(name, at + steps * step)

    step = np.zeros(at.size)
    step[i] = STEP * (at[i] or 1000.0)
    if at[i] == 0.0:
        return (4.0 * beside(1) - beside(2) - 3.0 * beside(0)) / (2.0 * step[i])
    return (beside(1) - beside(-1)) / (2.0 * step[i])


@pytest.mark.parametrize("name", MARGINS)
@pytest.mark.parametrize("person", PERSONS)
def test_derivatives_are_those_of_differences(name, person):
    """Along three stiffnesses, height and mass; 0 along a rigid joint, numbers beside infinity."""
    at, slopes = PLACES[person], slopes_of(name)[person]
    here = value_at(name, at)
    assert np.isfinite(slopes).all()
    for i, slope in enumerate(slopes):
        if np.isinf(at[i]):
            assert slope == 0.0
        elif np.isfinite(here):
            least = 1e-9 * abs(here) / (at[i] or 1000.0)
            assert slope == pytest.approx(difference(name, at, i), rel=GRADIENT_RTOL, abs=least)


@pytest.mark.parametrize(
    "springs", [(0.0, 2000.0, 0.0), (100.0, 100.0, 10.0), (np.inf, np.inf, np.inf)]
)
@pytest.mark.parametrize("name", ["safety_factor", *(f"critical_{j}_stiffness" for j in JOINTS)])
def test_slopes_are_numbers_also_where_the_value_is_none(name, springs):
    """Beside two free joints, where no threshold suffices, with three rigid joints."""
    at = np.array([*springs, 1.7, 70.0])
    slopes = np.asarray(jax.grad(partial(value_at, name))(at))
    assert np.isfinite(slopes).all()
    if not np.isfinite(value_at(name, at)):
        assert (slopes[:3] == 0.0).all()


CLOSED_RTOL = 1e-8
SPRINGS = ["stands", "falls by the ankle", "falls by the knee"]


def closed_forms(springs, height, mass):
    """Slopes along stiffnesses, height and mass of what solves M v = μ B v: vᵀ(M' − μ B')v/vᵀBv.

    With the C, A and gravity part G of the package and vectors of LAPACK. Loads grow with height
    and mass, inertia with height² and mass.
    """
    body = sf.Body.from_height_mass(height, mass, "winter")
    c, a = sf.stiffness_matrix(body, sf.Stiffness(*springs), 9.81), sf.inertia_matrix(body)
    k = np.diag(springs)
    g, one, none = k - c, np.eye(3), np.zeros((3, 3))
    # matrix, metric, and their slopes along height and mass
    problems = {
        "stiffness_reserve": (c, one, (-g / height, none), (-g / mass, none)),
        "eigenvalue_1": (c, a, (-g / height, 2.0 * a / height), (-g / mass, a / mass)),
        "safety_factor": (k, g, (none, g / height), (none, g / mass)),
    }
    found = {}
    for name, (matrix, metric, *bodily) in problems.items():
        values, vectors = scipy.linalg.eigh(matrix, metric)
        v, value = vectors[:, 0], values[0]
        slopes = [*v**2, *(v @ (m - value * b) @ v for m, b in bodily)]
        found[name] = np.array(slopes) / (v @ metric @ v)
    return found


@pytest.mark.parametrize("name", ["stiffness_reserve", "eigenvalue_1", "safety_factor"])
@pytest.mark.parametrize("person", SPRINGS)
def test_derivatives_of_eigenvalues_are_those_of_their_vectors(name, person):
    closed = closed_forms(PERSONS[person], 1.7, 70.0)[name]
    slopes = slopes_of(name)[person]
    assert slopes == pytest.approx(closed, rel=CLOSED_RTOL)
    for i in range(5):  # it can fail
        wrong = closed.copy()
        wrong[i] *= 1.0 + 1e-6
        assert slopes != pytest.approx(wrong, rel=CLOSED_RTOL)


@pytest.mark.parametrize("person", SPRINGS)
def test_derivatives_of_determinant_and_thresholds_in_closed_form(person):
    """The determinant's are its cofactors; at a threshold C v = 0 and v² weighs the joints."""
    at = PLACES[person]
    body = sf.Body.from_height_mass(1.7, 70.0, "winter")
    c = sf.stiffness_matrix(body, sf.Stiffness(*PERSONS[person]), 9.81)
    cofactors = np.linalg.det(c) * np.diagonal(np.linalg.inv(c))
    found = slopes_of("stability_determinant")[person][:3]
    assert found == pytest.approx(cofactors, rel=CLOSED_RTOL)
    for joint, name in enumerate(JOINTS):
        limit = value_at(f"critical_{name}_stiffness", at)
        slopes = slopes_of(f"critical_{name}_stiffness")[person][:3]
        if np.isinf(limit):
            continue
        just = c.copy()
        just[joint, joint] += limit - at[joint]
        _, vectors = np.linalg.eigh(just)
        v = vectors[:, 0]
        wanted = -((v / v[joint]) ** 2)
        wanted[joint] = 0.0  # its own stiffness does not enter
        assert slopes == pytest.approx(wanted, rel=CLOSED_RTOL)
