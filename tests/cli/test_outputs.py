"""Where results go: -o names a file, or a folder that is made."""

import pytest

from standfast.cli.app import main
from standfast.cli.parsing import output_file, output_folder

STUDY = """
[body]
height = 1.7
mass = 70
[stiffness]
ankle = [500, 900]
knee = inf
hip = 500
"""


@pytest.fixture
def place(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "one.toml").write_text(STUDY)
    (tmp_path / "people.csv").write_text("height,mass\n1.7,70\n")
    (tmp_path / "there").mkdir()
    return tmp_path


@pytest.mark.parametrize(
    ("given", "path"),
    [(None, "a.h5"), ("b.h5", "b.h5"), ("new/", "new/a.h5"), ("there", "there/a.h5"),
     ("there/b.h5", "there/b.h5"), (".", "a.h5")],
)  # fmt: skip
def test_a_folder_is_what_is_one_or_ends_in_a_slash(place, given, path):
    assert str(output_file(given, "a.h5")) == path


@pytest.mark.parametrize(
    ("command", "name"),
    [
        (["sweep", "one.toml"], "one.h5"),
        (["assess", "people.csv"], "people-assessed.csv"),
    ],
)
def test_a_new_folder_is_made_and_a_file_is_written_into_it(place, capsys, command, name):
    assert main([*command, "-o", "new/deep/"]) == 0
    assert (place / "new" / "deep" / name).is_file()
    assert main([*command, "-o", "there"]) == 0
    assert (place / "there" / name).is_file()


def test_a_job_script_makes_no_folder(place, capsys):
    main(["sweep", "one.toml", "-o", "new/", "--job-script", "slurm"])
    assert not (place / "new").exists()


def test_a_study_is_no_output(place, capsys):
    (place / "other.toml").write_text("[body]\n")
    for name in ("other.toml", "one.toml", "new.toml"):
        assert main(["sweep", "one.toml", "-o", name]) == 2
        known = "the study itself; name another file for the result, as one.h5"
        if name != "one.toml":
            known = f"the name of a study, and the output is HDF5; write -o {name[:-5]}.h5"
        assert f"{name} is {known}" in capsys.readouterr().err
    assert (place / "other.toml").read_text() == "[body]\n"
    assert not (place / "new.toml.parts").exists()


@pytest.mark.parametrize("command", ["thresholds", "plot"])
def test_a_folder_is_not_named_like_a_file(place, capsys, command):
    source = "one.toml" if command == "thresholds" else "one.h5"
    if command == "plot":
        main(["sweep", "one.toml"])
    with pytest.raises(SystemExit):
        main([command, source, "-o", "mine.csv"])
    assert "mine.csv looks like a file, and several are written" in capsys.readouterr().err
    assert not (place / "mine.csv").exists()
    (place / "there.csv").mkdir()
    assert str(output_folder("there.csv")) == "there.csv"
    assert str(output_folder("new.csv/")) == "new.csv"
