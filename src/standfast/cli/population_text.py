"""The answers of a population as text, on one screen."""

from collections.abc import Mapping, Sequence
from typing import Any

from standfast.cli.rejected import print_rejected
from standfast.parameters import JOINTS

UNITS = {"absolute": "N·m/rad", "mgh": "of mgh"}  # else of the person's own threshold


def print_summary(summary: Mapping[str, Any]) -> None:
    """Print the answers of a population on one screen."""
    print(f"{summary['title'] or 'untitled study'}")
    _print_who(summary)
    _print_unstable(summary)
    print("\nstiffness each joint needs with the other two rigid, N·m/rad")
    for joint, load in summary["single_joint_critical_stiffness"].items():
        print(f"  {joint:12} mean {load['mean']:.4g}, sd {load['sd']:.4g}")
    _print_quantiles("safety factor", summary["safety_factor"], "")
    _print_quantiles("growth rate of falls", summary["growth_rate_of_the_unstable"], " 1/s")
    print("\nstiffness at which that share stands, N·m/rad (as a multiple of the law)")
    required = summary["required_stiffness"]
    print(f"  {'':12}" + "".join(f"{_percent(float(share)):>20}" for share in required["all"]))
    for joint, shares in required.items():
        words = "".join(f"{_required(found):>20}" for found in shares.values())
        print(f"  {joint if joint != 'all' else 'all at once':12}{words}")
    for output, factors in summary["drivers"].items():
        _print_sensitivity("falling" if output == "unstable" else "the safety factor", factors)


def _print_who(summary: Mapping[str, Any]) -> None:
    people = summary["people"]
    print(f"{summary['size']:,} persons drawn from {people['source']}, seed {summary['seed']}")
    if "used" in people:
        print(
            f"  {people['used']:,} people used, {len(people['rejected']):,} rows rejected, "
            f"{people['not_selected']:,} not selected"
        )
        print_rejected(people["rejected"])
        for remark in people["remarks"]:
            print(f"    note: {remark}")
    for joint in JOINTS:
        law = dict(summary["laws"][joint])
        kind, relative = law.pop("distribution"), law.pop("relative_to")
        numbers = ", ".join(f"{name} {value}" for name, value in law.items())
        unit = UNITS.get(relative, "of the own threshold") if numbers else ""
        print(f"  {joint:6} {kind} {numbers} {unit}".rstrip())


def _print_unstable(summary: Mapping[str, Any]) -> None:
    low, high = summary["unstable_fraction_interval"]
    unstable = _percent(summary["unstable_fraction"])
    print(f"\nunstable   {unstable}   [{_percent(low)}, {_percent(high)}]")
    if summary["people"].get("survey_interval"):
        low, high = summary["people"]["survey_interval"]
        print(f"  as the people are a sample themselves: [{_percent(low)}, {_percent(high)}]")
    for key, classes in summary["strata"].items():
        if len(classes) > 1:
            print(f"  by {key if key != 'bmi' else 'BMI'}")
            for label, found in classes.items():
                low, high = found["interval"]
                print(
                    f"    {label:14} {_percent(found['unstable_fraction']):>8}   "
                    f"[{_percent(low)}, {_percent(high)}]   {_percent(found['share'])} of all"
                )


def _print_quantiles(what: str, shares: Mapping[str, Any] | None, unit: str) -> None:
    if shares is None:
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
