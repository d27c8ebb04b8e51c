"""What ``standfast person`` says."""

import math
from collections.abc import Mapping
from typing import Any

from standfast.parameters import COUPLINGS, JOINTS, PARAMETERS, SEGMENT_NUMBERS, STIFFNESS_UNIT


def print_person(given: dict[str, Any], facts: dict[str, Any]) -> None:
    """Print who it is, the verdict, each joint, each mode, and what feedback makes of it."""
    print(_in_words(given))
    print(f"\n{_verdict(facts)}\n")
    print(f"  {STIFFNESS_UNIT:10}{'stiffness':>12}{'threshold':>12}{'alone':>12}{'to spare':>12}")
    for joint in JOINTS:
        own, threshold, alone = (
            facts[key][joint] for key in ("stiffness", "thresholds", "thresholds_alone")
        )
        spare = "" if math.isinf(own) and math.isinf(threshold) else _number(own - threshold)
        print(f"  {joint:10}{_number(own):>12}{_number(threshold):>12}{alone:12.4g}{spare:>12}")
    print("  threshold: the other two as given; alone: the other two rigid")
    print(f"\n  {'mode':10}{'':>24}{'ankle : knee : hip':>24}")
    for number, mode in enumerate(facts["modes"], 1):
        turns = " : ".join(f"{turn:.3g}" for turn in mode["rotations"].values())
        print(f"  {number:<10}{motion(mode):24}{turns:>24}")
    if not facts["modes"]:
        print("  none: all three joints are rigid")
    if "critical_delay" in facts:
        print(f"\n{_with_feedback(facts)}")


def _in_words(given: dict[str, Any]) -> str:
    """Say who is looked at: body, gravity, and what is given beside stiffness."""
    if "height" in given:
        mass = given.get("mass", given.get("bmi", 0.0) * given["height"] ** 2)
        who = f"{given['height']:g} m, {mass:.4g} kg, {given['body_model']}"
    else:
        mass = sum(given[name] for name in SEGMENT_NUMBERS["segment_mass"])
        who = f"own segments, {mass:.4g} kg without the feet"
    beside = [
        f"{name.replace('_', ' ')} {value:g} {PARAMETERS[name].unit}"
        for name, value in given.items()
        if _is_of_nerves(name) or name in COUPLINGS
    ]
    return "; ".join([who, f"gravity {given['gravity']:g} m/s²", *beside])


def _verdict(facts: dict[str, Any]) -> str:
    """Say whether springs alone hold the person, and by how much."""
    factor, reserve = facts["safety_factor"], facts["stiffness_reserve"]
    alone = " by springs alone" if "critical_delay" in facts else ""
    if facts["stands_by_springs"]:
        if math.isinf(factor):
            return f"Stands{alone}: every joint is rigid."
        return (
            f"Stands{alone}: safety factor {factor:.4g} (all stiffnesses divided by it, the person "
            f"just stands);\nevery joint could lose {reserve:.4g} {STIFFNESS_UNIT} at once."
        )
    text = (
        f"Falls{alone}: safety factor {factor:.4g} (all stiffnesses divided by it, the person just "
        f"stands);\nevery joint must gain {-reserve:.4g} {STIFFNESS_UNIT} at once"
    )
    one_does = any(math.isfinite(threshold) for threshold in facts["thresholds"].values())
    return f"{text}, or one what it lacks." if one_does else f"{text}; no joint alone suffices."


def fed_back(given: Mapping[str, Any]) -> bool:
    """Return whether damping, a delay or a gain is given, beside springs."""
    return any(_is_of_nerves(name) for name in given)


def _is_of_nerves(name: str) -> bool:
    return PARAMETERS[name].section.partition(".")[0] in ("damping", "feedback")


def motion(mode: dict[str, Any]) -> str:
    """Say how a mode moves."""
    if mode["eigenvalue"] > 0.0:
        return f"sways at {mode['frequency']:.3g} Hz"
    if mode["growth_rate"] == 0.0:
        return "drifts"
    return f"falls, doubles in {math.log(2.0) / mode['growth_rate']:.3g} s"


def _with_feedback(facts: dict[str, Any]) -> str:
    """Say what damping and feedback change."""
    verdict = {True: "Stands", False: "Falls", None: "Open within rounding"}
    text = f"{verdict[facts['stands_with_feedback']]} with damping and feedback as given"
    critical, margin, root = facts["critical_delay"], facts["delay_margin"], facts["rightmost_root"]
    if critical == math.inf:
        text += "; no delay ends it"
    elif critical:
        text += f"; critical delay {critical:.4g} s, margin {margin:.4g} s"
    elif critical == 0.0:
        text += "; falls without delay already"
    if root is None:
        return f"{text}.\nThe rightmost root was not proven."
    real, imaginary = root
    text += f".\nRightmost root {real:.4g}"
    text += f" ± {imaginary:.4g}i 1/s" if imaginary else " 1/s"
    if imaginary and real < 0.0:
        text += f": sways at {imaginary / math.tau:.3g} Hz, halves in {-math.log(2.0) / real:.3g} s"
    elif real > 0.0:
        text += f": grows, doubles in {math.log(2.0) / real:.3g} s"
    return f"{text}."


def _number(stiffness: float) -> str:
    return f"{stiffness:.4g}"
