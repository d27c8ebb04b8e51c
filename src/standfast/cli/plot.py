"""``standfast plot``: the figures of an atlas, or of a population."""

import argparse
from pathlib import Path
from typing import Any

from standfast.cli.parsing import add_command, add_folder_option, add_format_option, made_folder


def add(commands: Any) -> None:
    """Declare the command."""
    parser = add_command(
        commands,
        _plot,
        "draw an atlas: limits of standing, maps and curves of its quantities",
        "plot atlas.h5 -o results --format pdf",
    )
    parser.add_argument("atlas", type=Path, metavar="FILE.h5")
    add_folder_option(parser)
    parser.add_argument(
        "-q", "--quantity", action="append", default=[], metavar="NAME", help="only this one"
    )
    add_format_option(parser)


def _plot(options: argparse.Namespace) -> None:
    from standfast.population.summary.file import is_population, open_population

    folder, formats = options.output, options.format or ("png",)
    if is_population(options.atlas):
        from standfast.figures.population import draw

        population = open_population(options.atlas)
        paths = draw(population, made_folder(folder) / options.atlas.stem, formats)
        print(f"Written to {folder}: {', '.join(path.name for path in paths)}")
        return
    from standfast.atlas.opening import open_atlas
    from standfast.figures.atlas_figures import plot

    atlas = open_atlas(options.atlas)
    drawn = plot(atlas, made_folder(folder), quantities=options.quantity, formats=formats)
    print(f"Written to {folder}:")
    for paths, left_out in drawn:
        note = f"   ({left_out})" if left_out else ""
        print(f"  {', '.join(path.name for path in paths)}{note}")
