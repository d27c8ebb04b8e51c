"""``standfast info``: what is inside a file, finished or not, on one screen."""

import argparse
import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

from standfast.cli.parsing import add_command
from standfast.files import in_bytes
from standfast.parameters import PARAMETERS
from standfast.study.canonical import describe
from standfast.study.study import Study

if TYPE_CHECKING:
    from standfast.atlas.reader import Atlas

MOST_RUNS = 20  # of shards that are named


def add(commands: Any) -> None:
    """Declare the command."""
    parser = add_command(
        commands,
        _info,
        "say what is inside the file of an atlas or a population, on one screen",
        "info atlas.h5",
    )
    words = "an atlas or a population, finished or not"
    parser.add_argument("atlas", type=Path, metavar="FILE.h5", help=words)
    parser.add_argument("--json", action="store_true", help="as one JSON object")


def _info(options: argparse.Namespace) -> None:
    from standfast.population.summary.file import is_population, open_population

    path: Path = options.atlas
    if is_population(path):
        from standfast.cli.population_text import print_summary

        summary = open_population(path).summary
        if options.json:
            print(json.dumps({"complete": True, **summary}, ensure_ascii=False))
        else:
            print_summary(summary)
    elif path.exists() or not _print_unfinished(path, as_json=options.json):
        from standfast.atlas.opening import open_atlas

        atlas = open_atlas(path)
        if options.json:
            print(json.dumps(_facts(atlas)))
        else:
            _print_atlas(atlas)


def _print_unfinished(path: Path, *, as_json: bool) -> bool:
    """Print what is known of a file that is being made; return whether one is."""
    from standfast.population.people.study import PopulationStudy
    from standfast.run.folder import unfinished, writers_of

    found: tuple[PopulationStudy | Study, list[int]] | None
    found = unfinished(path, PopulationStudy) or unfinished(path, Study)
    if found is None:
        return False
    study, missing = found
    count = study.shard_count
    done = count - len(missing)
    writers = writers_of(path)
    if as_json:
        facts = {"title": study.title, "complete": False, "done": done, "of": count}
        print(json.dumps({**facts, "missing": missing, "writers": writers}))
        return True
    print(f"{path}: {study.title or 'untitled study'}")
    print(f"not finished, {done} of {count} shards; the same command goes on")
    if missing:
        print(f"missing: {_in_runs(missing)}")
    for writer in writers:
        print(f"written by {writer}")
    if isinstance(study, Study):
        print()
        _print_parameters(study)
    return True


def _in_runs(numbers: list[int]) -> str:
    """Return rising numbers in words, such as ``0-3, 7``; many are cut short."""
    runs: list[list[int]] = []
    for number in numbers:
        if runs and number == runs[-1][1] + 1:
            runs[-1][1] = number
        else:
            runs.append([number, number])
    words = [f"{first}-{last}" if last > first else f"{first}" for first, last in runs]
    return ", ".join(words[:MOST_RUNS]) + (", …" if len(words) > MOST_RUNS else "")


def _facts(atlas: "Atlas") -> dict[str, Any]:
    study = atlas.study
    return {
        "title": study.title,
        "complete": True,
        "standfast_version": atlas.version,
        "study_sha256": study.fingerprint,
        "study": json.loads(study.canonical),
        "values": study.points,
        "bytes": atlas.path.stat().st_size,
        "quantities": {name: list(atlas[name].dims) for name in atlas.quantities},
    }


def _print_atlas(atlas: "Atlas") -> None:
    study = atlas.study
    print(f"{atlas.path}: {study.title or 'untitled study'}")
    print(
        f"complete, {study.points:,} values, {in_bytes(atlas.path.stat().st_size)}, "
        f"written by standfast {atlas.version}\n"
    )
    _print_parameters(study)
    print()
    for name, variable in atlas.items():
        axes = " × ".join(f"{axis} {len(study.axes[axis])}" for axis in variable.dims)
        print(f"  {name:26}{axes or 'one value'}   [{variable.units}]")
    print(f"\nstudy {study.fingerprint}")


def _print_parameters(study: Study) -> None:
    width = max(16, *map(len, study.parameters)) + 2
    for name, value in study.parameters.items():
        row = PARAMETERS[name]
        unit = "" if row.choices else f" {row.unit}"
        print(f"  {name:{width}}{describe(value)}{unit}")
