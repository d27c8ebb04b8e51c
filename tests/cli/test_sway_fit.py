"""``standfast sway --fit``: what the library finds, as text and JSON, and what it asks for."""

import csv
import dataclasses
import io
import json
import math

import numpy as np
import pytest

import standfast as sf
from fits import fits_once
from recordings import sway, table
from standfast.cli.app import main
from standfast.cli.person_options import GivenPerson
from standfast.cli.sway_fit import fit_facts, fit_row
from standfast.figures import recording as recording_figures
from standfast.figures.recording import spectra
from standfast.fitting.result import Estimate
from standfast.parameters import JOINTS
from standfast.recordings import expected

PERSON = ("--law", "dec-2015", "--height", "1.72", "--mass", "68")
FIT = ("--fit", "noise,derivative_gain")


@pytest.fixture(scope="module", autouse=True)
def one_fit_each():
    """The command is asked for the same fit by most tests."""
    with fits_once():
        yield


@pytest.fixture(scope="module")
def file(tmp_path_factory):
    time, ap, ml = sway(1)
    path = tmp_path_factory.mktemp("plate") / "a.csv"
    names = ["t (s)", "COP_AP (mm)", "COP_ML (mm)"]
    path.write_text(table(names, [time, 1e3 * ap, 1e3 * ml], decimals=9), encoding="utf-8")
    return path


@pytest.fixture(scope="module")
def fitted(file):
    body = sf.Body.from_height_mass(1.72, 68.0)
    free = ("noise", "derivative_gain")
    return sf.fit_sway(sf.read_recording(file), "dec-2015", body, free=free)


def said(capsys, *command, code=0):
    assert main(["sway", *map(str, command)]) == code
    out, err = capsys.readouterr()
    return err if code else out


def test_the_text_has_estimates_intervals_and_the_status(file, fitted, capsys):
    lines = said(capsys, file, *PERSON, *FIT).splitlines()
    printed = lines[lines.index("Fit of dec-2015, with 95 % intervals") :]
    for name, estimate in {**fitted.parameters, **fitted.margins}.items():
        (line,) = (x for x in printed if x.startswith(f"  {name.replace('_', ' ')}  "))
        assert f"{estimate.value:.4g}" in line
        assert f"{estimate.low:.4g}" in line
        assert f"{estimate.high:.4g}" in line
    assert printed[-1] == f"  {fitted.status}"


def test_json_has_all_in_si(file, fitted, capsys):
    (found,) = json.loads(said(capsys, file, *PERSON, *FIT, "--json"))["recordings"]
    fit = found["fit"]
    assert [*fit["parameters"]] == ["noise", "derivative_gain"]
    for name, estimate in fitted.parameters.items():
        assert fit["parameters"][name]["value"] == pytest.approx(estimate.value, rel=1e-9)
        assert fit["parameters"][name]["unit"] == estimate.unit
    assert fit["measures"]["sd_ap"]["measured"] == pytest.approx(found["measures"]["sd_ap"])
    assert fit["status"] == fitted.status
    assert fit["explained"] is fitted.explained


def test_a_fit_can_be_traced_to_its_person(file, fitted, capsys):
    printed = said(capsys, file, *PERSON, *FIT, "--delay", "0.17", "--low-pass", "5")
    law = sf.LAWS["dec-2015"]
    scale = law.scale(sf.Body.from_height_mass(1.72, 68.0))
    assert f"Its stiffness, damping and gains are × {scale:.4g}, " in printed
    damping = f"ankle damping {scale * law.parameters['ankle_damping']:g} N·m·s/rad"
    assert f"Fitted on 1.72 m, 68 kg, winter; gravity 9.80665 m/s²; {damping}." in printed
    assert "The delay is held at 0.17 s. Noise of one strength is at ankle." in printed
    assert "Recording and model pass a low-pass at 5 Hz." in printed
    (found,) = json.loads(said(capsys, file, *PERSON, *FIT, "--json"))["recordings"]
    fit = found["fit"]
    assert fit["scaled_by"] == pytest.approx(scale)
    assert (fit["person"]["height"], fit["person"]["knee_stiffness"]) == (1.72, "inf")
    gains = fitted.person["feedback"]
    for kind in ("proportional", "derivative"):
        wanted = getattr(gains, kind)[0, 0]
        assert fit["person"][f"ankle_{kind}_gain"] == pytest.approx(wanted, rel=1e-9)
    assert fit["person"]["feedback_delay"] == law.delay
    noise = {"ankle_noise": fitted.noise[0], "knee_noise": 0.0, "hip_noise": 0.0}
    assert fit["noise"] == pytest.approx(noise, rel=1e-9)


def test_the_laws_own_body_is_said(file, capsys):
    printed = said(capsys, file, "--law", "dec-2015", "--fit", "noise")
    assert "on its own body.\nFitted on own segments, 69 kg without the feet" in printed
    assert "No body is given (--height and --mass), so it is the law's own." in printed
    assert "Samples are as given, taken to have passed a plate's low-pass at 10 Hz." in printed


def test_infinite_margins_are_written_as_of_a_person(fitted):
    given = GivenPerson({f"{joint}_stiffness": 1.0 for joint in JOINTS}, None, 1.0)
    endless = Estimate(math.inf, 0.1, math.inf, "s")
    margins = {**fitted.margins, "critical_delay": endless}
    facts = fit_facts(given, dataclasses.replace(fitted, margins=margins))
    critical = facts["margins"]["critical_delay"]
    assert (critical["value"], critical["low"], critical["high"]) == ("inf", 0.1, "inf")
    json.dumps(facts, allow_nan=False)


def test_the_table_has_estimates_margins_and_what_they_come_to(file, fitted, capsys, tmp_path):
    path = tmp_path / "t.csv"
    said(capsys, file, *PERSON, *FIT, "--csv", path)
    (row,) = csv.DictReader(io.StringIO(path.read_text(encoding="utf-8")))
    units = ["Nm_sqrt_s", "Nms_rad", "s", "s", "per_s", ""]
    both = {**fitted.parameters, **fitted.margins}
    for (name, estimate), unit in zip(both.items(), units, strict=True):
        for end, number in zip(("", "_low", "_high"), estimate[:3], strict=True):
            column = "_".join(part for part in (f"fit_{name}{end}", unit) if part)
            assert float(row.pop(column)) == pytest.approx(number, rel=1e-7)
    assert float(row["fit_p"]) == pytest.approx(fitted.p_value, rel=1e-7)
    assert row["fit_explained"] == ("yes" if fitted.explained else "no")
    open_ends = [
        f"{name}_{end}"
        for name, estimate in both.items()
        for end, is_open in zip(("low", "high"), estimate.open, strict=True)
        if is_open
    ]
    assert row["fit_open_ends"].split() == open_ends
    assert [*row][-3:] == ["fit_open_ends", "fit_p", "fit_explained"]


def test_the_table_says_nothing_of_a_law_that_cannot_be_tested(fitted):
    untested = dataclasses.replace(fitted, p_value=None, explained=None)
    *_, p_value, explained = fit_row(untested)
    assert math.isnan(p_value)
    assert explained == ""
    given = GivenPerson({f"{joint}_stiffness": 1.0 for joint in JOINTS}, None, 1.0)
    assert fit_facts(given, untested)["p_value"] is None


def test_the_figure_has_the_spectrum_of_the_person_fitted(
    file, fitted, capsys, tmp_path, monkeypatch
):
    drawn = []
    monkeypatch.setattr(
        recording_figures,
        "spectra",
        lambda axes, *given: drawn.append(given) or spectra(axes, *given),
    )
    path = tmp_path / "a.png"
    said(capsys, file, *PERSON, *FIT, "-o", path)
    ((_, _, shown),) = drawn
    found = sf.expected_sway(sf.read_recording(file), **fitted.person, noise=fitted.noise)
    np.testing.assert_allclose(shown.density, found.density, rtol=1e-6)
    assert path.exists()


def test_whose_spectrum_is_not_known_is_told(file, fitted, capsys, tmp_path, monkeypatch):
    path = tmp_path / "a.png"

    def falls(*_, **__):
        raise sf.InputError("the person falls, and so has no sway to compare")

    monkeypatch.setattr(expected, "expected_sway", falls)
    assert main(["sway", *map(str, (file, *PERSON, *FIT, "-o", path))]) == 0
    out, err = capsys.readouterr()
    assert fitted.status in out
    assert f"the spectrum of the person fitted to {file} is not drawn: the person falls" in err
    assert path.exists()


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        (("--fit",), "--fit needs the law whose noise and gains it finds: --law dec-2015"),
        ((*PERSON, "--fit", "nois"), "--fit: free: 'nois' is none of noise, proportional_gain,"),
        ((*PERSON, *FIT, "--noise", "ankle=1"), "--noise beside --fit: springs and damping are"),
        ((*PERSON[:2], *FIT, "--height", "1.7"), "give --mass or --bmi"),
    ],
)
def test_what_is_missing_is_said(file, options, sentence, capsys):
    assert sentence in said(capsys, file, *options, code=2)
