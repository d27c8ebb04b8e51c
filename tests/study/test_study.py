"""The study's border: every wrong study gets its sentence, and nothing else."""

import json
import math
import random
from pathlib import Path

import mpmath
import numpy as np
import pytest

import standfast as sf
from standfast.quantities import QUANTITIES
from standfast.study.values import axis_values
from studies import GOOD, UNEQUAL, changed, toml_of

NAN, INF = math.nan, math.inf
QUANTITY_NAMES = ", ".join(QUANTITIES)
STUDIES = Path(__file__).parents[2] / "studies"
FUZZED = 12_000

WRONG = [
    (
        "gravty",
        9.8,
        "study has no key 'gravty'; did you mean 'gravity'? (keys: title, gravity, body, stiffness, damping, feedback, noise, output)",
    ),
    (
        "titel",
        "x",
        "study has no key 'titel'; did you mean 'title'? (keys: title, gravity, body, stiffness, damping, feedback, noise, output)",
    ),
    ("title", 5, "title = 5 is not one line of text"),
    ("gravity", -9.8, "gravity = -9.8 is outside the allowed range, 0.001 to 200 m/s²"),
    ("gravity", "9.8", "gravity = '9.8' is text; give a number, 0.001 to 200 m/s²"),
    ("gravity", NAN, "gravity is NaN (not a number); give 0.001 to 200 m/s²"),
    ("gravity", INF, "gravity = inf is outside the allowed range, 0.001 to 200 m/s²"),
    ("gravity", True, "gravity = True is of type bool; give a number, 0.001 to 200 m/s²"),
    ("gravity", [], "gravity is an empty list; give at least one value"),
    (
        "gravity",
        [9.8, 1.6],
        "gravity[1] = 1.6 falls below the value before it; the values of an axis must rise",
    ),
    (
        "body",
        3,
        "[body] = 3 is not a table of model, height, mass, bmi, segment_mass, segment_inertia, segment_length, segment_com",
    ),
    (
        "body.heigth",
        1.75,
        "[body] has no key 'heigth'; did you mean 'height'? (keys: model, height, mass, bmi, segment_mass, segment_inertia, segment_length, segment_com)",
    ),
    (
        "body.height",
        175,
        "body.height = 175 is outside the allowed range, 0.5 to 2.8 m; 175 looks like centimetres, write 1.75",
    ),
    (
        "body.height",
        [1.6, 175.0],
        "body.height[1] = 175 is outside the allowed range, 0.5 to 2.8 m; 175 looks like centimetres, write 1.75",
    ),
    ("body.height", 0, "body.height = 0 is outside the allowed range, 0.5 to 2.8 m"),
    (
        "body.height",
        [1.7, 1.7],
        "body.height[1] = 1.7 repeats the value before it; the values of an axis must rise",
    ),
    (
        "body.height",
        {"start": 1.9, "stop": 1.5, "num": 5},
        "body.height goes from 1.9 to 1.5; stop must be above start",
    ),
    ("body.mass", -80, "body.mass = -80 is outside the allowed range, 2 to 650 kg"),
    (
        "body.mass",
        80000,
        "body.mass = 80000 is outside the allowed range, 2 to 650 kg; 80000 looks like grams, write 80",
    ),
    ("body.mass", "80 kg", "body.mass = '80 kg' is text; give a number, 2 to 650 kg"),
    ("body.bmi", 25, "body needs mass or bmi, one of them; both are given"),
    ("body.mass", None, "body needs mass or bmi, one of them; neither is given"),
    (
        "body.model",
        "wintr",
        "body.model = 'wintr' is not a body model; did you mean 'winter'? (models: edwards2007, winter, de-leva-male, de-leva-female)",
    ),
    ("body.model", ["winter", "winter"], "body.model names a model twice: winter, winter"),
    ("body.model", [], "body.model is an empty list; give at least one value"),
    ("body.model", {"start": 1}, "body.model is a table; give a model or a list of models"),
    (
        "body.model",
        3,
        "body.model = 3 is not a body model (models: edwards2007, winter, de-leva-male, de-leva-female)",
    ),
    (
        "stiffness.ankel",
        3,
        "[stiffness] has no key 'ankel'; did you mean 'ankle'? (keys: ankle, knee, hip, ankle_knee, knee_hip, ankle_hip)",
    ),
    (
        "stiffness.ankle",
        -1,
        "stiffness.ankle = -1 is outside the allowed range, 0 to 1e+12 N·m/rad, or inf for a rigid joint",
    ),
    (
        "stiffness.ankle",
        [1000.0, 900.0],
        "stiffness.ankle[1] = 900 falls below the value before it; the values of an axis must rise",
    ),
    (
        "stiffness.ankle",
        [0.0, NAN],
        "stiffness.ankle[1] is NaN (not a number); give 0 to 1e+12 N·m/rad, or inf for a rigid joint",
    ),
    (
        "stiffness.ankle",
        ["a"],
        "stiffness.ankle[0] = 'a' is text; give a number, 0 to 1e+12 N·m/rad, or inf for a rigid joint",
    ),
    ("stiffness.ankle", [[1.0]], "stiffness.ankle[0] = [1.0] is not a number"),
    (
        "stiffness.ankle",
        {"start": 0, "stop": 2000},
        "stiffness.ankle lacks num; a range is { start = …, stop = …, num = … }",
    ),
    (
        "stiffness.ankle",
        {"start": 0, "stop": 2000, "num": 1},
        "stiffness.ankle.num = 1 is not a whole number of values, 2 to 10000000",
    ),
    (
        "stiffness.ankle",
        {"start": 0, "stop": 2000, "num": 2.5},
        "stiffness.ankle.num = 2.5 is not a whole number of values, 2 to 10000000",
    ),
    (
        "stiffness.ankle",
        {"start": 0, "stop": 2000, "num": 1000000000},
        "stiffness.ankle.num = 1000000000 is not a whole number of values, 2 to 10000000",
    ),
    (
        "stiffness.ankle",
        {"start": 0, "stop": 2000, "num": 5, "step": 3},
        "stiffness.ankle has a step; a range has the number of its values instead: "
        "{ start = …, stop = …, num = … }",
    ),
    (
        "stiffness.ankle",
        {"start": 0, "stop": 2000, "num": 5, "spacing": "log"},
        "stiffness.ankle.start = 0 has no logarithm; start a log range above 0",
    ),
    (
        "stiffness.ankle",
        {"start": 1, "stop": 2000, "num": 5, "spacing": "logarithmic"},
        "stiffness.ankle.spacing = 'logarithmic' is not known (spacings: linear, log)",
    ),
    (
        "stiffness.ankle",
        {"start": 1, "stop": INF, "num": 5},
        "stiffness.ankle reaches inf; put inf into a list instead, for example [800, inf]",
    ),
    (
        "stiffness.ankle",
        {"start": 5, "stop": 5, "num": 5},
        "stiffness.ankle goes from 5 to 5; stop must be above start",
    ),
    (
        "stiffness.ankle",
        {"start": "a", "stop": 5, "num": 5},
        "stiffness.ankle.start = 'a' is text; give a number, 0 to 1e+12 N·m/rad, or inf for a rigid joint",
    ),
    (
        "stiffness.ankle",
        {"start": 1.0, "stop": 1.0000000000000002, "num": 50},
        "stiffness.ankle has 50 values between 1 and 1.0000000000000002, more than there are numbers; take fewer",
    ),
    (
        "stiffness",
        [1],
        "[stiffness] = [1] is not a table of ankle, knee, hip, ankle_knee, knee_hip, ankle_hip",
    ),
    (
        "stiffness.knee_ankle",
        30,
        "[stiffness] has no key 'knee_ankle'; did you mean 'ankle_knee'? (keys: ankle, knee, hip, ankle_knee, knee_hip, ankle_hip)",
    ),
    (
        "stiffness.knee_hip",
        INF,
        "stiffness.knee_hip = inf is outside the allowed range, -100000 to 100000 N·m/rad",
    ),
    (
        "damping",
        {"ankel": 3},
        "[damping] has no key 'ankel'; did you mean 'ankle'? (keys: ankle, knee, hip)",
    ),
    (
        "damping",
        {"hip": -1},
        "damping.hip = -1 is outside the allowed range, 0 to 100000 N·m·s/rad",
    ),
    (
        "feedback",
        {"delya": 0.1},
        "[feedback] has no key 'delya'; did you mean 'delay'? (keys: delay, proportional, derivative)",
    ),
    (
        "feedback",
        {"delay": 100},
        "feedback.delay = 100 is outside the allowed range, 0 to 10 s; 100 looks like milliseconds, write 0.1",
    ),
    (
        "feedback",
        {"delay": {"start": 0, "stop": 400, "num": 5}},
        "feedback.delay.stop = 400 is outside the allowed range, 0 to 10 s; 400 looks like milliseconds, write 0.4",
    ),
    (
        "feedback",
        {"delay": -0.1},
        "feedback.delay = -0.1 is outside the allowed range, 0 to 10 s; feedback comes after what it senses, write 0.1",
    ),
    (
        "feedback",
        {"delay": {"start": 0}},
        "feedback.delay lacks stop; a range is { start = …, stop = …, num = … }",
    ),
    (
        "feedback",
        {"proportional": 900},
        "[feedback.proportional] = 900 is not a table of ankle, ankle_knee, ankle_hip, knee_ankle, knee, knee_hip, hip_ankle, hip_knee, hip",
    ),
    (
        "feedback",
        {"derivative": {"ankle_hips": 1}},
        "[feedback.derivative] has no key 'ankle_hips'; did you mean 'ankle_hip'? (keys: ankle, ankle_knee, ankle_hip, knee_ankle, knee, knee_hip, hip_ankle, hip_knee, hip)",
    ),
    (
        "feedback",
        {"proportional": {"hip_ankle": [1.0, NAN]}},
        "feedback.proportional.hip_ankle[1] is NaN (not a number); give -100000 to 100000 N·m/rad",
    ),
    ("output.quantities", [], "output.quantities is an empty list; give at least one quantity"),
    (
        "output.quantities",
        ["stabel"],
        f"output.quantities has no 'stabel'; did you mean 'stable'? (quantities: {QUANTITY_NAMES})",
    ),
    ("output.quantities", "stable", "output.quantities = 'stable' is not a list of quantities"),
    ("output.quantities", ["stable", "stable"], "output.quantities names stable twice"),
    ("output.quantities", [3], f"output.quantities has no 3 (quantities: {QUANTITY_NAMES})"),
    (
        "output.quantites",
        ["stable"],
        "[output] has no key 'quantites'; did you mean 'quantities'? (keys: quantities)",
    ),
    ("output", 5, "[output] = 5 is not a table of quantities"),
    ("body.height", None, "body.height is missing"),
    ("stiffness.knee", None, "stiffness.knee is missing"),
    ("body.mass", 10**400, "body.mass is an integer beyond all floats; give 2 to 650 kg"),
    (
        "stiffness.ankle",
        10**400,
        "stiffness.ankle is an integer beyond all floats; give 0 to 1e+12 N·m/rad, or inf for a rigid joint",
    ),
    ("title", ["a"], "title = ['a'] is not one line of text"),
    (
        "stiffness.hip",
        {"start": 0, "stop": 9, "num": 10000001},
        "stiffness.hip.num = 10000001 is not a whole number of values, 2 to 10000000",
    ),
]


@pytest.mark.parametrize(
    ("key", "value", "sentence"),
    WRONG,
    ids=[f"{number}-{row[0]}" for number, row in enumerate(WRONG)],
)
def test_a_wrong_study_gets_its_sentence(key, value, sentence):
    with pytest.raises(sf.InputError) as caught:
        sf.Study.from_dict(changed(key, value))
    assert str(caught.value) == sentence


def test_there_are_enough_wrong_studies():
    assert len(WRONG) >= 40


def test_a_mass_that_no_one_has_follows_from_bmi_and_height():
    content = changed("body", {"height": [1.5, 2.5], "bmi": [20.0, 200.0]})
    with pytest.raises(sf.InputError) as caught:
        sf.Study.from_dict(content)
    assert str(caught.value) == (
        "body.bmi = 200 at a height of 2.5 m is a mass of 1250 kg, "
        "outside the allowed range, 2 to 650 kg"
    )


def test_a_grid_beyond_all_disks_is_refused():
    long = {"start": 0, "stop": 2000, "num": 1_000_000}
    content = changed("stiffness", {"ankle": long, "knee": long, "hip": long})
    with pytest.raises(sf.InputError, match=r"1e\+18 points .* at most 1e\+13 are allowed"):
        sf.Study.from_dict(content)


@pytest.mark.parametrize(
    ("content", "sentence"),
    [
        (b"\xff\xfe\x00", "is not a text file in UTF-8"),
        (b"title = ", "is not valid TOML"),
        (b"a = " + b"9" * 5000, "is not valid TOML"),
        (b"a = " + b"[" * 5000, "is not valid TOML"),
        (b"", "body.height is missing"),
    ],
)
def test_a_file_that_is_no_study(tmp_path, content, sentence):
    path = tmp_path / "study.toml"
    path.write_bytes(content)
    with pytest.raises(sf.InputError) as caught:
        sf.Study.from_toml(path)
    assert str(caught.value).startswith(str(path))
    assert sentence in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_folder_and_a_missing_file(tmp_path):
    with pytest.raises(sf.InputError, match="is a folder; give a study file"):
        sf.Study.from_toml(tmp_path)
    with pytest.raises(sf.InputError, match="there is no such study file"):
        sf.Study.from_toml(tmp_path / "none.toml")


JUNK = [
    None, True, -1, 0, 1, 2.5, 175, 1e400, -1e-300, 10**400, NAN, INF, -INF, "", "x", "inf", "1.75",
    "ä" * 500, [], [[]], [1, 2], [2, 1], [1, "a"], {}, {"start": 1}, {"start": 0, "stop": 1, "num": 3},
    {"start": 1, "stop": 0, "num": 3}, {"start": NAN, "stop": 1, "num": 3}, "winter", ["winter"],
    {"start": 1, "stop": 9, "num": -3}, {"start": 1, "stop": 9, "num": "3", "spacing": 7}, b"x",
    ["stable"], ["stable", None], np.arange(3.0), np.float32(3), {1: 2}, (1.0, 2.0), object(),
]  # fmt: skip


def test_fuzzed_studies_are_read_or_refused_with_a_sentence():
    rng = random.Random(2007)  # noqa: S311 - a test's draws
    keys = [*GOOD, *(f"{t}.{k}" for t in ("body", "stiffness", "output") for k in GOOD[t])]
    keys += ["body.bmi", "body.x", "y", "stiffness.coupling", "stiffness.knee_hip", "feedback"]
    accepted = 0
    for _ in range(FUZZED):
        content = GOOD if rng.random() < 0.5 else UNEQUAL
        for _ in range(rng.randint(1, 3)):
            try:
                content = changed(rng.choice(keys), rng.choice(JUNK), content)
            except (IndexError, KeyError, TypeError, ValueError):
                continue  # the table to change is no longer there
        try:
            study = sf.Study.from_dict(content)
        except sf.InputError as error:
            assert str(error)
            assert "\n" not in str(error)
        else:
            accepted += 1
            assert sf.Study.from_canonical(study.canonical) == study
    assert 0 < accepted < FUZZED


def test_fuzzed_files_are_read_or_refused_with_a_sentence(tmp_path):
    rng = random.Random(1)  # noqa: S311 - a test's draws
    text = (STUDIES / "atlas.toml").read_bytes()
    path = tmp_path / "fuzzed.toml"
    for _ in range(2000):
        broken = bytearray(text)
        for _ in range(rng.randint(1, 6)):
            at = rng.randrange(len(broken))
            broken[at : at + rng.randint(0, 3)] = rng.randbytes(rng.randint(0, 3))
        path.write_bytes(broken)
        try:
            sf.Study.from_toml(path)
        except sf.InputError as error:
            assert "\n" not in str(error)


def test_fuzzed_canonical_texts_are_read_or_refused_with_a_sentence():
    rng = random.Random(2)  # noqa: S311 - a test's draws
    text = sf.Study.from_dict(UNEQUAL).canonical
    for _ in range(3000):
        broken = list(text)
        for _ in range(rng.randint(1, 4)):
            at = rng.randrange(len(broken))
            broken[at : at + rng.randint(0, 3)] = rng.choice('0123456789{}[]",:einfstacklo-.')
        try:
            sf.Study.from_canonical("".join(broken))
        except sf.InputError as error:
            assert "\n" not in str(error)


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
        changed("stiffness.knee", INF),
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
    other = sf.Study.from_dict(changed("stiffness.knee", [800.0, INF], changed("title", "Old")))
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
