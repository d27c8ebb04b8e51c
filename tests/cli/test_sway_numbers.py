"""``standfast sway --measure … --fit``: published numbers, fitted as the library does."""

import csv
import io
import json
import math

import pytest

import standfast as sf
from fits import fits_once
from recordings import sway, table
from standfast.cli.app import main

TABLE = {"sd_ap": 0.0041, "mean_velocity_ap": 0.0058}
MEASURES = ("--measure", "sd_ap=4.1mm", "--measure", "mean_velocity_ap=0.0058")
PERSON = ("--law", "dec-2015", "--height", "1.75", "--mass", "70")
FIT = ("--fit", "noise,derivative_gain")


@pytest.fixture(scope="module", autouse=True)
def one_fit_each():
    """The command is asked for the fit of the library."""
    with fits_once():
        yield


@pytest.fixture(scope="module")
def fitted():
    body = sf.Body.from_height_mass(1.75, 70.0)
    return sf.fit_sway(TABLE, "dec-2015", body, free=("noise", "derivative_gain"), duration=30)


def said(capsys, *command, code=0):
    assert main(["sway", *map(str, command)]) == code
    out, err = capsys.readouterr()
    return err if code else out


def test_the_text_is_that_of_a_fit_and_says_of_what(fitted, capsys):
    text = said(capsys, *MEASURES, "--duration", "30", *PERSON, *FIT)
    assert "The numbers are of 30 s at 100 Hz, behind a low-pass at 10 Hz." in text
    for name, estimate in {**fitted.parameters, **fitted.margins}.items():
        (line,) = (x for x in text.splitlines() if x.startswith(f"  {name.replace('_', ' ')}  "))
        for number in estimate[:3]:
            assert f"{number:.4g}" in line
    (line,) = (x for x in text.splitlines() if x.startswith("  SD of the CoP"))
    assert line.split()[5] == "4.1"
    assert text.rstrip().endswith(fitted.status)


def test_json_and_the_table_have_all(fitted, capsys, tmp_path):
    path = tmp_path / "t.csv"
    command = (*MEASURES, "--duration", "30", *PERSON, *FIT)
    found = json.loads(said(capsys, *command, "--json", "--csv", path))
    assert found["measures"] == pytest.approx(TABLE)
    assert (found["duration"], found["rate"], found["low_pass"]) == (30.0, 100.0, None)
    noise = found["fit"]["parameters"]["noise"]["value"]
    assert noise == pytest.approx(fitted.parameters["noise"].value, rel=1e-9)
    (row,) = csv.DictReader(io.StringIO(path.read_text(encoding="utf-8")))
    assert float(row["sd_ap_mm"]) == pytest.approx(4.1)
    assert float(row["mean_velocity_ap_mm_s"]) == pytest.approx(5.8)
    assert float(row["fit_noise_Nm_sqrt_s"]) == pytest.approx(noise, rel=1e-7)


@pytest.mark.parametrize(
    ("written", "name", "value"),
    [
        ("sd_ap=0.41cm", "sd_ap", 0.0041),
        ("mean_velocity_ap=5.8 mm/s", "mean_velocity_ap", 0.0058),
        ("mean_frequency_ap=0.23Hz", "mean_frequency_ap", 0.23),
        ("sd_hip=0.22deg", "sd_hip", math.radians(0.22)),
        ("sd_hip=0.22°", "sd_hip", math.radians(0.22)),
        ("sd_ap=4.1e-3", "sd_ap", 0.0041),
    ],
)
def test_a_number_may_have_its_unit(written, name, value, capsys, monkeypatch):
    given = []

    def refuses(measured, *_, **__):
        given.append(measured)
        raise sf.InputError("enough")

    monkeypatch.setattr("standfast.fitting.fit.fit_sway", refuses)
    said(capsys, "--measure", written, *PERSON, *FIT, code=2)
    assert given == [{name: pytest.approx(value)}]


WRONG = {
    "nothing": ((), "give a recording, or numbers to fit a law to: --measure sd_ap=4.1mm --fit"),
    "no fit": ((*MEASURES, *PERSON), "numbers alone are there to be fitted: add --fit, --law and"),
    "no law": ((*MEASURES, "--fit"), "--fit needs the law whose noise and gains it finds"),
    "no such measure": (("--measure", "sd_app=1", *PERSON, "--fit"), "--measure sd_app cannot be fitted; did you mean 'sd_ap'?"),
    "no number": (("--measure", "sd_ap=small", *PERSON, "--fit"), "--measure sd_ap=small is not a number in m or cm or mm"),
    "no such unit": (("--measure", "sd_ap=4.1kg", *PERSON, "--fit"), "--measure sd_ap=4.1kg is not a number in m or cm or mm"),
    "no name": (("--measure", "4.1", *PERSON, "--fit"), "--measure 4.1: '4.1' is not NAME=NUMBER, as sd_ap=4.1mm"),
    "mm for m": (("--measure", "sd_ap=4.1", *PERSON, *FIT[:1], "noise"), "--fit: sd_ap = 4.1 m is outside of 0.0001 to 0.1 m, between which people are; is the unit right?"),
    "twice": ((*MEASURES, "--measure", "sd_ap=3mm", *PERSON, *FIT), "--measure sd_ap is given twice"),
    "too few": ((*MEASURES, *PERSON, "--fit"), "are 3 open numbers, which need 3 measures or more"),
    "a figure": ((*MEASURES, *PERSON, *FIT, "-o", "a.png"), "numbers have no path and no spectrum to draw"),
    "an option of files": ((*MEASURES, *PERSON, *FIT, "--unit", "mm"), "--unit says how recordings are read; leave it away"),
    "a height of the surface": ((*MEASURES, *PERSON, *FIT, "--surface", "0.04"), "--surface says how recordings are read; leave it away"),
    "short": ((*MEASURES, *PERSON, *FIT, "--duration", "3"), "--fit: --duration = 3 s is outside of 5 to 1200 s"),
    "a word": ((*MEASURES, *PERSON, *FIT, "--duration", "long"), "--duration = 'long' is not a number"),
}  # fmt: skip


@pytest.mark.parametrize("name", WRONG)
def test_what_is_wrong_is_said(name, capsys):
    command, sentence = WRONG[name]
    assert sentence in said(capsys, *command, code=2)


def test_a_table_that_is_another_is_refused_before_the_fit(capsys, tmp_path, monkeypatch):
    path = tmp_path / "t.csv"
    path.write_text("a,b\n1,2\n", encoding="utf-8")
    monkeypatch.setattr("standfast.fitting.fit.fit_sway", lambda *_, **__: pytest.fail("fits"))
    message = said(capsys, *MEASURES, *PERSON, *FIT, "--csv", path, code=2)
    assert "is no table of standfast of this kind" in message
    assert path.read_text(encoding="utf-8") == "a,b\n1,2\n"


def test_a_recording_has_its_own_measures_and_duration(capsys, tmp_path):
    time, ap, ml = sway()
    path = tmp_path / "a.csv"
    path.write_text(table(["t (s)", "ap (mm)", "ml (mm)"], [time, 1e3 * ap, 1e3 * ml]), "utf-8")
    message = said(capsys, path, *MEASURES, *PERSON, *FIT, code=2)
    assert f"--measure beside {path}, whose measures are computed; give one of both" in message
    assert "--duration beside a recording" in said(capsys, path, "--duration", "30", code=2)
