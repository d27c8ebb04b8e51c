"""Every quantity on a grid of unequal axes against LAPACK and the unbatched functions."""

import math

import jax
import numpy as np
import pytest
import scipy.linalg

import standfast as sf
from standfast.engine.grid import Evaluator
from standfast.parameters import JOINTS
from standfast.quantities import QUANTITIES
from standfast.stability.rounding import load_rounding
from studies import UNEQUAL, changed

# The grid and the plain functions round differently (XLA contracts a·b + c, and the body is scaled
# again), by some ulp of the terms that cancel; so margins agree relative to those terms.
CANCELLATION = 1e-12
RTOL = 1e-11


@pytest.fixture(scope="module")
def grids():
    study = sf.Study.from_dict(UNEQUAL)
    evaluate = Evaluator(study)
    arrays = {}
    for index, group in enumerate(study.grid.groups):
        assert group.tile_count == 1
        results = evaluate(study.grid.tile(index, 0))
        arrays |= dict(zip(group.quantities, results, strict=True))
    return study, arrays


def cases(study, count=400):
    """Random points: the person, and the index of each quantity's own grid."""
    rng = np.random.default_rng(3)
    for _ in range(count):
        at = {name: int(rng.integers(len(values))) for name, values in study.axes.items()}
        values = {name: study.axes[name][i] for name, i in at.items()}
        height = values["height"]
        body = sf.Body.from_height_mass(height, values["bmi"] * height**2, values["body_model"])
        stiffness = sf.Stiffness(
            *(values[f"{joint}_stiffness"] for joint in ("ankle", "knee", "hip"))
        )
        index = {
            quantity: tuple(at[axis] for axis in study.axes_of(quantity))
            for quantity in study.quantities
        }
        yield body, stiffness, float(values["gravity"]), index


def test_the_study_asks_for_every_quantity_on_axes_of_different_lengths(grids):
    study, arrays = grids
    of_springs = {name for name, row in QUANTITIES.items() if row.reference is not None}
    assert set(study.quantities) == of_springs == set(arrays)
    for quantity, array in arrays.items():
        assert array.shape == tuple(len(study.axes[axis]) for axis in study.axes_of(quantity))
        assert array.dtype == QUANTITIES[quantity].dtype
    assert arrays["critical_knee_stiffness"].ndim == arrays["stable"].ndim - 1


def test_every_quantity_equals_the_unbatched_function(grids):
    study, arrays = grids
    unlike = 0
    for body, stiffness, gravity, index in cases(study):
        person = (body, stiffness, gravity)
        ours = {quantity: arrays[quantity][index[quantity]] for quantity in study.quantities}
        modes = sf.modes(*person)
        reserve = sf.stiffness_reserve(*person)
        soft = max(k for k in stiffness.joints if math.isfinite(k))
        loads = 20.0 * body.segment_mass.sum() * gravity
        slack = CANCELLATION * (loads + soft)
        for joint, threshold in zip(JOINTS, sf.critical_stiffness(*person).joints, strict=True):
            # close to where nothing helps, a threshold runs away and with it its error
            ill = 1.0 + threshold / loads if math.isfinite(threshold) else 1.0
            assert ours[f"critical_{joint}_stiffness"] == pytest.approx(threshold, rel=RTOL * ill)
        assert ours["stiffness_reserve"] == pytest.approx(reserve, abs=slack, rel=RTOL)
        assert ours["safety_factor"] == pytest.approx(sf.safety_factor(*person), rel=RTOL)
        size = float(np.abs(modes.eigenvalues[np.isfinite(modes.eigenvalues)]).max())
        for number in range(3):
            assert ours[f"eigenvalue_{number + 1}"] == pytest.approx(
                modes.eigenvalues[number], rel=RTOL, abs=CANCELLATION * size
            )
        assert ours["frequency"] == pytest.approx(sf.frequency(*person), rel=1e-8, abs=1e-7)
        assert ours["growth_rate"] == pytest.approx(sf.growth_rate(*person), rel=1e-8, abs=1e-6)
        assert ours["hip_ankle_ratio"] == pytest.approx(modes.shapes[2, 0], rel=1e-9, abs=1e-9)
        assert ours["knee_ankle_ratio"] == pytest.approx(modes.shapes[1, 0], rel=1e-9, abs=1e-9)
        determinant = sf.stability_determinant(*person)
        assert ours["stability_determinant"] == pytest.approx(
            determinant, rel=1e-9, abs=CANCELLATION * (loads + soft) ** 3
        )
        if bool(ours["stable"]) != sf.is_stable(*person):
            unlike += 1
            assert abs(reserve) < slack
    assert unlike <= 1


def test_eigenvalues_and_verdicts_equal_lapack(grids):
    study, arrays = grids
    stable = 0
    for body, stiffness, gravity, index in cases(study):
        free = np.flatnonzero(np.isfinite(stiffness.joints))
        keep = np.ix_(free, free)
        a = sf.inertia_matrix(body)[keep]
        c = sf.stiffness_matrix(body, stiffness, gravity)[keep]
        values, vectors = scipy.linalg.eigh(c, a)
        ours = [arrays[f"eigenvalue_{n}"][index["stable"]] for n in (1, 2, 3)]
        # LAPACK's errors are ulp of the largest eigenvalue, times the condition of A
        np.testing.assert_allclose(
            ours[: free.size], values, rtol=1e-10, atol=1e-12 * np.abs(values).max()
        )
        assert np.isinf(ours[free.size :]).all()
        assert bool(arrays["stable"][index["stable"]]) == (values[0] > 0.0)
        shape = np.zeros(3)
        shape[free] = vectors[:, 0]
        assert arrays["hip_ankle_ratio"][index["stable"]] == pytest.approx(
            shape[2] / shape[0], rel=1e-7, abs=1e-9
        )
        stable += values[0] > 0.0
    assert 50 < stable < 350


FAST = ["stiffness_reserve", "eigenvalue_3", "frequency", "eigenvalue_1", "eigenvalue_2"]
# The grid scales the body again, by an ulp or two, on which small eigenvalues hang.
FAST_RTOL = 1e-10


@pytest.mark.parametrize(
    ("side", "quantities"),
    [(side, FAST) for side in (3, 5, 9, 70)]
    # vectors know nothing of quantities: what stands alone comes with one side each
    + [(5, ["eigenvalue_3"]), (9, ["growth_rate"]), (70, ["stiffness_reserve"])],
)
def test_the_fast_way_equals_the_unbatched_functions(side, quantities):
    """On last axes that fill no vector, soft enough to fall in every manner, some rigid."""
    knees = [20.0, 300.0, 900.0, math.inf]
    study = sf.Study.from_dict(
        {
            "gravity": 9.8,
            "body": {"height": 1.7, "mass": 70.0},
            "stiffness": {
                "ankle": {"start": 1.0, "stop": 2500.0, "num": 61},
                "knee": knees,
                "hip": {"start": 2.0, "stop": 1500.0, "num": side},
            },
            "output": {"quantities": quantities},
        }
    )
    body = sf.Body.from_height_mass(1.7, 70.0, "winter")
    found = dict(zip(quantities, Evaluator(study)(study.grid.tile(0, 0)), strict=True))
    rng = np.random.default_rng(side)
    for _ in range(200):
        at = tuple(int(rng.integers(n)) for n in (61, 4, side))
        stiffness = sf.Stiffness(*(study.axes[f"{joint}_stiffness"][i] for joint, i in
                                   zip(("ankle", "knee", "hip"), at, strict=True)))  # fmt: skip
        low, middle, high = sf.modes(body, stiffness, gravity=9.8).eigenvalues
        exact = {
            "stiffness_reserve": sf.stiffness_reserve(body, stiffness, 9.8),
            "eigenvalue_1": low,
            "eigenvalue_2": middle,
            "eigenvalue_3": high,
            "frequency": sf.frequency(body, stiffness, 9.8),
            "growth_rate": sf.growth_rate(body, stiffness, 9.8),
        }
        for name, values in found.items():
            assert values[at] == pytest.approx(exact[name], rel=FAST_RTOL), (name, stiffness)


@pytest.mark.parametrize("knee", [900.0, math.inf])
@pytest.mark.parametrize("hip", [500.0, math.inf])
@pytest.mark.parametrize("ankle", [1200.0, math.inf])
def test_one_person_with_rigid_joints_gets_numbers(ankle, knee, hip):
    """A study without axes, whose only point is in doubt."""
    study = sf.Study.from_dict(
        {
            "gravity": 9.8,
            "body": {"height": 1.7, "mass": 70.0},
            "stiffness": {"ankle": ankle, "knee": knee, "hip": hip},
            "output": {"quantities": ["eigenvalue_1", "eigenvalue_3", "stiffness_reserve"]},
        }
    )
    person = (sf.Body.from_height_mass(1.7, 70.0, "winter"), sf.Stiffness(ankle, knee, hip), 9.8)
    low, _, high = sf.modes(*person).eigenvalues
    found = Evaluator(study)(study.grid.tile(0, 0))
    for ours, exact in zip(found, (low, high, sf.stiffness_reserve(*person)), strict=True):
        assert float(ours) == pytest.approx(exact, rel=FAST_RTOL)


def test_the_only_point_of_a_study_may_be_in_doubt():
    """Nobody holds anything: the third eigenvalue is a small rest of the sum."""
    body = sf.Body.edwards2007()
    study = sf.Study.from_dict(
        {
            "gravity": 9.8,
            "body": {"model": "edwards2007", "height": 1.753, "mass": 75.3},
            "stiffness": {"ankle": 1e-9, "knee": 1e-9, "hip": 1e-9},
            "output": {"quantities": ["eigenvalue_3", "eigenvalue_1"]},
        }
    )
    exact = sf.modes(body, sf.Stiffness(1e-9, 1e-9, 1e-9), gravity=9.8).eigenvalues
    third, first = Evaluator(study)(study.grid.tile(0, 0))
    assert float(third) == pytest.approx(exact[2], rel=FAST_RTOL)
    assert float(first) == pytest.approx(exact[0], rel=FAST_RTOL)


def test_one_wrong_entry_of_c_would_be_noticed(grids):
    study, arrays = grids
    worst = 0.0
    for body, stiffness, gravity, index in cases(study, 50):
        free = np.flatnonzero(np.isfinite(stiffness.joints))
        keep = np.ix_(free, free)
        c = sf.stiffness_matrix(body, stiffness, gravity)[keep]
        c[0, 0] *= 1.0 + 1e-6
        values = scipy.linalg.eigh(c, sf.inertia_matrix(body)[keep], eigvals_only=True)
        ours = arrays["eigenvalue_1"][index["stable"]]
        worst = max(worst, abs(ours - values[0]) / np.abs(values).max())
    assert worst > 1e-12


def test_far_chunks_are_the_same_as_near_ones():
    """A grid cut into many chunks equals the parts of the same grid computed alone."""
    wide = {"start": 100, "stop": 2100, "num": 2001}
    study = sf.Study.from_dict(
        changed(
            "stiffness",
            {
                "ankle": wide,
                "knee": [1000.0, math.inf],
                "hip": {"start": 1, "stop": 1500, "num": 701},
            },
            changed("output.quantities", ["stable", "stability_determinant"]),
        )
    )
    evaluate = Evaluator(study)
    body, gravity = sf.Body.from_height_mass(1.75, 80.0), 9.8
    rng = np.random.default_rng(4)
    for index, group in enumerate(study.grid.groups):
        for number in (0, group.tile_count // 2, group.tile_count - 1):
            tile = study.grid.tile(index, number)
            (values,) = evaluate(tile)
            assert values.shape == group.chunk_shape
            for _ in range(30):
                within = [int(rng.integers(side)) for side in group.chunk_shape]
                at = [
                    min(first + i, n - 1)
                    for first, i, n in zip(group.start(tile), within, group.shape, strict=True)
                ]
                joints = dict(
                    zip(
                        group.axes,
                        (study.axes[a][i] for a, i in zip(group.axes, at, strict=True)),
                        strict=True,
                    )
                )
                person = (
                    body,
                    sf.Stiffness(*(joints[f"{j}_stiffness"] for j in ("ankle", "knee", "hip"))),
                    gravity,
                )
                value = values[tuple(within)]
                if group.quantities == ("stable",):
                    if np.isfinite(load_rounding(*person)[0]):
                        assert bool(value) == sf.is_stable(*person)
                else:
                    assert value == pytest.approx(
                        float(sf.stability_determinant(*person)), rel=1e-8
                    )


def test_a_study_without_axes_is_one_number():
    study = sf.Study.from_dict(
        changed("stiffness.ankle", 900.0, changed("output.quantities", ["stable", "frequency"]))
    )
    assert study.axes == {}
    (stable,), (hertz,) = (Evaluator(study)(study.grid.tile(index, 0)) for index in (0, 1))
    person = sf.Body.from_height_mass(1.75, 80.0), sf.Stiffness(900.0, 2000.0, 500.0), 9.8
    assert bool(stable) == sf.is_stable(*person)
    assert float(hertz) == pytest.approx(float(sf.frequency(*person)))


def test_the_engine_asks_for_double_precision_itself():
    study = sf.Study.from_dict(changed("output.quantities", ["stable", "safety_factor"]))
    with jax.enable_x64(False):
        (factors,) = Evaluator(study)(study.grid.tile(1, 0))
        (verdicts,) = Evaluator(study)(study.grid.tile(0, 0))
    assert factors.dtype == np.float64
    assert verdicts.dtype == np.uint8
