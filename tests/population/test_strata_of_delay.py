"""Tables and screens of classes with feedback: which delay each class bears, and how many fall."""

import csv
import json
import math

import numpy as np
import pytest

import standfast as sf
from standfast.cli.app import main

# A curve is stored at every 2 ms, and a quantile lies within a bin of 1.2 %: between them a share
# moves by less, as no class here spreads over less than 50 ms.
SHARE_TOLERANCE = 0.04

STUDY = """
[population]
people = "people.csv"
size = 4000
age_bands = [40, 65]
[stiffness]
ankle = { distribution = "normal", relative_to = "mgh", mean = 0.67, sd = 0.08 }
knee = { distribution = "fixed", value = inf }
hip = { distribution = "fixed", value = inf }
[feedback]
delay = 0.1
[feedback.proportional]
ankle = { distribution = "normal", relative_to = "mgh", mean = 0.9, sd = 0.1 }
[feedback.derivative]
ankle = { distribution = "normal", relative_to = "mgh", mean = 0.35, sd = 0.07 }
"""


def write_people(path):
    random = np.random.default_rng(8)
    rows = ["height,mass,sex,age"]
    for number in range(60):
        sex = ("male", "female")[number % 2]
        height = random.normal(1.75 if sex == "male" else 1.62, 0.06)
        mass = random.uniform(20, 30) * height**2
        rows.append(f"{height:.3f},{mass:.1f},{sex},{(30, 50, 70)[number % 3]}")
    path.write_text("\n".join([*rows, "1.7,70,,50"]) + "\n")


def table(path):
    with path.open(encoding="utf-8") as file:
        return list(csv.DictReader(file))


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    folder = tmp_path_factory.mktemp("delays")
    write_people(folder / "people.csv")
    (folder / "study.toml").write_text(STUDY)
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        assert main(["population", "study.toml", "--no-figures", "--csv", "s.csv"]) == 0
    return folder


def test_every_class_by_sex_and_age_has_the_delays_of_its_curve(place):
    rows = {(row["stratum"], row["class"]): row for row in table(place / "s.csv")}
    population = sf.open_population(place / "study.h5")
    delay, curves = population.array("delay"), population.array("standing_by_sex_and_age")
    ages = ("under 40", "40-64", "65+")
    for s, sex in enumerate(("male", "female")):
        for a, age in enumerate(ages):
            row = rows["sex and age", f"{sex} {age}"]
            for share in ("0.5", "0.9", "0.95", "0.99"):
                names = (f"delay_borne_by_{share}{end}_s" for end in ("_95_low", "", "_95_high"))
                low, borne, high = (float(row[name]) for name in names)
                assert low <= borne <= high
                if borne > 0.0:
                    assert low < high
                    stand = np.interp(borne, delay, curves[s, a])
                    assert stand == pytest.approx(float(share), abs=SHARE_TOLERANCE)
    # of unknown sex there is one age, so that both classes are the same persons
    assert (
        rows["sex and age", "unknown 40-64"]["delay_borne_by_0.5_s"]
        == rows["sex", "unknown"]["delay_borne_by_0.5_s"]
        != ""
    )
    assert rows["BMI", "25 to 30"]["delay_borne_by_0.5_s"] == ""


def test_json_and_screen_tell_them_too(place, monkeypatch, capsys):
    monkeypatch.chdir(place)
    assert main(["info", "study.h5"]) == 0
    told = capsys.readouterr().out.partition("delay up to which that share stands")[2]
    assert "\n  female 65+ " in told
    assert "unknown 40-64" not in told
    assert main(["info", "study.h5", "--json"]) == 0
    borne = json.loads(capsys.readouterr().out)["delay_borne"]
    assert len(borne["sex_and_age"]) == 7
    everybody = borne["all"]["0.5"]["delay"]
    of_classes = [each["0.5"]["delay"] for each in borne["sex_and_age"].values()]
    assert min(of_classes) < everybody < max(of_classes)


def test_infinite_delays_are_infinite_and_not_empty(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    write_people(tmp_path / "people.csv")
    text = STUDY.replace("mean = 0.67, sd = 0.08", "mean = 3.0, sd = 0.01")
    text = text.replace("mean = 0.9, sd = 0.1", "mean = 0.1, sd = 0.01")
    text = text.replace("mean = 0.35, sd = 0.07", "mean = 0.01, sd = 0.001")
    (tmp_path / "study.toml").write_text(text + "[damping]\nankle = 500\n")
    assert main(["population", "study.toml", "--no-figures", "--csv", "s.csv"]) == 0
    assert table(tmp_path / "s.csv")[0]["delay_borne_by_0.99_s"] == "inf"


def test_one_year_bands_make_a_file_that_can_be_read(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    rows = [f"1.7,70,{sex},{age}" for sex in ("m", "f") for age in range(20, 80)]
    (tmp_path / "people.csv").write_text("\n".join(["height,mass,sex,age", *rows]) + "\n")
    text = STUDY.replace("[40, 65]", str(list(range(20, 80))))
    (tmp_path / "study.toml").write_text(text)
    assert main(["population", "study.toml", "--no-figures"]) == 0
    assert len(sf.open_population("study.h5").summary["strata"]["sex_and_age"]) == 120


def test_assess_tells_delays_and_both_kinds_of_falls(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    write_people(tmp_path / "people.csv")
    options = ["--ankle", "500", "--knee", "inf", "--hip", "inf", "--delay", "0.258"]
    gains = ["--proportional", "ankle=0.9mgh", "--derivative", "ankle=0.3mgh"]
    assert main(["assess", "people.csv", *options, *gains, "--csv", "s.csv"]) == 0
    told = capsys.readouterr().out
    head = next(line for line in told.splitlines() if "ankle alone needs, median" in line)
    assert head.index("fall by springs alone") < head.index("fall with feedback")
    rows = {(row["stratum"], row["class"]): row for row in table(tmp_path / "s.csv")}
    persons = table(tmp_path / "people-assessed.csv")
    for sex in ("male", "female"):
        chosen = [row for row in persons if row["sex"] == sex]
        delays = [float(row["critical_delay_s"]) for row in chosen]
        found = rows["sex", sex]
        for share in (5, 50, 95):
            wanted = np.quantile(delays, share / 100.0)
            assert math.isfinite(wanted)
            of_table = float(found[f"critical_delay_s_p{share}"])
            assert of_table == pytest.approx(wanted, rel=1e-5)
        falls = sum(row["stands_with_feedback"] == "no" for row in chosen)
        assert int(found["unstable_with_feedback"]) == falls
        assert 0 < falls < len(chosen)
        assert falls != int(found["unstable"])
        line = next(line for line in told.splitlines() if line.startswith(f"    {sex} "))
        assert f"{100.0 * falls / len(chosen):.3g} % [" in line
