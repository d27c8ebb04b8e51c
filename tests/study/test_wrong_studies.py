"""The study's border: every wrong study gets its sentence, and nothing else."""

import math
import random
from pathlib import Path

import numpy as np
import pytest

import standfast as sf
from standfast.quantities import QUANTITIES
from studies import GOOD, UNEQUAL, changed

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
