"""``assess`` and the table of strata, from a messy file to what a paper prints."""

import csv
import json
import math
import re

import numpy as np
import pytest

import messy_people
import standfast as sf
from standfast.cli.app import main
from standfast.engine.mapping import map_over_batch
from standfast.population.summary.estimators import wilson


@pytest.fixture(scope="module")
def messy(tmp_path_factory):
    """The messy file assessed once: the folder, what is in the file, the summary."""
    folder = tmp_path_factory.mktemp("messy")
    told = messy_people.write(folder / "messy.txt")
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        options = ["--knee", "inf", "--age-bands", "20,40,65,80", "--csv", "strata.csv"]
        assert main(["assess", "messy.txt", *options]) == 0
    return folder, told


def table(path):
    with path.open(encoding="utf-8") as file:
        return list(csv.DictReader(file))


def test_only_impossible_rows_are_rejected_and_nobody_for_being_old(messy):
    folder, told = messy
    rows = table(folder / "messy-assessed.csv")
    assert len(rows) == messy_people.SIZE - told["rejected"]
    assert len(table(folder / "messy-assessed-rejected.csv")) == told["rejected"]
    old = [row for row in rows if row["age"] in ("80", "90")]
    assert told["top-coded"] - 10 < len(old) <= told["top-coded"]
    assert sum(row["sex"] == "other" for row in rows) == told["sex other"]
    heights = np.array([float(row["height_m"]) for row in rows])
    masses = np.array([float(row["mass_kg"]) for row in rows])
    assert 1.5 < heights.mean() < 1.8
    assert 60.0 < masses.mean() < 80.0
    assert list(rows[0])[-2:] == ["Site", "Falls last year"]
    assert {row["Site"] for row in rows} == {"Köln", "'=Ulm", "Graz; Ost"}


def test_the_table_of_strata_counts_the_rows_of_the_table_of_persons(messy):
    folder, _ = messy
    rows = table(folder / "messy-assessed.csv")
    strata = {(r["stratum"], r["class"]): r for r in table(folder / "strata.csv")}
    kinds = ("all", "sex", "age", "sex and age", "BMI", "height")
    assert tuple(dict.fromkeys(kind for kind, _ in strata)) == kinds
    for kind in kinds:
        assert sum(int(r["persons"]) for (k, _), r in strata.items() if k == kind) == len(rows)
    assert strata["BMI", "25 to 30"]["unit_of_class"] == "kg/m²"
    chosen = [
        row for row in rows if row["sex"] == "female" and row["age"] and float(row["age"]) >= 80
    ]
    found = strata["sex and age", "female 80+"]
    judged = [row for row in chosen if row["stands"]]
    falls = sum(row["stands"] == "no" for row in judged)
    assert (int(found["persons"]), int(found["judged"])) == (len(chosen), len(judged))
    assert int(found["unstable"]) == falls
    wanted = wilson(falls, len(judged))
    assert float(found["unstable_fraction"]) == pytest.approx(wanted.value, rel=1e-5)
    ends = (float(found["unstable_95_low"]), float(found["unstable_95_high"]))
    assert ends == pytest.approx((wanted.low, wanted.high), rel=1e-5)
    middle = np.median([float(row["ankle_threshold_alone_Nm_rad"]) for row in chosen])
    assert float(found["ankle_threshold_alone_Nm_rad_p50"]) == pytest.approx(middle, rel=1e-5)
    labels = [c for k, c in strata if k == "age"]
    assert labels == ["20-39", "40-64", "65-79", "80+", "unknown"]


def test_sex_and_age_choose_persons(messy, monkeypatch, capsys):
    folder, _ = messy
    monkeypatch.chdir(folder)
    arguments = ["assess", "messy.txt", "--sex", "other", "--age", "65+", "-o", "o.csv", "--json"]
    assert main(arguments) == 0
    found = json.loads(capsys.readouterr().out)
    rows = table(folder / "o.csv")
    assert {row["sex"] for row in rows} == {"other"}
    assert min(float(row["age"]) for row in rows) >= 65.0
    everybody = found["persons"] + found["not_selected"] + len(found["rejected"])
    assert everybody == messy_people.SIZE
    assert found["strata"]["all"]["all"]["persons"] == found["persons"] == len(rows)
    assert "Wilson" in found["interval_method"]


def test_every_column_is_explained_by_the_help(messy, capsys):
    folder, _ = messy
    with pytest.raises(SystemExit):
        main(["assess", "--help"])
    told = capsys.readouterr().out
    for column in list(table(folder / "messy-assessed.csv")[0])[:-2]:
        assert re.sub(r"^(ankle|knee|hip)_", "JOINT_", column) in told


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        (["--age", "old"], '--age = \'old\' is not a range of ages; write "65+" or "20-39"'),
        (["--age-bands", "18;30"], "--age-bands = '18;30' is no list of whole years from 0 to 130"),
        (["--age-bands", "30,18"], "--age-bands = [30, 18] does not rise"),
        (["--csv", "p.csv"], "p.csv is the file of people itself; choose another output"),
        (["--csv", "o.csv", "-o", "o.csv"], "o.csv cannot be both -o and --csv"),
        (["--age", "65+"], "p.csv has no usable row: 0 rejected; 1 of another sex or age"),
    ],
)
def test_wrong_options_get_their_sentence(tmp_path, monkeypatch, capsys, options, sentence):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "p.csv").write_text("height,mass,age\n1.7,70,30\n")
    assert main(["assess", "p.csv", *options]) == 2
    assert sentence in capsys.readouterr().err


def test_own_columns_of_our_names_are_computed_anew_and_told(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "p.csv").write_text("id,height,mass,stands,group\nA,1.7,70,maybe,x\n")
    assert main(["assess", "p.csv", "--ankle", "inf", "--knee", "inf", "--hip", "inf"]) == 0
    (row,) = table(tmp_path / "p-assessed.csv")
    assert (row["stands"], row["group"]) == ("yes", "x")
    told = capsys.readouterr().out
    assert "computed anew, not kept as they were: stands" in told
    assert "1 person assessed, 0 rows rejected" in told


@pytest.fixture(scope="module")
def fifty(tmp_path_factory):
    """Fifty persons with springs and a gain."""
    random = np.random.default_rng(3)
    rows = [f"{h:.3f},{m:.1f},{a:.1f},{g:.1f}" for h, m, a, g in zip(
        random.uniform(1.5, 1.9, 50), random.uniform(50, 100, 50), random.uniform(300, 900, 50),
        random.uniform(100, 900, 50), strict=True,
    )]  # fmt: skip
    header = "height,mass,ankle_stiffness,ankle_proportional_gain"
    path = tmp_path_factory.mktemp("fifty") / "p.csv"
    path.write_text("\n".join([header, *rows]))
    return sf.read_people(path)


def test_a_person_gets_the_same_bits_in_any_company(fifty, monkeypatch):
    """And what is compiled for them serves any number of persons, on every planet."""
    programs = set()

    def noted(*problem):
        programs.add(problem)  # each serves any number (test_distributions.py)
        return map_over_batch(*problem)

    monkeypatch.setattr("standfast.population.assess.map_over_batch", noted)
    otherwise = {"knee": 900.0, "hip": "0.6mgh"}
    whole = sf.assess(fifty, otherwise=otherwise).columns
    compiled = set(programs)
    for company in ([0], [7], [3, 1], range(49, -1, -1), range(5, 38)):
        chosen = np.array(company)
        found = sf.assess(fifty.at(chosen), otherwise=otherwise).columns
        for name, values in whole.items():
            np.testing.assert_array_equal(found[name], values[chosen], err_msg=name)
    sf.assess(fifty, otherwise=otherwise, gravity=1.62)
    assert programs == compiled


def test_pieces_and_their_length_are_irrelevant(fifty, monkeypatch):
    people, told = fifty, []
    otherwise = {"knee": math.inf, "hip": math.inf}
    whole = sf.assess(people, otherwise=otherwise, progress=lambda *at: told.append(at))
    assert told == [(50, 100), (100, 100)]
    monkeypatch.setattr("standfast.population.assess.PIECE", 7)
    told.clear()
    pieces = sf.assess(people, otherwise=otherwise, progress=lambda *at: told.append(at))
    assert told[0] == (7, 100)
    assert told[-1] == (100, 100)
    assert whole.columns.keys() == pieces.columns.keys()
    for name, values in whole.columns.items():
        if values.dtype == np.float64:
            np.testing.assert_allclose(pieces.columns[name], values, rtol=1e-12)
        else:
            assert pieces.columns[name].tolist() == values.tolist()


def test_assess_reads_files_itself_and_refuses_what_makes_no_sense(tmp_path):
    (tmp_path / "p.csv").write_text("height,mass,centre\n1.7,70,Bonn\n")
    found = sf.assess(tmp_path / "p.csv", otherwise={"ankle": 900.0})
    assert found.own["centre"].tolist() == ["Bonn"]
    assert found.columns["ankle_stiffness_Nm_rad"].tolist() == [900.0]
    for settings, sentence in (
        ({"otherwise": {"ankel": 1.0}}, "otherwise has no key 'ankel'; did you mean 'ankle'"),
        ({"otherwise": {"ankle": -1.0}}, r"otherwise\['ankle'\] = -1 is outside"),
        ({"body_model": "wintr"}, "did you mean 'winter'"),
        ({"gravity": 0.0}, "gravity = 0 is outside"),
    ):
        with pytest.raises(sf.InputError, match=sentence):
            sf.assess(tmp_path / "p.csv", **settings)


def test_a_population_of_the_messy_file_writes_the_table_of_its_strata(messy, monkeypatch, capsys):
    folder, _ = messy
    monkeypatch.chdir(folder)
    (folder / "s.toml").write_text(
        '\ufeff[population]\npeople = "messy.txt"\nage_bands = [20, 40, 65, 80]\nsize = 4000\n'
        'proportions = "scattered"\n'
        "[stiffness]\nankle = {distribution = 'normal', mean = 0.9, sd = 0.2}\n"
        "knee = {distribution = 'fixed', value = inf}\n"
        "hip = {distribution = 'fixed', value = inf}\n",
        encoding="utf-8",
    )
    for own in ("messy.txt", "s.toml", "s.h5"):
        assert main(["population", "s.toml", "--csv", own]) == 2
        assert f"--csv {own} is a file of this study itself" in capsys.readouterr().err
    assert main(["population", "s.toml", "--csv", "s.csv", "--no-figures"]) == 0
    told, warned = capsys.readouterr()
    assert "stiffness.ankle.mean = 0.9 N·m/rad holds nobody; did you mean a multiple: rel" in warned
    assert "by sex and age, years" in told
    assert "of the persons drawn" in told
    assert "95 % interval of the simulation, Wilson's score interval" in told
    rows = table(folder / "s.csv")
    assert rows[0]["stratum"] == "all"
    assert int(rows[0]["persons_simulated"]) == 4000
    for kind in ("sex", "age", "sex and age", "BMI", "height"):
        chosen = [row for row in rows if row["stratum"] == kind]
        assert sum(int(row["persons_simulated"]) for row in chosen) == 4000
        assert sum(float(row["share_of_persons"]) for row in chosen) == pytest.approx(1.0)
    assert {"other", "unknown"} <= {row["class"] for row in rows if row["stratum"] == "sex"}


def test_joints_of_one_option_may_stand_together(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "people.csv").write_text("height,mass\n1.7,70\n")
    springs = ["assess", "people.csv", "--ankle", "500", "--knee", "inf", "--hip", "900"]
    apart = ["--proportional", "ankle=0.5mgh", "--proportional", "hip=100", "--damping", "hip=20"]
    together = ["--proportional", "ankle=0.5mgh,hip=100", "--damping", "hip=20"]
    assert main([*springs, *apart, "-o", "apart.csv"]) == 0
    assert main([*springs, *together, "-o", "together.csv"]) == 0
    assert (tmp_path / "together.csv").read_text() == (tmp_path / "apart.csv").read_text()
    (row,) = table(tmp_path / "together.csv")
    assert row["hip_proportional_gain_Nm_rad"] == "100"
