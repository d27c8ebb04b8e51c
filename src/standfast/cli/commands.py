"""The command line: the only module that prints, exits or sets flags."""

import argparse
import io
import json
import os
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from standfast import __version__
from standfast.cli.parsing import (
    StoppedError,
    add_command,
    add_run_options,
    kept_when_stopped,
    made_folder,
)
from standfast.cli.people import assess_parser, population_parser, tell_population
from standfast.quantities import PARAMETERS, QUANTITIES, InputError, in_bytes

if TYPE_CHECKING:
    from standfast.population import PopulationStudy
    from standfast.study import Study
    from standfast.sweep import Forecast
    from standfast.thresholds import Contour

DONE, FAILED, WRONG_INPUT = 0, 1, 2


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line and return the exit code: 0 done, 1 failed, 2 wrong input."""
    parser = _parser()
    options = parser.parse_args(arguments)
    try:
        options.run(options)
    except InputError as error:
        return _complain(str(error), WRONG_INPUT)
    except BrokenPipeError:  # the reader of a pipe has seen enough
        sys.stdout = None
        return DONE
    except StoppedError as stop:
        return _complain(str(stop), FAILED)
    except OSError as error:
        where = f" ({error.filename})" if error.filename else ""
        return _complain(f"{error.strerror or error}{where}", FAILED)
    except KeyboardInterrupt:
        return _complain("stopped", FAILED)
    return DONE


def run() -> None:
    """Entry point of the installed command."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):  # a console without Greek letters shows "?"
            stream.reconfigure(errors="replace")
    os.environ["MPLBACKEND"] = "agg"  # figures go to files, whatever the user's screen
    code = main()
    if code == FAILED:
        # threads of an interrupted run must not meet the interpreter taking itself apart
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(code)
    sys.exit(code)


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="standfast",
        description="How stiff must ankle, knee and hip be for a person to stand?",
        epilog="example: standfast reproduce",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--version", action="version", version=f"standfast {__version__}")
    commands = parser.add_subparsers(title="commands", metavar="COMMAND", required=True)

    _sweep_parser(commands)
    _thresholds_parser(commands)
    _plot_parser(commands)
    population_parser(commands)
    assess_parser(commands)
    _info_parser(commands)
    _reproduce_parser(commands)
    return parser


def _sweep_parser(commands: Any) -> None:
    parser = add_command(
        commands,
        "sweep",
        _sweep,
        "compute a study into an atlas file (the same command resumes what was broken off)",
        "studies/atlas.toml -o atlas.h5",
    )
    parser.add_argument("study", type=Path, metavar="STUDY.toml")
    add_run_options(parser, "compress")


def _thresholds_parser(commands: Any) -> None:
    parser = add_command(
        commands,
        "thresholds",
        _thresholds,
        "limits of standing over ankle and hip: exact curves of a study, contours of an atlas",
        "atlas.h5 -o results",
    )
    parser.add_argument("source", type=Path, metavar="FILE.h5|STUDY.toml")
    parser.add_argument(
        "-o", "--output", type=Path, default=Path(), metavar="FOLDER", help="default: this folder"
    )


def _plot_parser(commands: Any) -> None:
    parser = add_command(
        commands,
        "plot",
        _plot,
        "draw an atlas: limits of standing, maps and curves of its quantities",
        "atlas.h5 -o results --format pdf",
    )
    parser.add_argument("atlas", type=Path, metavar="FILE.h5")
    parser.add_argument(
        "-o", "--output", type=Path, default=Path(), metavar="FOLDER", help="default: this folder"
    )
    parser.add_argument(
        "-q", "--quantity", action="append", default=[], metavar="NAME", help="only this one"
    )
    parser.add_argument(
        "--format",
        action="append",
        choices=("png", "svg", "pdf"),
        help="may be given more than once (default: png)",
    )


def _info_parser(commands: Any) -> None:
    parser = add_command(
        commands, "info", _info, "say what is inside an atlas file, on one screen", "atlas.h5"
    )
    parser.add_argument("atlas", type=Path, metavar="FILE.h5")
    parser.add_argument("--json", action="store_true", help="as one JSON object")


def _reproduce_parser(commands: Any) -> None:
    parser = add_command(
        commands,
        "reproduce",
        _reproduce,
        "recompute the 2007 paper: its figures, and every published number beside ours",
        "-o results/edwards2007",
    )
    parser.add_argument(
        "-o",
        "--output",
        type=Path,
        default=Path("results/edwards2007"),
        metavar="FOLDER",
        help="where to write (default: %(default)s)",
    )


def _sweep(options: argparse.Namespace) -> None:
    from standfast.cli.progress import interruptible, progress_bar
    from standfast.study import Study
    from standfast.sweep import sweep

    study = Study.from_toml(options.study)
    output: Path = options.output or Path(options.study.name).with_suffix(".h5")
    if output.exists() and options.part is None:
        atlas = sweep(study, output)
        print(f"{output} is finished already.")
        return
    with progress_bar() as (announce, progress), interruptible() as stop_if_asked:

        def after_forecast(forecast: "Forecast") -> None:
            announce(forecast)
            stop_if_asked()

        def after_tile(done: int, total: int) -> None:
            progress(done, total)
            stop_if_asked()

        with kept_when_stopped(output):
            atlas = sweep(
                study,
                output,
                threads=options.threads,
                part=options.part,
                progress=after_tile,
                announce=after_forecast,
            )
    if atlas is None:
        share = "{}/{}".format(*options.part)
        print(f"Share {share} of {output} is done; without --part the same command finishes it.")
    else:
        print(f"{output}: {study.points:,} values, {in_bytes(output.stat().st_size)}.")


def _thresholds(options: argparse.Namespace) -> None:
    from standfast import thresholds

    source: Path = options.source
    folder = made_folder(options.output)
    if source.suffix == ".toml":
        from standfast.study import Study

        study = Study.from_toml(source)
        found = thresholds.contours(study)
    else:
        from standfast.store import open_atlas

        atlas = open_atlas(source)
        study = atlas.study
        print(f"contours of {thresholds.source_of(atlas)[0]}, plane by plane:")
        found = _told(thresholds.extracted(atlas))
    written = thresholds.write_tables(study, found, folder / f"{source.stem}-thresholds")
    print(f"Written to {folder}: {', '.join(path.name for path in written)}")


MOST_LINES = 20


def _told(found: Iterator["Contour"]) -> Iterator["Contour"]:
    """Hand contours on and say how far each lies from the closed form, the first ones in full."""
    count, greatest = 0, 0.0
    for contour in found:
        count += 1
        crossed = bool(contour.lines)
        greatest = max(greatest, contour.greatest) if crossed else greatest
        if count <= MOST_LINES:
            where = ", ".join(f"{key} {value}" for key, value in contour.place.values.items())
            far = (
                f"distance from closed form at most {contour.greatest:.3g}, mean "
                f"{contour.mean:.3g} N·m/rad (step of the grid {contour.resolution:.3g})"
                if crossed
                else "no limit of standing on it"
            )
            print(f"  {where or 'the plane'}: {far}")
        yield contour
    if count > MOST_LINES:
        print(f"  … {count} planes in all, distance at most {greatest:.3g} N·m/rad")


def _plot(options: argparse.Namespace) -> None:
    from standfast.plots import plot
    from standfast.population.report import is_population, open_population
    from standfast.store import open_atlas

    if is_population(options.atlas):
        from standfast.population.drawings import draw

        stem = made_folder(options.output) / options.atlas.stem
        paths = draw(open_population(options.atlas), stem, options.format or ("png",))
        print(f"Written to {options.output}: {', '.join(path.name for path in paths)}")
        return
    atlas = open_atlas(options.atlas)
    folder = made_folder(options.output)
    drawn = plot(atlas, folder, quantities=options.quantity, formats=options.format or ("png",))
    print(f"Written to {folder}:")
    for drawing in drawn:
        note = f"   ({drawing.left_out})" if drawing.left_out else ""
        print(f"  {', '.join(path.name for path in drawing.paths)}{note}")


def _info(options: argparse.Namespace) -> None:
    from standfast.population import PopulationStudy
    from standfast.population.report import is_population, open_population
    from standfast.store import beginnings, open_atlas
    from standfast.study import Study

    if is_population(options.atlas):
        found = open_population(options.atlas)
        if options.json:
            print(json.dumps({"complete": True, **found.summary}, ensure_ascii=False))
        else:
            tell_population(found.summary)
        return
    if not options.atlas.exists() and (people_begun := beginnings(options.atlas, PopulationStudy)):
        _tell_unfinished(options, *people_begun)
        return
    begun = None if options.atlas.exists() else beginnings(options.atlas, Study)
    if begun is not None:
        _tell_unfinished(options, *begun)
        if not options.json:
            print()
            _tell_parameters(begun[0])
        return
    atlas = open_atlas(options.atlas)
    study = atlas.study
    size = options.atlas.stat().st_size
    if options.json:
        print(
            json.dumps(
                {
                    "title": study.title,
                    "complete": True,
                    "standfast_version": atlas.version,
                    "study_sha256": study.fingerprint,
                    "study": json.loads(study.canonical),
                    "values": study.points,
                    "bytes": size,
                    "quantities": {name: list(atlas[name].dims) for name in atlas.quantities},
                }
            )
        )
        return
    print(f"{options.atlas}: {study.title or 'untitled study'}")
    print(
        f"complete, {study.points:,} values, {in_bytes(size)}, "
        f"written by standfast {atlas.version}\n"
    )
    _tell_parameters(study)
    print()
    for name in atlas.quantities:
        variable = atlas[name]
        axes = " × ".join(
            f"{axis} {n}" for axis, n in zip(variable.dims, variable.shape, strict=True)
        )
        print(f"  {name:26}{axes or 'one value'}   [{QUANTITIES[name].unit}]")
    print(f"\nstudy {study.fingerprint}")


def _tell_unfinished(
    options: argparse.Namespace, study: "Study | PopulationStudy", done: int
) -> None:
    count = study.shard_count
    if options.json:
        print(json.dumps({"title": study.title, "complete": False, "done": done, "of": count}))
        return
    print(f"{options.atlas}: {study.title or 'untitled study'}")
    print(f"not finished, {done} of {count} shards; the same command goes on")


def _tell_parameters(study: "Study") -> None:
    from standfast.study import describe

    for name, value in study.parameters.items():
        unit = "" if name == "body_model" else f" {PARAMETERS[name].unit}"
        print(f"  {name:18}{describe(value)}{unit}")


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


def _complain(sentence: str, code: int) -> int:
    print(f"standfast: {sentence}", file=sys.stderr)
    return code
