"""``standfast sway``: the measures of recordings of people on a force plate."""

import argparse
import csv
import json
import sys
from collections import Counter
from pathlib import Path
from typing import TYPE_CHECKING, Any

from standfast.cli.parsing import add_command, made_room, output_file
from standfast.cli.sway_files import (
    HELP_OF_FILES,
    add_file_options,
    of_options,
    plain,
    read_recordings,
)
from standfast.cli.sway_fit import (
    add_fit_options,
    fit_facts,
    fit_header,
    fit_row,
    fits_of,
    fitted_spectra,
    person_to_fit,
    print_fits,
)
from standfast.cli.sway_model import (
    ModelBeside,
    add_model_options,
    model_beside,
    model_facts,
    model_header,
    model_row,
)
from standfast.cli.sway_numbers import add_number_options, fit_numbers
from standfast.cli.sway_text import print_measures
from standfast.errors import InputError
from standfast.files import column_name, for_spreadsheets, require_replaceable, whole_table

if TYPE_CHECKING:
    from standfast.fitting.result import SwayFit
    from standfast.recordings.expected import ExpectedSway
    from standfast.recordings.measures import SwayMeasures
    from standfast.recordings.recording import Recording

FORMATS = (".png", ".svg", ".pdf")


def add(commands: Any) -> None:
    """Declare the command."""
    parser = add_command(
        commands,
        _sway,
        "measures of sway from recordings of a force plate",
        "sway recording.csv --unit mm --rate 100 -o recording.png",
    )
    parser.epilog = f"{parser.epilog}\n\n{HELP_OF_FILES}"
    add_file_options(parser)
    words = "Butterworth filter forth and back, Hz, as 10 (default: none)"
    parser.add_argument("--low-pass", metavar="HZ", help=words)
    words = "draw it too (.png, .svg or .pdf); of several recordings FOLDER/"
    parser.add_argument("-o", "--output", metavar="FIGURE.png", help=words)
    words = "write a table, a line a recording"
    parser.add_argument("--csv", type=Path, metavar="FILE.csv", help=words)
    parser.add_argument("--json", action="store_true", help="everything as one JSON object, in SI")
    add_model_options(parser)
    add_fit_options(parser)
    add_number_options(parser)


def _sway(options: argparse.Namespace) -> None:
    if options.measure or not options.recordings:
        fit_numbers(options)
        return
    if options.duration is not None:
        raise InputError("--duration beside a recording, which has its own")
    _measure(options, _figures(options))


def _measure(options: argparse.Namespace, figures: list[Path]) -> None:
    """Measure recordings, and write what is asked for."""
    from standfast.recordings.measures import MEASURES, sway_measures

    low_pass = None if options.low_pass is None else plain("--low-pass", options.low_pass)
    if options.csv:
        require_replaceable(options.csv, _header(MEASURES))
    recordings = read_recordings(options)
    try:
        found = [sway_measures(each, low_pass=low_pass) for each in recordings]
    except InputError as error:
        raise InputError(of_options(str(error))) from None
    fitted = person_to_fit(options)
    fits = [] if fitted is None else fits_of(options, fitted, recordings, low_pass)
    model = None if fits else model_beside(options, recordings, low_pass)
    written = [*figures]
    if options.csv:
        _write(options.csv, recordings, found, model, fits)
        written.append(options.csv)
    if figures:
        beside = _beside(recordings, model, fits, low_pass)
        _draw(options, figures, recordings, found, beside, low_pass)
    if options.json:
        facts = _facts(recordings, found, low_pass, model)
        if fitted is not None:
            for each, fit in zip(facts["recordings"], fits, strict=True):
                each["fit"] = fit_facts(fitted, fit)
        print(json.dumps(facts, ensure_ascii=False, allow_nan=False))
        return
    remarks = [[of_options(each) for each in recording.remarks] for recording in recordings]
    print_measures(recordings, found, remarks, low_pass, model)
    if fitted is not None:
        print_fits(fitted, recordings, fits, low_pass)
    if written:
        print(f"\nWritten: {', '.join(map(str, written))}")


def _beside(
    recordings: "list[Recording]",
    model: ModelBeside | None,
    fits: "list[SwayFit]",
    low_pass: float | None,
) -> "list[ExpectedSway | None]":
    """Return the spectra that are drawn beside those of recordings, if any."""
    if fits:
        shown, undrawn = fitted_spectra(fits, recordings, low_pass)
        for sentence in undrawn:
            print(f"standfast: {sentence}", file=sys.stderr)
        return shown
    return [None] * len(recordings) if model is None else [*model.shown]


def _draw(
    options: argparse.Namespace,
    figures: list[Path],
    recordings: "list[Recording]",
    found: "list[SwayMeasures]",
    beside: "list[ExpectedSway | None]",
    low_pass: float | None,
) -> None:
    """Draw a figure of each recording."""
    from standfast.figures.recording import draw_recording

    for path, recording, measures, shown in zip(figures, recordings, found, beside, strict=True):
        draw_recording(made_room(path, options.output), recording, measures, low_pass, shown)


def _figures(options: argparse.Namespace) -> list[Path]:
    """Return the files that figures are drawn into, one a recording; none if none is asked."""
    if options.output is None:
        return []
    names = ["recording" if str(p) == "-" else p.stem for p in options.recordings]
    paths = [output_file(options.output, f"{name}-sway.png") for name in names]
    for path in paths:
        if path.suffix not in FORMATS:
            raise InputError(f"{path} is not the name of a figure; end it in .png, .svg or .pdf")
    twice = [path for path, count in Counter(paths).items() if count > 1]
    if twice and twice[0] == Path(options.output):
        raise InputError(f"{len(paths)} recordings have a figure each; give a folder, as -o NAME/")
    if twice:
        raise InputError(f"two recordings would be drawn into {twice[0]}; draw them one by one")
    return paths


def _header(measures: Any) -> str:
    columns = [column_name(name, row.printed) for name, row in measures.items()]
    return ",".join(["recording", "duration_s", "rate_Hz", *columns])


def _write(
    path: Path,
    recordings: "list[Recording]",
    found: "list[SwayMeasures]",
    model: ModelBeside | None,
    fits: "list[SwayFit]",
) -> None:
    """Write a line a recording, in the units that are printed."""
    from standfast.recordings.measures import MEASURES

    header = _header(MEASURES)
    beside: list[str] = []
    rows: list[list[Any]] = [[] for _ in recordings]
    if model is not None:
        beside, rows = model_header(), [model_row(model, place) for place in range(len(rows))]
    elif fits:
        beside, rows = fit_header(fits[0]), [fit_row(fit) for fit in fits]
    with whole_table(path, header) as file:
        file.write(f"{','.join([header, *beside])}\r\n")
        lines = csv.writer(file)
        for recording, measures, more in zip(recordings, found, rows, strict=True):
            own = [row.factor * getattr(measures, name) for name, row in MEASURES.items()]
            cells = (recording.duration, recording.rate, *own, *more)
            lines.writerow(
                [
                    for_spreadsheets(recording.name),
                    *(cell if isinstance(cell, str) else f"{cell:.8g}" for cell in cells),
                ]
            )


def _facts(
    recordings: "list[Recording]",
    found: "list[SwayMeasures]",
    low_pass: float | None,
    model: ModelBeside | None,
) -> dict[str, Any]:
    from standfast.recordings.measures import MEASURES

    return {
        "low_pass": low_pass,
        "units": {name: row.unit for name, row in MEASURES.items()},
        "recordings": [
            {
                "recording": recording.name,
                "samples": recording.ap.size,
                "duration": recording.duration,
                "rate": recording.rate,
                "measures": measures._asdict(),
                "remarks": [of_options(each) for each in recording.remarks],
                **({} if model is None else {"model": model_facts(model, place)}),
            }
            for place, (recording, measures) in enumerate(zip(recordings, found, strict=True))
        ],
    }
