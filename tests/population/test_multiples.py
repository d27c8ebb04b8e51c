"""A stiffness of ``assess`` as a multiple of each person's own load, and one that is none."""

import csv
import math

import numpy as np
import pytest

import standfast as sf
from standfast.cli.app import main

# Numbers of a CSV file have six digits.
SIX_DIGITS = 1e-5


@pytest.fixture
def place(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    rows = "A,1.7,70,m,\nB,1.6,60,f,\nC,1.85,95,divers,500\n"
    (tmp_path / "p.csv").write_text("id,height,mass,sex,ankle_stiffness\n" + rows)
    return tmp_path


def rows_of(path):
    with path.open(encoding="utf-8") as file:
        return {row["id"]: row for row in csv.DictReader(file)}


def test_a_multiple_is_of_the_load_of_ones_own_body(place):
    command = ["assess", "p.csv", "--gravity", "9.81"]
    assert main([*command, "--ankle", "0.67mgh", "--hip", "0.5mgh", "--knee", "inf"]) == 0
    rows = rows_of(place / "p-assessed.csv")
    for name, height, mass in (("A", 1.7, 70.0), ("B", 1.6, 60.0)):
        rigid = sf.Stiffness(0.0, math.inf, math.inf)
        body = sf.Body.from_height_mass(height, mass)
        load = sf.critical_stiffness(body, rigid, gravity=9.81).ankle
        row = rows[name]
        ankle, hip = (float(row[f"{joint}_stiffness_Nm_rad"]) for joint in ("ankle", "hip"))
        assert ankle == pytest.approx(0.67 * load, rel=SIX_DIGITS)
        assert hip == pytest.approx(0.5 * load, rel=SIX_DIGITS)
        stands = sf.is_stable(body, sf.Stiffness(0.67 * load, math.inf, 0.5 * load), gravity=9.81)
        assert row["stands"] == ("yes" if stands else "no")
    assert rows["C"]["ankle_stiffness_Nm_rad"] == "500"  # measured


def test_in_python_it_is_a_text(place):
    found = sf.assess("p.csv", otherwise={"ankle": "0.67mgh", "knee": math.inf, "hip": math.inf})
    alone = found.columns["ankle_threshold_alone_Nm_rad"]
    ankle = found.columns["ankle_stiffness_Nm_rad"]
    np.testing.assert_allclose(ankle[:2], 0.67 * alone[:2], rtol=1e-12)
    for given in ("0.67 of mgh", "mgh", "nanmgh", "-1mgh"):
        with pytest.raises(sf.InputError, match=r"otherwise\['ankle'\]"):
            sf.assess("p.csv", otherwise={"ankle": given})


def test_a_stiffness_that_holds_nobody_is_noted(place, capsys):
    assert main(["assess", "p.csv", "--ankle", "0.67", "--knee", "inf", "--hip", "0"]) == 0
    told = capsys.readouterr().out
    assert (
        "note: stiffness of the ankle below 5 N·m/rad holds nobody (2 of 3 persons, as 0.67); if a "
        "multiple is meant, write --ankle 0.67mgh"
    ) in told
    assert "stiffness of the hip" not in told
    assert main(["assess", "p.csv", "--ankle", "0.67mgh"]) == 0
    assert "holds nobody" not in capsys.readouterr().out
    assert main(["assess", "p.csv", "--ankle", "0.67mhg"]) == 2
    assert "or a multiple of the body's load, as 0.67mgh" in capsys.readouterr().err


def test_sex_is_chosen_by_the_words_of_files(place, capsys):
    for word, name in (("divers", "C"), ("W", "B"), ("male", "A")):
        assert main(["assess", "p.csv", "--sex", word]) == 0
        assert list(rows_of(place / "p-assessed.csv")) == [name]
    for word in ("femal", "unknown"):
        with pytest.raises(SystemExit):
            main(["assess", "p.csv", "--sex", word])
        assert f"{word!r} is not known; write male, female or other" in capsys.readouterr().err


def test_the_gains_of_a_published_law_are_asked_of_ones_own_persons(place):
    """The page on people: 943.9 of 610.7 N·m/rad of its own body is 1.5456 of mgh."""
    law = sf.LAWS["pasma-2017"]
    proportional, derivative = law.feedback.proportional[0, 0], law.feedback.derivative[0, 0]
    assert proportional / law.load == pytest.approx(1.5456, abs=5e-5)
    assert derivative / law.load == pytest.approx(0.5133, abs=5e-5)

    def of_mgh(value):
        return {"distribution": "fixed", "relative_to": "mgh", "value": value}

    found = sf.assess(
        "p.csv",
        otherwise={"ankle": "0.0663mgh", "knee": math.inf, "hip": math.inf},
        nerves={
            "damping": {"ankle": of_mgh(0.1127)},
            "feedback": {
                "delay": 0.097,
                "proportional": {"ankle": of_mgh(1.5456)},
                "derivative": {"ankle": of_mgh(0.5133)},
            },
        },
    )
    alone = found.columns["ankle_threshold_alone_Nm_rad"]
    gains = found.columns["ankle_proportional_gain_Nm_rad"]
    np.testing.assert_allclose(gains / alone, 1.5456, rtol=1e-12)
    assert found.columns["stands_with_feedback"].tolist() == ["yes"] * 3
    normal = {"distribution": "normal", "mean": 0.1, "sd": 0.01}
    with pytest.raises(sf.InputError, match="feedback_delay is normal; of single persons it is a"):
        sf.assess("p.csv", nerves={"feedback": {"delay": normal}})
