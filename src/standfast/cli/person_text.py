"""What ``standfast person`` says."""

import math
from collections.abc import Mapping
from typing import Any

from standfast.parameters import (
    COUPLINGS,
    DAMPINGS,
    GAINS,
    JOINTS,
    NOISES,
    PARAMETERS,
    SEGMENT_NUMBERS,
    STIFFNESS_UNIT,
)

# People sway below 1 Hz; what is lost above this (Hz) is a stiff joint that rings.
RINGING = 3.0

# What is said of sway: words, printed unit, how many of it make one of SI.
SWAY = {
    "ankle_sway": ("SD of the ankle's rotation", "°", math.degrees(1.0)),
    "knee_sway": ("SD of the knee's rotation", "°", math.degrees(1.0)),
    "hip_sway": ("SD of the hip's rotation", "°", math.degrees(1.0)),
    "com_sway": ("SD of the centre of mass", "mm", 1e3),
    "cop_sway": ("SD of the centre of pressure", "mm", 1e3),
    "cop_velocity": ("SD of its velocity", "mm/s", 1e3),
    "cop_frequency": ("its mean frequency", "Hz", 1.0),
}


def print_person(given: dict[str, Any], facts: dict[str, Any]) -> None:
    """Print who it is, the verdict, each joint, each mode, and what feedback makes of it."""
    print(person_in_words(given))
    if sentence := fed_back_in_words(given, facts):
        print(f"\n{sentence}{_lost(given, facts)}\n{_root(facts)}")
    print(f"\n{_verdict(facts, alone=bool(sentence))}")
    if not gained(given) and given.get("feedback_delay"):
        print("Without gains (--proportional, --derivative) the delay does nothing.")
    print()
    print(f"  {STIFFNESS_UNIT:10}{'stiffness':>12}{'threshold':>12}{'alone':>12}{'to spare':>12}")
    for joint in JOINTS:
        own, threshold, alone = (
            facts[key][joint] for key in ("stiffness", "thresholds", "thresholds_alone")
        )
        spare = "" if math.isinf(own) and math.isinf(threshold) else _number(own - threshold)
        print(f"  {joint:10}{_number(own):>12}{_number(threshold):>12}{alone:12.4g}{spare:>12}")
    note = "threshold: the other two as given"
    if math.inf in facts["thresholds"].values():
        note += " (inf: no stiffness suffices)"
    print(f"  {note}; alone: the other two rigid")
    print(f"\n  {'mode':10}{'':>24}{'ankle : knee : hip':>24}")
    for number, mode in enumerate(facts["modes"], 1):
        turns = " : ".join(f"{turn:.3g}" for turn in mode["rotations"].values())
        print(f"  {number:<10}{motion(mode):24}{turns:>24}")
    if not facts["modes"]:
        print("  none: all three joints are rigid")
    if "sway" in facts:
        print(f"\n{_swaying(facts)}")


def person_in_words(given: dict[str, Any]) -> str:
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
        if _is_of_nerves(name) or name in (*COUPLINGS, *NOISES)
    ]
    return "; ".join([who, f"gravity {given['gravity']:g} m/s²", *beside])


def _verdict(facts: dict[str, Any], *, alone: bool) -> str:
    """Say whether springs hold the person, and by how much; ``alone``: nerves were spoken of."""
    factor, reserve = facts["safety_factor"], facts["stiffness_reserve"]
    stands = facts["stands_by_springs"]
    text = f"{'Stands' if stands else 'Falls'}{' by springs alone' if alone else ''}"
    if math.isinf(factor):
        return f"{text}: every joint is rigid."
    text += (
        f": safety factor {factor:.4g} (all stiffnesses divided by it, the person just stands).\n"
    )
    if stands:
        return f"{text}Each joint could lose {reserve:.4g} {STIFFNESS_UNIT}, all at the same time."
    text += f"They would just stand with {-reserve:.4g} {STIFFNESS_UNIT} more at each joint"
    enough = [joint for joint, needed in facts["thresholds"].items() if math.isfinite(needed)]
    if not enough:
        return f"{text}; no joint alone suffices."
    return f"{text}, or with {' or '.join(enough)} alone at its threshold."


def fed_back(given: Mapping[str, Any]) -> bool:
    """Return whether damping, a delay or a gain is given, beside springs."""
    return any(_is_of_nerves(name) for name in given)


def gained(given: Mapping[str, Any]) -> bool:
    """Return whether any gain is another number than 0, so that a delay matters."""
    return any(given.get(name) for name in GAINS)


def _is_of_nerves(name: str) -> bool:
    return PARAMETERS[name].section.partition(".")[0] in ("damping", "feedback")


def motion(mode: dict[str, Any]) -> str:
    """Say how a mode moves."""
    if mode["eigenvalue"] > 0.0:
        return f"sways at {mode['frequency']:.3g} Hz"
    if mode["growth_rate"] == 0.0:
        return "drifts"
    return f"falls, doubles in {math.log(2.0) / mode['growth_rate']:.3g} s"


def fed_back_in_words(given: Mapping[str, Any], facts: dict[str, Any]) -> str:
    """Say the verdict with damping and feedback; empty where neither changes anything."""
    damped = any(given.get(name) for name in DAMPINGS)
    if not (damped or gained(given)):
        return ""
    means = " and ".join(
        name for name, there in (("damping", damped), ("feedback", gained(given))) if there
    )
    if facts["stands_with_feedback"] is None:
        return f"With {means} it is open within rounding."
    verdict = "Stands" if facts["stands_with_feedback"] else "Falls"
    text = f"{verdict} with {means}"
    critical, delay = facts["critical_delay"], given.get("feedback_delay", 0.0)
    if not gained(given) or critical is None:
        return f"{text}."
    if critical == 0.0:
        return f"{text}: falls without delay already."
    if critical == math.inf:
        return f"{text}: no delay ends it."
    margin = facts["delay_margin"]
    text += f": critical delay {critical:.4g} s, delay {delay:.4g} s, margin {margin:.4g} s"
    later = " (a later window of standing)" if margin <= 0.0 and verdict == "Stands" else ""
    return f"{text}{later}."


def _lost(given: Mapping[str, Any], facts: dict[str, Any]) -> str:
    """Say which sway is lost at the critical delay, and what may be behind it."""
    frequency = facts["critical_frequency"]
    if frequency is None:
        return ""
    text = f"\nAt the critical delay a sway at {frequency:.3g} Hz begins to grow"
    free = [joint for joint in JOINTS if math.isfinite(facts["stiffness"][joint])]
    if frequency > RINGING and not any(given.get(name) for name in DAMPINGS):
        text += f"; stiff joints without damping ring (--damping {'=…,'.join(free)}=…)"
    return f"{text}."


def _root(facts: dict[str, Any]) -> str:
    """Say what the rightmost root does."""
    if facts["rightmost_root"] is None:
        return "The rightmost root was not proven."
    real, imaginary = facts["rightmost_root"]
    text = f"Rightmost root {real:.4g}"
    text += f" ± {imaginary:.4g}i 1/s" if imaginary else " 1/s"
    if imaginary and real < 0.0:
        text += f": sways at {imaginary / math.tau:.3g} Hz, halves in {-math.log(2.0) / real:.3g} s"
    elif real > 0.0:
        text += f": grows, doubles in {math.log(2.0) / real:.3g} s"
    return f"{text}."


def _swaying(facts: dict[str, Any]) -> str:
    """Say how much noise makes the person sway, as force plates and goniometers measure it."""
    sway = facts["sway"]
    if sway is None:
        return "Nothing sways: no joint that turns has noise."
    if math.inf in sway.values():
        stands = facts.get("stands_with_feedback", facts["stands_by_springs"])
        if stands is False:
            return "Under noise it has no sway: it falls."
        free = [joint for joint in JOINTS if math.isfinite(facts["stiffness"][joint])]
        return f"Nothing damps it, and noise moves it ever more (--damping {'=…,'.join(free)}=…)."
    lines = ["Under noise it sways, of the centre of pressure below 10 Hz:"]
    for name, (words, unit, size) in SWAY.items():
        rigid = math.isinf(facts["stiffness"].get(name.removesuffix("_sway"), 0.0))
        value = "open" if sway[name] is None else f"{size * sway[name]:.4g}"
        lines.append(f"  {words:30}{unit:6}{'rigid' if rigid else value:>10}")
    if None in sway.values():
        lines.append("  open: within rounding, or too near to falling to say")
    return "\n".join(lines)


def _number(stiffness: float) -> str:
    return f"{stiffness:.4g}"
