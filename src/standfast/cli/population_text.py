"""The answers of a population as text, on one screen."""

import math
from collections.abc import Mapping, Sequence
from typing import Any

from standfast.cli.printing import counted
from standfast.cli.rejected import print_rejected
from standfast.parameters import JOINTS, PARAMETERS
from standfast.population.people.classes import STRATA, UNKNOWN

# How a multiple of a load is told, of something in N·m/rad.
RELATIVE = {"mgh": "mgh", "single_joint_critical": "the own threshold"}
# How sway is printed, by its unit: in which unit, and how many of that are one of SI.
SWAY_PRINTED = {
    "m": ("mm", 1e3),
    "m/s": ("mm/s", 1e3),
    "rad": ("°", math.degrees(1.0)),
    "Hz": ("Hz", 1.0),
}
DRIVEN = {
    "unstable": "falling",
    "safety_factor": "the safety factor",
    "delay_margin": "the delay margin (critical delay at most 1 s)",
}


def print_summary(summary: Mapping[str, Any]) -> None:
    """Print the answers of a population on one screen."""
    print(f"{summary['title'] or 'untitled study'}")
    _print_who(summary)
    _print_unstable(summary)
    print("\nstiffness each joint needs with the other two rigid, N·m/rad")
    for joint, load in summary["single_joint_critical_stiffness"].items():
        print(f"  {joint:12} mean {load['mean']:.4g}, sd {load['sd']:.4g}")
    if "delay_borne" in summary:
        _print_delays(summary)
    else:
        _print_springs(summary)
    for output, factors in summary["drivers"].items():
        _print_sensitivity(DRIVEN[output], factors)


def _print_springs(summary: Mapping[str, Any]) -> None:
    _print_quantiles("safety factor", "safety_factor", summary, "")
    _print_quantiles("growth rate of falls", "growth_rate_of_the_unstable", summary, " 1/s")
    print(
        "\nstiffness of a joint with which that share of persons stands, all else as drawn, N·m/rad"
    )
    print("  (in brackets: everybody's own, as drawn, times this instead)")
    required = summary["required_stiffness"]
    print(f"  {'':12}" + "".join(f"{_percent(float(share)):>20}" for share in required["all"]))
    for joint, shares in required.items():
        words = "".join(f"{_required(found):>20}" for found in shares.values())
        print(f"  {joint if joint != 'all' else 'all at once':12}{words}")


def _print_delays(summary: Mapping[str, Any]) -> None:
    _print_quantiles("critical delay", "critical_delay", summary, " s")
    _print_quantiles("delay margin", "delay_margin", summary, " s")
    print("\ndelay up to which that share stands, s [95 % interval]")
    borne = summary["delay_borne"]
    print(f"  {'':16}" + "".join(f"{_percent(float(share)):>22}" for share in borne["all"]))
    rows = [("all", borne["all"]), *borne["sex"].items(), *borne["age"].items()]
    if not _says_nothing_new(borne):
        both = borne.get("sex_and_age", {}).items()
        rows += [(label, shares) for label, shares in both if UNKNOWN not in label]
    for label, shares in rows:
        words = "".join(f"{_delay(found):>22}" for found in shares.values())
        print(f"  {label:16}{words}")
    if "sway" in summary:
        _print_sway(summary["sway"])
    if left_open := summary["left_open_by_rounding"]:
        of_all = counted(summary["size"], "person")
        print(f"  rounding leaves something open of {left_open:,} of {of_all}")


def _print_sway(sway: Mapping[str, Any]) -> None:
    """Print median and the middle 95 % of each quantity of sway, of all and by class."""
    _print_who_sways(sway)
    heads = [
        f"{name.replace('_', ' ')}, {SWAY_PRINTED[of['unit']][0]}" for name, of in sway.items()
    ]
    print(f"  {'':16}" + "".join(f"{head:>24}" for head in heads))
    labels = [("all", "")]
    one_kind = _says_nothing_new(next(iter(sway.values())))
    for key in ("sex", "age", *([] if one_kind else ["sex_and_age"])):
        of_key = next(iter(sway.values()))[key]
        crossed = key == "sex_and_age"
        labels += [(key, each) for each in of_key if not (crossed and UNKNOWN in each)]
    for key, label in labels:
        found = [of[key][label] if label else of[key] for of in sway.values()]
        units = [SWAY_PRINTED[of["unit"]][1] for of in sway.values()]
        words = map(_middle, found, units)
        print(f"  {label or 'all':16}" + "".join(f"{each:>24}" for each in words))


def _print_who_sways(sway: Mapping[str, Any]) -> None:
    """Print how many sway, have none, and are open: once for quantities that agree in it."""
    sentences: dict[str, list[str]] = {}
    for name, of in sway.items():
        persons, swaying, left_open = (of["all"][n] for n in ("persons", "swaying", "left_open"))
        none = counted(persons - swaying - left_open, "person")
        open_of = f"; of {counted(left_open, 'person')} more it is open" if left_open else ""
        sentence = (
            f"the {swaying:,} of {counted(persons, 'person')} who stand and are damped\n  (the "
            f"other {none} have none, and are not in it{open_of})"
        )
        sentences.setdefault(sentence, []).append(name.replace("_", " "))
    heading = "\nsway under noise: median [2.5 %, 97.5 %] of"
    if len(sentences) == 1:
        print(f"{heading} {next(iter(sentences))}")
        return
    print(heading)
    for sentence, names in sentences.items():
        print(f"  {', '.join(names)}: {sentence}")


def _middle(found: Mapping[str, Any], factor: float) -> str:
    """Return median and middle 95 % of a quantity of sway."""
    if found["quantiles"] is None:
        return "nobody"
    low, middle, high = (found["quantiles"][share]["value"] for share in ("0.025", "0.5", "0.975"))
    words = ["∞" if each is None else f"{factor * each:.3g}" for each in (low, middle, high)]
    return f"{words[1]} [{words[0]}, {words[2]}]"


def _delay(found: Mapping[str, Any]) -> str:
    """Return a delay with its interval; None is infinity, and 0 no delay at all."""
    if found["delay"] is None:
        return "any"
    if found["delay"] == 0.0:
        return "not even without"
    low, high = ("∞" if end is None else f"{end:.3f}" for end in found["delay_interval"])
    return f"{found['delay']:.3f} [{low}, {high}]"


def _print_who(summary: Mapping[str, Any]) -> None:
    people = summary["people"]
    drawn = counted(summary["size"], "person")
    print(f"{drawn} drawn from {people['source']}, seed {summary['seed']}")
    if "used" in people:
        print(
            f"  {counted(people['used'], 'person', 'people')} used, "
            f"{counted(len(people['rejected']), 'row')} rejected, "
            f"{people['not_selected']:,} not selected"
        )
        print_rejected(people["rejected"])
        for remark in people["remarks"]:
            print(f"    note: {remark}")
    for joint in JOINTS:
        print(f"  {joint:6} {_law(summary['laws'][joint], PARAMETERS[f'{joint}_stiffness'].unit)}")
    for name, law in summary.get("nerves", {}).items():
        print(f"  {name.replace('_', ' ')}: {_law(law, PARAMETERS[name].unit)}")


def _law(law: Mapping[str, Any], unit: str) -> str:
    """Return a distribution in words."""
    law = dict(law)
    kind, relative = law.pop("distribution"), law.pop("relative_to")
    if not law:
        return str(kind)
    numbers = ", ".join(f"{name} {value}" for name, value in law.items())
    if relative in RELATIVE:
        made = {PARAMETERS["ankle_damping"].unit: "s ", PARAMETERS["ankle_noise"].unit: "√s "}
        unit = f"{made.get(unit, '')}of {RELATIVE[relative]}"
    return f"{kind} {numbers} {unit}"


def _print_unstable(summary: Mapping[str, Any]) -> None:
    low, high = summary["unstable_fraction_interval"]
    unstable = _percent(summary["unstable_fraction"])
    print(f"\nunstable   {unstable}   [{_percent(low)}, {_percent(high)}]")
    print(f"  [ ]: 95 % interval of the simulation, {summary['interval_method']}")
    if settled := summary["settled_exactly"]:
        print(
            f"  {counted(settled, 'person')} within rounding of a threshold, settled in exact "
            "arithmetic; right at it a person falls"
        )
    if "unstable_by_springs_alone" in summary:
        low, high = summary["unstable_by_springs_alone_interval"]
        alone = _percent(summary["unstable_by_springs_alone"])
        print(
            f"  by springs alone, without feedback: {alone}   [{_percent(low)}, {_percent(high)}]"
        )
    if summary["people"].get("survey_interval"):
        low, high = summary["people"]["survey_interval"]
        print(f"  as the people are a sample themselves: [{_percent(low)}, {_percent(high)}]")
    for key, classes in summary["strata"].items():
        crossed = key == "sex_and_age"
        if len(classes) > 1 and not (crossed and _says_nothing_new(summary["strata"])):
            name, unit = STRATA[key]
            print(f"  by {name}" + (f", {unit}" if unit else ""))
            for label, found in classes.items():
                if crossed and UNKNOWN in label:
                    continue
                low, high = found["interval"]
                print(
                    f"    {label:16} {_percent(found['unstable_fraction']):>8}   "
                    f"[{_percent(low)}, {_percent(high)}]   "
                    f"{_percent(found['share'])} of the persons drawn"
                )


def _says_nothing_new(strata: Mapping[str, Any]) -> bool:
    """Return whether sex and age together tell no more than one of them."""
    return len(strata["sex"]) == 1 or len(strata["age"]) == 1


def _print_quantiles(what: str, key: str, summary: Mapping[str, Any], unit: str) -> None:
    if (same := summary["same_for_everybody"].get(key)) is not None:
        print(f"{what}: {same:.6g}{unit}, the same for everybody")
        return
    if (shares := summary[key]) is None:
        return
    low, middle, high = (shares[share]["value"] for share in ("0.05", "0.5", "0.95"))
    words = [f"{value:.3g}{unit}" if value is not None else "∞" for value in (middle, low, high)]
    print(f"{what}: median {words[0]}, nine in ten from {words[1]} to {words[2]}")


def _print_sensitivity(what: str, factors: Mapping[str, Any]) -> None:
    if "remark" in factors:
        print(f"\ndrivers of {what}: {factors['remark']}")
        return
    print(f"\ndrivers of {what}: Sobol indices, first order (alone) and total (with all others)")
    for factor, found in factors.items():
        print(
            f"  {factor:34} {_index(found['first'], found['first_interval'])}   "
            f"{_index(found['total'], found['total_interval'])}"
        )


def _required(found: Mapping[str, Any]) -> str:
    multiple = found["multiple"]
    times = "" if multiple is None else f"{multiple:.3g} ×"
    if "stiffness" not in found:
        return f"({times})" if times else "none"
    if found["stiffness"] is None:
        return "none suffices"
    return f"{found['stiffness']:.4g}" + (f" ({times})" if times else "")


def _percent(share: float) -> str:
    return f"{100.0 * share:.3g} %"


def _index(value: float, interval: Sequence[float]) -> str:
    # adding 0 turns the -0 of a rounded index into 0
    return f"{round(value, 3) + 0.0:6.3f} ± {0.5 * (interval[1] - interval[0]):.3f}"
