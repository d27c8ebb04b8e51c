"""``standfast plot``: the figures of an atlas, of several, or of a population."""

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from standfast.cli.parsing import (
    add_command,
    add_folder_option,
    add_format_option,
    made_folder,
    pairs_of,
)
from standfast.errors import InputError

if TYPE_CHECKING:
    from standfast.figures.marking import Subject

PAIR = "NAME=VALUE, as gravity=1.62"


def add(commands: Any) -> None:
    """Declare the command."""
    parser = add_command(
        commands,
        _plot,
        "draw an atlas (limits of standing, maps, curves), limits of several, or a population",
        "plot atlas.h5 -o results --at knee=2000 --mark ankle=900,hip=400,id=S1",
    )
    words = "an atlas or a population; several atlases: their limits in one figure"
    parser.add_argument("atlas", type=Path, nargs="+", metavar="FILE.h5", help=words)
    add_folder_option(parser)
    words = "only this quantity, or this figure of a population; may be given more than once"
    parser.add_argument("-q", "--quantity", action="append", default=[], metavar="NAME", help=words)
    words = "the slice to draw, at the nearest value of the grid; repeatable, or with commas"
    parser.add_argument("--at", action="append", default=[], metavar="AXIS=VALUE", help=words)
    words = "the axis whose values become curves of the limits, for example body_model"
    parser.add_argument("--overlay", metavar="AXIS", help=words)
    words = (
        "a subject on maps and limits, as ankle=900,hip=400 with id=NAME if wanted, or a CSV file "
        "of subjects (columns of parameters and id); repeatable"
    )
    parser.add_argument("--mark", action="append", default=[], metavar="SUBJECT", help=words)
    add_format_option(parser)


def _plot(options: argparse.Namespace) -> None:
    from standfast.cli.progress import interruptible, progress_bar
    from standfast.population.summary.file import is_population

    populations = [path for path in options.atlas if is_population(path)]
    if populations and len(options.atlas) > 1:
        raise InputError(f"{populations[0]} is a population, which is drawn alone")
    with progress_bar("panels", "drawing") as (_, show), interruptible() as stop_if_asked:

        def after_panel(done: int, total: int) -> None:
            show(done, total)
            stop_if_asked()

        draw = _draw_population if populations else _draw_atlases
        drawn = draw(options, after_panel)
    print(f"Written to {options.output}:")
    for paths, remark in drawn:
        names = ", ".join(path.name for path in paths)
        note = f"   ({remark})" if remark and names else remark
        print(f"  {names}{note}")


def _draw_population(options: argparse.Namespace, progress: Any) -> Sequence[tuple[Any, str]]:
    from standfast.figures.population import draw, names_of
    from standfast.population.summary.file import open_population

    for option in ("at", "overlay", "mark"):
        if getattr(options, option):
            raise InputError(f"--{option} is for atlases, and {options.atlas[0]} is a population")
    population = open_population(options.atlas[0])
    wanted = names_of(population, options.quantity)
    stem = made_folder(options.output) / options.atlas[0].stem
    formats = options.format or ("png",)
    return draw(population, stem, formats, wanted=wanted, progress=progress)


def _draw_atlases(options: argparse.Namespace, progress: Any) -> Sequence[tuple[Any, str]]:
    from standfast.atlas.opening import open_atlas
    from standfast.figures.atlas_figures import plot

    atlases = [open_atlas(path) for path in options.atlas]
    at = dict(pair for text in options.at for pair in pairs_of("--at", text, PAIR))
    subjects = [one for text in options.mark for one in _subjects(text)]
    return plot(
        atlases,
        made_folder(options.output),
        quantities=options.quantity,
        formats=options.format or ("png",),
        at=at,
        overlay=options.overlay,
        mark=subjects,
        progress=progress,
    )


def _subjects(text: str) -> "list[Subject]":
    """Read one subject, or a file of them."""
    from standfast.figures.marking import subject, subjects_in

    if "=" in text and not Path(text).exists():
        return [subject("--mark", dict(pairs_of("--mark", text, PAIR)))]
    subjects, remark = subjects_in(Path(text))
    if remark:
        print(f"standfast: {remark}", file=sys.stderr)
    return subjects
