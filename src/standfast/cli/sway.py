"""``standfast sway``: the measures of recordings of people on a force plate."""

import argparse
import contextlib
import csv
import json
import re
import sys
from collections import Counter
from pathlib import Path
from typing import TYPE_CHECKING, Any

from standfast.cli.parsing import add_command, made_room, output_file
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
from standfast.cli.sway_text import print_measures
from standfast.errors import InputError
from standfast.files import column_name, for_spreadsheets, require_replaceable, whole_table
from standfast.parameters import number_in

if TYPE_CHECKING:
    from standfast.fitting.result import SwayFit
    from standfast.recordings.expected import ExpectedSway
    from standfast.recordings.measures import SwayMeasures
    from standfast.recordings.recording import Recording

# As messages of the library write an argument: ``unit=mm``, ``rate = 5``.
ARGUMENT = re.compile(r"\b(time|ap|ml|unit|rate|surface|low_pass)( ?= ?)")
FORMATS = (".png", ".svg", ".pdf")
HELP_OF_FILES = """\
columns are found by their names, which say the unit too or have it in the line below; lines before
the names, decimal commas and semicolons, tabs or blanks are understood:
  time (s or ms), or --rate, or a line "Sampling rate: 100" before the table
  COP_AP (mm), COP_ML (mm); or COPx, COPy (x is anterior-posterior, or --ap y); in m, cm or mm
  or Fz (N), Mx, My (N·m or N·mm): CoP at the surface, with --surface also of Fx, Fy
measures are of the samples as they are, or after --low-pass; frequencies need 60 s"""


def add(commands: Any) -> None:
    """Declare the command."""
    parser = add_command(
        commands,
        _sway,
        "measures of sway from recordings of a force plate",
        "sway recording.csv --unit mm --rate 100 -o recording.png",
    )
    parser.epilog = f"{parser.epilog}\n\n{HELP_OF_FILES}"
    words = "CSV, TSV or text, a person standing on a plate each; - is standard input"
    parser.add_argument("recordings", type=Path, nargs="+", metavar="RECORDING.csv", help=words)
    words = "of the CoP (m, cm, mm) or the moments (Nm, Nmm) where names do not say it"
    parser.add_argument("--unit", metavar="UNIT", help=words)
    words = "samples a second where no column of time says it, Hz"
    parser.add_argument("--rate", metavar="HZ", help=words)
    for option, what in (("time", "of time"), ("ap", "anterior-posterior"), ("ml", "mediolateral")):
        words = f"name or number (from 1) of the column {what}"
        words += ", or the plate's axis, x or y" if option != "time" else ""
        parser.add_argument(f"--{option}", metavar="COLUMN", help=words)
    words = "height of the surface over the origin of the moments, along the plate's z, m"
    parser.add_argument("--surface", metavar="D", default="0", help=f"{words} (default: 0)")
    words = "Butterworth filter forth and back, Hz, as 10 (default: none)"
    parser.add_argument("--low-pass", metavar="HZ", help=words)
    words = "draw it too (.png, .svg or .pdf); of several recordings FOLDER/"
    parser.add_argument("-o", "--output", metavar="FIGURE.png", help=words)
    words = "write a table, a line a recording"
    parser.add_argument("--csv", type=Path, metavar="FILE.csv", help=words)
    parser.add_argument("--json", action="store_true", help="everything as one JSON object, in SI")
    add_model_options(parser)
    add_fit_options(parser)


def _sway(options: argparse.Namespace) -> None:
    from standfast.recordings.measures import sway_measures

    figures = _figures(options)
    low_pass = None if options.low_pass is None else _plain("--low-pass", options.low_pass)
    recordings = _read(options)
    try:
        found = [sway_measures(each, low_pass=low_pass) for each in recordings]
    except InputError as error:
        raise InputError(_of_options(str(error))) from None
    fitted = person_to_fit(options)
    fits = [] if fitted is None else fits_of(options, fitted, recordings, low_pass)
    model = None if fits else model_beside(options, recordings, low_pass)
    written = [*figures]
    if options.csv:
        _write(options.csv, recordings, found, model, fits)
        written.append(options.csv)
    if figures:
        from standfast.figures.recording import draw_recording

        shown: list[ExpectedSway | None] = [None] * len(figures)
        if model is not None:
            shown = [*model.shown]
        if fits:
            shown, undrawn = fitted_spectra(fits, recordings, low_pass)
            for sentence in undrawn:
                print(f"standfast: {sentence}", file=sys.stderr)
        for path, recording, measures, beside in zip(
            figures, recordings, found, shown, strict=True
        ):
            draw_recording(made_room(path, options.output), recording, measures, low_pass, beside)
    if options.json:
        facts = _facts(recordings, found, low_pass, model)
        if fitted is not None:
            for each, fit in zip(facts["recordings"], fits, strict=True):
                each["fit"] = fit_facts(fitted, fit)
        print(json.dumps(facts, ensure_ascii=False, allow_nan=False))
        return
    remarks = [[_of_options(each) for each in recording.remarks] for recording in recordings]
    print_measures(recordings, found, remarks, low_pass, model)
    if fitted is not None:
        print_fits(fitted, recordings, fits, low_pass)
    if written:
        print(f"\nWritten: {', '.join(map(str, written))}")


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


def _read(options: argparse.Namespace) -> "list[Recording]":
    """Read all recordings; say of every one that is refused why."""
    from standfast.recordings.measures import MEASURES
    from standfast.recordings.reading import read_recording

    if options.csv:
        require_replaceable(options.csv, _header(MEASURES))
    rate = None if options.rate is None else _plain("--rate", options.rate)
    surface = _plain("--surface", options.surface)
    recordings, refused = [], []
    for path in options.recordings:
        try:
            recordings.append(
                read_recording(
                    path,
                    time=options.time,
                    ap=options.ap,
                    ml=options.ml,
                    unit=options.unit,
                    rate=rate,
                    surface=surface,
                )
            )
        except InputError as error:
            refused.append(_of_options(str(error)))
    if len(options.recordings) == 1 and refused:
        raise InputError(refused[0])
    if refused:
        raise InputError(
            f"{len(refused)} of {len(options.recordings)} recordings cannot be used: "
            f"{'; '.join(refused)}"
        )
    return recordings


def _of_options(sentence: str) -> str:
    """Name options instead of the arguments of the library."""
    return ARGUMENT.sub(
        lambda m: f"--{m[1].replace('_', '-')}{m[2] if ' ' in m[2] else ' '}", sentence
    )


def _plain(option: str, text: str) -> float:
    with contextlib.suppress(ValueError):
        return number_in(text)
    raise InputError(f"{option} = {text!r} is not a number")


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
                "remarks": [_of_options(each) for each in recording.remarks],
                **({} if model is None else {"model": model_facts(model, place)}),
            }
            for place, (recording, measures) in enumerate(zip(recordings, found, strict=True))
        ],
    }
