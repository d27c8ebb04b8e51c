"""The commands about many persons: ``population`` and ``assess``."""

import argparse
import csv
import json
import math
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from standfast.cli.parsing import add_command, add_run_options, kept_when_stopped
from standfast.quantities import PARAMETERS, STANDARD_GRAVITY, InputError, checked_number

if TYPE_CHECKING:
    from standfast.population.assess import Assessment

# Rows of a file of people that are told on the screen; a file beside the result has all.
MOST_TOLD = 5


def population_parser(commands: Any) -> None:
    """Declare ``standfast population``."""
    parser = add_command(
        commands,
        "population",
        _population,
        "who of a population would not stand, and what it would take (the same command resumes)",
        "studies/us-adults.toml",
    )
    parser.add_argument("study", type=Path, metavar="STUDY.toml")
    add_run_options(parser, "count")
    parser.add_argument("--strict", action="store_true", help="stop at the first unusable row")
    parser.add_argument("--json", action="store_true", help="all answers as one JSON object")
    parser.add_argument("--no-figures", action="store_true", help="write no figures")
    parser.add_argument(
        "--format",
        action="append",
        choices=("png", "svg", "pdf"),
        help="of the figures; may be given more than once (default: png)",
    )


def assess_parser(commands: Any) -> None:
    """Declare ``standfast assess``."""
    parser = add_command(
        commands,
        "assess",
        _assess,
        "thresholds and margins of single persons, one line each",
        "people.csv --knee inf --hip 700",
    )
    parser.add_argument(
        "people",
        type=Path,
        nargs="+",
        metavar="PEOPLE.csv",
        help="columns height (m; height_cm), mass (kg), and if known id, sex, age, "
        "ankle_stiffness, knee_stiffness, hip_stiffness (N·m/rad, both legs; inf is rigid); "
        "further files are joined by id",
    )
    parser.add_argument(
        "-o", "--output", type=Path, metavar="FILE.csv", help="default: NAME-assessed.csv"
    )
    for joint in ("ankle", "knee", "hip"):
        parser.add_argument(
            f"--{joint}",
            metavar="K",
            help=f"stiffness of the {joint} where the file has none, N·m/rad or inf",
        )
    parser.add_argument("--body-model", default="winter", metavar="MODEL", help="default: winter")
    parser.add_argument(
        "--gravity", default=str(STANDARD_GRAVITY), metavar="G", help="m/s² (default: %(default)s)"
    )
    parser.add_argument("--strict", action="store_true", help="stop at the first unusable row")
    parser.add_argument("--json", action="store_true", help="the summary as one JSON object")


def _population(options: argparse.Namespace) -> None:
    from standfast.cli.progress import interruptible, progress_bar
    from standfast.population import PopulationStudy, simulate

    study = PopulationStudy.from_toml(options.study)
    output: Path = options.output or Path(options.study.name).with_suffix(".h5")
    with progress_bar("persons") as (_, progress), interruptible() as stop_if_asked:

        def after_block(done: int, total: int) -> None:
            progress(done, total)
            stop_if_asked()

        with kept_when_stopped(output):
            found = simulate(
                study,
                output,
                threads=options.threads,
                part=options.part,
                strict=options.strict,
                progress=after_block,
            )
    if found is None:
        share = "{}/{}".format(*options.part)
        print(f"Share {share} of {output} is done; without --part the same command finishes it.")
        return
    written = [output]
    rejected = found.summary["people"].get("rejected", [])
    written += _write_rejected(rejected, output)
    if not options.no_figures:
        from standfast.population.drawings import draw

        written += draw(found, output.with_suffix(""), options.format or ("png",))
    if options.json:
        print(json.dumps(found.summary, ensure_ascii=False))
        return
    tell_population(found.summary)
    print(f"\nWritten to {output.parent}: {', '.join(path.name for path in written)}")


def tell_population(summary: dict[str, Any]) -> None:
    """Print the answers of a population on one screen."""
    people = summary["people"]
    print(f"{summary['title'] or 'untitled study'}")
    source = people["source"]
    print(f"{summary['size']:,} persons drawn from {source}, seed {summary['seed']}")
    if "used" in people:
        print(
            f"  {people['used']:,} people used, {len(people['rejected']):,} rows rejected, "
            f"{people['not_selected']:,} not selected"
        )
        _tell_rejected(people["rejected"])
        for remark in people["remarks"]:
            print(f"    note: {remark}")
    for joint in ("ankle", "knee", "hip"):
        law = dict(summary["laws"][joint])
        kind, relative = law.pop("distribution"), law.pop("relative_to")
        numbers = ", ".join(f"{name} {value}" for name, value in law.items())
        unit = {"absolute": "N·m/rad", "mgh": "of mgh"}.get(relative, "of the own threshold")
        print(f"  {joint:6} {kind} {numbers} {unit if numbers else ''}".rstrip())
    low, high = summary["unstable_fraction_interval"]
    unstable = _percent(summary["unstable_fraction"])
    print(f"\nunstable   {unstable}   [{_percent(low)}, {_percent(high)}]")
    if people.get("survey_interval"):
        low, high = people["survey_interval"]
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
    print("\nstiffness each joint needs with the other two rigid, N·m/rad")
    for joint, load in summary["single_joint_critical_stiffness"].items():
        print(f"  {joint:12} mean {load['mean']:.4g}, sd {load['sd']:.4g}")
    _tell_quantiles("safety factor", summary["safety_factor"], "")
    _tell_quantiles("growth rate of falls", summary["growth_rate_of_the_unstable"], " 1/s")
    print("\nstiffness at which that share stands, N·m/rad (as a multiple of the law)")
    required = summary["required_stiffness"]
    print(f"  {'':12}" + "".join(f"{_percent(float(share)):>20}" for share in required["all"]))
    for joint, shares in required.items():
        words = "".join(f"{_required(found):>20}" for found in shares.values())
        print(f"  {joint if joint != 'all' else 'all at once':12}{words}")
    for output, factors in summary["drivers"].items():
        what = "falling" if output == "unstable" else "the safety factor"
        if "remark" in factors:
            print(f"\ndrivers of {what}: {factors['remark']}")
            continue
        print(
            f"\ndrivers of {what}: Sobol indices, first order (alone) and total (with all others)"
        )
        for factor, found in factors.items():
            print(
                f"  {factor:34} {_index(found['first'], found['first_interval'])}   "
                f"{_index(found['total'], found['total_interval'])}"
            )


def _tell_quantiles(what: str, shares: dict[str, Any] | None, unit: str) -> None:
    if shares is None:
        return
    low, middle, high = (shares[share]["value"] for share in ("0.05", "0.5", "0.95"))
    words = [f"{value:.3g}{unit}" if value is not None else "∞" for value in (middle, low, high)]
    print(f"{what}: median {words[0]}, nine in ten from {words[1]} to {words[2]}")


def _required(found: dict[str, Any]) -> str:
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


def _assess(options: argparse.Namespace) -> None:
    from standfast.body import BODY_MODELS
    from standfast.population.assess import assess, write_assessment
    from standfast.population.people import read_people
    from standfast.quantities import nearest_name

    if options.body_model not in BODY_MODELS:
        raise InputError(
            f"--body-model {options.body_model} is not known"
            f"{nearest_name(options.body_model, BODY_MODELS)} (models: {', '.join(BODY_MODELS)})"
        )
    gravity = _number("--gravity", options.gravity, "gravity")
    otherwise = {
        joint: _number(f"--{joint}", text, f"{joint}_stiffness")
        for joint in ("ankle", "knee", "hip")
        if (text := getattr(options, joint)) is not None
    }
    output: Path = options.output or Path(f"{options.people[0].stem}-assessed.csv")
    if output.resolve() in [path.resolve() for path in options.people]:
        raise InputError(f"{output} is the file of people itself; choose another output with -o")
    people = read_people(options.people, strict=options.strict)
    found = assess(people, body_model=options.body_model, gravity=gravity, otherwise=otherwise)
    write_assessment(found, output)
    summary = _assessed(found)
    written = [output, *_write_rejected(summary["rejected"], output)]
    if options.json:
        print(json.dumps(summary, ensure_ascii=False))
        return
    print(f"{summary['persons']:,} persons assessed, {len(people.rejected):,} rows rejected")
    _tell_rejected(summary["rejected"])
    for remark in summary["remarks"]:
        print(f"    note: {remark}")
    for joint, (low, middle, high) in summary["threshold_alone"].items():
        print(
            f"  {joint:6} alone, the others rigid, needs {middle:.4g} N·m/rad (median; "
            f"{low:.4g} to {high:.4g} for nine in ten)"
        )
    if summary["judged"]:
        print(f"  {summary['stand']:,} of {summary['judged']:,} with known stiffness stand", end="")
        print(
            f", {summary['stand_with_hip_strategy']:,} of them by the hip strategy "
            "(the hip turns more than the ankle)"
        )
        for joint, fallen in summary["least_gain_at"].items():
            print(f"  {fallen:,} who fall would stand with the least gain at the {joint}")
        if summary["fall_whatever_one_joint_gains"]:
            print(f"  {summary['fall_whatever_one_joint_gains']:,} fall whatever one joint gains")
    else:
        print("  no one has all three stiffnesses; give --ankle, --knee, --hip for a verdict")
    print(f"Written: {', '.join(str(path) for path in written)}")


def _assessed(found: "Assessment") -> dict[str, Any]:
    """Return the summary of an assessment."""
    import numpy as np

    columns = found.columns
    joints = ("ankle", "knee", "hip")
    quantiles = {
        joint: np.quantile(columns[f"{joint}_threshold_alone_Nm_rad"], (0.05, 0.5, 0.95)).tolist()
        for joint in joints
    }
    best = {joint: int((columns["least_gain_at"] == joint).sum()) for joint in joints}
    return {
        "persons": len(found.people),
        "rejected": [
            {"file": r.file, "line": r.line, "reason": r.reason} for r in found.people.rejected
        ],
        "remarks": list(found.people.remarks),
        "threshold_alone": quantiles,
        "judged": int(found.judged.sum()),
        "stand": int((columns["stands"] == "yes").sum()),
        "stand_with_hip_strategy": int(
            ((columns["strategy"] == "hip") & (columns["stands"] == "yes")).sum()
        ),
        "fall_whatever_one_joint_gains": int(
            (found.falls & (columns["least_gain_at"] == "")).sum()
        ),
        "least_gain_at": {joint: number for joint, number in best.items() if number},
    }


def _tell_rejected(rejected: Sequence[dict[str, Any]]) -> None:
    """Print some rejected rows, and how often each of the plain reasons occurs."""
    for row in rejected[:MOST_TOLD]:
        print(f"    {row['file']}, line {row['line']}: {row['reason']}")
    if len(rejected) > MOST_TOLD:
        often = Counter(row["reason"].split(" =")[0] for row in rejected).most_common(MOST_TOLD)
        reasons = ", ".join(f"{number:,} {reason}" for reason, number in often)
        print(f"    … in all {reasons}; see the file of rejected rows")


def _write_rejected(rejected: Sequence[dict[str, Any]], output: Path) -> list[Path]:
    """Write which rows were not used and why, beside the result; nothing if all were."""
    path = output.with_name(f"{output.stem}-rejected.csv")
    if not rejected:
        path.unlink(missing_ok=True)  # of a run before
        return []
    partial = path.with_name(f".{path.name}.partial")
    with partial.open("w", encoding="utf-8", newline="") as file:
        rows = csv.DictWriter(file, ("file", "line", "reason"), lineterminator="\n")
        rows.writeheader()
        rows.writerows(rejected)
    partial.replace(path)
    return [path]


def _number(option: str, text: str, parameter: str) -> float:
    try:
        number: float | str = float(text)
    except ValueError:
        number = text
    if isinstance(number, float) and math.isnan(number):
        number = text
    return checked_number(option, number, row=PARAMETERS[parameter])
