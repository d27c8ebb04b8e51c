"""Limits of springs alone lie where the closed form says, whatever the steps of the grid."""

import math

import pytest

import standfast as sf
from standfast.thresholds import planes, regions

GRAVITY = 9.81

# A line between two of 400 steps of an axis leaves a curve by the square of a step.
DRAWN = 2e-3
EXACT = 1e-12


def study_of(stiffness, body=None, **others):
    body = {"model": "winter", **(body or {"height": 1.7, "mass": 70.0})}
    return sf.Study.from_dict({"gravity": GRAVITY, "body": body, "stiffness": stiffness, **others})


COARSE = {"start": 100.0, "stop": 3000.0, "num": 9}
AXES = {"ankle": COARSE, "knee": 1500.0, "hip": {**COARSE, "num": 8}}


def test_on_ankle_and_hip_the_curve_is_the_threshold_itself():
    region = regions.exact_region(study_of(AXES), planes.PLANE_AXES, {})
    ankle, hip = region.curve
    assert len(ankle) > 400  # the grid has nine
    body = sf.Body.from_height_mass(1.7, 70.0)
    for a, h in zip(ankle[::40], hip[::40], strict=True):
        found = sf.critical_stiffness(body, sf.Stiffness(a, 1500.0, h), GRAVITY)
        assert min(abs(found.ankle / a - 1.0), abs(found.hip / h - 1.0)) < EXACT


@pytest.mark.parametrize("ankle", [900.0, math.inf])
def test_on_knee_and_hip_the_lines_pass_where_one_joint_just_holds(ankle):
    study = study_of({"ankle": ankle, "knee": COARSE, "hip": {**COARSE, "num": 8}})
    region = regions.exact_region(study, ("knee_stiffness", "hip_stiffness"), {})
    body = sf.Body.from_height_mass(1.7, 70.0)
    (line,) = region.lines
    for knee, hip in line[::20]:
        found = sf.critical_stiffness(body, sf.Stiffness(ankle, knee, hip), GRAVITY)
        away = abs(found.knee / knee - 1.0), abs(found.hip / hip - 1.0)
        assert min(away) < DRAWN
        assert min(away) < abs(found.knee / (1.1 * knee) - 1.0)  # it can fail


def test_on_height_and_bmi_the_lines_pass_between_verdicts():
    body = {
        "height": {"start": 1.5, "stop": 1.9, "num": 9},
        "bmi": {"start": 18, "stop": 38, "num": 8},
    }
    study = study_of({"ankle": 900.0, "knee": 2000.0, "hip": 500.0}, body)
    region = regions.exact_region(study, ("height", "bmi"), {})
    (line,) = region.lines
    springs = sf.Stiffness(900.0, 2000.0, 500.0)
    for height, bmi in line[::20]:
        verdicts = [
            sf.is_stable(
                sf.Body.from_height_mass(height, share * bmi * height**2), springs, GRAVITY
            )
            for share in (1.0 - DRAWN, 1.0 + DRAWN)
        ]
        assert verdicts == [True, False]


@pytest.mark.parametrize(
    ("values", "log"),
    [
        ({"start": 10, "stop": 1000, "num": 9, "spacing": "log"}, True),
        ([1.0, 10.0, 100.0], True),
        ({"start": 10, "stop": 1000, "num": 9}, False),
        ([100.0, 200.0], False),
        ([0.0, 1.0, 10.0, 100.0], False),
        ([100.0, 200.0, 400.0, math.inf], True),
    ],
)
def test_an_axis_that_rises_by_factors_is_logarithmic(values, log):
    assert planes.is_log(study_of({**AXES, "hip": values}), "hip_stiffness") is log
