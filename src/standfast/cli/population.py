"""``standfast population``: who of a population would not stand, and what it would take."""

import argparse
import contextlib
import json
import os
import sys
from pathlib import Path
from typing import Any

from standfast.cli.parsing import add_command, add_format_option
from standfast.cli.population_text import print_summary
from standfast.cli.rejected import HEADER as OF_REJECTED
from standfast.cli.rejected import rejected_path, write_rejected
from standfast.cli.running import add_run_options, output_of, run_shards
from standfast.cli.strata_table import OF_POPULATION, WORDS, rows_of_population, write_strata
from standfast.errors import InputError
from standfast.files import require_replaceable
from standfast.parameters import STIFFNESSES


def add(commands: Any) -> None:
    """Declare the command."""
    parser = add_command(
        commands,
        _population,
        "who of a population would not stand, and what it would take (the same command resumes)",
        "population studies/us-adults.toml",
        compiles=True,
    )
    add_run_options(parser, "count")
    parser.add_argument("--strict", action="store_true", help="stop at the first unusable row")
    parser.add_argument("--json", action="store_true", help="all answers as one JSON object")
    parser.add_argument("--csv", type=Path, metavar="FILE.csv", help=WORDS)
    parser.add_argument("--no-figures", action="store_true", help="write no figures")
    add_format_option(parser, "of the figures; ")


def _population(options: argparse.Namespace) -> None:
    from standfast.population.people.sections import likely_slips
    from standfast.population.people.study import PopulationStudy

    try:
        study = PopulationStudy.from_toml(options.study)
    except InputError:
        if not _holds_people(options.study):
            raise
        name = options.study.name
        raise InputError(
            f"{options.study} is a file of people, not a study; write a study with "
            f"[population] people = {name!r}, or take them one by one: standfast assess {name}"
        ) from None
    springs = tuple(zip(STIFFNESSES, study.distributions, strict=True))
    for note in likely_slips(springs + study.nerves):
        print(f"standfast: {note}", file=sys.stderr)
    output = output_of(options)
    _check_tables(options.csv, output, [*study.files, options.study, output])
    found = run_shards(_compute, study, options, "persons", strict=options.strict)
    if found is None:
        return
    written = [output, *write_rejected(found.summary["people"].get("rejected", []), output)]
    said: list[str] = []
    if not options.no_figures:
        from standfast.figures.population import draw

        drawn = draw(found, output.with_suffix(""), options.format or ("png",))
        written += [path for drawing in drawn for path in drawing.paths]
        said = [drawing.remark for drawing in drawn if drawing.remark]
    if options.csv:
        write_strata(list(rows_of_population(found.summary)), options.csv, OF_POPULATION)
        written.append(options.csv)
    if options.json:
        print(json.dumps(found.summary, ensure_ascii=False))
        return
    print_summary(found.summary)
    print(f"\nWritten to {output.parent}: {', '.join(path.name for path in written)}")
    for remark in said:
        print(f"  {remark}")


def _holds_people(path: Path) -> bool:
    """Return whether a file is one of people."""
    from standfast.population.people.csv_table import read_table
    from standfast.population.people.decoding import STANDARD_INPUT

    with contextlib.suppress(InputError):
        return str(path) != STANDARD_INPUT and {"height", "mass"} <= set(read_table(path).columns)
    return False


def _check_tables(table: Path | None, output: Path, others: list[Path]) -> None:
    """Refuse to write tables over anything that is read or written, or any but their like."""
    rejected = rejected_path(output)
    others = [*others, rejected]
    if table is not None and os.path.realpath(table) in map(os.path.realpath, others):
        raise InputError(f"--csv {table} is a file of this study itself; choose another")
    require_replaceable(rejected, OF_REJECTED)
    if table is not None:
        require_replaceable(table, OF_POPULATION)


def _compute(study: Any, output: Path, **settings: Any) -> Any:
    from standfast.population.simulation import simulate

    return simulate(study, output, **settings)
