"""Slips on the command line: the nearest name, and the usage of the command that was meant."""

import pytest

from standfast.cli.app import main


@pytest.mark.parametrize(
    ("command", "usage", "sentence"),
    [
        ("persn --height 2", "standfast ", "there is no command 'persn'; did you mean 'person'?"),
        ("xyz", "standfast ", "there is no command 'xyz' (commands: sweep, thresholds, plot, pop"),
        ("person --heigth 2", "standfast person", "--heigth; did you mean '--height'?"),
        ("sweep a.toml --thread=2 --parts 1/2", "standfast sweep", "did you mean '--part'?"),
        ("sweep a.toml b.toml", "standfast sweep", "unrecognized arguments: b.toml\n"),
        ("person --segment-mass 5.6 14.2 46.8", "standfast person",
         "46.8; separate the numbers of an option by commas, as 5.6,14.2,46.8"),
        ("person --segment-mass 5.6, 14.2, 46.8", "standfast person", "numbers of an option by"),
    ],
)  # fmt: skip
def test_a_slip_gets_its_sentence_and_usage(capsys, command, usage, sentence):
    with pytest.raises(SystemExit) as stop:
        main(command.split())
    assert stop.value.code == 2
    said = capsys.readouterr().err
    assert said.startswith(f"usage: {usage}")
    assert sentence in said


def test_a_number_is_not_the_name_of_a_study(capsys):
    assert main(["person", "--segment-length", "0.385", "0.405", "--ankle", "900"]) == 2
    assert capsys.readouterr().err == (
        "standfast: 0.405 is not the name of a study; separate the numbers of an option by commas, "
        "as 5.6,14.2,46.8\n"
    )
