"""The recordings of ``standfast sway``: how files are read, and messages that name its options."""

import argparse
import contextlib
import re
from pathlib import Path
from typing import TYPE_CHECKING

from standfast.errors import InputError
from standfast.parameters import number_in

if TYPE_CHECKING:
    from standfast.recordings.recording import Recording

# As messages of the library write an argument: ``unit=mm``, ``rate = 5``, ``plate="1"``.
ARGUMENT = re.compile(r"\b(time|ap|ml|unit|rate|surface|low_pass|plate|duration)( ?= ?)")
PLACE = re.compile(r'plate=\{"(\w+)": \((-?[\d.]+), (-?[\d.]+)\)\}')
QUOTED = re.compile(r'(--plate )"(\w+)"')
# What is said of how a file is read.
OF_FILES = ("time", "ap", "ml", "unit", "plate", "surface")
HELP_OF_FILES = """\
columns are found by their names, which say the unit too or have it in the line below; lines before
the names, decimal commas and semicolons, tabs or blanks are understood:
  time (s or ms), or --rate, or a line "Sampling rate: 100" before the table
  COP_AP (mm), COP_ML (mm); or COPx, COPy (x is anterior-posterior, or --ap y); in m, cm or mm
  or Fz (N), Mx, My (N·m or N·mm): CoP at the surface, with --surface also of Fx, Fy
  of several plates Fz1, Mx1, My1, Fz2 and so on, or CoPx1, CoPy1, Fz1, with --plate
measures are of the samples as they are, or after --low-pass; frequencies need 60 s"""


def add_file_options(parser: argparse.ArgumentParser) -> None:
    """Declare the recordings and how they are read."""
    words = "CSV, TSV, text or C3D, a person who stands each; - is standard input"
    parser.add_argument("recordings", type=Path, nargs="*", metavar="RECORDING.csv", help=words)
    words = "of the CoP (m, cm, mm) or the moments (Nm, Nmm) where names do not say it"
    parser.add_argument("--unit", metavar="UNIT", help=words)
    words = "samples a second where no column of time says it, Hz"
    parser.add_argument("--rate", metavar="HZ", help=words)
    for option, what in (("time", "of time"), ("ap", "anterior-posterior"), ("ml", "mediolateral")):
        words = f"name or number (from 1) of the column {what}"
        words += ", or the plate's axis, x or y" if option != "time" else ""
        parser.add_argument(f"--{option}", metavar="COLUMN", help=words)
    words = (
        "read plate N alone; or N=X,Y: where its origin lies from that of the other plate along "
        "their x and y, m, as 2=0,0.6 (repeatable); a C3D file says it itself"
    )
    parser.add_argument("--plate", action="append", default=[], metavar="N[=X,Y]", help=words)
    words = "height of the surface over the origin of the moments, along the plate's z, m"
    parser.add_argument("--surface", metavar="D", help=f"{words} (default: 0)")


def read_recordings(options: argparse.Namespace) -> "list[Recording]":
    """Read all recordings; say of every one that is refused why."""
    from standfast.recordings.reading import read_recording

    rate = None if options.rate is None else plain("--rate", options.rate)
    surface = 0.0 if options.surface is None else plain("--surface", options.surface)
    plate = _plate(options.plate)
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
                    plate=plate,
                )
            )
        except InputError as error:
            # a name of a file stays as it is
            name = str(path) if str(error).startswith(str(path)) else ""
            refused.append(name + of_options(str(error).removeprefix(name)))
    if len(options.recordings) == 1 and refused:
        raise InputError(refused[0])
    if refused:
        raise InputError(
            f"{len(refused)} of {len(options.recordings)} recordings cannot be used: "
            f"{'; '.join(refused)}"
        )
    return recordings


def of_options(sentence: str) -> str:
    """Name options instead of the arguments of the library."""
    named = ARGUMENT.sub(
        lambda m: f"--{m[1].replace('_', '-')}{m[2] if ' ' in m[2] else ' '}",
        PLACE.sub(r"--plate \1=\2,\3", sentence),
    )
    return QUOTED.sub(r"\1\2", named)


def _plate(given: list[str]) -> "str | dict[str, list[float]] | None":
    """Return what ``--plate`` says: one plate, or where several lie."""
    if len(given) == 1 and "=" not in given[0]:
        return given[0]
    places: dict[str, list[float]] = {}
    for text in given:
        name, equals, numbers = (part.strip() for part in text.partition("="))
        if not (name and equals and numbers.count(",") == 1):
            raise InputError(
                f"--plate {text}: write where its origin lies, m, as --plate 2=0,0.6; --plate 1 "
                "reads one alone, and nothing beside it"
            )
        if name in places:
            raise InputError(f"--plate {name} is given twice; give it one place")
        places[name] = [plain(f"--plate {name}", number) for number in numbers.split(",")]
    return places or None


def plain(option: str, text: str) -> float:
    """Return the number that an option gives.

    Raises
    ------
    InputError
        if it is none.
    """
    with contextlib.suppress(ValueError):
        return number_in(text)
    raise InputError(f"{option} = {text!r} is not a number")
