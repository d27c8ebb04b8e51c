"""``standfast sweep``: a study into an atlas file."""

import argparse
import sys
from pathlib import Path
from typing import Any

from standfast.cli.parsing import add_command
from standfast.cli.running import add_run_options, output_of, run_shards
from standfast.files import in_bytes
from standfast.mechanics.feedback import likely_per_degree
from standfast.parameters import GAINS
from standfast.study.study import Study


def add(commands: Any) -> None:
    """Declare the command."""
    parser = add_command(
        commands,
        _sweep,
        "compute a study into an atlas file (the same command resumes what was broken off)",
        "sweep studies/atlas.toml -o atlas.h5",
        compiles=True,
    )
    add_run_options(parser, "compress")


def _sweep(options: argparse.Namespace) -> None:
    study = Study.from_toml(options.study)
    largest = {name: float(axis.max()) for name, axis in study.axes.items() if name in GAINS}
    if note := likely_per_degree({**study.fixed, **largest}):
        print(f"standfast: {note}", file=sys.stderr)
    output = output_of(options)
    if output.exists() and options.part is None:
        _compute(study, output)
        print(f"{output} is finished already.")
    elif run_shards(_compute, study, options, "values") is not None:
        print(f"{output}: {study.points:,} values, {in_bytes(output.stat().st_size)}.")


def _compute(study: Study, output: Path, **settings: Any) -> Any:
    from standfast.atlas.sweeping import sweep

    return sweep(study, output, **settings)
