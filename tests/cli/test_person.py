"""``standfast person``: the same numbers as the library, in words, as JSON and drawn."""

import json
import math
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import standfast as sf
from standfast.cli.app import main
from standfast.figures.person import draw_person, stiffness_bars
from standfast.figures.style import paper_figure
from standfast.parameters import JOINTS, PARAMETERS, SEGMENT_NUMBERS

PERSON = "person --height 1.66 --mass 68 --ankle 900 --knee 1500 --hip 400"
MEASURED = (
    "person --segment-mass 5.6,14.2,46.8 --segment-inertia 0.085,0.24,2.72"
    " --segment-length 0.385,0.405 --segment-com 0.22,0.235,0.344"
    " --ankle 900 --knee 1500 --hip 400"
)
FED_BACK = (
    "person --height 1.8 --bmi 24 --model de-leva-male --gravity 9.81 --ankle 600 --knee inf"
    " --hip 900 --ankle-hip 20 --damping ankle=40 --damping hip=40"
    " --proportional ankle=500 --proportional ankle_hip=50 --derivative ankle=200 --delay 0.05"
)


def said(capsys, command, code=0):
    assert main(command.split()) == code
    out, err = capsys.readouterr()
    return err if code else out


def test_the_verdict_with_measured_segments_differs(capsys):
    text = said(capsys, PERSON)
    assert text.startswith(
        "1.66 m, 68 kg, winter; gravity 9.80665 m/s²\n\nStands: safety factor 1.05 "
    )
    assert "sways at 0.108 Hz" in text
    text = said(capsys, MEASURED)
    assert text.startswith("own segments, 66.6 kg without the feet; gravity")
    assert "Falls: safety factor 0.9707" in text
    assert "falls, doubles in 1.34 s" in text


def test_json_holds_the_numbers_of_the_library(capsys):
    found = json.loads(said(capsys, FED_BACK + " --json"))
    body = sf.Body.from_height_mass(1.8, 24 * 1.8**2, "de-leva-male")
    stiffness = sf.Stiffness(600, math.inf, 900, ankle_hip=20)
    gains = np.zeros((3, 3))
    gains[0, 0], gains[0, 2] = 500.0, 50.0
    nerves = {"damping": (40, 0, 40), "feedback": sf.Feedback(gains, (200, 0, 0), 0.05)}
    person = (body, stiffness, 9.81)
    assert found["stands_by_springs"] is sf.is_stable(*person)
    assert found["stands_with_feedback"] is sf.is_stable(*person, **nerves)
    assert found["critical_delay"] == sf.critical_delay(*person, **nerves)
    assert found["delay_margin"] == found["critical_delay"] - 0.05
    assert found["unstable_roots"] == sf.unstable_roots(*person, **nerves)
    root = sf.rightmost_root(*person, **nerves)
    assert found["rightmost_root"] == [root.real, root.imag]
    assert found["safety_factor"] == sf.safety_factor(*person)
    assert found["stiffness_reserve"] == sf.stiffness_reserve(*person)
    assert found["stiffness"] == {"ankle": 600.0, "knee": "inf", "hip": 900.0}
    thresholds = sf.critical_stiffness(*person).joints
    assert [float(found["thresholds"][joint]) for joint in JOINTS] == list(map(float, thresholds))
    modes = sf.modes(*person)
    assert [mode["eigenvalue"] for mode in found["modes"]] == modes.eigenvalues[:2].tolist()
    shapes = [list(mode["rotations"].values()) for mode in found["modes"]]
    np.testing.assert_array_equal(shapes, modes.shapes.T[:2])
    assert found["body"]["segment_mass"] == body.segment_mass.tolist()


def test_every_parameter_of_the_table_has_its_option(capsys):
    with pytest.raises(SystemExit):
        main(["person", "--help"])
    text = " ".join(capsys.readouterr().out.split())
    assert "example: standfast person --height 1.66" in text
    for row in PARAMETERS.values():
        if row.section.startswith(("damping", "feedback.", "body.")):
            continue
        assert f"--{row.key.replace('_', '-')} " in text
        assert (
            "edwards2007" in text if row.choices else f"{row.lowest:g} to {row.highest:g}" in text
        )
    for part in SEGMENT_NUMBERS:
        assert f"--{part.replace('_', '-')}" in text


@pytest.mark.parametrize(
    ("command", "sentence"),
    [
        (PERSON.replace("1.66", "166"), "--height = 166 is outside the allowed range, 0.5 to 2.8"),
        (PERSON.replace("--height 1.66", ""), "--height is missing, or give the person's own seg"),
        (PERSON.replace("--mass 68", ""), "give --mass or --bmi; neither is given"),
        (PERSON + " --bmi 24", "give --mass or --bmi; both are given"),
        (PERSON.replace("--hip 400", ""), "--hip is missing; for a rigid hip write --hip inf"),
        (PERSON.replace("400", "-4"), "--hip = -4 is outside the allowed range, 0 to 1e+12"),
        (PERSON.replace("400", "4OO"), "--hip = '4OO' is text; give a number"),
        (PERSON.replace("400", "nan"), "--hip = 'nan' is text; give a number"),
        (PERSON + " --model wintr", "--model = 'wintr' is not a body model; did you mean 'winter'"),
        (PERSON + " --damping ankel=3", "--damping has no key 'ankel'; did you mean 'ankle'?"),
        (PERSON + " --damping 3", "--damping 3: '3' is not JOINT=NUMBER, as ankle=30"),
        (PERSON + " --damping ankle=3,5", "--damping ankle=3,5: '5' is not JOINT=NUMBER, as ank"),
        (PERSON + " --damping ankle=-3", "--damping ankle = -3 is outside the allowed range"),
        (PERSON + " --delay 100", "--delay = 100 is outside the allowed range, 0 to 10 s; 100 lo"),
        (PERSON + " -o figure.jpg", "figure.jpg is not the name of a figure; end it in .png"),
        (PERSON.replace("1.66", "1,66"), "--height = '1,66' is text; give a number, 0.5 to 2.8 m; "
         "decimals have a point, write 1.66"),
        (PERSON + " --gravity 981", "--gravity = 981 is outside the allowed range, 0.001 to 200 m/"
         "s²; 981 looks like cm/s², write 9.81"),
        (PERSON + " --segment-mass 5,14,46", "--height and --mass beside --segment-mass: give a"),
        (MEASURED.replace("5.6", "5600"), "--segment-mass shank = 5600 is outside the allowed ran"),
        (MEASURED.replace("46.8", "46.8,1"), "--segment-mass = [5.6, 14.2, 46.8, 1.0] is not 3"),
        (MEASURED.replace("0.22,", "0.52,"), "the centre of mass of the shank lies 0.52 m above"),
        (MEASURED.replace("--segment-com 0.22,0.235,0.344", ""), "--segment-com is missing; meas"),
        (PERSON.replace("900", "inf").replace("1500", "inf").replace("400", "inf") + " -o a.png",
         "three rigid joints do not move, so there is nothing to draw"),
    ],
)  # fmt: skip
def test_what_is_wrong_is_said_by_its_option(capsys, command, sentence):
    assert f"standfast: {sentence}" in said(capsys, command, code=2)


def test_what_cannot_be_helped_is_said(capsys):
    text = said(capsys, "person --height 1.8 --mass 80 --ankle 100 --knee 100 --hip 100")
    assert "no joint alone suffices" in text
    text = said(capsys, "person --height 1.8 --mass 80 --ankle inf --knee inf --hip inf")
    assert "Stands: every joint is rigid." in text
    assert "none: all three joints are rigid" in text


def test_the_verdict_that_was_asked_comes_first(capsys):
    weak = PERSON.replace("900", "400")
    lines = said(capsys, weak + " --proportional ankle=600 --derivative ankle=150").split("\n")
    assert lines[2] == (
        "Stands with feedback: critical delay 0.008731 s, delay 0 s, margin 0.008731 s."
    )
    # a root crosses at 177 rad/s
    assert lines[3] == (
        "At the critical delay a sway at 28.2 Hz begins to grow; stiff joints without damping ring "
        "(--damping ankle=…,knee=…,hip=…)."
    )
    assert lines[6].startswith("Falls by springs alone: safety factor 0.5707")
    assert lines[7] == (
        "They would just stand with 333.7 N·m/rad more at each joint, or with ankle alone at its "
        "threshold."
    )


def test_what_is_lost_at_the_critical_delay_is_its_crossing(capsys):
    found = json.loads(said(capsys, FED_BACK + " --json"))
    body = sf.Body.from_height_mass(1.8, 24 * 1.8**2, "de-leva-male")
    gains = np.zeros((3, 3))
    gains[0, 0], gains[0, 2] = 500.0, 50.0
    crossings = sf.delay_crossings(
        body,
        sf.Stiffness(600, math.inf, 900, ankle_hip=20),
        9.81,
        damping=(40, 0, 40),
        feedback=sf.Feedback(gains, (200, 0, 0)),
    )
    omega = next(w for delay, w, _ in crossings if delay == pytest.approx(found["critical_delay"]))
    assert found["critical_frequency"] == pytest.approx(omega / math.tau, rel=1e-12)
    text = said(capsys, FED_BACK)
    assert f"a sway at {omega / math.tau:.3g} Hz begins to grow.\n" in text  # it does not ring


def test_joints_of_one_option_may_stand_together(capsys):
    apart = " --damping ankle=30 --damping knee=20 --damping hip=10 --proportional ankle=500"
    found = json.loads(said(capsys, PERSON + apart + " --json"))
    together = " --damping ankle=30,knee=20,hip=10 --proportional ankle=500"
    assert json.loads(said(capsys, PERSON + together + " --json")) == found
    assert found["given"]["hip_damping"] == 10.0


def test_a_delay_without_gains_does_nothing(capsys):
    text = said(capsys, PERSON + " --delay 0.1")
    assert "Stands: safety factor 1.05" in text
    assert "Without gains (--proportional, --derivative) the delay does nothing." in text
    assert "feedback as given" not in text
    assert "Stands with damping.\n" in said(capsys, PERSON + " --damping ankle=20")
    assert "the delay does nothing" not in said(capsys, FED_BACK)


STUDY = """
gravity = 9.81
[body]
height = 1.66
mass = 68
[stiffness]
ankle = [500, 900]
knee = 1500
hip = 400
[damping]
hip = 20
[feedback]
delay = { start = 0, stop = 0.1, num = 3 }
[feedback.proportional]
ankle = [100, 200]
"""


def test_a_study_gives_what_the_options_leave_open(tmp_path, capsys):
    path = tmp_path / "a.toml"
    path.write_text(STUDY)
    said_of = "--ankle 900 --proportional ankle=150 --delay 0.05 --json"
    found = json.loads(said(capsys, f"person {path} {said_of}"))
    options = f"{PERSON} --gravity 9.81 --damping hip=20 {said_of}"
    wanted = json.loads(said(capsys, options))
    assert found == wanted
    other = json.loads(said(capsys, f"person {path} {said_of} --knee 1600 --bmi 24"))
    assert other["given"]["knee_stiffness"] == 1600.0
    assert "mass" not in other["given"]
    message = said(capsys, f"person {path}", code=2)
    assert message == (
        f"standfast: {path} varies what one person has once; add --ankle X --delay X "
        "--proportional ankle=X\n"
    )
    # measured segments of the options take the place of the study's height and mass
    measured = MEASURED.removeprefix("person ")
    given = json.loads(said(capsys, f"person {path} {said_of} {measured}"))["given"]
    assert given["shank_mass"] == 5.6
    assert "height" not in given


def test_a_study_may_give_measured_segments(tmp_path, capsys):
    path = Path(__file__).parents[2] / "studies" / "own-body.toml"
    springs = "--ankle 900 --knee 1500 --hip 400"
    assert said(capsys, f"person {path} {springs}") == said(capsys, MEASURED)
    heavier = said(capsys, f"person {path} {springs} --segment-mass 5.6,14.2,48 --json")
    assert json.loads(heavier)["body"]["segment_mass"] == [5.6, 14.2, 48.0]
    message = said(capsys, f"person {path} {springs} --height 1.7", code=2)
    assert "--height beside --segment-mass and" in message
    varying = tmp_path / "b.toml"
    text = path.read_text(encoding="utf-8").replace("14.2, 46.8", "[13, 14], [46, 47]")
    varying.write_text(text, encoding="utf-8")
    message = said(capsys, f"person {varying} {springs}", code=2)
    assert message.endswith("once; add --segment-mass X,X,X\n")


def test_it_needs_neither_jax_nor_matplotlib():
    code = (
        f"import sys; from standfast.cli.app import main; main({FED_BACK.split()!r})\n"
        "heavy = {'jax', 'matplotlib', 'h5py'} & set(sys.modules)\n"
        "sys.exit(f'imported {heavy}' if heavy else 0)"
    )
    result = subprocess.run([sys.executable, "-c", code], capture_output=True, check=False)
    assert result.returncode == 0, result.stderr


@pytest.mark.parametrize("suffix", ["png", "svg", "pdf"])
def test_the_figure_is_drawn_in_the_format_of_its_name(tmp_path, capsys, suffix):
    path = tmp_path / f"a.person.{suffix}"
    text = said(capsys, f"{MEASURED} -o {path}")
    assert text.endswith(f"Written: {path}\n")
    first = path.read_bytes()
    assert first.startswith({"png": b"\x89PNG", "svg": b"<?xml", "pdf": b"%PDF"}[suffix])
    said(capsys, f"{MEASURED} -o {path}")
    assert path.read_bytes() == first


def test_bars_say_what_is_there_and_what_is_needed():
    with paper_figure() as (_, (ax,)):
        stiffness_bars(
            ax,
            {"ankle": 900.0, "knee": math.inf, "hip": 400.0},
            {"ankle": 700.0, "knee": 1e5, "hip": math.inf},
        )
        assert [text.get_text() for text in ax.texts] == [
            "900, needs 700", "rigid, needs 1e+05", "400, no stiffness suffices",
        ]  # fmt: skip
        widths = [bar.get_width() for bar in ax.patches]
        assert widths == [900.0, 2700.0, 400.0]  # a threshold far away does not flatten them
        assert [bool(bar.get_hatch()) for bar in ax.patches] == [False, False, True]
        marks = [line.get_xdata()[0] for line in ax.lines]
        assert marks == [700.0, 2700.0]


def test_a_head_is_where_the_height_says(tmp_path, monkeypatch):
    drawn = {}

    def pattern(ax, lengths, rotation, _):
        drawn.update(lengths=lengths, rotation=rotation)
        ax.plot([0.0], [0.0], label="drawn")

    monkeypatch.setattr("standfast.figures.person.sway_pattern", pattern)
    body = sf.Body.from_height_mass(1.8, 80.0)
    joints = dict.fromkeys(JOINTS, 900.0)
    draw_person(tmp_path / "a.png", body, 1.8, rotation=(1.0, 0.5, -3.0), words=("a", "b"),
                falls=False, title="", stiffness=joints, thresholds=joints)  # fmt: skip
    assert sum(drawn["lengths"]) == pytest.approx(1.8 * 0.961, rel=1e-12)
    # the joint that turns most turns by 10°
    np.testing.assert_allclose(np.degrees(drawn["rotation"]), (10 / 3, 5 / 3, -10), rtol=1e-12)


@pytest.mark.parametrize(
    ("command", "title", "labels"),
    [
        (PERSON, None, ["one extreme", "the other"]),
        (PERSON.replace("900", "400"), None, ["falling one way", "the other way"]),
        (FED_BACK, "Stands with damping and feedback\ncritical delay 0.",
         ["falling one way", "the other way"]),
    ],
)  # fmt: skip
def test_the_figure_says_what_is_drawn(tmp_path, monkeypatch, capsys, command, title, labels):
    figures = []
    monkeypatch.setattr("standfast.figures.person.save", lambda figure, *_: figures.append(figure))
    said(capsys, f"{command} -o {tmp_path / 'a.png'}")
    (figure,) = figures
    legend = figure.axes[0].get_legend()
    assert [text.get_text() for text in legend.get_texts()] == labels
    assert figure.axes[0].get_xlabel() == "Forward (m), amplitude arbitrary"
    above = figure.get_suptitle()
    assert above.startswith(title) if title else above == ""
    if title:
        assert ", delay 0.05 s" in above
        assert figure.axes[1].get_title().startswith("springs alone: falls, safety factor")
