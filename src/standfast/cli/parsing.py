"""What all commands share: how they are declared, and how their words are read."""

import argparse
import errno
import os
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

from standfast.errors import InputError

# Endings of what standfast writes.
FILES = {".csv", ".h5", ".json", ".md", ".pdf", ".png", ".svg", ".toml", ".xlsx"}
BY_COMMAS = "separate the numbers of an option by commas, as 5.6,14.2,46.8"
# With the comma that a list with blanks leaves at it.
NUMBER = re.compile(r",?[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?,?")
Command = Callable[[argparse.Namespace], None]


class StoppedError(Exception):
    """A run ended early for a reason outside; the message says how to go on."""


def add_command(
    commands: Any, run: Command, summary: str, example: str, *, compiles: bool = False
) -> argparse.ArgumentParser:
    """Declare a command by an example of its use; ``compiles``: it runs programs of JAX."""
    name = example.partition(" ")[0]
    parser: argparse.ArgumentParser = commands.add_parser(
        name,
        help=summary,
        description=summary[0].upper() + summary[1:] + ".",
        epilog=f"example: standfast {example}",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.set_defaults(run=run, command=name, compiles=compiles)
    return parser


def add_folder_option(
    parser: argparse.ArgumentParser, default: str = ".", words: str = "default: this folder"
) -> None:
    """Declare the folder that results go to."""
    parser.add_argument(
        "-o", "--output", type=output_folder, default=Path(default), metavar="FOLDER", help=words
    )


def output_folder(text: str) -> Path:
    """Read a folder; one that is not there and is named like a file is meant as a file."""
    path = Path(text)
    if path.suffix in FILES and not text.endswith(os.sep) and not path.is_dir():
        raise argparse.ArgumentTypeError(
            f"{text} looks like a file, and several are written; give a folder for them, as "
            f"{path.with_suffix('')}, or {text}/ if it is meant"
        )
    return path


def add_file_option(parser: argparse.ArgumentParser, kind: str, default: str) -> None:
    """Declare the file that a result goes to; :func:`output_file` reads what is given."""
    words = f"a file, or a folder for it (NAME/ is made); default: {default}"
    parser.add_argument("-o", "--output", metavar=kind, help=words)


def output_file(given: str | None, name: str) -> Path:
    """Return the file that a result goes to: as given, or under ``name`` in a given folder.

    A folder is what exists as one, or ends in a slash.
    """
    if given is None:
        return Path(name)
    is_folder = given.endswith(os.sep) or (given != "" and Path(given).is_dir())
    return Path(given) / name if is_folder else Path(given)


def made_room(path: Path, given: str | None) -> Path:
    """Return a file of :func:`output_file`; its folder is made if it was given as one."""
    if given is not None and path != Path(given):
        made_folder(path.parent)
    return path


def is_of_a_list(word: str) -> bool:
    """Return whether a word is a number of a list that was written with blanks."""
    return NUMBER.fullmatch(word) is not None


def pairs_of(option: str, text: str, form: str) -> list[tuple[str, str]]:
    """Read ``a=1,b=2``; ``form`` tells what each is, as ``JOINT=NUMBER, as ankle=30``."""
    pairs = []
    for part in text.split(","):
        name, equals, value = (each.strip() for each in part.partition("="))
        if not (name and equals and value):
            raise InputError(f"{option} {text}: {part!r} is not {form}")
        pairs.append((name, value))
    return pairs


def add_format_option(parser: argparse.ArgumentParser, of_what: str = "") -> None:
    """Declare the formats of figures."""
    words = f"{of_what}may be given more than once (default: png)"
    parser.add_argument("--format", action="append", choices=("png", "svg", "pdf"), help=words)


def number_from_1(text: str) -> int:
    """Read a number of threads or workers."""
    if not (text.isascii() and text.isdecimal() and int(text) >= 1):
        raise argparse.ArgumentTypeError(f"{text!r} is not a number of them; give 1 or more")
    return int(text)


def made_folder(path: Path) -> Path:
    """Return a folder for results, made if need be."""
    try:
        path.mkdir(parents=True, exist_ok=True)
    except FileExistsError as error:
        raise OSError(errno.ENOTDIR, "not a folder", error.filename) from None
    return path
