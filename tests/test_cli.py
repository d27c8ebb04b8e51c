"""The command as a user types it."""

import csv
import os
import subprocess
import sys
import xml.etree.ElementTree as ET

import pytest

import standfast
from standfast.cli import main


def standfast_command(*arguments, cwd=None):
    return subprocess.run(
        [sys.executable, "-m", "standfast", *arguments],
        capture_output=True,
        text=True,
        encoding="utf-8",
        cwd=cwd,
        check=False,
        env={**os.environ, "PYTHONIOENCODING": "utf-8"},
    )


def test_help_has_an_example_and_imports_neither_jax_nor_matplotlib():
    code = (
        "import sys; from standfast.cli import main\n"
        "try: main(['--help'])\n"
        "except SystemExit: pass\n"
        "heavy = {'jax', 'matplotlib', 'h5py'} & set(sys.modules)\n"
        "sys.exit(f'imported {heavy}' if heavy else 0)"
    )
    result = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=False
    )
    assert result.returncode == 0, result.stderr
    assert "example: standfast reproduce" in result.stdout


@pytest.mark.parametrize("command", ["reproduce"])
def test_every_command_has_an_example(command):
    result = standfast_command(command, "--help")
    assert result.returncode == 0
    assert f"example: standfast {command}" in result.stdout


def test_version():
    assert standfast_command("--version").stdout.strip() == f"standfast {standfast.__version__}"


@pytest.mark.parametrize("arguments", [[], ["reprodice"], ["reproduce", "--outputt", "x"]])
def test_wrong_words_exit_with_2_and_no_traceback(arguments):
    result = standfast_command(*arguments)
    assert result.returncode == 2
    assert "Traceback" not in result.stderr
    assert "usage: standfast" in result.stderr


def test_reproduce_writes_figures_and_tables_and_nothing_else(tmp_path, capsys):
    folder = tmp_path / "deep" / "paper"
    assert main(["reproduce", "-o", str(folder)]) == 0
    names = {path.name for path in folder.iterdir()}
    figures = {
        f"{stem}.{suffix}"
        for stem in (
            "figure2_root_locus",
            "figure3_stability_contours",
            "figure4_sway_patterns",
            "figure5_frequency_bmi",
        )
        for suffix in ("png", "svg")
    }
    assert names == figures | {"comparison.md", "comparison.csv"}
    assert "not reproduced" in capsys.readouterr().out
    with (folder / "comparison.csv").open(encoding="utf-8", newline="") as file:
        rows = {(row["quantity"], row["published"]): row for row in csv.DictReader(file)}
    assert rows["hip threshold, ankle and knee rigid", "179.7"]["verdict"] == "not reproduced"
    for path in folder.glob("*.svg"):
        assert ET.parse(path).getroot().tag.endswith("svg")  # noqa: S314 - our own file


def test_reproduce_twice_gives_the_same_bytes(tmp_path):
    for name in ("one", "two"):
        main(["reproduce", "-o", str(tmp_path / name)])
    for path in (tmp_path / "one").iterdir():
        assert path.read_bytes() == (tmp_path / "two" / path.name).read_bytes(), path.name


def test_a_folder_that_cannot_be_made_is_one_sentence(tmp_path, capsys):
    blocking = tmp_path / "file"
    blocking.write_text("in the way")
    assert main(["reproduce", "-o", str(blocking)]) == 1
    message = capsys.readouterr().err
    assert message.startswith("standfast: ")
    assert str(blocking) in message
    assert message.count("\n") == 1
