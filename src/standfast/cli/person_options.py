"""A person on the command line: the options of all parameters, a study or a law that fills them.

Options come first, then a published law (springs, damping, feedback), then a study; what a law
leaves open of the body and gravity is its own.
"""

import argparse
import contextlib
import math
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from standfast.cli.parsing import BY_COMMAS, is_of_a_list, pairs_of
from standfast.errors import InputError
from standfast.parameters import (
    OWN_BODY,
    PARAMETERS,
    SEGMENT_NUMBERS,
    SEGMENT_PARAMETERS,
    Parameter,
    number_in,
)

if TYPE_CHECKING:
    from standfast.mechanics.law import Law

# Sections of parameters of which an option takes one by its key, as --damping ankle=10.
KEYED = {
    "damping": "damping",
    "noise": "noise",
    "feedback.proportional": "proportional",
    "feedback.derivative": "derivative",
}
PLAIN = [r for r in PARAMETERS.values() if r.name not in OWN_BODY and r.section not in KEYED]


class GivenPerson(NamedTuple):
    """A person's parameters by name; the law that they are of, and by what its gains are scaled."""

    parameters: dict[str, Any]
    law: "Law | None"
    factor: float


def add_person_options(parser: Any) -> None:
    """Declare the options; they and their limits are those of the table of parameters."""
    for row in PLAIN:
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
    words = (
        "stiffness, damping and feedback of a published law, where no option gives another "
        "(standfast laws); scaled by m g h to the person, or on its own body if none is given"
    )
    parser.add_argument("--law", metavar="LAW", help=words)


def names_a_person(options: argparse.Namespace) -> bool:
    """Return whether any option of a person is given."""
    keys = [*(row.key for row in PLAIN), *SEGMENT_NUMBERS, *KEYED.values(), "law"]
    return any(getattr(options, key) not in (None, []) for key in keys)


def person_given(options: argparse.Namespace, study: str | None) -> GivenPerson:
    """Check what the options say, by the border of a study.

    Raises
    ------
    InputError
        if anything is missing or out of range, or the law or the study is not there.
    """
    from standfast.mechanics.laws import LAWS
    from standfast.study.values import checked_parameters

    law = None if options.law is None else LAWS[options.law]
    content: dict[str, Any] = {}
    for row in PLAIN:
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
    of_law = [] if law is None else _fill_by_law(content, law)
    if study is not None:
        if is_of_a_list(study):
            raise InputError(f"{study} is not the name of a study; {BY_COMMAS}")
        _fill(content, Path(study), [] if law is None else ["stiffness", "damping", "feedback"])
    if law is not None and not content["body"]:
        content["body"] = {name: part.tolist() for name, part in law.body._asdict().items()}
        content.setdefault("gravity", law.gravity)
    _check_segments(content["body"])
    try:
        parameters = checked_parameters(content)
    except InputError as error:
        raise InputError(_of_options(str(error))) from None
    return GivenPerson(parameters, law, 1.0) if law is None else _scaled(parameters, law, of_law)


def law_in_words(given: GivenPerson) -> str:
    """Say which law it is, and how its gains became the person's; empty if there is none."""
    law = given.law
    if law is None:
        return ""
    text = f"Law {law.name} ({law.title})"
    if given.factor == 1.0:
        return f"{text}, on its own body."
    return (
        f"{text}.\nIts stiffness, damping and gains are × {given.factor:.4g}, as this person's "
        "m g h is of that of its body."
    )


def _fill_by_law(content: dict[str, Any], law: "Law") -> list[str]:
    """Take springs, damping and feedback of a law where options leave them open; return which."""
    taken = []
    for name, value in law.parameters.items():
        row = PARAMETERS[name]
        if not _has(content, row.section, row.key):
            _put(content, row.section, row.key, value)
            taken.append(name)
    return taken


def _scaled(parameters: dict[str, Any], law: "Law", of_law: list[str]) -> GivenPerson:
    """Scale what is of a law by the person's m g h over that of the law's body, not its delay."""
    from standfast.quantities.person_facts import person_of

    factor = law.scale(person_of(parameters).body, parameters["gravity"])
    if math.isclose(factor, 1.0, rel_tol=1e-12):  # its own body
        return GivenPerson(parameters, law, 1.0)
    scaled = {n: factor * parameters[n] for n in of_law if n != "feedback_delay"}
    return GivenPerson({**parameters, **scaled}, law, factor)


def _option(row: Parameter) -> str:
    """Return the option of a parameter: its key in a study, or the part of a body that it is."""
    return f"--{(row.key or row.name).replace('_', '-')}"


def _help(row: Parameter) -> str:
    allowed = ", ".join(row.choices) or row.allowed
    default = "" if row.default is None else f" (default: {row.default})"
    return f"{row.meaning}, {allowed}{default}".replace("%", "%%")


def _fill(content: dict[str, Any], path: Path, apart: list[str]) -> None:
    """Take from a study what is left open, but sections ``apart``; refuse what varies in it."""
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
        if row.section.partition(".")[0] in apart or _has(content, row.section, row.key):
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
                more = f"; for a rigid {row.key} write {option} inf, or take a law (--law)"
            elif sentence.endswith("is missing"):
                more = ", or give the person's own segments (--segment-mass and so on)"
            return option + sentence.removeprefix(row.place) + more
    return sentence
