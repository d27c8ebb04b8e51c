"""Verdicts of a sweep are those of exact arithmetic, also where rounding could decide."""

import json
import math
from fractions import Fraction
from itertools import product

import numpy as np
import pytest

import standfast as sf
from standfast.anthropometry.body import REFERENCE_PEOPLE
from standfast.engine.grid import Evaluator
from standfast.engine.steps import between, count_below
from standfast.stability.exact import exact_threshold

KNEES = (700.0, 900.0, 2000.0, math.inf)
HIPS = (300.0, 421.0, 1000.0, math.inf)
COUPLED = ("ankle_knee", "knee_hip", "ankle_hip")


def exact_minors(parameters, ankle):
    """The leading minors of C in fractions, from the study's own numbers."""
    reference = REFERENCE_PEOPLE[parameters["body_model"]]
    height = Fraction(parameters["height"])
    mass = Fraction(parameters["bmi"]) * height * height
    taller, heavier = height / Fraction(reference.height), mass / Fraction(reference.mass)
    ms, mt, mb = (Fraction(float(m)) * heavier for m in reference.body.segment_mass)
    hs, ht = (Fraction(float(h)) * taller for h in reference.body.segment_length)
    es, et, eb = (Fraction(float(e)) * taller for e in reference.body.segment_com)
    g = Fraction(parameters["gravity"])
    g3 = g * mb * eb
    g2 = g3 + g * (mt * et + mb * ht)
    g1 = g2 + g * (ms * es + (mt + mb) * hs)
    loads = ((g1, g2, g3), (g2, g2, g3), (g3, g3, g3))
    springs = (ankle, parameters["knee_stiffness"], parameters["hip_stiffness"])
    flexible = [i for i in range(3) if not math.isinf(springs[i])]
    coupled = [Fraction(parameters.get(f"{name}_stiffness", 0.0)) for name in COUPLED]
    across = {frozenset(pair): k for pair, k in zip(((0, 1), (1, 2), (0, 2)), coupled, strict=True)}
    c = [
        [
            (Fraction(springs[i]) if i == j else across[frozenset((i, j))]) - loads[i][j]
            for j in flexible
        ]
        for i in flexible
    ]
    minors = []
    for size in range(1, len(c) + 1):
        if size == 1:
            minors.append(c[0][0])
        elif size == 2:
            minors.append(c[0][0] * c[1][1] - c[0][1] ** 2)
        else:
            minors.append(
                c[0][0] * (c[1][1] * c[2][2] - c[1][2] ** 2)
                - c[0][1] * (c[0][1] * c[2][2] - c[1][2] * c[0][2])
                + c[0][2] * (c[0][1] * c[1][2] - c[1][1] * c[0][2])
            )
    return minors


def exact_verdict(parameters, ankle):
    return all(minor > 0 for minor in exact_minors(parameters, ankle))


def people(count):
    """Parameters of some persons; every other one has a number of many digits."""
    random = np.random.default_rng(4)
    for model, knee, hip in product(("edwards2007", "winter"), KNEES, HIPS):
        for _ in range(count):
            yield {
                "body_model": model,
                "height": float(random.uniform(1.5, 2.0)),
                "bmi": float(random.uniform(18.0, 40.0)),
                "gravity": 9.81,
                "knee_stiffness": knee,
                "hip_stiffness": hip,
            }


def coupled_people(count):
    """The same persons with joints that are coupled, some by negative stiffness."""
    random = np.random.default_rng(5)
    for parameters in people(count):
        couplings = np.round(random.uniform(-100.0, 200.0, 3), int(random.integers(0, 14)))
        couplings *= random.random(3) < 0.8
        names = (f"{name}_stiffness" for name in COUPLED)
        yield parameters | dict(zip(names, couplings.tolist(), strict=True))


def study_of(parameters, ankle):
    joints = {"knee": parameters["knee_stiffness"], "hip": parameters["hip_stiffness"]}
    names = ((name, f"{name}_stiffness") for name in COUPLED)
    joints |= {name: parameters[full] for name, full in names if full in parameters}
    return sf.Study.from_dict(
        {
            "gravity": parameters["gravity"],
            "body": {
                "model": parameters["body_model"],
                "height": parameters["height"],
                "bmi": parameters["bmi"],
            },
            "stiffness": {"ankle": list(ankle), **joints},
        }
    )


def ulps_around(value, steps):
    """Floats around a value, ``steps`` to each side."""
    values = [value]
    for _ in range(steps):
        values = [np.nextafter(values[0], 0.0), *values, np.nextafter(values[-1], np.inf)]
    return np.array(values)


BOTH = pytest.mark.parametrize("people_of", [people, coupled_people])


@BOTH
def test_the_exact_threshold_makes_c_singular(people_of):
    seen = 0
    for parameters in people_of(3):
        threshold = exact_threshold(parameters)
        if threshold is None:
            assert not exact_verdict(parameters, 1e9)
            continue
        seen += 1
        assert exact_minors(parameters, threshold)[-1] == 0
        assert exact_verdict(parameters, threshold + Fraction(1, 10**20))
        assert not exact_verdict(parameters, threshold - Fraction(1, 10**20))
    assert seen > 40


@BOTH
def test_verdicts_within_a_few_ulps_of_the_threshold_are_exact(people_of):
    """The axis runs through the threshold ulp by ulp; plain floating point gets some wrong."""
    differ = settled = 0
    for parameters in people_of(2):
        threshold = exact_threshold(parameters)
        if threshold is None:
            continue
        ankle = ulps_around(float(threshold), 12)
        study = study_of(parameters, ankle)
        evaluate = Evaluator(study)
        (found,) = evaluate(study.grid.tile(0, 0))
        exact = [exact_verdict(parameters, float(k)) for k in ankle]
        assert np.asarray(found).astype(bool).tolist() == exact
        settled += evaluate.resolved_exactly
        mass = parameters["bmi"] * parameters["height"] ** 2
        body = sf.Body.from_height_mass(parameters["height"], mass, model=parameters["body_model"])
        names = ("knee", "hip", *COUPLED)
        joints = [parameters.get(f"{name}_stiffness", 0.0) for name in names]
        plain = [sf.is_stable(body, sf.Stiffness(k, *joints), gravity=9.81) for k in ankle]
        differ += sum(a != b for a, b in zip(plain, exact, strict=True))
    assert settled > 500
    assert differ > 5


@pytest.mark.parametrize("joint", ["knee", "hip"])
@BOTH
def test_a_joint_that_just_holds_or_just_fails_is_settled(joint, people_of):
    """With that joint within ulps of its own limit, the ankle's threshold is huge or infinite."""
    checked = 0
    for parameters in people_of(1):
        if math.isinf(parameters[f"{joint}_stiffness"]):
            continue
        body = sf.Body.from_height_mass(
            parameters["height"],
            parameters["bmi"] * parameters["height"] ** 2,
            model=parameters["body_model"],
        )
        couplings = [parameters.get(f"{name}_stiffness", 0.0) for name in COUPLED]
        rigid = sf.Stiffness(math.inf, 1e9, parameters["hip_stiffness"], *couplings)
        limit = getattr(sf.critical_stiffness(body, rigid, 9.81), joint)
        if math.isinf(limit):
            continue
        for own in ulps_around(limit, 6):
            at_limit = {**parameters, f"{joint}_stiffness": float(own)}
            study = study_of(at_limit, [1.0, 1e3, 1e6, 1e12, math.inf])
            (found,) = Evaluator(study)(study.grid.tile(0, 0))
            exact = [exact_verdict(at_limit, k) for k in (1.0, 1e3, 1e6, 1e12, math.inf)]
            assert np.asarray(found).astype(bool).tolist() == exact
            checked += 1
    assert checked > 50


def test_verdicts_along_axes_of_coupling_are_exact():
    """A grid of couplings whose ankles lie within ulps of a threshold of one of its points."""
    base = {"body_model": "winter", "height": 1.8, "bmi": 24.0, "gravity": 9.81}
    base |= {"knee_stiffness": 1500.0, "hip_stiffness": 700.0, "ankle_hip_stiffness": 13.7}
    between, above = [-50.0, 0.0, 30.0, 77.7], [-20.0, 0.0, 100.0]
    points = [
        {**base, "ankle_knee_stiffness": x, "knee_hip_stiffness": y}
        for x, y in product(between, above)
    ]
    ankle = np.unique([ulps_around(float(exact_threshold(each)), 2) for each in points])
    study = study_of({**base, "ankle_knee_stiffness": between, "knee_hip_stiffness": above}, ankle)
    evaluate = Evaluator(study)
    (found,) = evaluate(study.grid.tile(0, 0))
    assert study.grid.groups[0].axes == (
        "ankle_stiffness", "ankle_knee_stiffness", "knee_hip_stiffness",
    )  # fmt: skip
    exact = [[exact_verdict(each, float(k)) for each in points] for k in ankle]
    assert np.asarray(found).reshape(len(ankle), -1).astype(bool).tolist() == exact
    assert evaluate.resolved_exactly >= 4 * len(points)


def test_what_is_in_doubt_is_near():
    ankle = np.array([1.0, 2.0, 3.0, 5.0, np.inf])
    low, high = np.array([2.0, 3.5, 0.0, np.inf]), np.array([3.0, 4.0, np.inf, np.inf])
    falling = np.array([2, 3, 4, 5])  # of thresholds 2.5, 3.7, 6 and infinity
    assert between(ankle, falling, low, high).tolist() == [True, False, True, False]
    for threshold in (Fraction(1, 2), Fraction(1), Fraction(5, 2), Fraction(5), Fraction(7)):
        assert count_below(ankle.tolist(), threshold) == sum(k <= threshold for k in ankle)
    assert count_below(ankle.tolist(), None) == ankle.size


def test_the_run_tells_how_many_verdicts_were_settled(tmp_path):
    parameters = next(people(1)) | {"knee_stiffness": 3000.0, "hip_stiffness": 3000.0}
    threshold = exact_threshold(parameters)
    assert threshold is not None
    ankle = ulps_around(float(threshold), 3)
    sf.sweep(study_of(parameters, ankle), tmp_path / "a.h5")
    story = json.loads((tmp_path / "a.run.json").read_text(encoding="utf-8"))
    assert story["verdicts_settled_by_exact_arithmetic"] == ankle.size


def test_a_long_ankle_axis_of_several_chunks_is_exact():
    """More values than small integers hold, and a last chunk that reaches beyond the axis."""
    for count in (300, 40_000):
        ankle = np.linspace(0.0, 2000.0, count)
        parameters = {"body_model": "winter", "height": 1.8, "bmi": 24.0, "gravity": 9.81}
        hips = np.linspace(100.0, 1500.0, 60)
        study = sf.Study.from_dict(
            {
                "gravity": 9.81,
                "body": {"model": "winter", "height": 1.8, "bmi": 24.0},
                "stiffness": {"ankle": ankle.tolist(), "knee": 1500.0, "hip": hips.tolist()},
            }
        )
        evaluate, group = Evaluator(study), study.grid.groups[0]
        grid = np.empty(group.shape, np.uint8)
        for number in range(group.tile_count):
            tile = study.grid.tile(0, number)
            (chunk,) = evaluate(tile)
            start = group.start(tile)
            inside = tuple(
                slice(0, min(side, n - first))
                for side, n, first in zip(group.chunk_shape, group.shape, start, strict=True)
            )
            place = tuple(
                slice(first, first + part.stop) for first, part in zip(start, inside, strict=True)
            )
            grid[place] = np.asarray(chunk)[inside]
            # beyond the axis a chunk repeats the last value
            last = np.asarray(chunk)[inside][-1:, :]
            assert (np.asarray(chunk)[inside[0].stop :, inside[1]] == last).all()
        for k, hip in enumerate(hips):
            joints = {"knee_stiffness": 1500.0, "hip_stiffness": float(hip)}
            threshold = exact_threshold({**parameters, **joints})
            exact = [threshold is not None and float(x) > threshold for x in ankle]
            assert grid[:, k].tolist() == exact


def test_a_zoom_into_the_threshold_is_settled_at_once():
    """Many values within the bound: each threshold costs one fraction, not one a value."""
    parameters = next(people(1)) | {"knee_stiffness": 3000.0, "hip_stiffness": 3000.0}
    threshold = exact_threshold(parameters)
    assert threshold is not None
    study = study_of(parameters, ulps_around(float(threshold), 200))
    evaluate = Evaluator(study)
    (found,) = evaluate(study.grid.tile(0, 0))
    assert np.asarray(found).astype(bool).tolist() == [
        exact_verdict(parameters, float(k)) for k in study.axes["ankle_stiffness"]
    ]
