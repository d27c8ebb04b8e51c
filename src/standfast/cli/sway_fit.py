"""The fit of a law to recordings, for ``standfast sway --fit``: text, JSON, columns, spectrum."""

import argparse
import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from standfast.cli.person_options import GivenPerson, law_in_words, person_given
from standfast.cli.person_text import person_in_words
from standfast.cli.sway_files import of_options
from standfast.errors import InputError
from standfast.files import column_name
from standfast.parameters import GAINS, JOINTS, LOOPS, NOISES, gain_name

if TYPE_CHECKING:
    from standfast.fitting.result import Estimate, SwayFit
    from standfast.recordings.expected import ExpectedSway
    from standfast.recordings.recording import Recording

ALL = "noise,proportional_gain,derivative_gain"
EXPLAINED = {True: "yes", False: "no", None: ""}  # nothing where it cannot be tested
# What a law and the fit say, so that options must not.
OF_LAW = ("ankle", "knee", "hip", "damping", "proportional", "derivative", "noise")
# The field's unit of a measure, and how many it has of ours.
PRINTED = {"m": ("mm", 1e3), "m/s": ("mm/s", 1e3), "Hz": ("Hz", 1.0), "rad": ("°", 180.0 / math.pi)}


def add_fit_options(parser: argparse.ArgumentParser) -> None:
    """Declare the option."""
    words = (
        "find which noise and gains of --law, on the body given, explain each recording, with "
        f"95 %% intervals, and how far from falling that is; PARAMETERS are at most three of "
        f"{ALL},feedback_delay (default: {ALL}); some seconds a recording"
    )
    parser.add_argument("--fit", nargs="?", const=ALL, metavar="PARAMETERS", help=words)


def person_to_fit(options: argparse.Namespace) -> GivenPerson | None:
    """Return whom a law is fitted on, with the law's gains; None if no fit is asked for.

    Raises
    ------
    InputError
        if the person or the law is not whole, or options say what the fit is to find.
    """
    if options.fit is None:
        return None
    if options.law is None:
        raise InputError("--fit needs the law whose noise and gains it finds: --law dec-2015")
    for name in OF_LAW:
        if getattr(options, name) not in (None, []):
            raise InputError(f"--{name} beside --fit: springs and damping are the law's, and noise "
                             "and gains are found")  # fmt: skip
    return person_given(options, options.start)


def fits_of(
    options: argparse.Namespace,
    given: GivenPerson,
    measured: "Sequence[Recording | Mapping[str, float]]",
    low_pass: float | None,
    duration: float | None = None,
    rate: float | None = None,
) -> "list[SwayFit]":
    """Return a fit of each recording, or of measures by name with duration and rate (s, Hz).

    Raises
    ------
    InputError
        if the fit is refused.
    """
    from standfast.fitting.fit import fit_sway
    from standfast.quantities.person_facts import person_of

    person, free = person_of(given.parameters), [each.strip() for each in options.fit.split(",")]
    delay = None if options.delay is None else float(given.parameters["feedback_delay"])
    found = []
    for each in measured:
        try:
            found.append(
                fit_sway(
                    each,
                    options.law,
                    person.body,
                    float(person.gravity),
                    free=free,
                    delay=delay,
                    low_pass=low_pass,
                    duration=duration,
                    rate=rate,
                )
            )
        except InputError as error:
            raise InputError(f"--fit: {of_options(str(error))}") from None
    return found


def print_fits(
    given: GivenPerson,
    recordings: "Sequence[Recording]",
    fits: "Sequence[SwayFit]",
    low_pass: float | None,
) -> None:
    """Print on whom, and each fit: parameters, margins, measures and the recording's, status."""
    cut = (
        "Samples are as given, taken to have passed a plate's low-pass at 10 Hz."
        if low_pass is None
        else f"Recording and model pass a low-pass at {low_pass:g} Hz."
    )
    print(f"\n{on_whom(given, fits[0], cut)}")
    for recording, fit in zip(recordings, fits, strict=True):
        print_fit(fit, f" to {recording.name}" if len(recordings) > 1 else "", "recording")


def print_fit(fit: "SwayFit", of: str, column: str) -> None:
    """Print a fit ``of`` something, whose measures stand in a column."""
    print(f"\nFit of {fit.law}{of}, with 95 % intervals\n")
    for name, estimate in {**fit.parameters, **fit.margins}.items():
        print(f"  {_in_words(name):38}{_number(estimate)}")
    print(f"\n  {'':38}{column:>10}{'model':>10}   chance")
    for name, each in fit.measures.items():
        unit, factor = PRINTED[each.unit]
        pair = f"{factor * each.measured:10.4g}{factor * each.model:10.4g}"
        print(f"  {_in_words(name):30}{unit:8}{pair}   ± {100.0 * each.spread:.0f} %")
    print(f"\n  {fit.status}")


def on_whom(given: GivenPerson, fit: "SwayFit", cut: str) -> str:
    """Say on which body the law was fitted, how it was scaled, what was held, and what is cut."""
    known = given.parameters
    # gains and delay are the fit's or said apart
    body = {name: each for name, each in known.items() if name not in (*GAINS, "feedback_delay")}
    lines = [law_in_words(given), f"Fitted on {person_in_words(body)}."]
    if given.factor == 1.0 and "height" not in known:
        lines.append("No body is given (--height and --mass), so it is the law's own.")
    held = f"The delay is held at {fit.person['feedback'].delay:g} s. "
    strength = "of one strength" if "noise" in fit.parameters else "of 1 N·m·√s"
    lines.append(
        f"{'' if 'feedback_delay' in fit.parameters else held}"
        f"Noise {strength} is at {' and '.join(_turning(known))}.\n{cut}"
    )
    return "\n".join(lines)


def _turning(known: dict[str, Any]) -> list[str]:
    return [joint for joint in JOINTS if math.isfinite(known[f"{joint}_stiffness"])]


def fit_facts(given: GivenPerson, fit: "SwayFit") -> dict[str, Any]:
    """Return what JSON says of a fit, in SI; infinite numbers as ``"inf"``, unknown ones as None.

    ``person`` has all parameters of the person fitted, and ``noise`` that of the joints that turn.
    """
    from standfast.study.canonical import json_value

    found, turning = fit.person["feedback"], _turning(given.parameters)
    gains = {
        gain_name(kind, *loop): float(each)
        for kind in ("proportional", "derivative")
        for loop, each in zip(LOOPS, getattr(found, kind).ravel(), strict=True)
        if each
    }
    held = {name: each for name, each in given.parameters.items() if name not in GAINS}
    sigma = zip(JOINTS, NOISES, fit.noise, strict=True)
    return {
        "law": fit.law,
        "scaled_by": given.factor,
        "person": json_value({**held, **gains, "feedback_delay": float(found.delay)}),
        "noise": {name: each if joint in turning else 0.0 for joint, name, each in sigma},
        "parameters": {name: _facts(each) for name, each in fit.parameters.items()},
        "margins": {name: _facts(each) for name, each in fit.margins.items()},
        "measures": {name: each._asdict() for name, each in fit.measures.items()},
        "p_value": fit.p_value,
        "explained": fit.explained,
        "status": fit.status,
    }


def fit_header(fit: "SwayFit") -> list[str]:
    """Return the names of a fit's columns in a table of recordings."""
    columns = [
        column_name(f"fit_{name}{end}", estimate.unit)
        for name, estimate in {**fit.parameters, **fit.margins}.items()
        for end in ("", "_low", "_high")
    ]
    return [*columns, "fit_open_ends", "fit_p", "fit_explained"]


def fit_row(fit: "SwayFit") -> list[float | str]:
    """Return the numbers of a fit under :func:`fit_header`; NaN where one is not known or tested.

    Open ends are those that the measures do not set, by name: the limit of the search or of
    standing stands there.
    """
    numbers = [
        number for estimate in {**fit.parameters, **fit.margins}.values() for number in estimate[:3]
    ]
    ends = [
        f"{name}_{end}"
        for name, estimate in {**fit.parameters, **fit.margins}.items()
        for end, open_ in zip(("low", "high"), estimate.open, strict=True)
        if open_
    ]
    p_value = math.nan if fit.p_value is None else fit.p_value
    return [*numbers, " ".join(ends), p_value, EXPLAINED[fit.explained]]


def fitted_spectra(
    fits: "Sequence[SwayFit]", recordings: "Sequence[Recording]", low_pass: float | None
) -> "tuple[list[ExpectedSway | None], list[str]]":
    """Return what a recording of each fitted person would show, and of whom it is not known why."""
    from standfast.recordings.expected import expected_sway

    shown: list[ExpectedSway | None] = []
    missing = []
    for fit, recording in zip(fits, recordings, strict=True):
        try:
            found = expected_sway(recording, **fit.person, noise=fit.noise, low_pass=low_pass)
        except (InputError, ArithmeticError) as error:  # a fit may end where standing does
            missing.append(
                f"the spectrum of the person fitted to {recording.name} is not drawn: {error}"
            )
            found = None
        shown.append(found)
    return shown, missing


def _facts(estimate: "Estimate") -> dict[str, Any]:
    numbers = {name: getattr(estimate, name) for name in ("value", "low", "high")}
    return {
        **{name: _told(number) for name, number in numbers.items()},
        "unit": estimate.unit,
        "open": list(estimate.open),
    }


def _told(number: float) -> float | str | None:
    if math.isnan(number):
        return None
    return number if math.isfinite(number) else str(number)


def _in_words(name: str) -> str:
    from standfast.fitting.words import NAMES

    return NAMES.get(name, name.replace("_", " "))


def _number(estimate: "Estimate") -> str:
    unit = "" if estimate.unit == "1" else f" {estimate.unit}"
    low, high = (f"{end:.4g}" for end in estimate[1:3])
    ends = (
        f"{low}, or less" if estimate.open[0] else low,
        f"{high}, or more" if estimate.open[1] else high,
    )
    return f"{estimate.value:10.4g}{unit:12}  {ends[0]} to {ends[1]}"
