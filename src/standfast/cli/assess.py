"""``standfast assess``: thresholds and margins of single persons, and of classes of them."""

import argparse
import contextlib
import json
import math
import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

from standfast.cli.assess_text import HELP_OF_COLUMNS, print_assessment, summary_of
from standfast.cli.parsing import add_command, add_file_option, made_room, output_file, pairs_of
from standfast.cli.rejected import HEADER as OF_REJECTED
from standfast.cli.rejected import rejected_path, write_rejected
from standfast.cli.strata_table import OF_ASSESSMENT, WORDS, rows_of_assessment, write_strata
from standfast.errors import InputError
from standfast.files import require_replaceable
from standfast.parameters import (
    JOINTS,
    PARAMETERS,
    STANDARD_GRAVITY,
    checked_number,
    number_in,
)

if TYPE_CHECKING:
    from standfast.population.people.distributions import Distributions


def add(commands: Any) -> None:
    """Declare the command."""
    parser = add_command(
        commands,
        _assess,
        "thresholds and margins of single persons, one line each",
        "assess people.csv --knee inf --hip 700",
        compiles=True,
    )
    parser.epilog = f"{parser.epilog}\n\n{HELP_OF_COLUMNS}"
    parser.add_argument(
        "people",
        type=Path,
        nargs="+",
        metavar="PEOPLE.csv",
        help="CSV or .xlsx, - is standard input; columns height (m; height_cm, height_in), mass "
        "(kg; weight_lb), and if known id, sex, age, ankle_stiffness, knee_stiffness, "
        "hip_stiffness (N·m/rad, both legs; inf is rigid), ankle_proportional_gain, "
        "ankle_derivative_gain, ankle_damping, feedback_delay and so on; files with height and "
        "mass are put together, others joined to them by id",
    )
    add_file_option(parser, "FILE.csv", "NAME-assessed.csv")
    parser.add_argument("--csv", type=Path, metavar="FILE.csv", help=WORDS)
    words = "only of this sex: male, female or other, as files say it (f, divers)"
    parser.add_argument("--sex", metavar="SEX", type=_sex, help=words)
    parser.add_argument("--age", metavar="AGES", help='only of these ages, as "65+" or "20-39"')
    words = "first age of each class, as 18,30,45,65 (default: 20,40,60)"
    parser.add_argument("--age-bands", metavar="AGES", help=words)
    for joint in JOINTS:
        words = (
            f"stiffness of the {joint} where the file has none, N·m/rad or inf, or a multiple of "
            "the body's load as 0.67mgh"
        )
        parser.add_argument(f"--{joint}", metavar="K", help=words)
    for option, kind, unit in (
        ("--damping", "damping", "N·m·s/rad"),
        ("--proportional", "proportional gain", "N·m/rad"),
        ("--derivative", "derivative gain", "N·m·s/rad"),
        ("--noise", "white noise of the torque", "N·m·√s"),
    ):
        words = f"{kind} where the file has none, {unit}, or a multiple as 1.2mgh; repeatable"
        parser.add_argument(option, action="append", default=[], metavar="JOINT=X,…", help=words)
    words = "delay of the feedback where the file has none, s"
    parser.add_argument("--delay", metavar="T", help=words)
    parser.add_argument(
        "--body-model",
        default="winter",
        metavar="MODEL",
        help="default: winter; by sex: female=de-leva-female,male=de-leva-male (other: winter)",
    )
    parser.add_argument(
        "--gravity", default=str(STANDARD_GRAVITY), metavar="G", help="m/s² (default: %(default)s)"
    )
    parser.add_argument("--strict", action="store_true", help="stop at the first unusable row")
    parser.add_argument("--json", action="store_true", help="the summary as one JSON object")


def _assess(options: argparse.Namespace) -> None:
    from standfast.cli.progress import interruptible, progress_bar
    from standfast.population.assess import assess
    from standfast.population.assessed import write_assessment
    from standfast.population.people.keys import selection
    from standfast.population.people.records import read_people

    body_model = _body_model(options.body_model)
    gravity = _number("--gravity", options.gravity, "gravity")
    otherwise = {
        joint: _stiffness(joint, text)
        for joint in JOINTS
        if (text := getattr(options, joint)) is not None
    }
    bands = _bands(options.age_bands)
    nerves = _nerves(options)
    output = _output_of(options)
    with progress_bar("persons") as (_, show), interruptible() as stop_if_asked:

        def after_piece(done: int, total: int) -> None:
            if done < total:  # of few persons the end comes with the answers
                show(done, total)
            stop_if_asked()

        people = read_people(
            options.people,
            strict=options.strict,
            selected=selection(options.sex, options.age, "--age"),
            selected_by=[name for name in ("sex", "age") if getattr(options, name) is not None],
            keep_own=True,
        )
        stop_if_asked()
        found = assess(
            people,
            body_model=body_model,
            gravity=gravity,
            otherwise=otherwise,
            nerves=nerves,
            progress=after_piece,
        )
    write_assessment(found, made_room(output, options.output))
    summary = summary_of(found, bands)
    written = [output, *write_rejected(summary["rejected"], output)]
    if options.csv:
        write_strata(list(rows_of_assessment(summary["strata"])), options.csv, OF_ASSESSMENT)
        written.append(options.csv)
    if options.json:
        print(json.dumps(summary, ensure_ascii=False))
    else:
        print_assessment(summary)
        print(f"Written: {', '.join(str(path) for path in written)}")


def _output_of(options: argparse.Namespace) -> Path:
    """Return the file that is written; refuse to write over the people, or any but its like."""
    from standfast.population.assessed import HEADER
    from standfast.population.people.decoding import STANDARD_INPUT

    first = options.people[0]
    name = "people" if str(first) == "-" else first.stem
    output = output_file(options.output, f"{name}-assessed.csv")
    tables = [(output, HEADER), (rejected_path(output), OF_REJECTED)]
    tables += [(options.csv, OF_ASSESSMENT)] if options.csv else []
    for path, _ in tables:
        if str(path) == STANDARD_INPUT:
            raise InputError("- is no file, and tables are written to files; give a name, as t.csv")
        if os.path.realpath(path) in map(os.path.realpath, options.people):
            raise InputError(f"{path} is the file of people itself; choose another output")
    if len({os.path.realpath(path) for path, _ in tables}) < len(tables):
        what = "-o" if options.csv != rejected_path(output) else "the file of rejected rows"
        raise InputError(f"{options.csv} cannot be both {what} and --csv; choose two names")
    for path, header in tables:
        require_replaceable(path, header)
    return output


def _sex(text: str) -> str:
    """Read a sex by the words of files."""
    from standfast.population.people.words import sex_of

    with contextlib.suppress(InputError):
        if (sex := sex_of(text.strip())) != "unknown":
            return sex
    raise argparse.ArgumentTypeError(f"{text!r} is not known; write male, female or other")


def _bands(text: str | None) -> list[int] | None:
    """Read the ages at which bands begin."""
    from standfast.population.people.classes import checked_bands

    if text is None:
        return None
    words = text.split(",")
    known = all(word.strip().isascii() and word.strip().isdecimal() for word in words)
    return checked_bands("--age-bands", [int(word) for word in words] if known else text)


def _body_model(text: str) -> str | dict[str, str]:
    """Read a body model, or one for each sex as ``female=…,male=…``."""
    from standfast.population.people.keys import checked_body_model

    given: Any = text
    if "=" in text:
        entries = (entry.partition("=") for entry in text.split(","))
        given = {sex.strip(): model.strip() for sex, _, model in entries}
    return checked_body_model("--body-model", given)


def _nerves(options: argparse.Namespace) -> "Distributions":
    """Read what the options say of damping, delay, gains and noise."""
    from standfast.population.people.sections import checked_nerves

    feedback: dict[str, Any] = {}
    content: dict[str, Any] = {"damping": {}, "feedback": feedback, "noise": {}}
    for option, table in (
        ("damping", content["damping"]),
        ("noise", content["noise"]),
        ("proportional", feedback.setdefault("proportional", {})),
        ("derivative", feedback.setdefault("derivative", {})),
    ):
        for text in getattr(options, option):
            for joint, value in pairs_of(f"--{option}", text, "JOINT=NUMBER, as ankle=1.2mgh"):
                number = value.removesuffix("mgh")
                relative_to = "absolute" if number == value else "mgh"
                law = {"distribution": "fixed", "relative_to": relative_to, "value": _plain(number)}
                table[joint] = law
    if options.delay is not None:
        feedback["delay"] = {"distribution": "fixed", "value": _plain(options.delay)}
    return checked_nerves(content)


def _plain(text: str) -> float | str:
    """Return a number; what is none goes to the check as the words that they are."""
    with contextlib.suppress(ValueError):
        return text if math.isnan(number_in(text)) else number_in(text)
    return text


def _stiffness(joint: str, text: str) -> float | str:
    """Return a stiffness, or a multiple of the body's load as it was written."""
    from standfast.population.known import checked_stiffness

    number, of_load = checked_stiffness(f"--{joint}", text, joint)
    return text if of_load else number


def _number(option: str, text: str, parameter: str) -> float:
    return checked_number(option, _plain(text), row=PARAMETERS[parameter])
