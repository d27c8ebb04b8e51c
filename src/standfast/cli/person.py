"""``standfast person``: verdict, thresholds, margins and modes of one person."""

import argparse
import json
from pathlib import Path
from typing import Any

from standfast.cli.parsing import add_command, made_room, output_file
from standfast.cli.person_facts import facts_of
from standfast.cli.person_options import add_person_options, law_in_words, person_given
from standfast.cli.person_text import fed_back_in_words, motion, print_person
from standfast.errors import InputError

FORMATS = (".png", ".svg", ".pdf")


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
    add_person_options(parser)
    words = "draw it too (.png, .svg or .pdf; NAME/ is a folder)"
    parser.add_argument("-o", "--output", metavar="FIGURE.png", help=words)
    parser.add_argument("--json", action="store_true", help="everything as one JSON object")


def _person(options: argparse.Namespace) -> None:
    from standfast.study.canonical import json_value

    output = None if options.output is None else output_file(options.output, "person.png")
    if output is not None and output.suffix not in FORMATS:
        raise InputError(f"{output} is not the name of a figure; end it in .png, .svg or .pdf")
    read = person_given(options, options.start)
    given, law = read.parameters, read.law
    facts = facts_of(given)
    if law is not None:
        facts["law"] = {"name": law.name, "scaled_by": read.factor}
    if output is not None:
        _draw(made_room(output, options.output), given, facts)
    if options.json:
        print(json.dumps(json_value(facts), ensure_ascii=False, allow_nan=False))
        return
    if law is not None:
        print(law_in_words(read))
    print_person(given, facts)
    if output is not None:
        print(f"\nWritten: {output}")


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
    )
