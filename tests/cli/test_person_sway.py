"""``standfast person --noise``: the sway of one person, as the library and the table have it."""

import json
import math

import numpy as np
import pytest

import standfast as sf
from standfast.cli.app import main
from standfast.parameters import JOINTS

PERSON = (
    "person --height 1.66 --mass 68 --ankle 400 --knee 1500 --hip 350"
    " --damping ankle=30,knee=20,hip=15 --proportional ankle=600 --derivative ankle=150"
    " --delay 0.05"
)
NOISE = " --noise ankle=1,hip=0.3"
STUDY = """
gravity = 9.81
[body]
height = 1.66
mass = 68.0
[stiffness]
ankle = 900.0
knee = 1500.0
hip = [350.0, 400.0]
[damping]
ankle = 30.0
[noise]
ankle = 1.0
knee = 0.5
"""
DEGREES, MILLI = math.degrees(1.0), 1e3
# Of a grid each variance is good to 1e-6 (engine.delays.OF_GRIDS); a deviation is its root.
OF_GRIDS = 1e-6


def said(capsys, command, code=0):
    assert main(command.split()) == code
    out, err = capsys.readouterr()
    return err if code else out


def of_library():
    body = sf.Body.from_height_mass(1.66, 68.0, "winter")
    stiffness = sf.Stiffness(400.0, 1500.0, 350.0)
    nerves = {
        "damping": (30, 20, 15),
        "feedback": sf.Feedback((600, 0, 0), (150, 0, 0), 0.05),
        "noise": (1.0, 0.0, 0.3),
    }
    return body, stiffness, nerves


def sway_in(capsys, options):
    return json.loads(said(capsys, f"{options} --json"))["sway"]


def test_json_is_the_librarys_covariance(capsys):
    sway = sway_in(capsys, PERSON + NOISE)
    body, stiffness, nerves = of_library()
    covariance = sf.sway_covariance(body, stiffness, **nerves)
    np.testing.assert_array_equal(sway["covariance"], covariance)
    for place, joint in enumerate(JOINTS):
        assert sway[f"{joint}_sway"] == math.sqrt(covariance[place, place])


def test_the_spectrum_adds_up_to_what_is_said_of_the_centres(capsys):
    sway = sway_in(capsys, PERSON + NOISE)
    body, stiffness, nerves = of_library()
    # of steps in log f, below which and beyond which hardly anything is left
    f = np.geomspace(1e-5, 200.0, 200_001)
    spectrum = sf.sway_spectrum(body, stiffness, **nerves, frequency=f)

    def total(density):
        return np.trapezoid(density * f, np.log(f))

    close = {"rel": 1e-4}  # what the ends leave out
    assert sway["com_sway"] == pytest.approx(math.sqrt(total(spectrum.com)), **close)
    assert sway["cop_sway"] == pytest.approx(math.sqrt(total(spectrum.cop)), **close)
    velocity = (math.tau * f) ** 2 * spectrum.cop
    assert sway["cop_velocity"] == pytest.approx(math.sqrt(total(velocity)), **close)
    mean = total(f * spectrum.cop) / total(spectrum.cop)
    assert sway["cop_frequency"] == pytest.approx(mean, **close)


def test_a_grid_has_the_same_numbers(capsys):
    sway = sway_in(capsys, PERSON + NOISE)
    names = [name for name in sway if name != "covariance"]
    study = sf.Study.from_dict({
        "body": {"model": "winter", "height": 1.66, "mass": 68.0},
        "stiffness": {"ankle": 400.0, "knee": 1500.0, "hip": [350.0, 500.0]},
        "damping": {"ankle": 30.0, "knee": 20.0, "hip": 15.0},
        "feedback": {
            "delay": 0.05, "proportional": {"ankle": 600.0}, "derivative": {"ankle": 150.0},
        },
        "noise": {"ankle": 1.0, "hip": 0.3},
        "output": {"quantities": names},
    })  # fmt: skip
    found = sf.compute(study)
    for name in names:
        assert float(found[name][0]) == pytest.approx(sway[name], rel=OF_GRIDS), name
        assert float(found[name][1]) != pytest.approx(sway[name], rel=1e-3), name


def test_words_have_degrees_and_millimetres(capsys):
    text = said(capsys, PERSON + NOISE)
    sway = sway_in(capsys, PERSON + NOISE)
    assert "ankle noise 1 N·m·√s" in text.partition("\n")[0]
    lines = text.partition("Under noise it sways")[2].splitlines()[1:]
    shown = [line.split() for line in lines]
    assert [words[-2] for words in shown] == ["°", "°", "°", "mm", "mm", "mm/s", "Hz"]
    sizes = [DEGREES] * 3 + [MILLI] * 3 + [1.0]
    expected = [size * sway[name] for size, name in zip(sizes, sway, strict=False)]
    assert [float(words[-1]) for words in shown] == pytest.approx(expected, rel=1e-3)
    rigid = said(capsys, f"{PERSON}{NOISE}".replace("--knee 1500", "--knee inf"))
    assert "SD of the knee's rotation     °          rigid" in rigid


def test_without_noise_nothing_is_said_of_sway(capsys):
    assert "noise" not in said(capsys, PERSON)
    assert "sway" not in json.loads(said(capsys, f"{PERSON} --json"))


def test_who_falls_has_no_sway(capsys):
    falls = PERSON.replace("--delay 0.05", "--delay 0.5") + NOISE
    assert "Under noise it has no sway: it falls." in said(capsys, falls)
    sway = sway_in(capsys, falls)
    assert sway.pop("cop_frequency") is None
    assert np.unique(np.array(list(sway.pop("covariance")))).tolist() == ["inf"]
    assert set(sway.values()) == {"inf"}


def test_what_nothing_damps_is_moved_ever_more(capsys):
    alone = "person --height 1.66 --mass 68 --ankle 900 --knee inf --hip 400 --noise hip=1"
    text = said(capsys, alone)
    assert "Nothing damps it, and noise moves it ever more (--damping ankle=…,hip=…)." in text
    sway = sway_in(capsys, alone)
    assert (sway["ankle_sway"], sway["knee_sway"], sway["cop_sway"]) == ("inf", 0.0, "inf")


def test_noise_of_a_rigid_joint_moves_nothing(capsys):
    rigid = PERSON.replace("--hip 350", "--hip inf") + " --noise hip=1"
    assert "Nothing sways: no joint that turns has noise." in said(capsys, rigid)
    assert sway_in(capsys, rigid) is None


def test_what_rounding_leaves_open_is_none(capsys, monkeypatch):
    def is_open(*_, **__):
        raise ArithmeticError

    monkeypatch.setattr("standfast.quantities.person_facts.sway_covariance", is_open)
    sway = sway_in(capsys, PERSON + NOISE)
    assert sway["ankle_sway"] is None
    assert sway["covariance"] == [[None] * 3] * 3
    assert sway["com_sway"] > 0.0
    text = said(capsys, PERSON + NOISE)
    assert "open: within rounding, or too near to falling to say" in text


def test_a_study_gives_its_noise_and_an_option_another(capsys, tmp_path):
    path = tmp_path / "noisy.toml"
    path.write_text(STUDY, encoding="utf-8")
    found = json.loads(said(capsys, f"person {path} --hip 350 --noise ankle=2 --json"))
    given = {name: value for name, value in found["given"].items() if name.endswith("_noise")}
    assert given == {"ankle_noise": 2.0, "knee_noise": 0.5}
    path.write_text(STUDY.replace("knee = 0.5", "knee = [0.5, 1.0]"), encoding="utf-8")
    assert "add --noise knee=X" in said(capsys, f"person {path} --hip 350", code=2)


@pytest.mark.parametrize(("option", "words"), [
    ("ankle=-1", "--noise ankle = -1 is outside the allowed range, 0 to 10000 N·m·√s"),
    ("hop=1", "--noise has no key 'hop'; did you mean 'hip'?"),
    ("ankle=much", "--noise ankle = 'much' is text"),
    ("1", "--noise 1: '1' is not JOINT=NUMBER"),
])  # fmt: skip
def test_a_wrong_noise_is_a_sentence(capsys, option, words):
    assert words in said(capsys, f"{PERSON} --noise {option}", code=2)
