"""``standfast completion``: what a shell makes of the script."""

import shutil
import subprocess

import pytest

from standfast.cli.app import build_parser, main
from standfast.mechanics.laws import LAWS
from standfast.parameters import BODY_MODELS
from standfast.quantities import QUANTITIES

ANSWER = """
source "$1"; shift
COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1))
_shtab_standfast 2>/dev/null
printf '%s\\n' "${COMPREPLY[@]}"
"""


@pytest.fixture
def script(tmp_path, capsys):
    """Write the script of a shell, and return its path."""

    def written(shell):
        assert main(["completion", shell]) == 0
        path = tmp_path / f"standfast.{shell}"
        path.write_text(capsys.readouterr().out, encoding="utf-8")
        return path

    return written


def shell_of(name):
    if (path := shutil.which(name)) is None:
        pytest.skip(f"{name} is not at hand")
    return path


def in_bash(path, *words, cwd):
    """What bash offers for the last of the words of a line."""
    command = [shell_of("bash"), "-c", ANSWER, "bash", str(path), "standfast", *words]
    found = subprocess.run(command, cwd=cwd, capture_output=True, text=True, check=True)
    return found.stdout.split()


# The words of a line, of which the last is being typed, and what is offered.
LINES = {
    ("sw",): {"sweep", "sway"},
    ("person", "--he"): {"--height", "--help"},
    ("person", "--model", "de-leva"): {"de-leva-male", "de-leva-female"},
    ("assess", "--body-model", "w"): {"winter"},
    ("laws", ""): set(LAWS),
    ("plot", "-q", "critical_"): {n for n in QUANTITIES if n.startswith("critical_")},
    ("plot", "--format", ""): {"png", "svg", "pdf"},
    ("sweep", "st"): {"study.toml", "study.h5", "studies"},
    ("sweep", "study.toml", "-o", "study.h"): {"study.h5"},
    ("reproduce", "-o", "st"): {"studies"},
    ("completion", ""): {"bash", "zsh", "fish"},
    ("no-such-command", "x"): set(),
}


def test_bash_offers_commands_options_names_and_files(script, tmp_path):
    path = script("bash")
    desk = tmp_path / "desk"
    (desk / "studies").mkdir(parents=True)
    for name in ("study.toml", "study.h5"):
        (desk / name).touch()
    for words, offered in LINES.items():
        assert set(in_bash(path, *words, cwd=desk)) == offered, words


def test_fish_offers_them_too(script, tmp_path):
    path, fish = script("fish"), shell_of("fish")
    for line, offered in (("sw", {"sweep", "sway"}), ("person --model w", {"winter"})):
        found = subprocess.run(
            [fish, "--no-config", "-c", f"source {path}; complete -C 'standfast {line}'"],
            capture_output=True,
            text=True,
            check=True,
        )
        assert {each.split("\t")[0] for each in found.stdout.splitlines()} == offered


def test_zsh_understands_its_script(script):
    path = script("zsh")
    assert path.read_text("utf-8").startswith("#compdef standfast")
    subprocess.run([shell_of("zsh"), "-n", path], check=True)


def test_names_are_offered_and_not_demanded():
    """Body models stay words to the parser, so that ``female=winter`` is read and checked."""
    options = build_parser().parse_args(["assess", "p.csv", "--body-model", "female=winter"])
    assert "winter" in BODY_MODELS
    assert "female=winter" in options.body_model
