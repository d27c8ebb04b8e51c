"""Whatever a file or a name holds, the terminal shows it and does not obey it."""

import json
import unicodedata

import h5py
import numpy as np
import pytest

from populations import GOOD, of
from standfast.cli.app import main
from standfast.cli.printing import visible
from standfast.population.simulation import simulate

EVIL = "\x1b]0;mine\x07\x1b[2J\x7f\x9b31m\r\u202e\u2066"
TURNS = {"LRE", "RLE", "LRO", "RLO", "PDF", "LRI", "RLI", "FSI", "PDI"}


def acts(character):
    """Whether a terminal would act on a character, as Unicode classes it."""
    return (
        (unicodedata.category(character) in {"Cc", "Zl", "Zp"} and character not in "\n\t")
        or unicodedata.bidirectional(character) in TURNS
        or character in "\u061c\u200e\u200f"
    )


def shown(capsys):
    """What was printed; nothing of it acts."""
    captured = capsys.readouterr()
    text = captured.out + captured.err
    assert any(map(acts, EVIL))
    assert not any(map(acts, text))
    return text


def test_every_character_that_acts_is_shown_and_no_other():
    for code in range(0x30000):
        wanted = {f"\\x{code:02x}", f"\\u{code:04x}"} if acts(chr(code)) else {chr(code)}
        assert visible(chr(code)) in wanted


def test_names_of_files(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    name = f"{EVIL}\n.csv"
    (tmp_path / name).write_text("height,mass\n1.7,70\n1.7,700\n")
    assert main(["assess", name]) == 0
    assert r"\x1b]0;mine\x07\x1b[2J\u007f" in shown(capsys)
    assert main(["assess", f"no{name}"]) == 2
    assert shown(capsys).count("\n") == 1
    with pytest.raises(SystemExit):
        main(["assess", "people.csv", f"--{EVIL}"])
    assert r"unrecognized arguments: --\x1b]0;mine" in shown(capsys)


def test_names_of_columns(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "people.csv").write_text(f"size{EVIL[:-3]},mass\n1.7,70\n", newline="")
    assert main(["assess", "people.csv"]) == 2
    assert r"columns there: size\x1b]0;mine" in shown(capsys)


def test_what_stands_in_a_file_of_hdf5(tmp_path, capsys):
    path = tmp_path / "a.h5"
    simulate(of({**GOOD, "title": ""}, size=64), path)
    with h5py.File(path, "r+") as file:
        summary = json.loads(bytes(file["summary"][()]))
        summary["title"] = EVIL
        del file["summary"]
        text = json.dumps(summary, ensure_ascii=False).encode()
        file["summary"] = np.array(text, dtype=f"S{len(text)}")
    assert main(["info", str(path)]) == 0
    assert r"\x1b]0;mine\x07" in shown(capsys)
    assert main(["info", str(path), "--json"]) == 0
    assert json.loads(shown(capsys))["title"] == EVIL
