"""Files as epidemiologists have them: other encodings, commas, units, ages, sexes, ids."""

import importlib.util
import io
import math
import subprocess
import sys

import numpy as np
import pytest

import standfast as sf
from standfast.population.people.decimals import Comma, comma_of, plain_number
from standfast.population.people.records import read_people
from standfast.population.people.words import age_of, sex_of
from standfast.study.toml import read_toml

TABLE = "id,height,mass,sex,age\nÄnne,1.752,80.5,female,44\nB,1.61,55,male,70\n"


def read(tmp_path, content, name="people.csv", **settings):
    path = tmp_path / name
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return read_people(path, **settings)


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "utf-32", "latin-1"])
@pytest.mark.parametrize("separator", [",", ";", "\t", "|"])
def test_encodings_and_separators_give_the_same_people(tmp_path, encoding, separator):
    text = TABLE.replace(",", separator)
    people = read(tmp_path, text.encode(encoding))
    assert people.id == ("Änne", "B")
    assert people.height.tolist() == [1.752, 1.61]
    assert people.mass.tolist() == [80.5, 55.0]
    assert people.age.tolist() == [44.0, 70.0]


@pytest.mark.parametrize("separator", [";", "\t", "|"])
def test_decimal_commas_are_read_where_they_cannot_be_anything_else(tmp_path, separator):
    text = TABLE.replace(",", separator).replace(".", ",")
    assert read(tmp_path, text).height.tolist() == [1.752, 1.61]
    quoted = 'height,mass,note\n"1,75","80,5",x\n"1,6",55,y\n'
    assert read(tmp_path, quoted).mass.tolist() == [80.5, 55.0]


def test_a_first_line_that_says_the_separator_is_no_header(tmp_path):
    people = read(tmp_path, "sep=;\nheight;mass\n1,75;80\n1,7;8000\n")
    assert people.height.tolist() == [1.75]
    assert people.rejected[0].line == 4


@pytest.mark.parametrize(
    ("entries", "separator", "comma"),
    [
        (["1,75", "80"], "\t", Comma.DECIMAL),
        (["0,912"], "\t", Comma.DECIMAL),
        (["1,2345"], "\t", Comma.DECIMAL),
        (["1.234,5"], "\t", Comma.DECIMAL),
        (["1,200.5"], "\t", Comma.THOUSANDS),
        (["1,200,500"], "\t", Comma.THOUSANDS),
        (["1,200"], "\t", Comma.UNKNOWN),
        (["1,75", "1,200.5"], "\t", Comma.UNKNOWN),
        (["1,200"], ";", Comma.ASSUMED),
        (["1.75"], "\t", Comma.UNKNOWN),
    ],
)
def test_what_a_comma_is_in_a_file(entries, separator, comma):
    assert comma_of(entries, separator) is comma


@pytest.mark.parametrize(
    ("entry", "comma", "plain"),
    [
        ("1,75", Comma.UNKNOWN, "1.75"),
        ("1,200", Comma.UNKNOWN, None),
        ("1,200", Comma.DECIMAL, "1.200"),
        ("1,200", Comma.THOUSANDS, "1200"),
        ("1.200", Comma.DECIMAL, None),
        ("1.200", Comma.ASSUMED, "1.200"),
        ("1.2", Comma.DECIMAL, "1.2"),
        ("1.200,5", Comma.ASSUMED, "1200.5"),
        ("1,200.5", Comma.THOUSANDS, "1200.5"),
        ("-1,5", Comma.UNKNOWN, "-1.5"),
        ("1,75 m", Comma.UNKNOWN, "1,75 m"),
    ],
)
def test_a_number_with_a_comma_is_one_number_or_refused(entry, comma, plain):
    assert plain_number(entry, comma) == plain


def test_what_may_be_two_numbers_is_refused_by_line_and_column(tmp_path):
    text = 'height,mass,Ankle stiffness\n1.7,70,900\n"1,752","80,500","1,200"\n1.6,60,"1,2"\n'
    people = read(tmp_path, text.replace(',"1,2"', ",800"))
    (rejected,) = people.rejected
    assert str(rejected) == (
        "people.csv, line 3: the column 'Ankle stiffness' has '1,200', which may be 1200 or "
        "1.200; write one of them"
    )
    # with a decimal comma elsewhere it is one number; height and mass are by their range anyway
    people = read(tmp_path, text)
    assert people.rejected == ()
    assert people.height.tolist() == [1.7, 1.752, 1.6]
    assert people.mass.tolist() == [70.0, 80.5, 60.0]
    assert people.measured["ankle_stiffness"].tolist() == [900.0, 1.2, 1.2]


def test_what_may_be_two_numbers_in_a_joined_file_is_refused_too(tmp_path):
    (tmp_path / "a.csv").write_text("id,height,mass\nA,1.7,70\nB,1.8,80\n")
    (tmp_path / "b.csv").write_text('id,ankle_stiffness\nA,"1,200"\nB,900\n')
    people = read_people([tmp_path / "a.csv", tmp_path / "b.csv"])
    assert people.id == ("B",)
    assert "b.csv, line 2: the column 'ankle_stiffness' has '1,200'" in people.rejected[0].reason


@pytest.mark.parametrize(
    ("header", "row", "height", "mass"),
    [
        ("height_in,weight_lb", "70,165", 1.778, 165 * 0.45359237),
        ("Height (in),Weight (lbs)", "70,165", 1.778, 165 * 0.45359237),
        ("Height [inches],Body mass [lb]", "70,165", 1.778, 165 * 0.45359237),
        ("height_ft,mass_g", "5.5,70000", 5.5 * 0.3048, 70.0),
        ("height_mm,mass_pounds", "1750,165", 1.75, 165 * 0.45359237),
    ],
)
def test_units_of_america_are_made_si(tmp_path, header, row, height, mass):
    people = read(tmp_path, f"{header}\n{row}\n")
    assert people.height[0] == pytest.approx(height, rel=1e-12)
    assert people.mass[0] == pytest.approx(mass, rel=1e-12)


def test_metric_and_imperial_columns_of_one_file_each_fill_some_rows(tmp_path):
    people = read(
        tmp_path,
        "id,height_cm,height_in,weight_kg,weight_lb\nA,175,,70,\nB,,70,NA,165\nC,178,70,75,165\n"
        'D,175,70,75,\nE,175,,75,150\nF,,,70,\nG,,"70,5",,165\nH,-178,70,75,\nI,abc,70,75,\n',
    )
    assert people.id == ("A", "B", "C", "G")
    assert people.height.tolist() == pytest.approx([1.75, 1.778, 1.78, 70.5 * 0.0254])
    pounds = 165 * 0.45359237
    assert people.mass.tolist() == pytest.approx([70.0, pounds, 75.0, pounds])
    assert [str(each) for each in people.rejected] == [
        "people.csv, line 5: two of height: 1.75 in 'height_cm' and 1.778 in 'height_in', made m; "
        "they differ by more than 1 %",
        "people.csv, line 6: two of mass: 75 in 'weight_kg' and 68.04 in 'weight_lb', made kg; "
        "they differ by more than 1 %",
        "people.csv, line 7: no height",
        "people.csv, line 9: two of height: -1.78 in 'height_cm' and 1.778 in 'height_in', made m; "
        "they differ by more than 1 %",
        "people.csv, line 10: height = 'abc' is text; give a number, 0.5 to 2.8 m",
    ]


def test_bytes_of_windows_are_its_letters_and_else_of_latin_1(tmp_path):
    row = "Šimon – 5 €,1.7,70\n".encode("cp1252") + b"\x81\xfc,1.6,60\n"
    people = read(tmp_path, b"id,height,mass\n" + row)
    assert people.id == ("Šimon – 5 €", "\x81ü")


@pytest.mark.parametrize(
    ("entry", "age"),
    [
        ("80+", 80), ("80 +", 80), ("90 and over", 90), (">=85", 85), ("≥ 85", 85),
        ("85 and older", 85), ("85 or older", 85), ("85 years and over", 85), (">80", 80),
        ("90+ years", 90), ("42 years", 42), ("42.5 y", 42.5), ("42", 42), ("over 90", 90),
    ],
)  # fmt: skip
def test_ages_of_surveys_are_their_lowest(entry, age):
    assert age_of(entry) == age


def test_ages_that_are_not_known_or_none(tmp_path):
    for entry in ("", "NA", "n/a", "unknown", "-"):
        assert math.isnan(age_of(entry))
    for entry, why in (
        ("40-49", "class of ages"), ("old", "is text"), ("200+", "outside"), ("6 months", "is text")
    ):  # fmt: skip
        with pytest.raises(sf.InputError, match=why):
            age_of(entry)
    people = read(tmp_path, "height,mass,age\n1.7,70,80+\n1.6,60,90 and over\n1.8,80,30\n")
    assert people.age.tolist() == [80.0, 90.0, 30.0]
    assert people.remarks == ("2 ages such as 80+ are taken as the lowest, 80 and 90",)


def test_neither_male_nor_female_is_a_class_of_its_own(tmp_path):
    for word in ("x", "divers", "D", "Other", "nonbinary", "non-binary"):
        assert sex_of(word) == "other"
    assert [sex_of(w) for w in ("weiblich", "M", "1", "2", "", "NA")] == [
        "female", "male", "male", "female", "unknown", "unknown",
    ]  # fmt: skip
    people = read(tmp_path, "height,mass,sex\n1.7,70,divers\n1.6,60,2\n")
    assert people.sex == ("other", "female")
    assert people.remarks == (
        "people.csv: sex is given by numbers: 1 is read as male and 2 as female",
    )


def test_ids_that_are_there_twice_are_told_with_their_lines(tmp_path):
    people = read(tmp_path, "id,height,mass\nA,1.7,70\nB,1.6,60\nA,1.71,70\n7.0,1.8,80\n7,1.8,80\n")
    assert len(people) == 5
    assert people.remarks == (
        "people.csv: 2 ids are there more than once, each row taken as a person: 'A' on lines 2, "
        "4; '7' on lines 5, 6",
    )


def test_ids_that_are_in_two_files_are_told_too(tmp_path):
    (tmp_path / "a.csv").write_text("id,height,mass\nA,1.7,70\nB,1.6,60\n")
    (tmp_path / "b.csv").write_text("id,height,mass\nC,1.7,70\nB.0,1.6,60\n")
    (tmp_path / "c.csv").write_text("id,age\nA,44\n")
    files = [tmp_path / name for name in ("a.csv", "b.csv", "c.csv")]
    people = read_people(files)
    assert people.id == ("A", "B", "C", "B.0")
    assert people.remarks == (
        "one id is in several files, each row taken as a person: 'B' in a.csv, b.csv",
    )


@pytest.mark.parametrize(
    ("header", "row", "good", "sentence"),
    [
        (
            "height_cm,mass",
            "1.70,70",
            "170,70",
            "1.70 in the column 'height_cm' looks like metres; write 170",
        ),
        (
            "Height (in),mass",
            "1.75,70",
            "70,70",
            "1.75 in the column 'Height (in)' looks like metres; write",
        ),
        (
            "height,weight_g",
            "1.75,70",
            "1.75,70000",
            "70 in the column 'weight_g' looks like kilograms; write 7e+04",
        ),
    ],
)
def test_a_number_in_si_under_another_unit_is_hinted_at(tmp_path, header, row, good, sentence):
    people = read(tmp_path, f"{header}\n{row}\n{good}\n")
    (rejected,) = people.rejected
    assert rejected.line == 2
    assert sentence in rejected.reason


def test_own_columns_are_kept_when_asked_also_of_joined_files(tmp_path):
    (tmp_path / "a.csv").write_text("id,height,mass,site,note\nA,1.7,70,Bonn,x\nB,1.8,800,Ulm,y\n")
    (tmp_path / "b.csv").write_text("id,age,site,falls\nA,80+,Köln,3\n")
    files = [tmp_path / "a.csv", tmp_path / "b.csv"]
    people = read_people(files, keep_own=True)
    assert people.own == {"site": ("Bonn",), "note": ("x",), "falls": ("3",)}
    assert people.at(np.array([0, 0])).own["falls"] == ("3", "3")
    assert read_people(files).own == {}


def test_a_decimal_comma_that_makes_a_column_more_is_refused(tmp_path):
    people = read(tmp_path, "height,mass\n1,75,80\n1.7,70,\n")
    assert people.height.tolist() == [1.7]
    assert str(people.rejected[0]) == (
        "people.csv, line 2: 3 entries under 2 columns; is a decimal comma not in quotes?"
    )


def test_own_columns_of_one_name_are_numbered(tmp_path):
    people = read(tmp_path, "height,note,mass,note\n1.7,a,70,b\n", keep_own=True)
    assert people.own == {"note": ("a",), "note (2)": ("b",)}


def test_units_that_make_no_body_are_remarked(tmp_path):
    people = read(tmp_path, "id,height,mass\nA,1.7,70\nB,1.7,330\nC,1.9,30\n")
    assert people.remarks == (
        "2 have a BMI below 10 or above 100 kg/m², look at the units (id B, C)",
    )


def test_standard_input_is_read(tmp_path):
    script = (
        "import standfast as sf; p = sf.read_people('-'); "
        "print(p.height.tolist(), p.rejected[0].file, p.rejected[0].line)"
    )
    done = subprocess.run(
        [sys.executable, "-c", script], input="height\tmass\n1,75\t80\n17\t80\n",
        capture_output=True, text=True, check=True,
    )  # fmt: skip
    assert done.stdout == "[1.75] standard input 3\n"


def excel(tmp_path, sheets):
    openpyxl = pytest.importorskip("openpyxl")
    pytest.importorskip("pandas")
    book = openpyxl.Workbook()
    book.remove(book.active)
    for name, rows in sheets.items():
        sheet = book.create_sheet(name)
        for row in rows:
            sheet.append(row)
    book.save(tmp_path / "people.xlsx")
    return tmp_path / "people.xlsx"


def test_excel_is_read_like_its_csv(tmp_path):
    rows = [
        ["id", "height_cm", "mass", "sex", "age"],
        [7, 175.5, 80, "divers", "80+"],
        ["B", "1,6"],
    ]
    path = excel(tmp_path, {"data": rows, "codes": [["what", "ever"]]})
    people = read_people(path)
    assert people.id == ("7",)
    assert people.height.tolist() == [1.755]
    assert people.sex == ("other",)
    assert people.remarks[0] == "people.xlsx: of its sheets 'data' is read, not codes"
    assert people.rejected[0].line == 3


def test_excel_without_its_readers_names_the_extra(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "openpyxl", None)
    monkeypatch.setitem(sys.modules, "pandas", None)
    with pytest.raises(sf.InputError, match=r"install 'standfast\[excel\]', or save it as CSV"):
        read(tmp_path, b"PK\x03\x04 and so on", "people.xlsx")


@pytest.mark.skipif(importlib.util.find_spec("openpyxl") is None, reason="openpyxl is an extra")
def test_what_only_looks_like_excel_gets_a_sentence(tmp_path):
    with pytest.raises(sf.InputError, match="is not a file of Excel that can be read"):
        read(tmp_path, b"PK\x03\x04 and so on", "people.xlsx")
    with pytest.raises(sf.InputError, match=r"file of old Excel; save it as \.xlsx or as CSV"):
        read(tmp_path, b"\xd0\xcf\x11\xe0 and so on", "people.xls")


def test_what_begins_as_utf_16_and_is_none_gets_a_sentence(tmp_path):
    with pytest.raises(sf.InputError, match="begins as a file in UTF-16 and is none"):
        read(tmp_path, b"\xff\xfea")


def test_a_study_with_a_byte_order_mark_is_read(tmp_path):
    path = tmp_path / "study.toml"
    path.write_bytes(io.BytesIO("\ufefftitle = 'é'\n".encode()).getvalue())
    assert read_toml(path) == {"title": "é"}
