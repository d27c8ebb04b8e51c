"""How fast are verdicts and every other quantity computed in memory.

Beside filling memory with the same threads. Run as ``python benchmarks/verdicts.py`` (a minute).
"""

import os
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor

import numpy as np

import standfast as sf
from harness import ROOT, Demand, Report, Row, in_turn
from standfast.engine.grid import Evaluator
from standfast.quantities import QUANTITIES
from standfast.study.grid import Tile

THREADS = os.cpu_count() or 1
ROUNDS = 7
BIG = 2**30
SIDE = 128


def main() -> None:
    """Measure, and write the report."""
    study = sf.Study.from_toml(ROOT / "studies" / "billion.toml")
    group = study.grid.groups[0]
    evaluate = Evaluator(study)
    tiles = [study.grid.tile(0, number) for number in range(group.tile_count)]
    # only tiles with a limit of standing in them: the others are known without a comparison
    crossed = [tile for tile in tiles if evaluate.uniform(tile) is None]
    points = len(crossed) * int(np.prod(group.chunk_shape))
    big = np.zeros(BIG, np.uint8)
    small = [np.zeros(2 * 2**20, np.uint8) for _ in range(THREADS)]

    with ThreadPoolExecutor(THREADS) as pool:

        def share(of: Callable[[int], None]) -> None:
            list(pool.map(of, range(THREADS)))

        def computing(i: int) -> None:
            _compute(evaluate, crossed[i::THREADS])

        def filling(i: int) -> None:
            part = BIG // THREADS
            big[i * part : (i + 1) * part].fill(i)

        def filling_small(i: int) -> None:
            for _ in range(points // (2 * 2**20) // THREADS):
                small[i].fill(i)

        seconds = in_turn(
            {
                "verdicts": lambda: share(computing),
                "fill": lambda: share(filling),
                "fill in cache": lambda: share(filling_small),
            },
            ROUNDS,
        )
    in_cache = points // (2 * 2**20) // THREADS * THREADS * 2 * 2**20
    rate = points / np.array(seconds["verdicts"])
    fill = BIG / np.array(seconds["fill"])
    rows = [
        Row("verdicts, certified, in blocks of 2 MB", seconds["verdicts"], points, "points"),
        Row("fill of an existing gigabyte", seconds["fill"], BIG, "bytes"),
        Row("fill of the same 2 MB in cache", seconds["fill in cache"], in_cache, "bytes"),
    ]
    rows += [_alone(name) for name in QUANTITIES if name != "stable"]
    Report(
        "verdicts",
        "How fast are verdicts and quantities computed in memory?",
        f"studies/billion.toml, {len(crossed)} chunks with a limit in them, {THREADS} threads; "
        f"quantities on {SIDE}³ stiffnesses of one person, double precision",
        rows,
        [
            Demand(
                "certified verdicts over memory fill, bytes/s", 0.8, float(np.median(rate / fill))
            )
        ],
        [
            "A verdict is one byte; the fill is of memory outside the caches, as PERFORMANCE means "
            "it. Filling the same 2 MB in cache again and again is faster than either.",
            "Chunks of equal verdicts, most of a grid, are not computed point by point and are "
            "left out here.",
            "Thresholds of a chunk are computed once and kept, as in a sweep; the first round, "
            "which computes them, is not counted.",
        ],
    ).write()


def _compute(evaluate: Evaluator, tiles: Sequence[Tile]) -> None:
    for tile in tiles:
        evaluate(tile)


def _alone(name: str) -> Row:
    """Time one quantity on a grid of all three stiffnesses."""
    axis = {"start": 400.0, "stop": 3000.0, "num": SIDE}
    study = sf.Study.from_dict(
        {
            "gravity": 9.8,
            "body": {"model": "edwards2007", "height": 1.753, "mass": 75.3},
            "stiffness": {"ankle": axis, "knee": axis, "hip": axis},
            "output": {"quantities": [name]},
        }
    )
    evaluate = Evaluator(study)
    tiles = [study.grid.tile(0, number) for number in range(study.grid.groups[0].tile_count)]
    repeats = 1 if len(tiles) > 1 else 50
    seconds = in_turn({name: lambda: _compute(evaluate, tiles * repeats)}, 3)[name]
    return Row(name, seconds, study.points * repeats, "values")


if __name__ == "__main__":
    main()
