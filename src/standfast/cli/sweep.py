"""``standfast sweep``: a study into an atlas file."""

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Any

from standfast.cli.parsing import add_command
from standfast.cli.running import add_run_options, output_of, run_shards
from standfast.files import in_bytes

if TYPE_CHECKING:
    from standfast.atlas.reader import Atlas
    from standfast.study.study import Study


def add_sweep(commands: Any) -> None:
    """Declare the command."""
    parser = add_command(
        commands,
        "sweep",
        _sweep,
        "compute a study into an atlas file (the same command resumes what was broken off)",
        "studies/atlas.toml -o atlas.h5",
        compiles=True,
    )
    add_run_options(parser, "compress")


def _sweep(options: argparse.Namespace) -> None:
    from standfast.study.study import Study

    study = Study.from_toml(options.study)
    output = output_of(options)
    if output.exists() and options.part is None:
        _compute(study, output)
        print(f"{output} is finished already.")
    elif run_shards(_compute, study, options, "values") is not None:
        print(f"{output}: {study.points:,} values, {in_bytes(output.stat().st_size)}.")


def _compute(study: "Study", output: Path, **settings: Any) -> "Atlas | None":
    from standfast.atlas.sweeping import sweep

    atlas: Atlas | None = sweep(study, output, **settings)
    return atlas
