"""Files of people: what is wrong gets one sentence, and one bad row costs one row."""

import math

import numpy as np
import pytest

import standfast as sf
from real_people import DATA, NHANES, needs_people
from standfast.population.people.records import read_people


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
