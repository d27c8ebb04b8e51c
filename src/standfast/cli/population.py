"""``standfast population``: who of a population would not stand, and what it would take."""

import argparse
import json
import sys
from pathlib import Path
from typing import Any

from standfast.cli.parsing import add_command, add_format_option
from standfast.cli.population_text import print_summary
from standfast.cli.rejected import write_rejected
from standfast.cli.running import add_run_options, output_of, run_shards


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
    parser.add_argument("--no-figures", action="store_true", help="write no figures")
    add_format_option(parser, "of the figures; ")


def _population(options: argparse.Namespace) -> None:
    from standfast.population.people.sections import likely_slips
    from standfast.population.people.study import PopulationStudy

    study = PopulationStudy.from_toml(options.study)
    for note in likely_slips(study.nerves):
        print(f"standfast: {note}", file=sys.stderr)
    found = run_shards(_compute, study, options, "persons", strict=options.strict)
    if found is None:
        return
    output = output_of(options)
    written = [output, *write_rejected(found.summary["people"].get("rejected", []), output)]
    said: list[str] = []
    if not options.no_figures:
        from standfast.figures.population import draw

        drawn = draw(found, output.with_suffix(""), options.format or ("png",))
        written += [path for drawing in drawn for path in drawing.paths]
        said = [drawing.remark for drawing in drawn if drawing.remark]
    if options.json:
        print(json.dumps(found.summary, ensure_ascii=False))
        return
    print_summary(found.summary)
    print(f"\nWritten to {output.parent}: {', '.join(path.name for path in written)}")
    for remark in said:
        print(f"  {remark}")


def _compute(study: Any, output: Path, **settings: Any) -> Any:
    from standfast.population.simulation import simulate

    return simulate(study, output, **settings)
