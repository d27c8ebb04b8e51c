"""What all commands share: how they are declared, and what a run that is stopped says."""

import argparse
import contextlib
import errno
import shlex
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any


class StoppedError(Exception):
    """A run ended early for a reason outside; the message says how to go on."""


def add_command(
    commands: Any, name: str, run: Callable[[argparse.Namespace], None], summary: str, example: str
) -> argparse.ArgumentParser:
    """Declare a command with an example in its help."""
    parser: argparse.ArgumentParser = commands.add_parser(
        name,
        help=summary,
        description=summary[0].upper() + summary[1:] + ".",
        epilog=f"example: standfast {name} {example}",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.set_defaults(run=run)
    return parser


def add_run_options(parser: argparse.ArgumentParser, work: str) -> None:
    """Declare the options of a run that is done in shards."""
    parser.add_argument(
        "-o", "--output", type=Path, metavar="FILE.h5", help="default: the study's name with .h5"
    )
    parser.add_argument(
        "--part",
        type=share_of_work,
        metavar="i/N",
        help="compute the i-th of N shares only, for array jobs; a later call finishes",
    )
    parser.add_argument(
        "--threads",
        type=number_of_threads,
        metavar="N",
        help=f"threads that {work} (default: all cores)",
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


@contextlib.contextmanager
def kept_when_stopped(output: Path) -> Iterator[None]:
    """Say of a run that is interrupted, or whose disk fills up, what is kept and how to go on."""
    again = "standfast " + " ".join(shlex.quote(word) for word in sys.argv[1:])
    try:
        yield
    except KeyboardInterrupt:
        raise StoppedError(
            f"stopped; shards that are done are kept in {output}.parts. To go on: {again}"
        ) from None
    except OSError as error:
        if error.errno == errno.ENOSPC:
            raise StoppedError(
                f"the disk is full; shards that are done are kept in {output}.parts. "
                f"Make room, then go on: {again}"
            ) from None
        raise
