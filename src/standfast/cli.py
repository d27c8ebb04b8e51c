"""The command line: the only module that prints, exits or sets flags."""

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from standfast import __version__
from standfast.quantities import InputError

DONE, FAILED, WRONG_INPUT = 0, 1, 2


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line and return the exit code: 0 done, 1 failed, 2 wrong input."""
    parser = _parser()
    options = parser.parse_args(arguments)
    try:
        options.run(options)
    except InputError as error:
        return _complain(str(error), WRONG_INPUT)
    except OSError as error:
        where = f" ({error.filename})" if error.filename else ""
        return _complain(f"{error.strerror or error}{where}", FAILED)
    except KeyboardInterrupt:
        return _complain("stopped", FAILED)
    return DONE


def run() -> None:
    """Entry point of the installed command."""
    sys.exit(main())


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="standfast",
        description="How stiff must ankle, knee and hip be for a person to stand?",
        epilog="example: standfast reproduce",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--version", action="version", version=f"standfast {__version__}")
    commands = parser.add_subparsers(title="commands", metavar="COMMAND", required=True)

    reproduce = commands.add_parser(
        "reproduce",
        help="recompute the 2007 paper: its figures, and every published number beside ours",
        description="Recompute Gait & Posture 25 (2007) 432-439: figures 2, 3, 4 and 5 as PNG and "
        "SVG,\nand a table of every published number beside ours (comparison.md, comparison.csv).",
        epilog="example: standfast reproduce -o results/edwards2007",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    reproduce.add_argument(
        "-o",
        "--output",
        type=Path,
        default=Path("results/edwards2007"),
        metavar="FOLDER",
        help="where to write (default: %(default)s)",
    )
    reproduce.set_defaults(run=_reproduce)
    return parser


def _reproduce(options: argparse.Namespace) -> None:
    from standfast.edwards2007.comparison import compare, write_tables
    from standfast.edwards2007.drawings import draw_all

    folder: Path = options.output
    folder.mkdir(parents=True, exist_ok=True)
    comparisons = compare()
    for row in comparisons:
        number = row.published
        print(
            f"{row.verdict:16} {number.printed:>17} published, {row.computed:10.6g} computed  "
            f"{number.what} [{number.unit}] ({number.where})"
        )
    written = [*write_tables(comparisons, folder), *draw_all(folder)]
    print(f"\nWritten to {folder}: {', '.join(path.name for path in written)}")


def _complain(sentence: str, code: int) -> int:
    print(f"standfast: {sentence}", file=sys.stderr)
    return code
