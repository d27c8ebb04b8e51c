"""Tables replace nothing but their like: what is there is looked at before any work."""

import pytest

from standfast.cli.app import main
from standfast.errors import InputError
from standfast.files import require_replaceable

STUDY = """
[population]
people = "people.csv"
size = 2000
[stiffness]
ankle = { distribution = "fixed", value = 900 }
knee = { distribution = "fixed", value = inf }
hip = { distribution = "fixed", value = inf }
"""
ASSESS = ["assess", "people.csv", "--knee", "inf"]
POPULATION = ["population", "study.toml", "--no-figures"]


@pytest.fixture
def place(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "people.csv").write_text("height,mass\n1.7,70\n17,70\n")
    (tmp_path / "study.toml").write_text(STUDY)
    return tmp_path


@pytest.mark.parametrize(
    ("command", "name"),
    [
        ([*ASSESS, "-o", "make.py"], "make.py"),
        ([*ASSESS, "--csv", "tab.txt"], "tab.txt"),
        ([*ASSESS, "-o", "o.csv"], "o-rejected.csv"),
        (ASSESS, "people-assessed.csv"),
        ([*POPULATION, "--csv", "tab.txt"], "tab.txt"),
        (POPULATION, "study-rejected.csv"),
    ],
)
@pytest.mark.parametrize(
    "content", ["print(1)\n", "", "file,line,reasons\n", "id,height_m,mass_kg\n"]
)
def test_what_is_no_table_of_ours_is_left_alone(place, capsys, command, name, content):
    (place / name).write_text(content)
    before = {path.name for path in place.iterdir()}
    assert main(command) == 2
    said = capsys.readouterr().err
    assert said == (
        f"standfast: {name} is there and is no table of standfast of this kind; choose another "
        "name or remove it\n"
    )
    assert (place / name).read_text() == content
    assert {path.name for path in place.iterdir()} == before


def test_tables_replace_their_like_and_no_other_kind(place, capsys):
    for _ in range(2):
        assert main([*ASSESS, "-o", "o.csv", "--csv", "s.csv"]) == 0
        assert main([*POPULATION, "--csv", "p.csv"]) == 0
    capsys.readouterr()
    tables = ("o.csv", "s.csv", "p.csv", "o-rejected.csv")
    kept = {name: (place / name).read_bytes() for name in tables}
    for command in (
        [*ASSESS, "-o", "s.csv"],
        [*ASSESS, "-o", "o-rejected.csv"],
        [*ASSESS, "--csv", "p.csv"],
        [*ASSESS, "--csv", "o.csv"],
        [*POPULATION, "--csv", "s.csv"],
        [*POPULATION, "--csv", "o.csv"],
    ):
        assert main(command) == 2
        assert "is no table of standfast of this kind" in capsys.readouterr().err
    assert {name: (place / name).read_bytes() for name in tables} == kept


def test_rejected_rows_of_a_run_before_are_removed_and_no_more(place, capsys):
    assert main([*ASSESS, "-o", "o.csv"]) == 0
    (place / "people.csv").write_text("height,mass\n1.7,70\n")
    assert main([*ASSESS, "-o", "o.csv"]) == 0
    assert not (place / "o-rejected.csv").exists()


def test_names_that_are_no_files_get_their_sentence(place, capsys):
    assert main([*ASSESS, "-o", "-"]) == 2
    assert "- is no file, and tables are written to files" in capsys.readouterr().err
    assert main([*ASSESS, "-o", "o.csv", "--csv", "o-rejected.csv"]) == 2
    assert "o-rejected.csv cannot be both the file of rejected rows" in capsys.readouterr().err
    with pytest.raises(OSError, match="not a plain file"):
        require_replaceable(place, "file,line,reason")
    with pytest.raises(InputError):
        require_replaceable(place / "people.csv", "height,masses")
    require_replaceable(place / "people.csv", "height,mass")


def test_a_study_is_neither_people_nor_its_own_result(place, capsys):
    study = (place / "study.toml").read_text()
    assert main(["population", "people.csv"]) == 2
    assert capsys.readouterr().err == (
        "standfast: people.csv is a file of people, not a study; write a study with [population] "
        "people = 'people.csv', or take them one by one: standfast assess people.csv\n"
    )
    for command in ("population", "sweep"):
        assert main([command, "study.toml", "-o", "study.toml"]) == 2
        said = capsys.readouterr().err
        if command == "population":
            assert said == (
                "standfast: study.toml is the study itself; name another file for the result, as "
                "study.h5\n"
            )
    assert (place / "study.toml").read_text() == study
    (place / "no.toml").write_text("this is no study")
    assert main(["population", "no.toml"]) == 2
    assert "no.toml is not valid TOML" in capsys.readouterr().err
