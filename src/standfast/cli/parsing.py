"""What all commands share: how they are declared, and how their words are read."""

import argparse
from collections.abc import Callable
from pathlib import Path
from typing import Any


class StoppedError(Exception):
    """A run ended early for a reason outside; the message says how to go on."""


def add_command(
    commands: Any,
    name: str,
    run: Callable[[argparse.Namespace], None],
    summary: str,
    example: str,
    *,
    compiles: bool = False,
) -> argparse.ArgumentParser:
    """Declare a command with an example in its help; ``compiles``: it runs programs of JAX."""
    parser: argparse.ArgumentParser = commands.add_parser(
        name,
        help=summary,
        description=summary[0].upper() + summary[1:] + ".",
        epilog=f"example: standfast {name} {example}",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.set_defaults(run=run, compiles=compiles)
    return parser


def add_folder_option(parser: argparse.ArgumentParser) -> None:
    """Declare the folder that results go to."""
    parser.add_argument(
        "-o", "--output", type=Path, default=Path(), metavar="FOLDER", help="default: this folder"
    )


def add_format_option(parser: argparse.ArgumentParser, of_what: str = "") -> None:
    """Declare the formats of figures."""
    parser.add_argument(
        "--format",
        action="append",
        choices=("png", "svg", "pdf"),
        help=f"{of_what}may be given more than once (default: png)",
    )


def share_of_work(text: str) -> tuple[int, int]:
    """Read ``i/N``."""
    first, _, last = text.partition("/")
    if not (first.isdecimal() and last.isdecimal() and 1 <= int(first) <= int(last)):
        raise argparse.ArgumentTypeError(f"{text!r} is not a share; give i/N, for example 2/8")
    return int(first), int(last)


def number_of_threads(text: str) -> int:
    """Read a number of threads."""
    if not text.isdecimal() or int(text) < 1:
        raise argparse.ArgumentTypeError(f"{text!r} is not a number of threads; give 1 or more")
    return int(text)


def made_folder(path: Path) -> Path:
    """Return a folder for results, made if need be."""
    path.mkdir(parents=True, exist_ok=True)
    return path
