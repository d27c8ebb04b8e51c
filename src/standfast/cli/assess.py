"""``standfast assess``: thresholds and margins of single persons."""

import argparse
import contextlib
import json
import math
import os
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from standfast.cli.parsing import add_command, add_file_option, made_room, output_file
from standfast.cli.rejected import print_rejected, write_rejected
from standfast.errors import InputError, nearest_name
from standfast.parameters import (
    BODY_MODELS,
    JOINTS,
    PARAMETERS,
    STANDARD_GRAVITY,
    checked_number,
    number_in,
)

if TYPE_CHECKING:
    from standfast.population.assess import Assessment
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
    parser.add_argument(
        "people",
        type=Path,
        nargs="+",
        metavar="PEOPLE.csv",
        help="columns height (m; height_cm), mass (kg), and if known id, sex, age, "
        "ankle_stiffness, knee_stiffness, hip_stiffness (N·m/rad, both legs; inf is rigid), "
        "ankle_proportional_gain, ankle_derivative_gain, ankle_damping, feedback_delay and so on; "
        "further files are joined by id",
    )
    add_file_option(parser, "FILE.csv", "NAME-assessed.csv")
    for joint in JOINTS:
        words = f"stiffness of the {joint} where the file has none, N·m/rad or inf"
        parser.add_argument(f"--{joint}", metavar="K", help=words)
    for option, kind, unit in (
        ("--damping", "damping", "N·m·s/rad"),
        ("--proportional", "proportional gain", "N·m/rad"),
        ("--derivative", "derivative gain", "N·m·s/rad"),
    ):
        words = f"{kind} where the file has none, {unit}, or a multiple as 1.2mgh; repeatable"
        parser.add_argument(option, action="append", default=[], metavar="JOINT=X", help=words)
    words = "delay of the feedback where the file has none, s"
    parser.add_argument("--delay", metavar="T", help=words)
    parser.add_argument("--body-model", default="winter", metavar="MODEL", help="default: winter")
    parser.add_argument(
        "--gravity", default=str(STANDARD_GRAVITY), metavar="G", help="m/s² (default: %(default)s)"
    )
    parser.add_argument("--strict", action="store_true", help="stop at the first unusable row")
    parser.add_argument("--json", action="store_true", help="the summary as one JSON object")


def _assess(options: argparse.Namespace) -> None:
    from standfast.population.assess import assess, write_assessment
    from standfast.population.people.records import read_people

    if options.body_model not in BODY_MODELS:
        raise InputError(
            f"--body-model {options.body_model} is not known"
            f"{nearest_name(options.body_model, BODY_MODELS)} (models: {', '.join(BODY_MODELS)})"
        )
    gravity = _number("--gravity", options.gravity, "gravity")
    otherwise = {
        joint: _number(f"--{joint}", text, f"{joint}_stiffness")
        for joint in JOINTS
        if (text := getattr(options, joint)) is not None
    }
    output = output_file(options.output, f"{options.people[0].stem}-assessed.csv")
    if os.path.realpath(output) in map(os.path.realpath, options.people):
        raise InputError(f"{output} is the file of people itself; choose another output with -o")
    people = read_people(options.people, strict=options.strict)
    found = assess(
        people,
        body_model=options.body_model,
        gravity=gravity,
        otherwise=otherwise,
        nerves=_nerves(options),
    )
    write_assessment(found, made_room(output, options.output))
    summary = _summary_of(found)
    written = [output, *write_rejected(summary["rejected"], output)]
    if options.json:
        print(json.dumps(summary, ensure_ascii=False))
    else:
        _print_summary(summary)
        print(f"Written: {', '.join(str(path) for path in written)}")


def _print_summary(summary: Mapping[str, Any]) -> None:
    rejected = summary["rejected"]
    print(f"{summary['persons']:,} persons assessed, {len(rejected):,} rows rejected")
    print_rejected(rejected)
    for remark in summary["remarks"]:
        print(f"    note: {remark}")
    for joint, (low, middle, high) in summary["threshold_alone"].items():
        print(
            f"  {joint:6} alone, the others rigid, needs {middle:.4g} N·m/rad (median; "
            f"{low:.4g} to {high:.4g} for nine in ten)"
        )
    if not summary["judged"]:
        print("  no one has all three stiffnesses; give --ankle, --knee, --hip for a verdict")
        return
    print(
        f"  {summary['stand']:,} of {summary['judged']:,} with known stiffness stand, "
        f"{summary['stand_with_hip_strategy']:,} of them by the hip strategy "
        "(the hip turns more than the ankle)"
    )
    for joint, fallen in summary["least_gain_at"].items():
        print(f"  {fallen:,} who fall would stand with the least gain at the {joint}")
    if fallen := summary["fall_whatever_one_joint_gains"]:
        print(f"  {fallen:,} fall whatever one joint gains")
    if (fed_back := summary.get("with_feedback")) is not None:
        print(
            f"  with feedback {fed_back['stand']:,} of {fed_back['judged']:,} with known gains and "
            "delay stand"
        )
        if fed_back["critical_delay"]:
            low, middle, high = fed_back["critical_delay"]
            print(
                f"  critical delay {middle:.3g} s (median of those who stand without delay; "
                f"{low:.3g} to {high:.3g} for nine in ten)"
            )


def _summary_of(found: "Assessment") -> dict[str, Any]:
    columns = found.columns
    quantiles = {
        joint: np.quantile(columns[f"{joint}_threshold_alone_Nm_rad"], (0.05, 0.5, 0.95)).tolist()
        for joint in JOINTS
    }
    best = {joint: int((columns["least_gain_at"] == joint).sum()) for joint in JOINTS}
    stands = columns["stands"] == "yes"
    fall_anyhow = found.falls & (columns["least_gain_at"] == "")
    return {
        **({"with_feedback": _fed_back(columns)} if "critical_delay_s" in columns else {}),
        "persons": len(found.people),
        "rejected": [
            {"file": r.file, "line": r.line, "reason": r.reason} for r in found.people.rejected
        ],
        "remarks": list(found.people.remarks),
        "threshold_alone": quantiles,
        "judged": int(found.judged.sum()),
        "stand": int(stands.sum()),
        "stand_with_hip_strategy": int((stands & (columns["strategy"] == "hip")).sum()),
        "fall_whatever_one_joint_gains": int(fall_anyhow.sum()),
        "least_gain_at": {joint: number for joint, number in best.items() if number},
    }


def _fed_back(columns: Mapping[str, Any]) -> dict[str, Any]:
    verdicts, critical = columns["stands_with_feedback"], columns["critical_delay_s"]
    lost = critical[np.isfinite(critical) & (critical > 0.0)]
    return {
        "judged": int((verdicts != "").sum()),
        "stand": int((verdicts == "yes").sum()),
        "critical_delay": np.quantile(lost, (0.05, 0.5, 0.95)).tolist() if lost.size else [],
    }


def _nerves(options: argparse.Namespace) -> "Distributions":
    """Read what the options say of damping, delay and gains."""
    from standfast.population.people.sections import checked_nerves

    feedback: dict[str, Any] = {}
    content: dict[str, Any] = {"damping": {}, "feedback": feedback}
    for option, table in (
        ("damping", content["damping"]),
        ("proportional", feedback.setdefault("proportional", {})),
        ("derivative", feedback.setdefault("derivative", {})),
    ):
        for text in getattr(options, option):
            joint, equals, value = text.partition("=")
            if not equals:
                raise InputError(f"--{option} {text} is not JOINT=NUMBER, as ankle=1.2mgh")
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


def _number(option: str, text: str, parameter: str) -> float:
    return checked_number(option, _plain(text), row=PARAMETERS[parameter])
