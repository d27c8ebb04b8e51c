"""Nobody is lost for a sex or an age that cannot be read, unless it is what they are chosen by."""

import math

import pytest

import standfast as sf
from standfast.cli.app import main
from standfast.population.people.records import read_people
from standfast.population.people.study import PopulationStudy
from standfast.population.people.words import age_of, is_top_coded, sex_of

TABLE = """height,mass,sex,age
1.70,70,U,44
1.71,71,trans,abt 70
1.72,72,Weibl.,85-89
1.73,73,female,999
1.74,74,m,-5
1.75,75,U,30
1.76,76,0,90 plus
1.77,77,9,85+
"""


@pytest.fixture
def file(tmp_path):
    path = tmp_path / "p.csv"
    path.write_text(TABLE)
    return path


def test_what_cannot_be_read_is_unknown_and_told(file):
    people = read_people(file)
    assert people.rejected == ()
    unknown = "unknown"
    assert people.sex == (unknown, unknown, unknown, "female", "male", *[unknown] * 3)
    ages = [44.0, math.nan, math.nan, math.nan, math.nan, 30.0, 90.0, 85.0]
    assert people.age.tolist() == pytest.approx(ages, nan_ok=True)
    assert people.remarks == (
        "p.csv: sex is given by numbers: 1 is read as male and 2 as female, 0 and 9 as not known; "
        "there is no 2, so if 0 is a sex here write words",
        "p.csv: 4 sexes are not read and taken as unknown: 'U' on lines 2, 7; 'trans' on line 3; "
        "'Weibl.' on line 4",
        "p.csv: 4 ages are not read and taken as unknown: 'abt 70' on line 3; '85-89' on line 4; "
        "'999' on line 5; '-5' on line 6",
        "2 ages such as 80+ are taken as the lowest, 85 and 90",
    )


@pytest.mark.parametrize(
    ("by", "rejected", "used"), [(["sex"], [2, 3, 4, 7], 4), (["age"], [3, 4, 5, 6], 4)]
)
def test_who_is_chosen_by_what_cannot_be_read_is_rejected(file, by, rejected, used):
    people = read_people(file, selected=lambda _sex, _age: True, selected_by=by)
    assert [each.line for each in people.rejected] == rejected
    assert len(people) == used


@pytest.mark.parametrize(
    ("options", "persons", "rejected"),
    [([], 8, 0), (["--sex", "female"], 1, 4), (["--age", "30+"], 4, 4)],
)
def test_options_reject_by_what_they_choose(file, monkeypatch, capsys, options, persons, rejected):
    monkeypatch.chdir(file.parent)
    assert main(["assess", "p.csv", "-o", "o.csv", *options]) == 0
    told = capsys.readouterr().out
    noun = "person" if persons == 1 else "persons"
    assert f"{persons} {noun} assessed, {rejected} rows rejected" in told
    if rejected:
        lines = (file.parent / "o-rejected.csv").read_text().splitlines()
        why = "sex = 'U' is not known" if "--sex" in options else "age = 'abt 70' is text"
        assert why in lines[1]


def test_strict_stops_at_the_first(file):
    with pytest.raises(sf.InputError, match="line 2: sex = 'U' is not known"):
        read_people(file, strict=True)


def test_numbers_of_sexes_and_words_of_ages():
    assert [sex_of(word) for word in ("0", "9", "9.0", "1", "2")] == [
        "unknown", "unknown", "unknown", "male", "female",
    ]  # fmt: skip
    assert [age_of(word) for word in ("90 plus", "90plus", "90 years plus")] == [90.0] * 3
    assert is_top_coded("90 plus")
    for word in ("3", "y", "１", "trans"):
        with pytest.raises(sf.InputError, match=f"sex = '{word}' is not known; write male, female"):
            sex_of(word)


def test_a_study_rejects_by_what_it_chooses(file):
    (file.parent / "s.toml").write_text(
        '[population]\npeople = "p.csv"\nage = "20+"\nsize = 100\n[stiffness]\n'
        + "".join(
            f'{joint} = {{ distribution = "fixed", value = 900 }}\n'
            for joint in ("ankle", "knee", "hip")
        )
    )
    people = PopulationStudy.from_toml(file.parent / "s.toml").read_people()
    assert [each.line for each in people.rejected] == [3, 4, 5, 6]
    assert people.sex.count("unknown") == 4
