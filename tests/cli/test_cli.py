"""The command as a user types it."""

import contextlib
import csv
import errno
import io
import json
import os
import shutil
import subprocess
import sys
import xml.etree.ElementTree as ET

import pytest

import standfast
import standfast.atlas.sweeping
from standfast.cli.app import main
from standfast.edwards2007.drawings import draw_figure_4
from standfast.study import grid
from studies import GOOD, toml_of


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
        "import sys; from standfast.cli.app import main\n"
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


@pytest.mark.parametrize("gain", ["15", "[5, 15]", "{ start = 0, stop = 15, num = 4 }"])
def test_a_gain_per_degree_is_noted_and_done(tmp_path, monkeypatch, capsys, gain):
    monkeypatch.chdir(tmp_path)
    content = toml_of(GOOD) + f"[feedback.proportional]\nankle = {gain}\n"
    (tmp_path / "study.toml").write_text(content, encoding="utf-8")
    main(["sweep", "study.toml"])
    assert "if it is meant in N·m per degree, write 859.5" in capsys.readouterr().err
    assert (tmp_path / "study.h5").exists()


def test_what_only_reads_starts_without_jax(place, monkeypatch):
    main(["sweep", "study.toml"])
    for command, needless in (
        ("info", {"jax", "scipy", "matplotlib"}),
        ("thresholds", {"jax", "scipy", "matplotlib"}),
        ("plot", {"jax", "scipy", "matplotlib.pyplot"}),
    ):
        code = (
            f"import sys; from standfast.cli.app import main; main([{command!r}, 'study.h5'])\n"
            f"heavy = {needless} & set(sys.modules)\n"
            "sys.exit(f'imported {heavy}' if heavy else 0)"
        )
        result = subprocess.run([sys.executable, "-c", code], capture_output=True, check=False)
        assert result.returncode == 0, result.stderr


def test_a_reader_that_has_seen_enough_loses_no_file(place):
    main(["sweep", "study.toml"])
    command = f"{sys.executable} -m standfast thresholds study.h5 | head -1"
    subprocess.run(command, shell=True, capture_output=True, check=True)  # noqa: S602 - a pipe
    assert {"study-thresholds.csv", "study-thresholds.h5"} <= {p.name for p in place.iterdir()}


@pytest.mark.parametrize("command", ["sweep", "thresholds", "plot", "info", "reproduce"])
def test_every_command_has_an_example(command):
    result = standfast_command(command, "--help")
    assert result.returncode == 0
    assert f"example: standfast {command}" in result.stdout


def test_version():
    assert standfast_command("--version").stdout.strip() == f"standfast {standfast.__version__}"


@pytest.mark.parametrize(
    "arguments",
    [
        [],
        ["reprodice"],
        ["reproduce", "--outputt", "x"],
        ["sweep"],
        ["sweep", "x.toml", "--part", "3/2"],
        ["sweep", "x.toml", "--threads", "0"],
        ["plot", "x.h5", "--format", "gif"],
    ],
)
def test_wrong_words_exit_with_2_and_no_traceback(arguments):
    result = standfast_command(*arguments)
    assert result.returncode == 2
    assert "Traceback" not in result.stderr
    assert "usage: standfast" in result.stderr


@pytest.fixture(scope="module")
def reproduced(tmp_path_factory):
    """The paper's figures and tables in a folder, and what the command printed."""
    folder = tmp_path_factory.mktemp("paper") / "deep" / "paper"
    with contextlib.redirect_stdout(io.StringIO()) as told:
        assert main(["reproduce", "-o", str(folder)]) == 0
    return folder, told.getvalue()


def test_reproduce_writes_figures_and_tables_and_nothing_else(reproduced):
    folder, told = reproduced
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
    assert "not reproduced" in told
    with (folder / "comparison.csv").open(encoding="utf-8", newline="") as file:
        rows = {(row["quantity"], row["published"]): row for row in csv.DictReader(file)}
    assert rows["hip threshold, ankle and knee rigid", "179.7"]["verdict"] == "not reproduced"
    for path in folder.glob("*.svg"):
        assert ET.parse(path).getroot().tag.endswith("svg")  # noqa: S314 - our own file


def test_a_console_without_greek_and_a_users_own_style_do_not_matter(tmp_path, reproduced):
    (tmp_path / "matplotlibrc").write_text("text.usetex: True\nfont.family: serif\n")
    result = subprocess.run(
        [sys.executable, "-m", "standfast", "reproduce", "-o", "there"],
        cwd=tmp_path, capture_output=True, check=False,
        env={**os.environ, "PYTHONIOENCODING": "cp1252", "MPLBACKEND": "tkagg"},
    )  # fmt: skip
    assert result.returncode == 0, result.stderr
    for path in reproduced[0].iterdir():
        assert path.read_bytes() == (tmp_path / "there" / path.name).read_bytes()


def test_a_second_time_in_a_process_gives_the_same_bytes(tmp_path, reproduced):
    """One figure; all of them, in another process, are compared above."""
    for path in draw_figure_4(standfast.Body.edwards2007(), tmp_path):
        assert path.read_bytes() == (reproduced[0] / path.name).read_bytes(), path.name


def test_a_folder_that_cannot_be_made_is_one_sentence(tmp_path, capsys):
    blocking = tmp_path / "file"
    blocking.write_text("in the way")
    assert main(["reproduce", "-o", str(blocking)]) == 1
    message = capsys.readouterr().err
    assert message.startswith("standfast: ")
    assert str(blocking) in message
    assert message.count("\n") == 1


STUDY = """
title = "A day's work"
gravity = 9.8
[body]
model = "edwards2007"
height = 1.753
mass = 75.3
[stiffness]
ankle = { start = 0, stop = 2000, num = 41 }
knee = [1000, inf]
hip = { start = 0, stop = 2000, num = 31 }
[output]
quantities = ["stable", "frequency"]
"""


@pytest.fixture
def place(tmp_path, monkeypatch):
    (tmp_path / "study.toml").write_text(STUDY, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_a_days_work(place, capsys):
    """Sweep, again, info, thresholds, plot: as in the README."""
    assert main(["sweep", "study.toml"]) == 0
    assert "study.h5: 5,084 values" in capsys.readouterr().out
    assert main(["sweep", "study.toml"]) == 0
    assert "finished already" in capsys.readouterr().out
    assert main(["info", "study.h5"]) == 0
    shown = capsys.readouterr().out
    assert "A day's work" in shown
    assert "complete, 5,084 values" in shown
    assert "ankle_stiffness   41 values from 0 to 2000 N·m/rad" in shown
    assert len(shown.splitlines()) < 25
    assert main(["thresholds", "study.h5"]) == 0
    assert "distance from closed form at most" in capsys.readouterr().out
    assert main(["thresholds", "study.toml", "-o", "exact"]) == 0
    assert main(["plot", "study.h5", "-o", "figures", "--format", "svg"]) == 0
    names = sorted(str(path.relative_to(place)) for path in place.rglob("*") if path.is_file())
    assert names == [
        "exact/study-thresholds.csv",
        "exact/study-thresholds.h5",
        "figures/study-frequency.svg",
        "figures/study-limits.svg",
        "study-thresholds.csv",
        "study-thresholds.h5",
        "study.h5",
        "study.run.json",
        "study.toml",
    ]


def test_info_as_json(place, capsys):
    main(["sweep", "study.toml", "-o", "a.h5"])
    capsys.readouterr()
    assert main(["info", "a.h5", "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["complete"] is True
    assert told["quantities"]["stable"] == ["ankle_stiffness", "knee_stiffness", "hip_stiffness"]


def test_parts_and_what_info_says_of_them(place, capsys, monkeypatch):
    monkeypatch.setattr(grid, "SHARD_WORK", 1)
    assert main(["sweep", "study.toml", "--part", "1/2"]) == 0
    assert "without --part the same command finishes it" in capsys.readouterr().out
    assert main(["info", "study.h5"]) == 0
    assert "not finished, 1 of 2 shards" in capsys.readouterr().out
    assert main(["plot", "study.h5"]) == 2
    assert "there is no such file" in capsys.readouterr().err
    assert main(["sweep", "study.toml"]) == 0


def refused(capsys, arguments, *, code=2):
    assert main(arguments) == code
    captured = capsys.readouterr()
    assert captured.err.startswith("standfast: ")
    assert captured.err.count("\n") == 1
    return captured.err


@pytest.mark.parametrize(
    ("output", "fault"),
    [
        ("file", "not a folder (file)"), ("file/deeper", "Not a directory (file/deeper)"),
        ("nothing", "not a folder (nothing)"), ("pipe", "not a folder (pipe)"),
        ("/dev/null", "not a folder (/dev/null)"), ("closed", "Permission denied (closed/"),
    ],
)  # fmt: skip
@pytest.mark.parametrize("command", [["plot", "a.h5"], ["thresholds", "a.h5"], ["reproduce"]])
def test_a_folder_that_cannot_be_is_one_sentence(place, capsys, command, output, fault):
    if output == "closed" and os.geteuid() == 0:
        pytest.skip("this user may write everywhere")
    main(["sweep", "study.toml", "-o", "a.h5"])
    before = put_in_the_way(place)
    capsys.readouterr()
    assert fault in refused(capsys, [*command, "-o", output], code=1)
    assert {path: path.lstat()[:3] for path in place.rglob("*")} == before


@pytest.mark.parametrize(
    ("output", "fault"),
    [
        ("", "not a plain file (.)"),
        ("pipe", "not a plain file (pipe)"), ("/dev/null", "not a plain file (/dev/null)"),
        ("nothing", "a link to nothing (nothing)"), ("circle", "(circle)"),
        ("no/where.csv", "No such file or directory (no/where.csv)"),
        ("file/deeper", "Not a directory (file/deeper)"),
        ("closed/a.csv", "Permission denied (closed/a.csv)"),
    ],
)  # fmt: skip
def test_only_a_plain_file_is_replaced(place, capsys, output, fault):
    if output == "closed/a.csv" and os.geteuid() == 0:
        pytest.skip("this user may write everywhere")
    (place / "people.csv").write_text("height,mass\n1.7,70\n")
    before = put_in_the_way(place)
    assert fault in refused(capsys, ["assess", "people.csv", "-o", output], code=1)
    assert {path: path.lstat()[:3] for path in place.rglob("*")} == before


def put_in_the_way(place):
    """Make what cannot be an output; return what is there now."""
    (place / "file").write_text("mine")
    (place / "closed").mkdir(mode=0o500)
    (place / "nothing").symlink_to("no/where")
    (place / "circle").symlink_to("circle")
    os.mkfifo(place / "pipe")
    return {path: path.lstat()[:3] for path in place.rglob("*")}


def test_wrong_files_get_one_sentence(place, capsys):
    (place / "words.h5").write_text("words")
    main(["sweep", "study.toml", "-o", "a.h5"])
    shutil.copy("a.h5", "cut.h5")
    os.truncate("cut.h5", 5000)
    for command in ("info", "plot", "thresholds"):
        capsys.readouterr()
        assert "is not an HDF5 file" in refused(capsys, [command, "words.h5"])
        assert "is damaged or cut short" in refused(capsys, [command, "cut.h5"])
        assert "there is no such file" in refused(capsys, [command, "none.h5"])
    assert "no such study file" in refused(capsys, ["sweep", "none.toml"])
    assert "is not valid TOML" in refused(capsys, ["sweep", "a.run.json"])
    assert "make it first" in refused(capsys, ["sweep", "study.toml", "-o", "no/where.h5"])
    assert "has no 'stabel'" in refused(capsys, ["plot", "a.h5", "-q", "stabel"])


def test_another_studys_output_is_refused(place, capsys):
    main(["sweep", "study.toml", "-o", "a.h5"])
    (place / "other.toml").write_text(STUDY.replace("1000, inf", "1100, inf"), encoding="utf-8")
    capsys.readouterr()
    message = refused(capsys, ["sweep", "other.toml", "-o", "a.h5"])
    assert "knee_stiffness: [1000, inf] there, [1100, inf] here" in message


@pytest.mark.parametrize(
    ("error", "words"),
    [
        (
            KeyboardInterrupt(),
            "stopped; shards that are done are kept in study.h5.parts. To go on: standfast",
        ),
        (
            OSError(errno.ENOSPC, "No space left"),
            "the disk is full; shards that are done are kept in",
        ),
    ],
)
def test_a_broken_off_run_says_how_to_go_on(place, capsys, monkeypatch, error, words):
    def broken(*arguments, **settings):
        raise error

    monkeypatch.setattr(sys.modules["standfast.atlas.sweeping"], "sweep", broken)
    assert words in refused(capsys, ["sweep", "study.toml"], code=1)


def test_a_run_off_the_terminal_prints_plain_lines_only(place):
    result = standfast_command("sweep", "study.toml", cwd=place)
    assert result.returncode == 0
    assert "\x1b" not in result.stderr
