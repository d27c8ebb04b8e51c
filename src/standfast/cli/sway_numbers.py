"""A fit of published numbers, for ``standfast sway --measure … --fit``, without a recording."""

import argparse
import csv
import json
import math
import re
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from standfast.cli.parsing import pairs_of
from standfast.cli.sway_files import OF_FILES, plain
from standfast.cli.sway_fit import (
    PRINTED,
    fit_facts,
    fit_header,
    fit_row,
    fits_of,
    on_whom,
    person_to_fit,
    print_fit,
)
from standfast.errors import InputError, nearest_name
from standfast.files import column_name, require_replaceable, whole_table
from standfast.parameters import number_in

if TYPE_CHECKING:
    from standfast.fitting.result import SwayFit

SECONDS, HERTZ, LOW_PASS = 60.0, 100.0, 10.0  # of published recordings
OF_NUMBERS = ("duration_s", "rate_Hz")  # columns by which a table is known as one of these
NUMBER = re.compile(r"[-+]?[\d.]+(?:e[-+]?\d+)?", re.ASCII | re.IGNORECASE)
# How many SI units one of a written unit is, by the SI unit.
WRITTEN: Mapping[str, Mapping[str, float]] = {
    "m": {"m": 1.0, "cm": 1e-2, "mm": 1e-3},
    "m/s": {"m/s": 1.0, "cm/s": 1e-2, "mm/s": 1e-3},
    "Hz": {"Hz": 1.0},
    "rad": {"rad": 1.0, "deg": math.radians(1.0), "°": math.radians(1.0)},
}


def add_number_options(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    group = parser.add_argument_group(
        "a fit of published numbers, without a recording",
        "with --fit, --law and a body; --rate and --low-pass are those of the recordings that the "
        f"numbers are of ({HERTZ:g} and {LOW_PASS:g} Hz if left out).",
    )
    words = (
        "sd_ap, mean_velocity_ap, mean_frequency_ap, sd_com, sd_ankle, sd_knee or sd_hip, in SI or "
        "with its unit, as sd_ap=4.1mm; repeatable"
    )
    group.add_argument("--measure", action="append", default=[], metavar="NAME=X,…", help=words)
    words = f"of the recordings that numbers are of, s (default: {SECONDS:g})"
    group.add_argument("--duration", metavar="S", help=words)


def fit_numbers(options: argparse.Namespace) -> None:
    """Fit a law to the numbers that options give, and print it.

    Raises
    ------
    InputError
        if there are none, or options are of recordings, or the fit is refused.
    """
    numbers = _numbers(options)
    duration = SECONDS if options.duration is None else plain("--duration", options.duration)
    rate = HERTZ if options.rate is None else plain("--rate", options.rate)
    low_pass = None if options.low_pass is None else plain("--low-pass", options.low_pass)
    given = person_to_fit(options)
    if given is None:
        raise InputError("numbers alone are there to be fitted: add --fit, --law and a body")
    if options.csv:
        require_replaceable(options.csv, ",".join(OF_NUMBERS))
    (fit,) = fits_of(options, given, [numbers], low_pass, duration=duration, rate=rate)
    if options.csv:
        _write(options.csv, fit, duration, rate)
    if options.json:
        facts: dict[str, Any] = {"duration": duration, "rate": rate, "low_pass": low_pass}
        facts |= {"measures": numbers, "fit": fit_facts(given, fit)}
        print(json.dumps(facts, ensure_ascii=False, allow_nan=False))
        return
    cut = LOW_PASS if low_pass is None else low_pass
    of = f"The numbers are of {duration:g} s at {rate:g} Hz, behind a low-pass at {cut:g} Hz."
    print(on_whom(given, fit, of))
    print_fit(fit, "", "given")
    if options.csv:
        print(f"\nWritten: {options.csv}")


def _numbers(options: argparse.Namespace) -> dict[str, float]:
    """Return the measures in SI, by name."""
    from standfast.fitting.measured import POSSIBLE

    if not options.measure:
        raise InputError(
            "give a recording, or numbers to fit a law to: --measure sd_ap=4.1mm --fit --law "
            "dec-2015 --height 1.75 --mass 70"
        )
    if options.recordings:
        raise InputError(
            f"--measure beside {options.recordings[0]}, whose measures are computed; give one of "
            "both"
        )
    for name in OF_FILES:
        if getattr(options, name) not in (None, []):
            raise InputError(f"--{name} says how recordings are read; leave it away")
    if options.output is not None:
        raise InputError("numbers have no path and no spectrum to draw; leave -o away")
    numbers: dict[str, float] = {}
    for text in options.measure:
        for name, value in pairs_of("--measure", text, "NAME=NUMBER, as sd_ap=4.1mm"):
            if name not in POSSIBLE:
                raise InputError(
                    f"--measure {name} cannot be fitted{nearest_name(name, POSSIBLE)} "
                    f"(measures are {', '.join(POSSIBLE)})"
                )
            if name in numbers:
                raise InputError(f"--measure {name} is given twice")
            numbers[name] = _in_si(name, value, POSSIBLE[name][2])
    return numbers


def _in_si(name: str, text: str, unit: str) -> float:
    """Read a number, in SI or with a unit behind it."""
    found = NUMBER.match(text)
    told = text[found.end() :].strip() if found else ""
    units = WRITTEN[unit]
    if found and (not told or told in units):
        try:
            return number_in(found[0]) * units.get(told, 1.0)
        except ValueError:
            pass
    raise InputError(f"--measure {name}={text} is not a number in {' or '.join(units)}")


def _write(path: Path, fit: "SwayFit", duration: float, rate: float) -> None:
    """Write a line of the fit, with its measures in the units that are printed."""
    measures = {name: PRINTED[each.unit] for name, each in fit.measures.items()}
    header = [*OF_NUMBERS, *(column_name(name, unit) for name, (unit, _) in measures.items())]
    own = [factor * fit.measures[name].measured for name, (_, factor) in measures.items()]
    cells: list[Any] = [duration, rate, *own, *fit_row(fit)]
    with whole_table(path, ",".join(OF_NUMBERS)) as file:
        lines = csv.writer(file)
        lines.writerow([*header, *fit_header(fit)])
        lines.writerow([cell if isinstance(cell, str) else f"{cell:.8g}" for cell in cells])
