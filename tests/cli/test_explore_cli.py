"""``standfast explore`` as a user types it; the page itself is tested in tests/explore."""

import json
import os
import re
import signal
import stat
import subprocess
import sys
import threading
import time
import urllib.parse
import urllib.request
import webbrowser
from pathlib import Path

import pytest

import standfast as sf
from standfast.cli.app import main
from standfast.explore.server import listening
from studies import GOOD, UNEQUAL


@pytest.fixture(scope="module")
def atlas(tmp_path_factory):
    path = tmp_path_factory.mktemp("explore") / "atlas.h5"
    content = {
        **GOOD,
        "stiffness": UNEQUAL["stiffness"],
        "output": {"quantities": ["stable", "frequency"]},
    }
    sf.sweep(content, path)
    return path


FEEDBACK = """
gravity = 9.81
[body]
height = 1.75
mass = 70
[stiffness]
ankle = 500
knee = {knee}
hip = {knee}
[feedback]
delay = 0.1
[feedback.proportional]
ankle = {{ start = 0, stop = 900, num = 10 }}
"""


SECONDS = 20.0  # after which a test that waits fails


def soon(holds):
    """Wait until something holds, and return whether it came to that."""
    end = time.monotonic() + SECONDS
    while not holds() and time.monotonic() < end:
        time.sleep(0.01)
    return holds()


def exported(path, *arguments):
    assert main(["explore", *map(str, arguments), "--export", str(path)]) == 0
    told = re.search(r'id="content">(.*?)</script>', path.read_text(encoding="utf-8"))
    return json.loads(told[1])


def starts(content):
    return {row["name"]: row["start"] for row in content["parameters"]}


def test_a_page_of_a_nominal_adult_is_written(tmp_path, capsys):
    path = tmp_path / "page.html"
    found = exported(path, "--person", "height=1.66,mass=68", "--person", "ankle=900,knee=rigid")
    assert found["title"] == "Nominal adult"
    start = starts(found)
    assert (start["height"], start["mass"]) == (1.66, 68.0)
    assert (start["ankle_stiffness"], start["knee_stiffness"]) == (900.0, "inf")
    assert start["hip_stiffness"] == 500.0
    assert f"Written: {path} (" in capsys.readouterr().out
    assert [each.name for each in tmp_path.iterdir()] == ["page.html"]


def test_an_atlas_is_embedded(tmp_path, atlas, capsys):
    found = exported(tmp_path / "page.html", atlas, "-q", "frequency", "--mark", "hip=400,id=S1")
    assert found["source"] == "embedded"
    assert list(found["embedded"]["values"]) == ["frequency"]
    assert found["subjects"] == [{"label": "S1", "values": {"hip_stiffness": 400.0}}]
    assert found["notes"] == []
    assert capsys.readouterr().err == ""


def test_a_thinned_atlas_says_so(tmp_path, atlas, capsys, monkeypatch):
    monkeypatch.setattr("standfast.explore.embedding.EMBEDDED_BYTES", 1500)
    (note,) = exported(tmp_path / "page.html", atlas)["notes"]
    assert "this page holds knee stiffness at 2 of 3 values" in note
    assert note in capsys.readouterr().err


@pytest.mark.parametrize(("knee", "several"), [("1500", True), ("inf", False)])
def test_feedback_of_several_joints_is_said_not_to_be_exported(tmp_path, capsys, knee, several):
    study = tmp_path / "study.toml"
    study.write_text(FEEDBACK.format(knee=knee))
    found = exported(tmp_path / "page.html", study)
    assert ("sweep the study and export the atlas" in capsys.readouterr().err) == several
    assert ("springs alone" in " ".join(found["notes"])) == several
    shown = found["start"]
    assert shown["quantity"] == ("safety_factor" if several else "stable")
    assert ("gain" in shown["x"] + shown["y"]) == (not several)


@pytest.mark.parametrize(("arguments", "words"), [
    (["--person", "anle=900"], "'anle' is no parameter; did you mean 'ankle'"),
    (["--person", "height"], "'height' is not NAME=VALUE"),
    (["--person", "height=175"], "looks like centimetres"),
    (["--person", "mass=rigid"], "'rigid' is not a number"),
    (["--person", "model=winther"], "did you mean 'winter'"),
    (["--person", "shank_mass=4"], "shank_mass is of measured segments"),
    (["-q", "stabel"], "did you mean 'stable'"),
    (["--mark", "nothere.csv"], "nothere.csv cannot be read"),
    (["nothere.h5"], "there is no such file"),
    (["nothere.toml"], "nothere.toml"),
    (["--export", "page.pdf"], "end it in .html"),
])  # fmt: skip
def test_what_is_wrong_is_said_in_one_sentence(tmp_path, capsys, arguments, words):
    path = tmp_path / "page.html"
    assert main(["explore", "--export", str(path), *arguments]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert words in line
    assert not path.exists()


def test_a_population_is_said_to_be_one(tmp_path, capsys):
    study = tmp_path / "people.toml"
    study.write_text("[population]\npeople = 'us-adults'\n")
    assert main(["explore", str(study)]) == 2
    assert "study of a population" in capsys.readouterr().err


@pytest.mark.parametrize("missing", ["bokeh", "tornado"])
def test_without_the_extra_it_says_what_to_install(monkeypatch, capsys, missing):
    monkeypatch.setitem(sys.modules, missing, None)
    assert main(["explore", "--no-browser"]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert f"explore needs {missing}: pip install 'standfast[explore]'" in line


@pytest.mark.parametrize("port", ["0", "65536", "x", "-1"])
def test_what_is_no_port_is_said(capsys, port):
    with pytest.raises(SystemExit) as stopped:
        main(["explore", f"--port={port}"])
    assert stopped.value.code == 2
    assert "is not a port; give 1 to 65535" in capsys.readouterr().err


def test_a_busy_port_is_said(capsys):
    taken = listening(0)
    port = taken.getsockname()[1]
    assert main(["explore", "--no-browser", "--port", str(port)]) == 2
    assert f"--port {port} cannot be had" in capsys.readouterr().err
    taken.close()


def test_it_opens_the_browser_and_ctrl_c_ends_it_well(atlas, capsys, monkeypatch, tmp_path):
    """The command line of the browser, which others can read, does not have the token."""
    opened = []

    def browser(leading):
        file = Path(urllib.parse.urlsplit(leading).path)
        modes = [stat.S_IMODE(each.stat().st_mode) for each in (file, file.parent)]
        opened.append((leading, file, modes, file.read_text(encoding="utf-8")))
        os.kill(os.getpid(), signal.SIGINT)

    monkeypatch.setenv("HOME", str(tmp_path))
    monkeypatch.setattr(webbrowser, "open", browser)
    assert main(["explore", str(atlas)]) == 0
    first, second = capsys.readouterr().out.splitlines()
    assert second == "Ctrl-C ends it"
    address = first.removeprefix("Open ")
    assert address.startswith("http://127.0.0.1:")
    ((leading, file, modes, text),) = opened
    assert f"url={address}" in text
    assert address.partition("token=")[2] not in leading
    assert modes == [0o600, 0o700]
    assert file.is_relative_to(tmp_path)
    assert soon(lambda: not any(tmp_path.iterdir()))


def test_what_led_the_browser_to_the_page_is_removed_once_it_is_seen(atlas, monkeypatch, tmp_path):
    def browser(leading):
        text = Path(urllib.parse.urlsplit(leading).path).read_text(encoding="utf-8")
        address = re.search(r"url=(\S+)\"", text)[1]

        def look():
            with urllib.request.urlopen(address) as answer:  # noqa: S310 - the program's own
                assert answer.status == 200
            gone.append(soon(lambda: not any(tmp_path.iterdir())))
            os.kill(os.getpid(), signal.SIGINT)

        threading.Thread(target=look).start()

    gone = []
    monkeypatch.setenv("HOME", str(tmp_path))
    monkeypatch.setattr(webbrowser, "open", browser)
    assert main(["explore", str(atlas)]) == 0
    assert gone == [True]


def test_the_page_is_there_before_jax(tmp_path, atlas):
    """What takes a second to import waits until it is asked for."""
    program = (
        "import sys\n"
        "from standfast.cli import explore\n"
        "import standfast.explore.server as server\n"
        "server.serve = lambda *_: print({'jax', 'matplotlib'} & set(sys.modules))\n"
        "from standfast.cli.app import main\n"
        "sys.exit(main(['explore', *sys.argv[1:]]))\n"
    )
    for source in ([], [str(atlas)]):
        command = [sys.executable, "-c", program, *source, "--person", "hip=400"]
        result = subprocess.run(command, capture_output=True, text=True, check=True)
        assert result.stdout == "set()\n"


def test_a_title_of_a_study_is_told(tmp_path):
    study = tmp_path / "study.toml"
    study.write_text(FEEDBACK.format(knee="1500").replace("gravity", "title = 'Mine'\ngravity", 1))
    found = exported(tmp_path / "page.html", study)
    assert found["title"] == "Mine"
    assert GOOD["title"] != found["title"]


def test_an_export_replaces_a_page_and_nothing_else(tmp_path, capsys):
    path = tmp_path / "own.html"
    path.write_text("<!doctype html>\n<p>hello", encoding="utf-8")
    assert main(["explore", "--export", str(path)]) == 2
    assert "is no page of standfast" in capsys.readouterr().err
    assert path.read_text(encoding="utf-8").endswith("hello")
    path.unlink()
    exported(path)
    exported(path)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--export", "nowhere/page.html"], "there is no folder"),
        (["--export", "page.html", "--port", "8000"], "--port is of a page that is served"),
    ],
)
def test_what_cannot_be_exported_is_said_before(tmp_path, monkeypatch, capsys, arguments, words):
    monkeypatch.chdir(tmp_path)
    assert main(["explore", *arguments]) == 2
    assert words in capsys.readouterr().err
