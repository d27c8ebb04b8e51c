"""The commands ``population`` and ``assess``, as a user calls them."""

import csv
import json
import math

import pytest

import standfast as sf
from standfast.cli.app import main
from standfast.parameters import JOINTS

STUDY = """
title = "Army women under a stiff law"
gravity = 9.81
[population]
people = "people.csv"
body_model = "winter"
size = 20000
seed = 5
[stiffness.ankle]
distribution = "normal"
relative_to = "single_joint_critical"
mean = 1.8
sd = 0.3
[stiffness.knee]
distribution = "fixed"
value = inf
[stiffness.hip]
distribution = "fixed"
relative_to = "single_joint_critical"
value = 2.0
"""
PEOPLE = """id,height,mass,sex,age,ankle_stiffness,knee_stiffness,hip_stiffness
A,1.70,70,female,30,900,inf,500
B,1.80,90,male,70,900,2000,
C,1.60,60,female,41,400,inf,300
D,165,60,female,41,,,
E,1.65,110,male,67,1200,1500,260
"""


@pytest.fixture
def place(tmp_path, monkeypatch):
    """A folder with a study and its people."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "women.toml").write_text(STUDY)
    (tmp_path / "people.csv").write_text(PEOPLE)
    return tmp_path


def test_population_tells_draws_and_writes(place, capsys):
    assert main(["population", "women.toml"]) == 0
    told = capsys.readouterr().out
    assert "20,000 persons drawn from people.csv, seed 5" in told
    assert "4 people used, 1 row rejected, 0 not selected" in told
    assert "people.csv, line 5: height = 165 is outside the allowed range" in told
    assert "drivers of falling" in told
    names = {path.name for path in place.iterdir()}
    assert names == {
        "women.toml",
        "people.csv",
        "women.h5",
        "women.run.json",
        "women-rejected.csv",
        "women-risk-map.png",
        "women-risk-by-multiple.png",
        "women-safety-factor.png",
        "women-drivers-unstable.png",
        "women-drivers-safety_factor.png",
    }
    header, row = (place / "women-rejected.csv").read_text(encoding="utf-8").splitlines()
    assert header == "file,line,reason"
    assert row.startswith('people.csv,5,"height = 165 is outside')
    # the same command again, and the commands that read the file
    assert main(["population", "women.toml", "--no-figures"]) == 0
    assert capsys.readouterr().out.splitlines()[:8] == told.splitlines()[:8]
    assert main(["info", "women.h5"]) == 0
    assert "unstable" in capsys.readouterr().out
    assert main(["plot", "women.h5", "-o", "figures", "--format", "pdf"]) == 0
    assert len(list((place / "figures").glob("*.pdf"))) == 5


def test_population_as_json(place, capsys):
    assert main(["population", "women.toml", "--json", "--no-figures"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert {
        "unstable_fraction",
        "unstable_fraction_interval",
        "size",
        "seed",
        "effective_sample_size",
    } <= set(found)
    assert (found["size"], found["seed"]) == (20000, 5)
    low, high = found["unstable_fraction_interval"]
    assert 0.0 <= low < found["unstable_fraction"] < high <= 1.0
    assert found["people"]["rejected"][0]["line"] == 5
    assert main(["info", "women.h5", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["unstable_fraction"] == found["unstable_fraction"]


def test_parts_and_what_info_says_of_them(place, capsys):
    text = STUDY.replace("size = 20000", "size = 20000\nmethod = 'quasi-monte-carlo'")
    (place / "women.toml").write_text(text)
    assert main(["population", "women.toml", "--part", "2/3"]) == 0
    assert "Share 2/3 of women.h5 is done" in capsys.readouterr().out
    assert main(["info", "women.h5"]) == 0
    assert "not finished, 5 of 16 shards" in capsys.readouterr().out
    assert main(["info", "women.h5", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["done"] == 5


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (["population", "nothing.toml"], "nothing.toml: there is no such study file"),
        (["population", "women.toml", "--strict"], "people.csv, line 5: height = 165 is outside"),
        (["assess", "nobody.csv"], "nobody.csv: there is no such file of people"),
        (["assess", "people.csv", "--strict"], "people.csv, line 5: height = 165 is outside"),
        (["assess", "people.csv", "--hip", "stiff"], "--hip = 'stiff' is text; give a number"),
        (["assess", "people.csv", "--hip", "-3"], "--hip = -3 is outside the allowed range"),
        (["assess", "people.csv", "--gravity", "0"], "--gravity = 0 is outside the allowed range"),
        (["assess", "people.csv", "--body-model", "wintr"], "did you mean 'winter'?"),
        (["sweep", "women.toml"], "this is the study of a population; run: standfast population"),
        (["thresholds", "women.h5"], "there is no such file"),
    ],
)
def test_what_a_user_gets_wrong(place, capsys, arguments, sentence):
    assert main(arguments) == 2
    said = capsys.readouterr().err
    assert sentence in said
    assert said.count("\n") == 1


def test_a_population_is_not_an_atlas(place, capsys):
    assert main(["population", "women.toml", "--no-figures"]) == 0
    assert main(["thresholds", "women.h5"]) == 2
    assert "women.h5 is HDF5, but not an atlas of standfast" in capsys.readouterr().err
    (place / "women.h5").write_bytes(b"nothing")
    assert main(["population", "women.toml", "--no-figures"]) == 2
    assert "women.h5 is not an HDF5 file" in capsys.readouterr().err


def rows_of(path):
    with path.open(encoding="utf-8") as file:
        return {row["id"]: row for row in csv.DictReader(file)}


def test_assess_gives_one_line_a_person(place, capsys):
    assert main(["assess", "people.csv", "--gravity", "9.81"]) == 0
    told = capsys.readouterr().out
    assert "4 persons assessed, 1 row rejected" in told
    assert "of 3 with known stiffness stand" in told
    rows = rows_of(place / "people-assessed.csv")
    assert list(rows) == ["A", "B", "C", "E"]
    for name, joints in (("A", (900, math.inf, 500)), ("E", (1200, 1500, 260))):
        row = rows[name]
        body = sf.Body.from_height_mass(float(row["height_m"]), float(row["mass_kg"]))
        K = sf.Stiffness(*joints)
        critical = sf.critical_stiffness(body, K, gravity=9.81)
        stands = sf.is_stable(body, K, gravity=9.81)
        assert row["stands"] == ("yes" if stands else "no")
        for joint, threshold in zip(JOINTS, critical.joints, strict=True):
            assert float(row[f"{joint}_threshold_Nm_rad"]) == pytest.approx(threshold, rel=1e-5)
        rigid = sf.Stiffness(0.0, math.inf, math.inf)
        alone = sf.critical_stiffness(body, rigid, gravity=9.81).ankle
        assert float(row["ankle_threshold_alone_Nm_rad"]) == pytest.approx(alone, rel=1e-5)
        found = sf.safety_factor(body, K, gravity=9.81)
        assert float(row["safety_factor"]) == pytest.approx(found, rel=1e-5)
        reserve = sf.stiffness_reserve(body, K, gravity=9.81)
        assert float(row["stiffness_reserve_Nm_rad"]) == pytest.approx(reserve, rel=1e-5)
        frequency = sf.frequency(body, K, gravity=9.81)
        assert float(row["frequency_Hz"]) == pytest.approx(frequency, rel=1e-5)
        ratio = sf.modes(body, K, gravity=9.81).shapes[2, 0]
        assert row["strategy"] == ("hip" if abs(ratio) > 1.0 else "ankle")
    # whose hip is not known gets thresholds alone
    assert rows["B"]["stands"] == rows["B"]["safety_factor"] == rows["B"]["least_gain_at"] == ""
    assert float(rows["B"]["hip_threshold_Nm_rad"]) > 0.0


def test_what_would_let_a_person_stand_again(place, capsys):
    """With the gain that is given they stand, with a little less they fall."""
    assert main(["assess", "people.csv", "--gravity", "9.81", "--json"]) == 0
    summary = json.loads(capsys.readouterr().out)
    row = rows_of(place / "people-assessed.csv")["C"]
    assert row["stands"] == "no"
    assert summary["stand"] < summary["judged"]
    body = sf.Body.from_height_mass(1.6, 60.0)
    K = sf.Stiffness(400.0, math.inf, 300.0)
    gains = {joint: row[f"{joint}_gain_needed_Nm_rad"] for joint in JOINTS}
    assert gains["knee"] == "inf"  # it is rigid already
    for joint in ("ankle", "hip"):
        gain = float(gains[joint])
        if math.isfinite(gain):
            own = getattr(K, joint)
            assert sf.is_stable(body, K._replace(**{joint: own + 1.001 * gain}), gravity=9.81)
            assert not sf.is_stable(body, K._replace(**{joint: own + 0.999 * gain}), gravity=9.81)
    assert row["least_gain_at"] == "ankle"


def test_assess_takes_what_is_not_measured_from_the_options(place):
    assert main(["assess", "people.csv", "--hip", "700", "-o", "out.csv"]) == 0
    rows = rows_of(place / "out.csv")
    assert rows["B"]["hip_stiffness_Nm_rad"] == "700"
    assert rows["A"]["hip_stiffness_Nm_rad"] == "500"
    assert rows["B"]["stands"] in ("yes", "no")


def test_no_id_is_a_formula_of_a_spreadsheet(place, capsys):
    """Nor the name of a file among the rejected rows; options are numbers in plain digits."""
    ids = ["=1+1", "+1", "-1", "@SUM(A1)", "plain"]
    rows = "".join(f"{name},1.7,70\n" for name in ids)
    (place / "=people.csv").write_text(f"id,height,mass\n{rows}bad,0,0\n")
    assert main(["assess", "=people.csv", "-o", "out.csv"]) == 0
    assert list(rows_of(place / "out.csv")) == ["'=1+1", "'+1", "'-1", "'@SUM(A1)", "plain"]
    assert "\n'=people.csv,7," in (place / "out-rejected.csv").read_text()
    assert main(["assess", "=people.csv", "--hip", "7_00"]) == 2
    assert "--hip = '7_00' is text; give a number" in capsys.readouterr().err


def test_what_assess_writes_can_be_read_again(place):
    assert main(["assess", "people.csv"]) == 0
    assert main(["assess", "people-assessed.csv", "-o", "again.csv"]) == 0
    assert (place / "again.csv").read_text() == (place / "people-assessed.csv").read_text().replace(
        "people", "again"
    )
