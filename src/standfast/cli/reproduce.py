"""``standfast reproduce``: the 2007 paper, its figures and its numbers beside ours."""

import argparse
from typing import Any

from standfast.cli.parsing import add_command, add_folder_option, made_folder


def add(commands: Any) -> None:
    """Declare the command."""
    parser = add_command(
        commands,
        _reproduce,
        "recompute the 2007 paper: its figures, and every published number beside ours",
        "reproduce -o results/edwards2007",
    )
    add_folder_option(parser, "results/edwards2007", "where to write (default: %(default)s)")


def _reproduce(options: argparse.Namespace) -> None:
    from standfast.edwards2007.comparison import compare, write_tables
    from standfast.edwards2007.drawings import draw_all

    folder = made_folder(options.output)
    comparisons = compare()
    written = [*write_tables(comparisons, folder), *draw_all(folder)]
    for row in comparisons:
        number = row.published
        print(
            f"{row.verdict:16} {number.printed:>17} published, {row.computed:10.6g} computed  "
            f"{number.what} [{number.unit}] ({number.where})"
        )
    print(f"\nWritten to {folder}: {', '.join(path.name for path in written)}")
