"""What the page asks the program to compute, against the functions for one person."""

import math

import numpy as np
import pytest

import standfast as sf
from standfast.explore.live import Live
from standfast.parameters import OWN_BODY

ADULT = {
    "gravity": 9.80665,
    "body_model": "edwards2007",
    "height": 1.753,
    "mass": 75.3,
    "ankle_stiffness": 600.0,
    "knee_stiffness": 1500.0,
    "hip_stiffness": 400.0,
    "ankle_damping": 10.0,
    "knee_damping": 5.0,
    "hip_damping": 5.0,
    "ankle_proportional_gain": 700.0,
    "ankle_derivative_gain": 250.0,
    "hip_proportional_gain": 200.0,
    "hip_derivative_gain": 60.0,
    "feedback_delay": 0.05,
}
SAME = 1e-9  # of what two ways of one formula round differently


@pytest.fixture
def live():
    return Live({})


def asked(quantities, x, y, **others):
    axes = {key: {"name": axis[0], "values": axis[1]} for key, axis in {"x": x, "y": y}.items()}
    return {"quantities": quantities, **axes, "parameters": {**ADULT, **others}}


def nothing():
    """Go on."""


def of_public_functions(given):
    body = sf.Body.from_height_mass(given["height"], given["mass"], given["body_model"])
    stiffness = sf.Stiffness(*(given[f"{joint}_stiffness"] for joint in ("ankle", "knee", "hip")))
    joints = ("ankle", "knee", "hip")
    damping = [given.get(f"{joint}_damping", 0.0) for joint in joints]
    gains = (
        [given.get(f"{joint}_{kind}_gain", 0.0) for joint in joints]
        for kind in ("proportional", "derivative")
    )
    return body, stiffness, damping, sf.Feedback(*gains, given.get("feedback_delay", 0.0))


def test_a_plane_is_that_of_each_person(live):
    ankles, delays = [300.0, 600.0, 900.0], [0.0, 0.05, 0.1, 0.2]
    request = asked(
        ["stable", "critical_delay", "unstable_roots"],
        ("ankle_stiffness", ankles),
        ("feedback_delay", delays),
    )
    stable, critical, unstable = live.planes(request, nothing)
    assert stable.shape == critical.shape == unstable.shape == (4, 3)
    assert stable.dtype == critical.dtype == unstable.dtype == np.float64
    for row, delay in enumerate(delays):
        for column, ankle in enumerate(ankles):
            given = {**ADULT, "ankle_stiffness": ankle, "feedback_delay": delay}
            body, stiffness, damping, late = of_public_functions(given)
            of = {"damping": damping, "feedback": late}
            assert stable[row, column] == sf.is_stable(body, stiffness, **of)
            assert unstable[row, column] == sf.unstable_roots(body, stiffness, **of)
            expected = sf.critical_delay(body, stiffness, **of)
            assert critical[row, column] == pytest.approx(expected, rel=SAME)
    assert 0 < stable.sum() < stable.size


def test_x_runs_along_rows_whichever_axis_it_is(live):
    one, other = ("hip_stiffness", [300.0, 800.0]), ("feedback_delay", [0.0, 0.1, 0.3])
    (plane,) = live.planes(asked(["delay_margin"], one, other), nothing)
    (turned,) = live.planes(asked(["delay_margin"], other, one), nothing)
    assert plane.shape == (3, 2)
    np.testing.assert_array_equal(plane, turned.T)


def test_measured_segments_stand_for_height_and_mass():
    body = sf.Body.from_height_mass(1.8, 90.0, "winter")
    own = dict(zip(OWN_BODY, (float(n) for part in body for n in part), strict=True))
    segments = Live(own).person({**ADULT, "body_model": "own"})
    scaled = Live({}).person({**ADULT, "body_model": "winter", "height": 1.8, "mass": 90.0})
    assert segments["rightmost_root"] == pytest.approx(scaled["rightmost_root"], rel=SAME)
    assert segments["critical_delay"] == pytest.approx(scaled["critical_delay"], rel=SAME)


def test_a_person_is_as_the_public_functions_say(live):
    found = live.person(ADULT)
    body, stiffness, damping, late = of_public_functions(ADULT)
    of = {"damping": damping, "feedback": late}
    assert found["stands"] is sf.is_stable(body, stiffness, **of)
    assert found["critical_delay"] == sf.critical_delay(body, stiffness, **of)
    assert found["delay_margin"] == found["critical_delay"] - 0.05
    root = sf.rightmost_root(body, stiffness, **of)
    assert complex(*found["rightmost_root"]) == root
    assert complex(*found["roots"][0]) == pytest.approx(root, rel=SAME)


def test_a_person_sways_as_the_public_function_says(live):
    assert live.person(ADULT)["sway"] is None
    ankle_alone = {"hip_proportional_gain": 0.0, "hip_derivative_gain": 0.0}
    damped = {"ankle_damping": 30.0, "knee_damping": 20.0, "hip_damping": 20.0}
    noise = {"ankle_noise": 1.0, "hip_noise": 0.4}
    noisy = {**ADULT, **ankle_alone, **damped, **noise, "ankle_derivative_gain": 100.0}
    body, stiffness, damping, late = of_public_functions(noisy)
    covariance = sf.sway_covariance(
        body, stiffness, damping=damping, feedback=late, noise=(1.0, 0.0, 0.4)
    )
    sway = live.person(noisy)["sway"]
    np.testing.assert_array_equal(sway["covariance"], covariance)
    assert np.isfinite(covariance).all()
    x, y = ("ankle_stiffness", [10.0, 600.0]), ("hip_stiffness", [400.0, 450.0, 500.0])
    names = [name for name in sway if name != "covariance"]
    others = {name: value for name, value in noisy.items() if name not in (x[0], y[0])}
    planes = live.planes({**asked(names, x, y), "parameters": others}, nothing)
    for name, plane in zip(names, planes, strict=True):
        assert plane.shape == (3, 2)
        assert plane[0, 1] == pytest.approx(sway[name], rel=1e-6), name  # accuracy of grids
        assert np.isnan(plane[0, 0]) if name == "cop_frequency" else np.isinf(plane[0, 0])


def test_the_shape_solves_the_equation_of_motion(live):
    found = live.person(ADULT)
    body, stiffness, damping, late = of_public_functions(ADULT)
    s = complex(*found["rightmost_root"])
    shape = np.array([complex(*each) for each in found["shape"]])
    passive = sf.inertia_matrix(body) * s**2 + np.diag(damping) * s
    passive = passive + sf.stiffness_matrix(body, stiffness)
    active = (late.proportional + late.derivative * s) * np.exp(-s * late.delay)
    assert np.abs((passive + active) @ shape).max() < 1e-9 * np.abs(passive).max()
    assert np.abs(shape).max() == pytest.approx(1.0)


def test_rigid_joints_do_not_turn(live):
    found = live.person({**ADULT, "knee_stiffness": "inf", "hip_stiffness": math.inf})
    (ankle, knee, hip) = found["shape"]
    assert ankle == [1.0, 0.0]
    assert knee == hip == [0.0, 0.0]
    still = live.person({**ADULT, **{f"{j}_stiffness": "inf" for j in ("ankle", "knee", "hip")}})
    assert still["shape"] is None
    assert still["roots"] == []


def test_a_plane_that_is_superseded_ends(live):
    class OtherError(Exception):
        pass

    def newer():
        raise OtherError

    request = asked(
        ["critical_delay"], ("hip_stiffness", [300.0, 800.0]), ("mass", [60.0, 80.0, 90.0])
    )
    with pytest.raises(OtherError):
        live.planes(request, newer)


GOOD = asked(["stable"], ("hip_stiffness", [300.0, 800.0]), ("mass", [60.0, 80.0]))


@pytest.mark.parametrize(("changes", "words"), [
    ({"quantities": ["stabel"]}, "did you mean 'stable'"),
    ({"quantities": "stable"}, "is not a list"),
    ({"x": {"name": "hip", "values": [1, 2]}}, "x: 'hip' is no parameter"),
    ({"x": {"name": "body_model", "values": [1, 2]}}, "no parameter that is a number"),
    ({"x": {"name": "shank_mass", "values": [1, 2]}}, "is measured"),
    ({"x": [1, 2]}, "is not an axis"),
    ({"x": {"name": "mass", "values": [60.0, 80.0]}}, "given twice"),
    ({"x": {"name": "hip_stiffness", "values": [1.0]}}, "two values or more"),
    ({"x": {"name": "hip_stiffness", "values": [2.0, 1.0]}}, "must rise"),
    ({"x": {"name": "hip_stiffness", "values": [-2.0, 1.0]}}, "outside the allowed range"),
    ({"x": {"name": "hip_stiffness", "values": [1.0, "a"]}}, "text"),
    ({"x": {"name": "hip_stiffness", "values": list(range(401 * 401))}}, "at most 160801"),
    ({"y": {"name": "mass", "values": [10.0, 60.0]}}, "BMI"),
    ({"parameters": [1]}, "are not values by name"),
    ({"parameters": {**ADULT, "heigt": 1.0}}, "did you mean 'height'"),
    ({"parameters": {**ADULT, "height": 175.0}}, "centimetres"),
    ({"parameters": {**ADULT, "height": [1.7, 1.8]}}, "no axis of the plane"),
    ({"parameters": {**ADULT, "height": None}}, "height"),
    ({"parameters": {**ADULT, "bmi": 24.0}}, "one of them"),
    ({"parameters": {}}, "missing|neither"),
])  # fmt: skip
def test_what_is_wrong_is_said(live, changes, words):
    with pytest.raises(sf.InputError, match=words):
        live.planes({**GOOD, **changes}, nothing)


def test_the_coarse_plane_of_the_page_is_of_few_points_and_the_fine_one_of_many(live):
    def sides(side):
        axis = {"values": list(range(side))}
        return {"x": {"name": "hip_stiffness", **axis}, "y": {"name": "ankle_stiffness", **axis}}

    assert live.are_few(sides(41))
    assert not live.are_few(sides(401))
    with pytest.raises(sf.InputError, match="y is missing"):
        live.are_few({"x": sides(2)["x"]})


@pytest.mark.parametrize("key", ["quantities", "x", "y", "parameters"])
def test_what_is_missing_is_said(live, key):
    request = {name: value for name, value in GOOD.items() if name != key}
    with pytest.raises(sf.InputError, match=f"{key} is missing"):
        live.planes(request, nothing)
