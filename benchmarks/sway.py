"""How fast is sway under noise found, how accurately, and what becomes of both near the threshold.

Persons with three free joints and delayed feedback who stand: rates of each quantity alone and of
all together, in as many threads as cores, and errors beside integrals to 1e-10. Then the same
persons at delays ever nearer to their critical delay. Run as ``python benchmarks/sway.py`` (about
three minutes).
"""

import os
import sys
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from functools import lru_cache
from typing import Any

import jax.numpy as jnp
import numpy as np

from harness import ROOT, Demand, Report, Row, in_turn, ratio

sys.path.insert(0, str(ROOT / "tests" / "helpers"))

from noisy_people import Standing, standing_people
from standfast.engine.delays import OF_GRIDS
from standfast.engine.mapping import in_batches
from standfast.quantities import QUANTITIES
from standfast.stability.delay.persons import all_crossings
from standfast.stability.delay.problem import Apply
from standfast.stability.sway import density
from standfast.stability.sway.nodes import over_intervals
from standfast.stability.sway.persons import variances

ROUNDS = 3
THREADS = os.cpu_count() or 1
SEED = 15
PERSONS = 90_000  # of whom one in eighteen stands
LONGEST = 0.3  # s
EXACT = 1e-10
PLAIN = "com_sway"  # found without the trick too
NEAR = 512  # persons followed to their critical delay
DISTANCES = tuple(10.0**-power for power in range(1, 7))
SWAY = {name: row.variances for name, row in QUANTITIES.items() if row.variances}
ALL = tuple(sorted({row for rows in SWAY.values() for row in rows}))


def main() -> None:
    """Measure, and write the report."""
    standing = standing_people(
        np.random.default_rng(SEED), PERSONS, LONGEST, rigid_share=0.0, apply=in_batches
    )
    jobs: dict[str, Callable[[], object]] = {
        name: lambda rows=rows: found(rows, standing) for name, rows in SWAY.items()
    }
    jobs["together"] = lambda: found(ALL, standing)
    found(SWAY[PLAIN], standing[:1], apply=with_plain_cosines)  # compiles, in one thread
    jobs["plain"] = lambda: found(SWAY[PLAIN], standing, apply=with_plain_cosines)
    jobs["verdicts"] = lambda: in_threads(standing, crossings)
    seconds = in_turn(jobs, ROUNDS, lambda: time.process_time() / THREADS)
    exact = found(ALL, standing, EXACT)
    count = standing.delay.size
    report = Report(
        "sway",
        "How fast is sway under noise found, and how accurately?",
        f"median of {ROUNDS} rounds; {count:,} random persons who stand, three free joints, full "
        f"or diagonal gains, delays up to {LONGEST} s; {THREADS} threads, and seconds of all "
        f"processors over {THREADS}, which other work on the machine does not lengthen",
    )
    errors = {}
    for name, rows in {**SWAY, "together": ALL}.items():
        which = [ALL.index(row) for row in rows]
        errors[name] = abs(found(rows, standing) / exact[which] - 1.0).max(axis=0)
        what = "all seven together" if name == "together" else name
        unit = "persons" if name == "together" else "points"
        report.rows.append(Row(what, seconds[name], count, unit, said(errors[name])))
    report.rows.append(Row(f"{PLAIN}, cosines of XLA", seconds["plain"], count, "points"))
    words = "crossings alone, for the verdict"
    report.rows.append(Row(words, seconds["verdicts"], count, "persons"))
    slowest = min(report.rows[: len(SWAY)], key=lambda row: row.rate)
    worst = max(float(each.max()) for each in errors.values())
    apart = sum(float(np.median(seconds[name])) for name in SWAY)
    report.demands = [
        Demand(f"sway, the slowest quantity ({slowest.what}), points a second", 1e4, slowest.rate),
        Demand("sway, worst relative error of a variance", 1e-6, worst, most=True),
        Demand(
            "sway, seven quantities one by one over together",
            1.0,
            apart / float(np.median(seconds["together"])),
        ),
        Demand(f"{PLAIN}, cosines in vectors: times as fast", 1.0, ratio(seconds, "plain", PLAIN)),
    ]
    report.extra = {"near": near_the_threshold(standing)}
    report.limitations = [
        "threads that wait for each other are not in the seconds",
        "errors are of variances, beside the same integrals asked to 1e-10, which "
        "`benchmarks/sway_check.py` compares with other methods",
        "verdicts come first and are not in the rates of sway; random persons "
        "(`tests/helpers/noisy_people.py`) are less damped than people are",
        "intervals: of ω, of 15 frequencies each, that are evaluated a person for the CoP",
    ]
    report.write()


def found(
    rows: tuple[int, ...],
    standing: Standing,
    accuracy: float = OF_GRIDS,
    apply: Apply = in_batches,
) -> np.ndarray:
    """Find variances as the engine does, (rows, persons)."""

    def job(part: Standing) -> np.ndarray:
        stands = np.ones(part.delay.size, bool)
        each, sure = variances(rows, part.swaying, stands, accuracy=accuracy, apply=apply)
        if not sure.all():
            raise ArithmeticError("a variance is not as accurate as asked")
        return each

    return np.concatenate(in_threads(standing, job), axis=1)


def with_plain_cosines(function: Callable[..., Any], problem: Any, *arrays: np.ndarray) -> Any:
    """Apply a function as the engine does, its cosines being those of the library."""
    return in_batches(_plainly(function), problem, *arrays)


@lru_cache
def _plainly(function: Callable[..., Any]) -> Callable[..., Any]:
    def traced(problem: Any, *arrays: Any) -> Any:
        quick = density.cosine_and_sine
        density.cosine_and_sine = lambda angle: (jnp.cos(angle), jnp.sin(angle))
        try:
            return function(problem, *arrays)
        finally:
            density.cosine_and_sine = quick

    return traced


def crossings(part: Standing) -> None:
    """Find what verdicts need."""
    people = part.people
    all_crossings(people.numbers, people.rigid, of="who may stand", apply=in_batches)


def in_threads(standing: Standing, job: Callable[[Standing], Any]) -> list[Any]:
    """Do a job for a part of the persons in each of as many threads as cores."""
    parts = np.array_split(np.arange(standing.delay.size), THREADS)
    with ThreadPoolExecutor(THREADS) as pool:
        return list(pool.map(lambda part: job(standing[part]), parts))


def near_the_threshold(standing: Standing) -> list[dict[str, float]]:
    """Return cost and error of the CoP's variance at delays nearer and nearer to the critical."""
    people = standing.people
    table = all_crossings(people.numbers, people.rigid, of="who stands at once", apply=in_batches)
    critical = table.critical_delay()
    chosen = np.flatnonzero((critical > 0.0) & np.isfinite(critical))[:NEAR]
    some, critical = standing[chosen], critical[chosen]
    found_there = []
    for distance in DISTANCES:
        at = some._replace(delay=critical * (1.0 - distance))
        intervals = 0

        def counted(function: Callable[..., Any], problem: Any, *arrays: np.ndarray) -> Any:
            nonlocal intervals
            intervals += arrays[-1].shape[-1] * (function is over_intervals)
            return in_batches(function, problem, *arrays)

        stands = np.ones(chosen.size, bool)
        swaying = at.swaying
        quick, sure = variances((density.COP,), swaying, stands, accuracy=OF_GRIDS, apply=counted)
        exact, known = variances((density.COP,), swaying, stands, accuracy=EXACT, apply=in_batches)
        error = abs(quick[0] / exact[0] - 1.0)[known[0]]
        found_there.append({
            "distance": distance,
            "persons": int(chosen.size),
            "intervals": intervals / chosen.size,
            "worst": float(error.max()),
            "of 99 %": float(np.quantile(error, 0.99)),
            "deviation": float(np.median(np.sqrt(exact[0]))),
            "left open": int((~sure).sum()),
            "left open of 1e-10": int((~known).sum()),
        })  # fmt: skip
    return found_there


def said(error: np.ndarray) -> str:
    """Say how large the errors are."""
    return f"worst {error.max():.0e}, of 99 % below {np.quantile(error, 0.99):.0e}"


if __name__ == "__main__":
    main()
