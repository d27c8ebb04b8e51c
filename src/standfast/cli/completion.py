"""``standfast completion``: a script by which a shell completes commands, options and values."""

import argparse
import re
from functools import partial
from typing import Any

from standfast.cli.parsing import add_command

PLACES = """\
once, and open a new shell:
  bash  standfast completion bash > ~/.local/share/bash-completion/completions/standfast
  zsh   standfast completion zsh > FOLDER/_standfast      (FOLDER: one that $fpath has)
  fish  standfast completion fish > ~/.config/fish/completions/standfast.fish"""
FILE = re.compile(r"\.\w+|^SUBJECT$")  # of STUDY.toml, FILE.h5|STUDY.toml


def add(commands: Any, parser: argparse.ArgumentParser) -> None:
    """Declare the command; ``parser`` is the one of all commands."""
    own = add_command(
        commands,
        partial(_completion, parser, commands),
        "print the script that completes commands, options and values in your shell",
        "completion bash",
    )
    own.epilog = f"{own.epilog}\n\n{PLACES}"
    own.add_argument("shell", choices=("bash", "zsh", "fish"), help="the shell that you use")


def _completion(
    parser: argparse.ArgumentParser, commands: Any, options: argparse.Namespace
) -> None:
    import shtab

    values = _values()
    for command in commands.choices.values():
        for action in command._actions:  # noqa: SLF001 - argparse has no other list of them
            _tell(action, values)
    print(shtab.complete(parser, options.shell))


def _values() -> dict[str, tuple[str, ...]]:
    """Return the names that an argument may have, by the word that stands for it in the help."""
    from standfast.mechanics.laws import LAWS
    from standfast.parameters import BODY_MODELS
    from standfast.quantities import QUANTITIES

    return {"LAW": tuple(LAWS), "MODEL": tuple(BODY_MODELS), "NAME": tuple(QUANTITIES)}


def _tell(action: Any, values: dict[str, tuple[str, ...]]) -> None:
    """Write at an argument what it completes to; the parser reads nothing after that."""
    import shtab

    word = action.metavar if isinstance(action.metavar, str) else ""
    if FILE.search(word):
        action.complete = shtab.FILE
    elif word == "FOLDER":
        action.complete = shtab.DIRECTORY
    elif word in values:
        action.choices = values[word]
