"""``standfast laws`` as a user types it."""

import dataclasses
import json
import subprocess
import sys

import pytest

import standfast as sf
from standfast.cli.app import main
from standfast.mechanics.law import Outcome
from standfast.mechanics.laws import LAWS, LEFT_OUT


def said(capsys, *arguments):
    assert main(["laws", *arguments]) == 0
    return capsys.readouterr().out


def test_the_table_has_a_line_for_every_law(capsys):
    lines = said(capsys).splitlines()
    names = [line.split()[0] for line in lines[1 : 1 + len(LAWS)]]
    assert names == list(LAWS)
    (line,) = (line for line in lines if line.startswith("pasma-2017"))
    assert line.split() == [
        "pasma-2017", "ankle", "40.5", "68.8", "943.9", "313.5", "97", "yes", "286.2", "seen",
    ]  # fmt: skip
    (line,) = (line for line in lines if line.startswith("wang-pd-det"))
    assert line.split()[-4:] == ["no", "any", "delay", "seen"]
    (line,) = (line for line in lines if line.startswith("wang-fpd-det"))
    assert "341.5 364 *" in line
    assert not any("not so" in line for line in lines)
    assert max(map(len, lines)) < 140


def test_a_law_that_does_not_do_what_its_source_says_is_marked(capsys, monkeypatch):
    other = dataclasses.replace(LAWS["asai-2009"], published=Outcome(stands=True))
    monkeypatch.setitem(LAWS, "asai-2009", other)
    assert "no (published: not so)" in said(capsys)


def test_one_law_is_shown_whole(capsys):
    text = said(capsys, "independent-channel-1deg")
    for words in (
        "PosturalControlLab/LA_toolbox", "gains seen", "70.57 kg·m²", "18 N·m/degree",
        "1031.32 N·m/rad", "5 N·m·s/degree", "190 ms", "0.1 degrees/N·m", "225.1 ms",
        "stands (of the whole model", "-0.611 ± 3.414i 1/s",
    ):  # fmt: skip
        assert words in text.replace("\n              ", " ")
    text = said(capsys, "wang-pd-det")
    assert "published   falls; roots -2.344 ± 8.717i, -0.987, 0.715 1/s" in text
    assert "computed    falls; rightmost root 0.715 1/s" in text
    assert "no outcome is stated" in said(capsys, "lqr-pydy")


@pytest.mark.parametrize("name", ["pasma-2017", "wang-fpd-sto3", "lqr-edwards2007"])
def test_json_is_enough_to_do_it_again(capsys, name):
    """Body, gains and delay of the JSON alone give the outcome that it states."""
    law = json.loads(said(capsys, name, "--json"))
    free = [("ankle", "knee", "hip").index(joint) for joint in law["joints"]]

    def whole(rows):
        matrix = [[0.0] * 3 for _ in range(3)]
        for i, row in zip(free, rows, strict=True):
            for j, value in zip(free, row, strict=True):
                matrix[i][j] = value
        return matrix

    K = whole(law["stiffness"])
    person = {
        "body": sf.Body(**law["body"]),
        "stiffness": sf.Stiffness(*(K[j][j] if j in free else float("inf") for j in range(3))),
        "gravity": law["gravity"],
        "damping": whole(law["damping"]),
        "feedback": sf.Feedback(whole(law["proportional"]), whole(law["derivative"]), law["delay"]),
    }
    computed = law["computed"]
    assert sf.critical_delay(**person) == pytest.approx(computed["critical_delay"], rel=1e-9)
    root = sf.rightmost_root(**person)
    assert [root.real, root.imag] == pytest.approx(computed["rightmost_root"], abs=1e-6)
    assert sf.unstable_roots(**person) == computed["unstable_roots"] == 0
    assert computed["stands"] is True


def test_json_of_all_is_a_list(capsys):
    found = json.loads(said(capsys, "--json"))
    assert [law["name"] for law in found] == list(LAWS)
    assert {law["name"]: law["published"] for law in found}["wang-pd-sto3"]["roots"] == [
        [-2.940, 9.115], [-0.181, 0.046],
    ]  # fmt: skip


def test_a_law_that_is_not_there_gets_one_sentence(capsys):
    assert main(["laws", "pasma"]) == 2
    assert capsys.readouterr().err == (
        "standfast: pasma is not a law; did you mean 'pasma-2017'? (standfast laws lists them)\n"
    )
    for name, reason in LEFT_OUT.items():
        assert main(["laws", name]) == 2
        assert capsys.readouterr().err == f"standfast: {name} is not among the laws: {reason}\n"


def test_it_has_an_example_and_starts_without_jax():
    code = (
        "import sys; from standfast.cli.app import main; main(['laws'])\n"
        "heavy = {'jax', 'scipy', 'matplotlib', 'h5py'} & set(sys.modules)\n"
        "sys.exit(f'imported {heavy}' if heavy else 0)"
    )
    result = subprocess.run([sys.executable, "-c", code], capture_output=True, check=False)
    assert result.returncode == 0, result.stderr
    shown = subprocess.run(
        [sys.executable, "-m", "standfast", "laws", "--help"],
        capture_output=True, text=True, check=True,
    )  # fmt: skip
    assert "example: standfast laws pasma-2017" in shown.stdout
