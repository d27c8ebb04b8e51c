"""The answers of ``standfast assess`` as text, as JSON, and what its columns mean."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from standfast.cli.printing import counted
from standfast.cli.rejected import print_rejected
from standfast.parameters import JOINTS
from standfast.population.people.classes import STRATA, UNKNOWN

if TYPE_CHECKING:
    from standfast.population.assessed import Assessment

HELP_OF_COLUMNS = """\
columns of the output, one line a person (nothing where it is not known):
  id, height_m, mass_kg, sex, age       as read, in these units
  JOINT_stiffness_Nm_rad                measured, else of the options; inf is rigid
  JOINT_threshold_alone_Nm_rad          what the joint must have, the other two rigid
  JOINT_threshold_Nm_rad                the same with the other two as they are; inf: none suffices
  stands                                yes or no, by springs alone
  safety_factor                         by which all stiffnesses could be divided; above 1 stands
  stiffness_reserve_Nm_rad              what every joint could lose at once
  frequency_Hz                          of the least stable mode; negative: grows, with this root
  strategy                              hip where it turns more than the ankle in this mode
  JOINT_gain_needed_Nm_rad              what this joint alone must gain to stand; 0 who stands
  least_gain_at                         the joint where that is least; nothing where none suffices
with gains also damping, delay and gains, and
  stands_with_feedback                  yes or no at the own delay
  critical_delay_s                      delay that is first too long; 0: falls without, inf: none is
  delay_margin_s                        critical delay less the own
with noise also the noises, and
  JOINT_sway_rad, com_sway_m, cop_sway_m, cop_velocity_m_s
                                        standard deviations; inf who falls or is not damped,
                                        nothing who is too near to falling to say
  cop_frequency_Hz                      mean frequency of the CoP
then all other columns of the file as they were"""


def print_assessment(summary: Mapping[str, Any]) -> None:
    """Print what was found of persons on one screen."""
    rejected = summary["rejected"]
    print(
        f"{counted(summary['persons'], 'person')} assessed, {counted(len(rejected), 'row')} "
        f"rejected, {summary['not_selected']:,} not selected; body model {summary['body_model']}"
    )
    print_rejected(rejected)
    for remark in summary["remarks"]:
        print(f"    note: {remark}")
    for joint, (low, middle, high) in summary["threshold_alone"].items():
        spread = f" (median; {low:.4g} to {high:.4g} for nine in ten)" if low < high else ""
        print(f"  {joint:6} alone, the others rigid, needs {middle:.4g} N·m/rad{spread}")
    if not summary["judged"]:
        print("  no one has all three stiffnesses; give --ankle, --knee, --hip for a verdict")
        _print_strata(summary["strata"])
        return
    alone = " by springs alone" if "with_feedback" in summary else ""
    print(
        f"  {summary['stand']:,} of {summary['judged']:,} with known stiffness stand{alone}, "
        f"{summary['stand_with_hip_strategy']:,} of them by the hip strategy "
        "(the hip turns more than the ankle)"
    )
    for joint, fallen in summary["least_gain_at"].items():
        verb = "falls" if fallen == 1 else "fall"
        print(f"  {fallen:,} who {verb} would stand with the least gain at the {joint}")
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
    _print_strata(summary["strata"])


def _print_strata(strata: Mapping[str, Any]) -> None:
    """Print each class: how many, how many of them fall, and what the ankle needs."""
    everybody = strata["all"]["all"]
    verdicts = [
        (suffix, words)
        for suffix, words in (
            ("", "fall by springs alone"),
            ("_with_feedback", "fall with feedback"),
        )
        if everybody.get(f"judged{suffix}")
    ]
    if "judged_with_feedback" not in everybody:
        verdicts = [(suffix, "fall") for suffix, _ in verdicts]
    heads = "".join(f"{'of':>8} {f'{words} [95 %]':27}" for _, words in verdicts)
    print(f"  {'':18}{'persons':>8}{heads}  ankle alone needs, median (N·m/rad)")
    for key, classes in strata.items():
        crossed = key == "sex_and_age"
        if len(classes) < 2 or (crossed and min(len(strata["sex"]), len(strata["age"])) < 2):
            continue
        name, unit = STRATA[key]
        print(f"  by {name}" + (f", {unit}" if unit else ""))
        for label, found in classes.items():
            if not (crossed and UNKNOWN in label):
                told = "".join(
                    f"{found[f'judged{suffix}']:>8,} {_fallen(found, suffix):27}"
                    for suffix, _ in verdicts
                )
                needed = found["ankle_threshold_alone_Nm_rad_p50"]
                print(f"    {label:16}{found['persons']:>8,}{told}  {needed:.4g}")
    if verdicts:
        print(
            "  of: persons of known stiffness (and gains and delay); [ ]: Wilson's score interval;"
        )
        print("  every person counts alike, without weights")


def _fallen(found: Mapping[str, Any], suffix: str) -> str:
    if not found[f"judged{suffix}"]:
        return ""
    names = ("unstable_fraction", "unstable_95_low", "unstable_95_high")
    falls, low, high = (f"{100.0 * found[name + suffix]:.3g} %" for name in names)
    return f"{falls:>7} [{low}, {high}]"


def summary_of(found: "Assessment", bands: list[int] | None) -> dict[str, Any]:
    """Return the answers as one dictionary that JSON can hold."""
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
        "not_selected": found.people.not_selected,
        "body_model": found.body_model,
        "remarks": list(found.remarks),
        "threshold_alone": quantiles,
        "judged": int(found.judged.sum()),
        "stand": int(stands.sum()),
        "stand_with_hip_strategy": int((stands & (columns["strategy"] == "hip")).sum()),
        "fall_whatever_one_joint_gains": int(fall_anyhow.sum()),
        "least_gain_at": {joint: number for joint, number in best.items() if number},
        "strata": found.strata(bands),
        "confidence": 0.95,
        "interval_method": "Wilson's score interval, persons unweighted",
    }


def _fed_back(columns: Mapping[str, Any]) -> dict[str, Any]:
    verdicts, critical = columns["stands_with_feedback"], columns["critical_delay_s"]
    lost = critical[np.isfinite(critical) & (critical > 0.0)]
    return {
        "judged": int((verdicts != "").sum()),
        "stand": int((verdicts == "yes").sum()),
        "critical_delay": np.quantile(lost, (0.05, 0.5, 0.95)).tolist() if lost.size else [],
    }
