"""``standfast sway`` with a person in the model beside recordings, and laws by name."""

import csv
import io
import json
import math

import numpy as np
import pytest

import standfast as sf
from recordings import sway, table
from standfast.cli.app import main
from standfast.figures.recording import spectra
from standfast.figures.style import paper_figure
from standfast.recordings.expected import MODELLED
from standfast.recordings.measures import cop_spectrum

MM = 1e3


@pytest.fixture
def files(tmp_path):
    paths = []
    for name, seed in (("a.csv", 1), ("b.csv", 2)):
        time, ap, ml = sway(seed)
        text = table(["t (s)", "COP_AP (mm)", "COP_ML (mm)"], [time, MM * ap, MM * ml], decimals=9)
        (tmp_path / name).write_text(text, encoding="utf-8")
        paths.append(tmp_path / name)
    return paths


def said(capsys, *command, code=0):
    assert main([*map(str, command)]) == code
    out, err = capsys.readouterr()
    return err if code else out


def person_of(law, height, mass):
    """A law on another body, every number of it scaled by m g h: arguments of the library."""
    law, body = sf.LAWS[law], sf.Body.from_height_mass(height, mass)
    lengths, com = body.segment_length, body.segment_com
    heights = [com[0], lengths[0] + com[1], lengths[0] + lengths[1] + com[2]]
    factor = 9.80665 * float(np.dot(body.segment_mass, heights)) / law.load
    joints = [factor * k for k in law.stiffness.joints]
    late = law.feedback
    return {
        "body": body,
        "stiffness": sf.Stiffness(*joints),
        "damping": factor * law.damping,
        "feedback": sf.Feedback(factor * late.proportional, factor * late.derivative, late.delay),
    }


@pytest.mark.parametrize("law", ["pasma-2017", "wang-fpd-det", "lqr-pydy"])
def test_a_law_is_scaled_to_the_person_by_mgh(capsys, law):
    found = json.loads(
        said(capsys, "person", *f"--law {law} --height 1.7 --mass 90 --json".split())
    )
    person = person_of(law, 1.7, 90.0)
    assert found["critical_delay"] == pytest.approx(sf.critical_delay(**person), rel=1e-9)
    factor = found["law"]["scaled_by"]
    gain = sf.LAWS[law].feedback.proportional[0, 0]
    assert found["given"]["ankle_proportional_gain"] == pytest.approx(factor * gain)
    assert factor == pytest.approx(person["feedback"].proportional[0, 0] / gain, rel=1e-12)


@pytest.mark.parametrize("law", sf.LAWS)
def test_a_law_without_a_body_is_as_published(capsys, law):
    found = json.loads(said(capsys, "person", "--law", law, "--json"))
    critical = found["critical_delay"]
    own = sf.critical_delay(**sf.LAWS[law].person)
    assert (math.inf if critical == "inf" else critical) == pytest.approx(own, rel=1e-9)
    assert found["law"] == {"name": law, "scaled_by": 1.0}


def test_an_option_has_its_say_before_a_law_and_a_law_before_a_study(capsys, tmp_path):
    study = tmp_path / "s.toml"
    study.write_text(
        "gravity = 9.81\n[body]\nheight = 1.8\nmass = 80\n[stiffness]\nankle = [1, 2]\nknee = 5\n"
        "hip = 5\n[noise]\nankle = 0.5\n",
        encoding="utf-8",
    )
    command = ["person", study, "--law", "dec-2015", "--delay", "0.1", "--json"]
    found = json.loads(said(capsys, *command))["given"]
    assert (found["height"], found["gravity"], found["ankle_noise"]) == (1.8, 9.81, 0.5)
    assert (found["knee_stiffness"], found["feedback_delay"]) == ("inf", 0.1)
    assert 10.0 < found["ankle_stiffness"] < 200.0
    text = said(capsys, "person", "--law", "dec-2015", "--height", "1.8", "--mass", "80")
    assert text.startswith("Law dec-2015 (disturbance estimation and compensation, eyes closed).\n")


def test_the_model_stands_beside_the_recording_by_the_same_definitions(files, capsys):
    options = ["--law", "dec-2015", "--height", "1.7", "--mass", "70"]
    lines = said(capsys, "sway", files[0], *options).splitlines()
    printed = {" ".join(line.split()[:-3]): line.split()[-2:] for line in lines[3:20]}
    recording = sf.read_recording(files[0])
    measures = sf.sway_measures(recording)
    shown = sf.expected_sway(recording, **person_of("dec-2015", 1.7, 70.0))
    assert shown.sd_ap == pytest.approx(measures.sd_ap)
    for name in ("sd_ap", "mean_velocity_ap"):
        row = MODELLED[name]
        numbers = [row.factor * getattr(each, name) for each in (measures, shown)]
        assert list(map(float, printed[row.meaning])) == pytest.approx(numbers, rel=1e-3)
    for name in ("com_sway", "ankle_sway"):
        row = MODELLED[name]
        first, second = printed[row.meaning]
        assert first == "–"
        assert float(second) == pytest.approx(row.factor * getattr(shown, name), rel=1e-3)
    assert printed["area of the 95 % prediction ellipse"][1] == "–"
    text = "\n".join(lines)
    assert f"Its noise, {shown.noise[0]:.4g} N·m·√s at ankle, is not given, but that with" in text
    critical = sf.critical_delay(**person_of("dec-2015", 1.7, 70.0))
    assert f"critical delay {critical:.4g} s, delay 0.16 s" in text


def test_json_and_the_table_have_the_model_of_every_recording(files, capsys, tmp_path):
    path = tmp_path / "t.csv"
    options = ["--law", "wang-fpd-sto3", "--noise", "ankle=0.1,hip=0.2", "--low-pass", "5"]
    found = json.loads(said(capsys, "sway", *files, *options, "--csv", path, "--json"))
    rows = list(csv.DictReader(io.StringIO(path.read_text(encoding="utf-8"))))
    for file, one, row in zip(files, found["recordings"], rows, strict=True):
        shown = sf.expected_sway(
            sf.read_recording(file),
            **sf.LAWS["wang-fpd-sto3"].person,
            noise=(0.1, 0.0, 0.2),
            low_pass=5.0,
        )
        model = one["model"]
        for name in MODELLED:
            assert model["measures"][name] == pytest.approx(getattr(shown, name), rel=1e-9)
        assert model["noise"] == {"ankle_noise": 0.1, "knee_noise": 0.0, "hip_noise": 0.2}
        assert model["noise_from_recording"] is False
        velocity = float(row["model_mean_velocity_ap_mm_s"])
        assert velocity == pytest.approx(MM * shown.mean_velocity_ap)
        assert float(row["model_critical_delay_s"]) == pytest.approx(model["critical_delay"])
    text = said(capsys, "sway", *files, *options)
    assert f"{MM * shown.mean_velocity_ap:.4g}" in text
    assert "is not given, but" not in text
    # a table without a model may stand in its place, and the other way round
    said(capsys, "sway", *files, "--csv", path)


def test_the_figure_has_the_models_spectrum(files, capsys):
    recording = sf.read_recording(files[0])
    shown = sf.expected_sway(recording, **sf.LAWS["dec-2015"].person)
    with paper_figure() as (_, (axes,)):
        spectra(axes, cop_spectrum(recording), sf.sway_measures(recording), shown)
        (line,) = [each for each in axes.lines if each.get_label() == "AP, model"]
        hertz, density = line.get_xydata().T
    places = np.searchsorted(shown.frequency, hertz)
    np.testing.assert_allclose(density, 1e6 * shown.density[places])
    said(capsys, "sway", files[0], "--law", "dec-2015", "-o", files[0].with_suffix(".png"))
    assert files[0].with_suffix(".png").exists()


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        ("--height 1.7 --mass 70", "--ankle is missing; for a rigid ankle write --ankle inf, or"),
        ("--law dec-2015 --height 1.7", "give --mass or --bmi"),
        ("--law dec-2051", "dec-2051 is not a law; did you mean 'dec-2015'?"),
        ("--law suzuki-2020", "suzuki-2020 is not among the laws: it switches, and its gains"),
        ("--law dec-2015 --delay 0.5", "a.csv: the person falls, and so has no sway to compare"),
        ("--law dec-2015 --noise hip=1", "a.csv: no joint that turns has noise"),
        ("--law dec-2015 --noise anke=1", "--noise has no key 'anke'; did you mean 'ankle'?"),
        ("--study nowhere.toml", "nowhere.toml"),
    ],
)
def test_who_cannot_stand_beside_is_told_why(files, capsys, options, sentence):
    assert sentence in said(capsys, "sway", files[0], *options.split(), code=2)
