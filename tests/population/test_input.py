"""Studies of populations and files of people: what is wrong gets one sentence."""

import math

import numpy as np
import pytest

import standfast as sf
from populations import GOOD, changed, law
from real_people import DATA, NHANES, needs_people
from standfast.population.people.classes import age_class, age_classes
from standfast.population.people.records import read_people
from standfast.population.people.study import PopulationStudy

WRONG = [
    ("population.size", 0, "population.size = 0 is not a whole number from 1 to 100000000000"),
    ("population.size", 2.5, "population.size = 2.5 is not a whole number from 1 to 100000000000"),
    (
        "population.seed",
        -1,
        "population.seed = -1 is not a whole number from 0 to 9223372036854775807",
    ),
    ("population.sex", "femal", "population.sex = 'femal' is not known; did you mean 'female'?"),
    ("population.age", "70+", "population.age = '70+' is not a group of nhanes-2017-2018"),
    ("population.age", "old", "population.age = 'old' is not a range of ages; write \"65+\""),
    ("population.builtin", "nhanes", "population.builtin = 'nhanes' is not known; did you mean"),
    ("population.people", "a.csv", "[population] needs people (a CSV file) or builtin"),
    ("population.age_bands", [18, 65], "population.age_bands needs people of known age in a file"),
    ("population.sex", "other", "population.sex = 'other' is not known"),
    ("population", {"people": "-"}, "population.people = '-' is standard input, which a study"),
    ("stiffness.ankle.distribution", None, "[stiffness.ankle] has no distribution; write"),
    ("stiffness.ankle.mean", -1.0, "-1 is outside the allowed range, 0 to 1e+06"),
    ("population.method", "qmc", "population.method = 'qmc' is not known"),
    ("population.body_model", "wintr", "population.body_model = 'wintr' is not known; did you"),
    ("population.proportions", "free", "population.proportions = 'free' is not known"),
    ("population.sise", 5, "[population] has no key 'sise'; did you mean 'size'?"),
    ("population", None, "[population] is missing: say people or builtin, and size"),
    ("stiffness", None, "[stiffness.ankle], [stiffness.knee] and [stiffness.hip] are missing"),
    ("stiffness.knee", None, "[stiffness.knee] is missing; for a rigid knee write"),
    ("stiffness.knee", 500.0, "stiffness.knee = 500.0 is not a law; write [stiffness.knee] with"),
    ("stiffness.ankle.sd", -0.3, "stiffness.ankle.sd = -0.3 is outside the allowed range"),
    ("stiffness.ankle.sd", None, "stiffness.ankle.sd is missing; normal takes mean, sd"),
    ("stiffness.ankle.mean", math.nan, "stiffness.ankle.mean is NaN"),
    ("stiffness.ankle.mean", math.inf, 'stiffness.ankle: only distribution = "fixed" may be inf'),
    ("stiffness.ankle.meen", 1.0, "has no key 'meen'; did you mean 'mean'?"),
    ("stiffness.ankle.distribution", "gauss", "stiffness.ankle.distribution = 'gauss' is not"),
    (
        "stiffness.ankle.relative_to",
        "weight",
        "stiffness.ankle.relative_to = 'weight' is not known",
    ),
    ("stiffness.hip.low", 950.0, "stiffness.hip goes from low = 950 to high = 900; high must not"),
    ("stiffness.knee.mean", 0.0, "stiffness.knee.mean = 0 has no lognormal; give a mean above 0"),
    ("stiffness.ankle", {"law": "winter"}, "stiffness.ankle.law = 'winter' is not known"),
    (
        "stiffness.correlation",
        [[1, 0.9, 0.9], [0.9, 1, -0.9], [0.9, -0.9, 1]],
        "stiffness.correlation is impossible: no three numbers are correlated like that",
    ),
    (
        "stiffness.correlation",
        [[1, 0.5, 0], [0.4, 1, 0], [0, 0, 1]],
        "stiffness.correlation: ankle with knee is 0.5, but knee with ankle 0.4",
    ),
    (
        "stiffness.correlation",
        [[2, 0, 0], [0, 1, 0], [0, 0, 1]],
        "stiffness.correlation[0][0] = 2 is outside the allowed range, -1 to 1",
    ),
    (
        "stiffness.correlation",
        [[0.5, 0, 0], [0, 1, 0], [0, 0, 1]],
        "stiffness.correlation: ankle with itself is 0.5; it must be 1",
    ),
    ("stiffness.correlation", [1, 0.5], "stiffness.correlation = [1, 0.5] is not a 3 × 3 matrix"),
    ("gravity", [9.8, 1.6], "gravity is one number in a population, without list or range"),
    ("gravity", 0.0, "gravity = 0 is outside the allowed range"),
    ("output.persons", "yes", "output.persons = 'yes' is not true or false"),
    ("body", {"height": 1.7}, "study has no key 'body'"),
    (
        "stiffness.ankle",
        law("lognormal", mean=1e-200, sd=284.0),
        "stiffness.ankle.sd = 284 is more than a thousand times the mean, 1e-200",
    ),
    ("population", {"people": "a\0b.csv"}, "'a\\x00b.csv' is not the name of a file"),
    ("title", 5, "title = 5 is not one line of text"),
    (
        "stiffness.hip",
        {"distribution": "measured"},
        "stiffness.hip: measured needs people with a column hip_stiffness, and a built-in",
    ),
    ("stiffness.hip", {"law": "casadio-2005"}, "'casadio-2005' is a law of the ankle"),
]


@pytest.mark.parametrize(("key", "value", "sentence"), WRONG)
def test_a_wrong_study_gets_its_sentence(key, value, sentence):
    with pytest.raises(sf.InputError) as caught:
        PopulationStudy.from_dict(changed(key, value))
    assert str(caught.value).startswith(sentence) or sentence in str(caught.value)
    assert "\n" not in str(caught.value)


def test_what_is_drawn_is_never_offered_to_be_rigid():
    for key in ("mean", "sd"):
        with pytest.raises(sf.InputError) as caught:
            PopulationStudy.from_dict(changed(f"stiffness.ankle.{key}", -0.3))
        assert "inf" not in str(caught.value)
        assert "rigid" not in str(caught.value)


@pytest.mark.parametrize(
    ("bands", "sentence"),
    [
        ("18", "population.age_bands = '18' is no list of whole years from 0 to 130"),
        ([], "population.age_bands = [] is no list of whole years"),
        ([18.5], "population.age_bands = [18.5] is no list of whole years"),
        ([18, 150], "population.age_bands = [18, 150] is no list of whole years"),
        ([30, 18], "population.age_bands = [30, 18] does not rise"),
    ],
)
def test_wrong_age_bands_get_their_sentence(tmp_path, bands, sentence):
    (tmp_path / "p.csv").write_text("height,mass\n1.7,70\n")
    content = changed("population", {"people": "p.csv", "age_bands": bands})
    with pytest.raises(sf.InputError) as caught:
        PopulationStudy.from_dict(content, folder=tmp_path)
    assert sentence in str(caught.value)


def test_age_bands_are_called_by_their_ages():
    names = [name for _, name in age_classes([18, 30, 31, 65])]
    assert names == ["under 18", "18-29", "30", "31-64", "65+"]
    assert [name for _, name in age_classes([0, 50])] == ["0-49", "50+"]
    for age, name in ((17.99, "under 18"), (18.0, "18-29"), (29.5, "18-29"), (130.0, "65+")):
        assert age_class(age, age_classes([18, 30, 31, 65])) == name


def test_a_joint_that_is_not_random_cannot_be_correlated():
    content = changed("stiffness.knee", {"distribution": "fixed", "value": 900.0})
    content["stiffness"]["correlation"] = [[1, 0.5, 0], [0.5, 1, 0], [0, 0, 1]]
    with pytest.raises(sf.InputError, match="the stiffness of the knee is not random; put 0 there"):
        PopulationStudy.from_dict(content)


def test_too_many_persons_to_keep_are_refused():
    content = changed("output.persons", True)
    content["population"]["size"] = 10**9
    with pytest.raises(sf.InputError, match="keeps at most 100,000,000 persons"):
        PopulationStudy.from_dict(content)


def test_the_study_of_a_sweep_is_told_apart():
    with pytest.raises(sf.InputError, match="run: standfast sweep"):
        PopulationStudy.from_dict({"body": {}, "stiffness": {}})


def test_the_canonical_form_reads_back():
    content = changed("stiffness.hip", {"distribution": "fixed", "value": math.inf})
    study = PopulationStudy.from_dict(content)
    again = PopulationStudy.from_canonical(study.canonical)
    assert again.fingerprint == study.fingerprint
    assert again.distributions == study.distributions
    assert again.shards == study.shards
    other = PopulationStudy.from_dict(changed("population.seed", 6, content))
    assert study.difference(other) == "population.seed: 6 there, 5 here"
    for text in ("", "[]", "{}", '{"population":5}'):
        with pytest.raises(sf.InputError, match="cannot be read"):
            PopulationStudy.from_canonical(text)


def test_where_a_file_of_people_lies_does_not_change_the_study(tmp_path):
    studies = []
    for folder in ("here", "there"):
        (tmp_path / folder).mkdir()
        (tmp_path / folder / "p.csv").write_text("height,mass\n1.7,70\n")
        content = changed("population", {"people": "p.csv", "size": 100})
        studies.append(PopulationStudy.from_dict(content, folder=tmp_path / folder))
    assert studies[0].fingerprint == studies[1].fingerprint
    (tmp_path / "there" / "p.csv").write_text("height,mass\n1.7,71\n")
    changed_people = PopulationStudy.from_dict(content, folder=tmp_path / "there")
    assert changed_people.fingerprint != studies[0].fingerprint


def read(tmp_path, text, **settings):
    path = tmp_path / "people.csv"
    path.write_text(text, encoding=settings.pop("encoding", "utf-8"))
    return read_people([path], **settings)


@pytest.mark.parametrize(
    ("header", "row"),
    [
        ("height,mass", "1.75,80"),
        ("Height (cm),Body mass [kg]", "175,80"),
        ("height_mm;weight_kg", "1750;80,0"),
        ("Stature_cm\tmass_kg", "175\t80"),
        ("stature,weightkg", "1750,800"),
        ("height_cm,weightkg", "175,80"),
        ("BMXHT,BMXWT", "175.0,80.0"),
        ("\ufeffheight , mass", " 1.75 , 80 "),
    ],
)
def test_units_are_recognised_by_the_names_of_columns(tmp_path, header, row):
    people = read(tmp_path, f"{header}\n{row}\n")
    assert people.height == pytest.approx([1.75])
    assert people.mass == pytest.approx([80.0])


def test_all_columns_are_read(tmp_path):
    people = read(
        tmp_path,
        "id,height,mass,sex,age,weight,ankle_stiffness,knee_stiffness\n"
        "A,1.7,70,F,30,2,900,inf\n"
        "B,1.8,80,male,,1,,800\n",
    )
    assert people.id == ("A", "B")
    assert people.sex == ("female", "male")
    assert people.age[0] == 30.0
    assert np.isnan(people.age[1])
    assert people.effective_size == pytest.approx(9.0 / 5.0)
    assert people.measured["ankle_stiffness"][0] == 900.0
    assert np.isnan(people.measured["ankle_stiffness"][1])
    assert people.measured["knee_stiffness"][0] == math.inf
    assert "hip_stiffness" not in people.measured


def test_one_bad_row_among_thousands_is_left_out_and_told(tmp_path):
    rows = ["height,mass", *["1.7,70"] * 4000]
    rows[2345] = "175,70"
    people = read(tmp_path, "\n".join(rows))
    assert len(people) == 3999
    (rejected,) = people.rejected
    assert rejected.line == 2346
    assert str(rejected) == (
        "people.csv, line 2346: height = 175 is outside the allowed range, 0.5 to 2.8 m; "
        "175 looks like centimetres, write 1.75"
    )
    with pytest.raises(sf.InputError, match=r"people.csv, line 2346: height = 175 .* \(--strict\)"):
        read(tmp_path, "\n".join(rows), strict=True)


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("", "is empty; give a header line and one line a person"),
        ("height,mass\n", "has a header and no rows"),
        ("size,mass\n1.7,70\n", "people.csv has no column of height (known names: bmxht, height"),
        ("height,weight\n1.7,70\n", "'weight' is read as the weight of the record, name body"),
        (
            "height,mass\n175,70\n168,60\n",
            "people.csv has no usable row: 2 rejected, the first on line 2: height = 175 is "
            "outside the allowed range, 0.5 to 2.8 m; 175 looks like centimetres, write 1.75; if "
            "the column is in centimetres, name it height_cm",
        ),
        ("height,mass\nabc,70\n", "line 2: height = 'abc' is text; give a number, 0.5 to 2.8 m"),
        ("height,mass\n1.7,\n", "line 2: no mass"),
        ("height,mass\n1.7,-70\n", "line 2: mass = -70 is outside the allowed range"),
        ("height,mass\n1.7,nan\n", "line 2: no mass"),
        ("height,mass,weight\n1.7,70,-1\n", "line 2: weight = -1 is outside the allowed range"),
        ("height,mass,weight\n1.7,70,0\n", "the weights of all usable rows are 0"),
        ("height,height_m,mass\n1,2,3\n", "the columns 'height' and 'height_m' both hold height"),
        (
            "height,height_cm,mass\n1.7,150,70\n",
            "line 2: two of height: 1.7 in 'height' and 1.5 in",
        ),
        ("height,mass\n1.7,8_0\n", "line 2: mass = '8_0' is text"),
        ("height,mass\n1.7,８０\n", "line 2: mass = '８０' is text"),
        ("height_cm,mass\n17_0,70\n", "line 2: height = '17_0' is text"),
        ("height,mass" + ",x" * 5000, "people.csv has 5,002 columns; at most 5,000 are read"),
        ("height,mass\n1.7,70\0\n", "if it is one in UTF-16, save it as UTF-8"),
    ],
)
def test_a_wrong_file_gets_its_sentence(tmp_path, text, sentence):
    with pytest.raises(sf.InputError) as caught:
        read(tmp_path, text)
    assert sentence in str(caught.value)


ROWS = ["id,height,mass,note", "A,1.7,70,x", *["B,1.8,80,y"] * 97, "C,1.6,60,z"]


@pytest.mark.parametrize(
    ("line", "row", "sentence"),
    [
        (2, 'B,1.8,80,"y', "line 3: a quotation mark opens in this row and is not closed"),
        (2, '"B,1.8,80,y', "line 3: a quotation mark opens in this row and is not closed"),
        (99, 'C,1.6,60,"', "line 100: a quotation mark opens in this row and is not closed"),
        (0, 'id,height,"mass,note', "line 1: a quotation mark opens in this row and is not"),
    ],
)
@pytest.mark.parametrize("end", ["\n", "\r\n", ""])
def test_a_quotation_mark_that_is_not_closed_swallows_no_rows(tmp_path, line, row, sentence, end):
    rows = ROWS.copy()
    rows[line] = row
    with pytest.raises(sf.InputError) as caught:
        read(tmp_path, (end or "\n").join(rows) + end)
    assert sentence in str(caught.value)


def test_a_quotation_mark_that_another_closes_swallows_no_rows(tmp_path):
    rows = ROWS.copy()
    rows[2], rows[50] = '"B,1.8,80,y', 'B",1.8,80,y'
    with pytest.raises(sf.InputError, match=r"line 3: .* in this row and closes on line 51 only"):
        read(tmp_path, "\n".join(rows))
    # longer than the module reads at once
    rows[50] = "x" * 200_000
    with pytest.raises(sf.InputError, match=r"line 3: .* and is not closed"):
        read(tmp_path, "\n".join(rows))


def test_notes_of_several_lines_are_no_fault(tmp_path):
    rows = ROWS.copy()
    rows[2] = 'B,1.8,80,"tall\nand ""kind"", says the file"'
    assert len(read(tmp_path, "\n".join(rows))) == 99


def test_files_that_are_not_there_or_cannot_be_joined(tmp_path):
    with pytest.raises(sf.InputError, match="there is no such file of people"):
        read_people([tmp_path / "nobody.csv"])
    with pytest.raises(sf.InputError, match="is a folder"):
        read_people([tmp_path])
    for name in ("a.csv", "b.csv"):
        (tmp_path / name).write_text("height,mass\n1.7,70\n")
    (tmp_path / "c.csv").write_text("sex,age\nmale,30\n")
    with pytest.raises(sf.InputError, match=r"cannot be joined: a\.csv has no column of ids"):
        read_people([tmp_path / "a.csv", tmp_path / "c.csv"])
    (tmp_path / "a.csv").write_text("id,height,mass\nA,1.7,70\n")
    (tmp_path / "c.csv").write_text("id,age\nX,30\n")
    with pytest.raises(sf.InputError, match=r"c\.csv has no id that a\.csv has"):
        read_people([tmp_path / "a.csv", tmp_path / "c.csv"])
    (tmp_path / "c.csv").write_text("id,age\nA,30\nA,31\n")
    with pytest.raises(sf.InputError, match=r"c\.csv, line 3: the id 'A' is there twice"):
        read_people([tmp_path / "a.csv", tmp_path / "c.csv"])


def test_files_with_height_and_mass_are_put_together(tmp_path):
    (tmp_path / "a.csv").write_text("height,mass\n1.7,70\n1.8,800\n")
    (tmp_path / "b.csv").write_text("stature,weightkg,Gender\n1650,600,Female\n")
    people = read_people([tmp_path / "b.csv", tmp_path / "a.csv"])
    assert people.height.tolist() == [1.65, 1.7]
    assert people.sex == ("female", "unknown")
    (rejected,) = people.rejected
    assert str(rejected).startswith("a.csv, line 3: mass = 800 is outside")


def test_what_a_user_may_not_have_meant_is_remarked(tmp_path):
    people = read(tmp_path, "name,height,mass,ankle_stiffnes,years\nJo,1.2,30,900,9\n")
    assert people.id == ("Jo",)
    assert people.remarks == (
        "people.csv: the column 'ankle_stiffnes' is not used; did you mean 'ankle_stiffness'?",
        "1 is under 18 years, and the body models are of adults",
    )


def test_files_are_joined_by_id_whatever_its_form(tmp_path):
    (tmp_path / "a.csv").write_text("SEQN,BMXHT,BMXWT\n7.0,170,70\n8.0,180,80\n9.0,160,60\n")
    (tmp_path / "b.csv").write_text("SEQN,RIAGENDR,RIDAGEYR,WTMEC2YR\n8,1,30,5\n7,2,70,3\n")
    people = read_people([tmp_path / "a.csv", tmp_path / "b.csv"])
    assert people.sex == ("female", "male")
    assert people.weight.tolist() == [3.0, 5.0]
    assert [r.reason for r in people.rejected] == ["no weight: the id is in no file of weights"]
    old = read_people(
        [tmp_path / "a.csv", tmp_path / "b.csv"], selected=lambda sex, age: age >= 65.0
    )
    assert old.id == ("7.0",)
    assert old.not_selected == 2
    (tmp_path / "a.csv").write_text("id,height,mass,sex\n,1.7,70,\nA,1.8,80,\n")
    (tmp_path / "b.csv").write_text("id,sex,age\n,female,99\nA,male,30\n")
    people = read_people([tmp_path / "a.csv", tmp_path / "b.csv"])
    assert people.sex == ("unknown", "male")
    assert np.isnan(people.age[0])


def test_a_law_of_measured_stiffness_needs_its_column(tmp_path):
    with pytest.raises(sf.InputError, match="has no column ankle_stiffness, which the law"):
        read(tmp_path, "height,mass\n1.7,70\n", needed=["ankle_stiffness"])
    people = read(
        tmp_path,
        "height,mass,ankle_stiffness\n1.7,70,900\n1.8,80,\n",
        needed=["ankle_stiffness"],
    )
    assert [str(r) for r in people.rejected] == ["people.csv, line 3: no ankle_stiffness"]


@needs_people
def test_nhanes_and_ansur_are_read_as_they_come():
    everyone = read_people(NHANES)
    lines = len(NHANES[0].read_text(encoding="utf-8").splitlines()) - 1
    assert len(everyone) + len(everyone.rejected) == lines
    reasons = {r.reason for r in everyone.rejected}
    assert {"no height", "no mass", "pregnant, for which no body model holds"} <= reasons
    women = read_people([DATA / "ANSUR_II_FEMALE_Public.csv"])
    men = read_people([DATA / "ANSUR_II_MALE_Public.csv"])
    assert (len(women), len(men)) == (1986, 4082)
    assert (women.mass.mean(), men.height.mean()) == pytest.approx((67.76, 1.7562), rel=1e-3)
    assert set(women.sex) == {"female"}


def test_a_good_study_is_good():
    assert PopulationStudy.from_dict(GOOD).size == 40_000
    quasi = PopulationStudy.from_dict(changed("population.method", "quasi-monte-carlo"))
    assert quasi.size == 65_536  # 16 scramblings of a power of two
    assert law("fixed", value=1.0)["value"] == 1.0
