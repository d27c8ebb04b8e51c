"""Studies as they are read: canonical form, fingerprint, axes and their values."""

import json
import math
from pathlib import Path

import mpmath
import numpy as np
import pytest

import standfast as sf
from standfast.study.values import axis_values
from studies import GOOD, UNEQUAL, changed, toml_of

STUDIES = Path(__file__).parents[2] / "studies"


@pytest.mark.parametrize("path", sorted(STUDIES.glob("*.toml")), ids=lambda path: path.stem)
def test_ready_studies_are_read_and_come_back_from_their_canonical_form(path):
    of_people = "[population]" in path.read_text(encoding="utf-8")
    kind = sf.PopulationStudy if of_people else sf.Study
    study = kind.from_toml(path)
    again = kind.from_canonical(study.canonical)
    assert again == study
    assert again.fingerprint == study.fingerprint
    assert json.loads(study.canonical)["title"] == study.title


def test_the_fingerprint_knows_every_key_and_their_order():
    base = sf.Study.from_dict(GOOD).fingerprint
    others = [
        changed("title", "Another"),
        changed("gravity", 9.81),
        changed("body.model", "edwards2007"),
        changed("stiffness.knee", math.inf),
        changed("output.quantities", ["stable", "frequency"]),
        changed("stiffness", dict(reversed(GOOD["stiffness"].items()))),
    ]
    prints = {sf.Study.from_dict(content).fingerprint for content in others}
    assert len(prints | {base}) == len(others) + 1


# Studies written before there was coupling, damping or feedback, and populations.
OLD_FINGERPRINTS = {
    "GOOD": "7a38374eebf227b7a03f2ab3e66d6631d5bdecbfa895af553bc290dc4030a9d3",
    "UNEQUAL": "8f21ea471bb31e4fc17d923b18c9d79657e9904cb13a0eb93bdfc94425c2cd2e",
    "atlas": "9ecbcdc703be3753ea97b15d4946f056df4798373154b4797a55824b5f7818e8",
    "billion": "cbe720dcf567545e067304abe3dcf460716935effc9b883d73f5951d766af836",
    "body-size": "c899d125165ecc772d15035650de4980647bf833761d058a8ec174d3cd3ad25e",
    "edwards2007": "14618936100080f614c88d4233222b1e78cbba04d72968ef557dcb5a4fdd8f1e",
    "us-adults": "c5c9070f83f74a17994c855cfff045ba5745951a59898266d86b1981ad68e539",
}


@pytest.mark.parametrize("name", OLD_FINGERPRINTS)
def test_a_study_that_names_nothing_new_keeps_its_fingerprint(name):
    made = {"GOOD": GOOD, "UNEQUAL": UNEQUAL}
    if name in made:
        study = sf.Study.from_dict(made[name])
    else:
        kind = sf.PopulationStudy if name == "us-adults" else sf.Study
        study = kind.from_toml(STUDIES / f"{name}.toml")
    assert study.fingerprint == OLD_FINGERPRINTS[name]


NERVES = {
    "damping": {"ankle": 10, "hip": [5.0, 10.0]},
    "feedback": {
        "delay": {"start": 0, "stop": 0.4, "num": 5},
        "proportional": {"ankle": {"start": 0, "stop": 2000, "num": 3}, "ankle_hip": -175},
        "derivative": {"ankle": 185, "hip_ankle": [0.0, 20.0]},
    },
}


def test_coupling_damping_and_feedback_are_parameters_like_any_other():
    content = {**changed("stiffness.knee_hip", [-10.0, 0.0, 30.0]), **NERVES}
    study = sf.Study.from_dict(content)
    assert sf.Study.from_canonical(study.canonical) == study
    assert list(study.axes) == [
        "ankle_stiffness", "knee_hip_stiffness", "hip_damping", "feedback_delay",
        "ankle_proportional_gain", "hip_ankle_derivative_gain",
    ]  # fmt: skip
    fixed = study.fixed
    assert (fixed["ankle_damping"], fixed["ankle_hip_proportional_gain"]) == (10.0, -175.0)
    assert study.axes_of("stiffness_reserve") == ("ankle_stiffness", "knee_hip_stiffness")
    assert study.axes_of("critical_ankle_stiffness") == ("knee_hip_stiffness",)
    for key in ("knee_hip_stiffness", "hip_damping", "feedback_delay"):
        assert study.fingerprint != sf.Study.from_dict(GOOD).fingerprint
        assert f"{key}: " in study.difference(sf.Study.from_dict(GOOD))


def test_feedback_in_a_file(tmp_path):
    path = tmp_path / "study.toml"
    tables = "[feedback]\ndelay = 0.1\n[feedback.proportional]\nankle = 900\nankle_hip = 175\n"
    path.write_text(toml_of(GOOD) + tables, encoding="utf-8")
    fixed = sf.Study.from_toml(path).fixed
    assert fixed["feedback_delay"] == 0.1
    assert fixed["ankle_proportional_gain"] == 900.0
    assert fixed["ankle_hip_proportional_gain"] == 175.0


def test_python_values_and_toml_values_make_the_same_study():
    numbers = changed("stiffness.ankle", (0, 1000))
    arrays = changed("stiffness.ankle", np.array([0.0, 1000.0]))
    assert sf.Study.from_dict(numbers) == sf.Study.from_dict(arrays) == sf.Study.from_dict(GOOD)


def test_a_difference_is_named_key_by_key():
    one = sf.Study.from_dict(GOOD)
    other = sf.Study.from_dict(
        changed("stiffness.knee", [800.0, math.inf], changed("title", "Old"))
    )
    assert one.difference(other) == (
        "title: 'Old' there, 'A small study' here; knee_stiffness: [800, inf] there, 2000 here"
    )
    assert one.difference(one) == ""


def test_axes_are_those_a_quantity_depends_on_in_the_studys_order():
    study = sf.Study.from_dict(UNEQUAL)
    body = ("body_model", "height", "bmi", "gravity")
    assert study.axes_of("stable") == ("hip_stiffness", "knee_stiffness", "ankle_stiffness", *body)
    assert study.axes_of("critical_knee_stiffness") == ("hip_stiffness", "ankle_stiffness", *body)


def test_log_and_linear_ranges():
    log = axis_values({"start": 1.0, "stop": 100.0, "num": 3, "spacing": "log"})
    linear = axis_values({"start": 0.0, "stop": 1.0, "num": 3, "spacing": "linear"})
    np.testing.assert_allclose(log, [1.0, 10.0, 100.0])
    np.testing.assert_array_equal(linear, [0.0, 0.5, 1.0])


@pytest.mark.parametrize(
    ("start", "stop", "num"), [(0.1, 2000.0, 1000), (10.0, 2000.0, 200), (1e-3, 3.3, 7), (1, 8, 4)]
)
def test_log_ranges_are_rounded_once(start, stop, num):
    """The float64 nearest to 60 digits, on every machine; powers of NumPy's are not always."""
    found = axis_values({"start": start, "stop": stop, "num": num, "spacing": "log"})
    with mpmath.workdps(60):
        step = (mpmath.mpf(stop) / mpmath.mpf(start)) ** (mpmath.mpf(1) / (num - 1))
        exact = [float(mpmath.mpf(start) * step**i) for i in range(num)]
    assert found.tolist() == exact
    assert (found[0], found[-1], found.size) == (start, stop, num)
    # it can fail
    assert start != 0.1 or np.geomspace(start, stop, num).tolist() != exact


def test_who_writes_into_an_axis_changes_no_other():
    value = {"start": 1.0, "stop": 100.0, "num": 3, "spacing": "log"}
    axis_values(value)[0] = 5.0
    assert axis_values(value)[0] == 1.0


@pytest.mark.parametrize("axis", [range(900, 1200, 100), np.array([900, 1000, 1100])])
def test_an_axis_may_be_what_holds_numbers(axis):
    springs = {"ankle": axis, "knee": 1500.0, "hip": 400.0}
    study = sf.Study.from_dict({"body": {"height": 1.7, "mass": 70.0}, "stiffness": springs})
    assert study.axes["ankle_stiffness"].tolist() == [900.0, 1000.0, 1100.0]
