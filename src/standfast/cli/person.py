"""``standfast person``: verdict, thresholds, margins and modes of one person."""

import argparse
import contextlib
import json
import math
from pathlib import Path
from typing import Any

from standfast.cli.parsing import (
    BY_COMMAS,
    add_command,
    is_of_a_list,
    made_room,
    output_file,
    pairs_of,
)
from standfast.cli.person_facts import facts_of
from standfast.cli.person_text import fed_back_in_words, motion, print_person
from standfast.errors import InputError
from standfast.parameters import (
    OWN_BODY,
    PARAMETERS,
    SEGMENT_NUMBERS,
    SEGMENT_PARAMETERS,
    Parameter,
    number_in,
)

FORMATS = (".png", ".svg", ".pdf")
# Sections of parameters of which an option takes one by its key, as --damping ankle=10.
KEYED = {
    "damping": "damping",
    "noise": "noise",
    "feedback.proportional": "proportional",
    "feedback.derivative": "derivative",
}


def add(commands: Any) -> None:
    """Declare the command; options and their limits are those of the table of parameters."""
    parser = add_command(
        commands,
        _person,
        "verdict, thresholds, margins and modes of one person",
        "person --height 1.66 --mass 68 --ankle 900 --knee 1500 --hip 400",
    )
    words = "a study, whose fixed numbers are taken where no option gives another"
    parser.add_argument("start", nargs="?", metavar="STUDY.toml", help=words)
    for row in PARAMETERS.values():
        if row.name not in OWN_BODY and row.section not in KEYED:
            metavar = "MODEL" if row.choices else "X"
            parser.add_argument(_option(row), metavar=metavar, help=_help(row))
    for part, names in SEGMENT_NUMBERS.items():
        row = SEGMENT_PARAMETERS[part]
        segments = ", ".join(PARAMETERS[name].key.replace("_", " ") for name in names)
        words = f"measured: {row.meaning} ({segments}), {row.unit}; instead of height and mass"
        metavar = ",".join("X" for _ in names)
        parser.add_argument(_option(row), metavar=metavar, help=words)
    for section, option in KEYED.items():
        rows = [row for row in PARAMETERS.values() if row.section == section]
        keys = ", ".join(row.key for row in rows[:3]) + (" and so on" if len(rows) > 3 else "")
        kind = f"{option} gain" if section.startswith("feedback") else option
        words = f"{kind} of {keys}, {rows[0].unit}; repeatable"
        metavar = "JOINT=X,…"
        parser.add_argument(f"--{option}", action="append", default=[], metavar=metavar, help=words)
    words = "draw it too, with noise its spectra (.png, .svg or .pdf; NAME/ is a folder)"
    parser.add_argument("-o", "--output", metavar="FIGURE.png", help=words)
    parser.add_argument("--json", action="store_true", help="everything as one JSON object")


def _option(row: Parameter) -> str:
    """Return the option of a parameter: its key in a study, or the part of a body that it is."""
    return f"--{(row.key or row.name).replace('_', '-')}"


def _help(row: Parameter) -> str:
    allowed = ", ".join(row.choices) or row.allowed
    default = "" if row.default is None else f" (default: {row.default})"
    return f"{row.meaning}, {allowed}{default}".replace("%", "%%")


def _person(options: argparse.Namespace) -> None:
    from standfast.study.canonical import json_value

    output = None if options.output is None else output_file(options.output, "person.png")
    if output is not None and output.suffix not in FORMATS:
        raise InputError(f"{output} is not the name of a figure; end it in .png, .svg or .pdf")
    given = _given(options)
    facts = facts_of(given)
    if output is not None:
        _draw(made_room(output, options.output), given, facts)
    if options.json:
        print(json.dumps(json_value(facts), ensure_ascii=False, allow_nan=False))
        return
    print_person(given, facts)
    if output is not None:
        print(f"\nWritten: {output}")


def _given(options: argparse.Namespace) -> dict[str, Any]:
    """Check what the options say, by the border of a study; return parameters by name."""
    from standfast.study.values import checked_parameters

    content: dict[str, Any] = {}
    for row in PARAMETERS.values():
        if row.name not in OWN_BODY and row.section not in KEYED:
            text = getattr(options, row.key)
            if text is not None:
                _put(content, row.section, row.key, text if row.choices else _plain(text))
    for part in SEGMENT_NUMBERS:
        if (text := getattr(options, part)) is not None:
            _put(content, "body", part, [_plain(number) for number in text.split(",")])
    for section, option in KEYED.items():
        for text in getattr(options, option):
            for key, number in pairs_of(f"--{option}", text, "JOINT=NUMBER, as ankle=30"):
                _put(content, section, key, _plain(number))
    content.setdefault("body", {})
    if options.start is not None:
        if is_of_a_list(options.start):
            raise InputError(f"{options.start} is not the name of a study; {BY_COMMAS}")
        _fill(content, Path(options.start))
    _check_segments(content["body"])
    try:
        return checked_parameters(content)
    except InputError as error:
        raise InputError(_of_options(str(error))) from None


def _fill(content: dict[str, Any], path: Path) -> None:
    """Take from a study what the options leave open; refuse what varies in it."""
    from standfast.study.study import Study

    study, body = Study.from_toml(path), content["body"]
    measured = not body.keys().isdisjoint(SEGMENT_PARAMETERS)
    scaled = measured and study.parameters.keys().isdisjoint(OWN_BODY)
    chosen = {key for sizes in ("mass", "bmi") if sizes in body for key in ("mass", "bmi")}
    chosen |= body.keys()
    vary: list[str] = []
    for name, value in study.parameters.items():
        row = PARAMETERS[name]
        part = row.section.removeprefix("body.") if name in OWN_BODY else row.key
        of_body = row.section.partition(".")[0] == "body"
        if of_body and (scaled or part in chosen):
            continue
        if not of_body and _has(content, row.section, row.key):
            continue
        if isinstance(value, float | str):
            _put(content, row.section, row.key, value)
        else:
            vary.append(_as_option(row))
    if vary:
        raise InputError(
            f"{path} varies what one person has once; add {' '.join(dict.fromkeys(vary))}"
        )


def _as_option(row: Parameter) -> str:
    """Return how a parameter is given as an option."""
    if row.section in KEYED:
        return f"--{KEYED[row.section]} {row.key}=X"
    if row.name in OWN_BODY:
        part = row.section.removeprefix("body.")
        commas = ",".join("X" for _ in SEGMENT_NUMBERS[part])
        return f"{_option(SEGMENT_PARAMETERS[part])} {commas}"
    return f"{_option(row)} X"


def _has(content: dict[str, Any], section: str, key: str) -> bool:
    table = content
    for name in section.split(".") if section else ():
        table = table.get(name, {})
    return key in table


def _check_segments(body: dict[str, Any]) -> None:
    """Refuse some segments alone, and segments beside what others are scaled from."""
    every = [_option(row) for row in SEGMENT_PARAMETERS.values()]
    given = [_option(row) for row in SEGMENT_PARAMETERS.values() if row.name in body]
    beside = [f"--{key}" for key in body if key not in SEGMENT_PARAMETERS]
    if given and beside:
        raise InputError(
            f"{' and '.join(beside)} beside {' and '.join(given)}: give a person's measured "
            f"segments ({', '.join(every)}), or height, mass and model, from which they are scaled"
        )
    if given and len(given) < len(every):
        missing = next(option for option in every if option not in given)
        raise InputError(f"{missing} is missing; measured segments are {', '.join(every)}, all")


def _put(content: dict[str, Any], section: str, key: str, value: Any) -> None:
    table = content
    for name in section.split(".") if section else ():
        table = table.setdefault(name, {})
    table[key] = value


def _plain(text: str) -> float | str:
    """Return a number; what is none goes to the check as the words that they are."""
    with contextlib.suppress(ValueError):
        return text if math.isnan(number_in(text)) else number_in(text)
    return text


def _of_options(sentence: str) -> str:
    """Name an option instead of the place in a study that a message begins with."""
    for section, option in KEYED.items():
        if sentence.startswith(f"[{section}]"):
            return sentence.replace(f"[{section}]", f"--{option}", 1)
    for part, row in SEGMENT_PARAMETERS.items():
        sentence = sentence.replace(f"body.{part}.", f"{_option(row)} ")
        sentence = sentence.replace(f"body.{part}", _option(row))
    sentence = sentence.removeprefix("[body]: ")
    if sentence.startswith("body needs"):
        return sentence.replace("body needs mass or bmi, one of them", "give --mass or --bmi")
    for row in sorted(PARAMETERS.values(), key=lambda row: -len(row.place)):
        if row.key and sentence.startswith(row.place):
            option = f"--{KEYED[row.section]} {row.key}" if row.section in KEYED else _option(row)
            more = ""
            if sentence.endswith("is missing") and row.or_rigid:
                more = f"; for a rigid {row.key} write {option} inf"
            elif sentence.endswith("is missing"):
                more = ", or give the person's own segments (--segment-mass and so on)"
            return option + sentence.removeprefix(row.place) + more
    return sentence


def _draw(path: Path, given: dict[str, Any], facts: dict[str, Any]) -> None:
    from standfast.figures.person import draw_person
    from standfast.quantities.person_facts import person_of

    if not facts["modes"]:
        raise InputError("three rigid joints do not move, so there is nothing to draw")
    (mode, *_) = facts["modes"]
    verb = "stands" if facts["stands_by_springs"] else "falls"
    title = fed_back_in_words(given, facts)
    alone = "springs alone: " if title else ""
    draw_person(
        path,
        person_of(given).body,
        given.get("height"),
        rotation=tuple(mode["rotations"].values()),
        falls=mode["eigenvalue"] <= 0.0,
        title=title.rstrip(".").replace(": ", "\n", 1),
        words=(
            f"{alone}{motion(mode)}",
            f"{alone}{verb}, safety factor {facts['safety_factor']:.3f}",
        ),
        stiffness=facts["stiffness"],
        thresholds=facts["thresholds"],
        spectrum=_spectrum(given, facts),
    )


def _spectrum(given: dict[str, Any], facts: dict[str, Any]) -> Any:
    """Return the spectra of a person whose sway is finite; None of others."""
    from standfast.quantities.person_facts import person_of, spectrum_of

    sway = facts.get("sway")
    if sway is None or sway["cop_frequency"] is None:
        return None
    # from the slowest that force plates tell to what rings, in equal steps of the logarithm
    hertz = [10.0 ** (place / 500.0) for place in range(-1000, 751)]
    return spectrum_of(person_of(given), hertz)
