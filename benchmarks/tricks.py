"""What does each trick buy that a plain program would not have.

Every row is one job with the trick and without it, in turn. Run as ``python benchmarks/tricks.py``
(two minutes); CONTRIBUTING.md lists the tricks and where they live.
"""

import os
import statistics
import subprocess
import sys
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from isal import isal_zlib

import standfast as sf
from harness import ROOT, Demand, Report, Row, in_turn, ratio
from standfast.atlas.encoding import encoded, encoded_constant
from standfast.engine import mapping
from standfast.engine.grid import Evaluator
from standfast.quantities import QUANTITIES, Person
from standfast.stability import fast
from standfast.stability.margins import safety_factor
from standfast.stability.modes import modes

ROUNDS = 7
REPEATS = 4
ODD = 13  # values of a last axis that fills no vector of eight
THREADS = os.cpu_count() or 1
SIDE = 128
SWEEP_ROUNDS = 3

# A process of its own: the memory of one that has kept freed memory once stays kept.
SWEEP = """
import sys, tempfile, time, pathlib, statistics
sys.path.insert(0, "benchmarks")
import standfast as sf
from standfast.engine import grid
from tricks import numbers
if sys.argv[1] == "without":
    grid.keep_freed_memory = lambda: None
study = numbers("safety_factor", side=200)
with tempfile.TemporaryDirectory(dir=".") as folder:
    path = pathlib.Path(folder) / "a.h5"
    seconds = []
    for _ in range(6):
        began = time.perf_counter()
        sf.sweep(study, path)
        seconds.append(time.perf_counter() - began)
        path.unlink()
print(statistics.median(seconds[1:]))
"""


def numbers(*quantities: str, side: int = SIDE, hips: int = 0, start: float = 400.0) -> sf.Study:
    """Return a study of quantities on a grid of all three stiffnesses, of ``hips`` if given."""
    axis = {"start": start, "stop": 3000.0, "num": side}
    last = {**axis, "num": hips or side}
    return sf.Study.from_dict(
        {
            "gravity": 9.8,
            "body": {"model": "edwards2007", "height": 1.753, "mass": 75.3},
            "stiffness": {"ankle": axis, "knee": axis, "hip": last},
            "output": {"quantities": list(quantities)},
        }
    )


def main() -> None:
    """Measure, and write the report."""
    report = Report(
        "tricks",
        "What does each trick buy?",
        f"the nominal adult, {SIDE}³ stiffnesses, {os.cpu_count()} cores; each row is the job "
        "without the trick, the rate with it is above",
    )
    for trick, (with_it, without, work, unit) in _pairs().items():
        seconds = in_turn({"with": with_it, "without": without}, ROUNDS)
        gain = ratio(seconds, "without", "with")
        report.rows.append(Row(trick, seconds["with"], work, unit, f"{gain:.2f} × as fast"))
        report.rows.append(Row("  without", seconds["without"], work, unit))
        report.demands.append(Demand(f"{trick}: times as fast", 1.0, gain))
    _freed_memory(report)
    report.write()


def _pairs() -> dict[str, tuple[Callable[[], Any], Callable[[], Any], float, str]]:
    """Return by trick the job with it and without it, and how much work it is."""
    points = REPEATS * SIDE**3
    verdicts = numbers("stable", side=2 * SIDE, start=300.0)
    verdict = QUANTITIES["stable"].reference

    def lowest(given: dict[str, Any]) -> Any:
        found, uncertain = fast.fast_eigenvalues(*_springs(given))
        return jnp.where(uncertain, jnp.nan, found.eigenvalues[0])

    def lowest_and_flag(given: dict[str, Any]) -> Any:
        found, uncertain = fast.fast_eigenvalues(*_springs(given))
        return found.eigenvalues[0], uncertain

    @contextmanager
    def narrow() -> Iterator[None]:
        options = mapping.COMPILER_OPTIONS
        mapping.COMPILER_OPTIONS = {}
        yield
        mapping.COMPILER_OPTIONS = options

    with narrow():
        narrow_safety = _grid(lambda given: safety_factor(*_springs(given)))
    return {
        "verdicts by the place of their step, instead of a verdict a point": (
            _tiles(verdicts),
            _grid(lambda given: verdict(Person.of(given)), side=2 * SIDE, start=300.0),
            8 * points,
            "points",
        ),
        "eigenvalues the fast way, instead of by modes": (
            _grid(lowest),
            _grid(lambda given: modes(*_springs(given)).eigenvalues[0]),
            points,
            "points",
        ),
        "uncertainty of a single quantity as NaN, instead of beside it": (
            _grid(lowest),
            _grid(lowest_and_flag),
            points,
            "points",
        ),
        "vectors of 512 bits (safety factor)": (
            _grid(lambda given: safety_factor(*_springs(given))),
            narrow_safety,
            points,
            "points",
        ),
        f"last axis in whole vectors ({ODD} values, safety factor)": (
            _tiles(numbers("safety_factor", hips=ODD)),
            _grid(lambda given: safety_factor(*_springs(given)), hips=ODD),
            points * ODD / SIDE,
            "points",
        ),
        **_encodings(),
    }


def _springs(given: dict[str, Any]) -> tuple[Any, Any, Any]:
    return Person.of(given)[:3]


def _in_threads(function: Callable[[Any], object], work: list[Any]) -> Callable[[], None]:
    """Return a job that does some work in all threads, as a sweep does."""

    def run() -> None:
        with ThreadPoolExecutor(THREADS) as pool:
            list(pool.map(function, work * REPEATS))

    return run


def _tiles(study: sf.Study) -> Callable[[], None]:
    """Return the computing of all tiles."""
    evaluate = Evaluator(study)
    tiles = [study.grid.tile(0, number) for number in range(study.grid.groups[0].tile_count)]
    return _in_threads(evaluate, tiles)


def _grid(
    function: Callable[[dict[str, Any]], Any],
    *,
    side: int = SIDE,
    hips: int = 0,
    start: float = 400.0,
) -> Callable[[], None]:
    """Return the computing of a function on the same tiles, by nothing but the map over axes."""
    study = numbers("safety_factor", side=side, hips=hips, start=start)
    inputs = mapping.Inputs(study)
    group = study.grid.groups[0]
    mapped = mapping.map_over_grid(function, group.axes)
    pieces = []
    for number in range(group.tile_count):
        starts = group.start(study.grid.tile(0, number))
        at = map(mapping.along_axis, starts, group.chunk_shape, group.shape)
        pieces.append(inputs.pieces(dict(zip(group.axes, at, strict=True))))

    def compute(piece: dict[str, Any]) -> None:
        with jax.enable_x64(True):
            jax.block_until_ready(mapped(inputs.fixed, piece))

    compute(pieces[0])  # compiles, while what it is to measure is in force
    return _in_threads(compute, pieces)


def _encodings() -> dict[str, tuple[Callable[[], Any], Callable[[], Any], float, str]]:
    """Return the tricks of writing: what does not shrink is stored, constants are encoded once."""
    study = numbers("safety_factor")
    evaluate = Evaluator(study)
    tiles = [study.grid.tile(0, number) for number in range(study.grid.groups[0].tile_count)]
    chunks = [evaluate(tile)[0] for tile in tiles]
    verdicts = np.ones(2**21, np.uint8)

    def deflated(values: np.ndarray) -> bytes:
        planes = np.ascontiguousarray(np.moveaxis(values[..., None].view(np.uint8), -1, 0))
        return isal_zlib.compress(planes, 1)

    return {
        "bytes that do not shrink are stored (safety factor)": (
            _in_threads(encoded, chunks),
            _in_threads(deflated, chunks),
            REPEATS * sum(chunk.size for chunk in chunks),
            "values",
        ),
        "a chunk of equal verdicts is encoded once": (
            lambda: encoded_constant("|u1", 1, verdicts.size),
            lambda: encoded(verdicts),
            verdicts.size,
            "values",
        ),
    }


def _freed_memory(report: Report) -> None:
    """Add what keeping freed memory buys a sweep of numbers, in processes in turn."""
    seconds: dict[str, list[float]] = {"with": [], "without": []}
    for _ in range(SWEEP_ROUNDS):
        for way, found in seconds.items():
            command = [sys.executable, "-c", SWEEP, way]
            done = subprocess.run(command, cwd=ROOT, check=True, capture_output=True, text=True)
            found.append(float(done.stdout))
    gain = statistics.median(seconds["without"]) / statistics.median(seconds["with"])
    trick = "freed memory is kept (a sweep of safety factors)"
    report.rows.append(Row(trick, seconds["with"], 200**3, "values", f"{gain:.2f} × as fast"))
    report.rows.append(Row("  without", seconds["without"], 200**3, "values"))
    report.demands.append(Demand(f"{trick}: times as fast", 1.0, gain))


if __name__ == "__main__":
    main()
