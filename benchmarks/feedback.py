"""How fast is delayed feedback solved, beside a solver of one delay at a time.

Rates of certified crossings, verdicts along the delay and proven rightmost roots; and the two ways
people have now: a loop of Chebyshev collocation with 10 nodes, and tdcpy. Every verdict of theirs
is compared with ours. Run as ``python benchmarks/feedback.py`` (about two minutes).
"""

import os
import sys
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import tdcpy

from harness import ROOT, Demand, Report, Row, in_turn, ratio

sys.path.insert(0, str(ROOT / "tests" / "helpers"))

from delay_people import Persons, random_persons
from standfast.engine.grid import Evaluator
from standfast.engine.mapping import in_batches
from standfast.stability.delay.persons import all_crossings, all_rightmost
from standfast.stability.delay.table import Crossings
from standfast.study.study import Study

ROUNDS = 3
SEED = 12
BLOCK = 2**14  # persons that a thread takes at once
GENERAL, CHANNEL, ROOTS = 2**17, 2**18, 2**15
ALONG, DELAYS = 2**15, np.linspace(0.0, 0.5, 1000)
COLLOCATED, BY_TDCPY = 1000, 100
NODES = 10
# of the rightmost root, in 1/s, within which 10 nodes, or the other's own tolerance, may be wrong
UNCLEAR = 0.05
PENDULUM = {
    "title": "Gains of a pendulum",
    "gravity": 9.8,
    "body": {"model": "winter", "height": {"start": 1.5, "stop": 1.95, "num": 32}, "bmi": 23.0},
    "stiffness": {"ankle": 450.0, "knee": float("inf"), "hip": float("inf")},
    "damping": {"ankle": 5.0},
    "feedback": {
        "proportional": {"ankle": {"start": 0, "stop": 2500, "num": 512}},
        "derivative": {"ankle": {"start": 0, "stop": 900, "num": 512}},
    },
    "output": {"quantities": ["critical_delay"]},
}


def main() -> None:
    """Measure, compare verdicts, and write the report."""
    rng = np.random.default_rng(SEED)
    general = random_persons(rng, GENERAL, ("diagonal", "full"), rigid_share=0.0)
    channel = random_persons(rng, CHANNEL, ("one channel", "ankle only"), rigid_share=0.0)
    own = rng.uniform(0.0, 0.3, GENERAL)
    study = Study.from_dict(PENDULUM)
    evaluate = Evaluator(study)
    tiles = [tile for shard in range(study.shard_count) for tile in study.grid.shard(shard)]
    tables = in_threads(general[:ALONG], crossings)
    verdicts: dict[str, np.ndarray] = {}

    def pendulum() -> None:
        with ThreadPoolExecutor() as pool:
            list(pool.map(evaluate, tiles))

    def along() -> None:
        with ThreadPoolExecutor() as pool:
            list(pool.map(lambda table: table.stable_at(DELAYS), tables))

    def at_own() -> None:
        found = in_threads(general, lambda part: crossings(part, "who may stand"))
        stable = [
            table.stable_each(own[first : first + BLOCK])
            for first, table in zip(range(0, GENERAL, BLOCK), found, strict=True)
        ]
        verdicts["standfast"] = np.concatenate(stable)

    def roots() -> None:
        starts = range(0, ROOTS, BLOCK // 4)
        with ThreadPoolExecutor() as pool:
            list(pool.map(lambda first: rightmost(general, own, first, BLOCK // 4), starts))

    def collocated() -> None:
        found = [by_collocation(general.matrices(i), own[i]) for i in range(COLLOCATED)]
        verdicts["collocation"] = np.array(found)

    def by_tdcpy() -> None:
        found = [abscissa_by_tdcpy(general.matrices(i), own[i]) for i in range(BY_TDCPY)]
        verdicts["tdcpy"] = np.array(found)

    jobs: dict[str, Callable[[], object]] = {
        "pendulum": pendulum,
        "channel": lambda: in_threads(channel, crossings),
        "channel, standing": lambda: in_threads(channel, at_once),
        "general": lambda: in_threads(general, crossings),
        "general, standing": lambda: in_threads(general, at_once),
        "crossings of these": lambda: in_threads(general[:ALONG], crossings),
        "along": along,
        "own": at_own,
        "roots": roots,
        "collocation": collocated,
        "tdcpy": by_tdcpy,
    }
    seconds = in_turn(jobs, ROUNDS)
    open_ = [sum(int(t.uncertain.sum()) for t in in_threads(p, crossings))
             for p in (channel, general)]  # fmt: skip
    write(seconds, study.points, open_, verdicts)


def crossings(persons: Persons, of: str = "everybody") -> Crossings:
    """Find the crossings of some persons, compiled as the engine does."""
    return all_crossings(persons.numbers, persons.rigid, of=of, apply=in_batches)


def at_once(persons: Persons) -> np.ndarray:
    """Find the critical delays alone."""
    return crossings(persons, "who stands at once").critical_delay()


def rightmost(persons: Persons, delay: np.ndarray, first: int, count: int) -> np.ndarray:
    """Find rightmost roots, all proven."""
    part = slice(first, first + count)
    root, proven = all_rightmost(
        persons.numbers[..., part], persons.rigid[:, part], delay[part], apply=in_batches
    )
    if not proven.all():
        raise ArithmeticError("a rightmost root was not proven")
    return root


def in_threads(persons: Persons, job: Callable[[Persons], object]) -> list:
    """Do a job for blocks of persons in as many threads as cores."""
    starts = range(0, persons.rigid.shape[1], BLOCK)
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        return list(pool.map(lambda first: job(persons[first : first + BLOCK]), starts))


def by_collocation(matrices: np.ndarray, delay: float) -> float:
    """Return the rightmost real part by Chebyshev collocation with few nodes, and nothing more."""
    now, late = first_order(matrices)
    size = len(now)
    x = np.cos(np.pi * np.arange(NODES + 1) / NODES)
    weights = np.where((abs(x) == 1.0), 2.0, 1.0) * (-1.0) ** np.arange(NODES + 1)
    slopes = np.outer(weights, 1.0 / weights) / (x[:, None] - x + np.eye(NODES + 1))
    slopes -= np.diag(slopes.sum(axis=1))
    whole = np.kron(slopes * (2.0 / delay), np.eye(size))
    whole[:size] = 0.0
    whole[:size, :size] = now
    whole[:size, -size:] = late
    return float(np.linalg.eigvals(whole).real.max())


def abscissa_by_tdcpy(matrices: np.ndarray, delay: float) -> float:
    """Return the rightmost real part by tdcpy."""
    now, late = first_order(matrices)
    system = tdcpy.RDDE(np.stack([now, late], axis=-1), np.array([0.0, delay]))
    return float(tdcpy.spectral_abscissa(system, r=-1.0))


def first_order(matrices: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the matrices of q and q̇, of now and of τ ago."""
    a, b, c, p, d = matrices
    n = len(a)
    none, one = np.zeros((n, n)), np.eye(n)
    now = np.block([[none, one], [-np.linalg.solve(a, c), -np.linalg.solve(a, b)]])
    late = np.block([[none, none], [-np.linalg.solve(a, p), -np.linalg.solve(a, d)]])
    return now, late


def unlike(ours: np.ndarray, abscissas: np.ndarray) -> str:
    """Say how many verdicts of another way differ from ours, away from the boundary."""
    clear = np.isfinite(abscissas) & (abs(abscissas) > UNCLEAR)
    wrong = int((ours[: len(abscissas)] != (abscissas < 0.0))[clear].sum())
    return f"{wrong} of {int(clear.sum())} verdicts unlike ours"


def write(
    seconds: dict[str, list[float]],
    points: int,
    left_open: list[int],
    verdicts: dict[str, np.ndarray],
) -> None:
    """Write the report."""
    n = len(DELAYS)
    told = [f"proven; {count} left open" for count in left_open]
    report = Report("feedback", "How fast is delayed feedback solved", f"median of {ROUNDS} rounds")
    report.rows = [
        Row("one free joint: critical delays", seconds["pendulum"], points, "persons"),
        Row("one channel: all crossings", seconds["channel"], CHANNEL, "persons", told[0]),
        Row("one channel: critical delays", seconds["channel, standing"], CHANNEL, "persons"),
        Row("three joints: all crossings", seconds["general"], GENERAL, "persons", told[1]),
        Row("three joints: critical delays", seconds["general, standing"], GENERAL, "persons"),
        Row(f"crossings for {n} delays", seconds["crossings of these"], ALONG, "persons"),
        Row(f"verdicts at {n} delays from them", seconds["along"], ALONG * n, "verdicts"),
        Row("three joints: verdict at one delay", seconds["own"], GENERAL, "persons"),
        Row("three joints: rightmost root", seconds["roots"], ROOTS, "persons", "all proven"),
        Row(
            f"loop of collocation, {NODES} nodes, one delay",
            seconds["collocation"],
            COLLOCATED,
            "persons",
            unlike(verdicts["standfast"], verdicts["collocation"]),
        ),
        Row(
            "loop of tdcpy, one delay",
            seconds["tdcpy"],
            BY_TDCPY,
            "persons",
            unlike(verdicts["standfast"], verdicts["tdcpy"]),
        ),
    ]
    rate = {row.what: row.rate for row in report.rows}
    loop = rate[f"loop of collocation, {NODES} nodes, one delay"]
    both = [a + b for a, b in zip(seconds["along"], seconds["crossings of these"], strict=True)]
    axis = {"both": both, "crossings": seconds["crossings of these"]}
    verdicts_a_second = ALONG * n / float(np.median(both))
    report.demands = [
        Demand("one free joint: critical delays a second", 50e6, report.rows[0].rate),
        Demand("one channel: critical delays a second", 0.5e6, report.rows[2].rate),
        Demand("one channel: all crossings, persons a second", 0.5e6, report.rows[1].rate),
        Demand("three joints: all crossings, persons a second", 50e3, report.rows[3].rate),
        Demand("rightmost roots, proven, a second", 10e3, report.rows[8].rate),
        Demand(
            f"an axis of {n} delays over its crossings alone",
            2.0,
            ratio(axis, "both", "crossings"),
            most=True,
        ),
        Demand("verdict at one delay over collocation", 30.0, report.rows[7].rate / loop),
        Demand(f"verdicts at {n} delays over collocation", 1e4, verdicts_a_second / loop),
    ]
    report.limitations = [
        "persons are random: bodies, springs, damping, gains, half of them with coupled joints "
        "(`tests/helpers/delay_people.py`); three joints free, gains diagonal or full",
        "the loops run in one thread with one BLAS thread or more, as NumPy is installed",
        "one free joint: a grid of gains and heights, in closed form, not stored",
    ]
    report.write(("tdcpy",))


if __name__ == "__main__":
    main()
