"""The same work by the means that people would otherwise use, with the same answers.

Run as ``python benchmarks/peers.py`` (about a minute and a half).
"""

import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor

import jax
import jax.numpy as jnp
import numpy as np
import scipy.linalg

import standfast as sf
from harness import Demand, Report, Row, in_turn
from standfast.engine.grid import Evaluator
from standfast.study.grid import Tile

SIDE = 192
LOOPED = 2000
BATCHED = 200_000
CALLS = 500
ROUNDS = 7
# Eigenvalues near 0 lose digits in LAPACK; ours keep them.
LAPACK = 1e-8

AXES = {
    "ankle": np.linspace(600.0, 2000.0, SIDE),
    "knee": np.linspace(500.0, 3000.0, SIDE),
    "hip": np.linspace(200.0, 2000.0, SIDE),
}


def main() -> None:
    """Measure, check that the answers are the same, and write the report."""
    body = sf.Body.edwards2007()
    study = sf.Study.from_dict(
        {
            "gravity": 9.8,
            "body": {"model": "edwards2007", "height": 1.753, "mass": 75.3},
            "stiffness": {joint: values.tolist() for joint, values in AXES.items()},
            "output": {"quantities": ["eigenvalue_1", "eigenvalue_2", "eigenvalue_3"]},
        }
    )
    evaluate = Evaluator(study)
    group = study.grid.groups[0]
    tiles = [study.grid.tile(0, number) for number in range(group.tile_count)]
    grid = np.stack(np.meshgrid(*AXES.values(), indexing="ij"), axis=-1).reshape(-1, 3)
    random = np.random.default_rng(1)
    chosen = random.integers(0, len(grid), BATCHED)
    some = grid[chosen]
    inertia = np.asarray(sf.inertia_matrix(body))
    gravity = -np.asarray(sf.stiffness_matrix(body, sf.Stiffness(0.0, 0.0, 0.0), gravity=9.8))
    matrices = np.zeros((BATCHED, 3, 3))
    matrices[:, range(3), range(3)] = some
    matrices -= gravity
    # reduced to a symmetric problem: L⁻¹ C L⁻ᵀ
    half = np.linalg.inv(np.linalg.cholesky(inertia))
    reduced = half @ matrices @ half.T
    with jax.enable_x64(True):
        on_device = jax.device_put(reduced)
        batched = jax.jit(jax.vmap(jnp.linalg.eigvalsh))

    def computed(tile: Tile) -> None:
        evaluate(tile)

    def ours() -> None:
        # as a sweep does it: every thread takes tiles
        with ThreadPoolExecutor(os.cpu_count()) as pool:
            list(pool.map(computed, tiles))

    def by_jax() -> np.ndarray:
        with jax.enable_x64(True):
            return np.asarray(batched(on_device))

    def by_scipy() -> np.ndarray:
        return np.array(
            [scipy.linalg.eigh(c, inertia, eigvals_only=True) for c in matrices[:LOOPED]]
        )

    jobs: dict[str, Callable[[], object]] = {
        "ours": ours,
        "NumPy": lambda: np.linalg.eigvalsh(reduced),
        "JAX": by_jax,
        "SciPy": by_scipy,
    }
    accuracy = _accuracy(body, evaluate, tiles, study)
    known = np.linalg.eigvalsh(reduced)
    found = _whole(study, evaluate, tiles)[:, chosen].T
    assert np.allclose(found, known, rtol=LAPACK, atol=1e-6)  # noqa: S101
    assert np.allclose(by_jax(), known, rtol=LAPACK, atol=1e-6)  # noqa: S101
    assert np.allclose(by_scipy(), known[:LOOPED], rtol=LAPACK, atol=1e-6)  # noqa: S101
    seconds = in_turn(jobs, ROUNDS)
    works = {"ours": study.points // 3, "NumPy": BATCHED, "JAX": BATCHED, "SciPy": LOOPED}
    words = {
        "ours": "standfast: three eigenvalues a point",
        "NumPy": "numpy.linalg.eigvalsh, batched, matrices already reduced",
        "JAX": "jax.vmap(jnp.linalg.eigvalsh), matrices already reduced",
        "SciPy": "loop over scipy.linalg.eigh(C, A)",
    }
    rows = [
        Row(words[name], seconds[name], works[name], "points", accuracy if name == "ours" else "")
        for name in jobs
    ]
    rates = {name: works[name] / np.median(seconds[name]) for name in jobs}
    report = Report(
        "peers",
        "Why not NumPy, JAX, numba, a loop over SciPy, or a sweep framework?",
        f"the nominal adult, {SIDE}³ stiffnesses, {os.cpu_count()} cores, double precision",
        rows,
        [
            Demand(
                "three eigenvalues against batched eigvalsh", 60.0, rates["ours"] / rates["NumPy"]
            ),
            Demand("three eigenvalues against the loop", 2000.0, rates["ours"] / rates["SciPy"]),
        ],
        [
            "Eigenvalues of ours are within 1e-12 of 50-digit arithmetic also near 0, where LAPACK "
            "keeps only the digits that the largest eigenvalue leaves.",
            "xyzpy and pipefunc call a function once a point, which is what they are for; the "
            "function is standfast's own.",
        ],
    )
    report.rows += _verdicts(body)
    report.write(("numba", "xyzpy", "pipefunc"))


def _accuracy(body: sf.Body, evaluate: Evaluator, tiles: list, study: sf.Study) -> str:
    """Compare some of our eigenvalues with the accurate function of one person."""
    worst = 0.0
    group = study.grid.groups[0]
    random = np.random.default_rng(2)
    for tile in tiles[:: max(len(tiles) // 4, 1)]:
        found = evaluate(tile)
        for _ in range(25):
            at = tuple(int(random.integers(0, n)) for n in group.chunk_shape)
            joints = [
                values[min(start + i, SIDE - 1)]
                for values, start, i in zip(AXES.values(), group.start(tile), at, strict=True)
            ]
            exact = sf.modes(body, sf.Stiffness(*joints), gravity=9.8).eigenvalues
            worst = max(worst, *(abs(f[at] / e - 1.0) for f, e in zip(found, exact, strict=True)))
    assert worst < 1e-12  # noqa: S101
    return f"within {worst:.0e}"


def _whole(study: sf.Study, evaluate: Evaluator, tiles: list) -> np.ndarray:
    """Put the tiles of all quantities together: (quantities, points)."""
    group = study.grid.groups[0]
    grids = np.empty((len(group.quantities), *group.shape))
    for tile in tiles:
        place = tuple(
            slice(first, min(first + side, count))
            for first, side, count in zip(
                group.start(tile), group.chunk_shape, group.shape, strict=True
            )
        )
        for grid, chunk in zip(grids, evaluate(tile), strict=True):
            grid[place] = chunk[tuple(slice(part.stop - part.start) for part in place)]
    return grids.reshape(len(grids), -1)


def _verdicts(body: sf.Body) -> list[Row]:
    """Time verdicts by numba with the same closed form, and by frameworks a call a point."""
    rows = []
    ankle, knee, hip = AXES.values()
    study = sf.Study.from_dict(
        {
            "gravity": 9.8,
            "body": {"model": "edwards2007", "height": 1.753, "mass": 75.3},
            "stiffness": {joint: values.tolist() for joint, values in AXES.items()},
        }
    )
    (stable,) = Evaluator(study)(study.grid.tile(0, 0))

    def ours() -> None:
        evaluate = Evaluator(study)  # keeps no threshold of the round before
        for number in range(study.grid.groups[0].tile_count):
            tile = study.grid.tile(0, number)
            if evaluate.uniform(tile) is None:
                evaluate(tile)

    rows.append(
        Row("standfast: verdicts, certified", in_turn({"": ours}, 20)[""], SIDE**3, "points")
    )
    loads = [float(g) for g in _segment_loads(body)]
    try:
        import numba  # noqa: PLC0415 - a peer that need not be there

        @numba.njit(parallel=True)
        def compiled(ankle, knee, hip, shank, thigh, upper, out):
            for i in numba.prange(ankle.size):
                for j in range(knee.size):
                    for k in range(hip.size):
                        fine = False
                        if hip[k] > upper:
                            at_knee = thigh + upper / (1.0 - upper / hip[k])
                            if knee[j] > at_knee:
                                fine = ankle[i] > shank + at_knee / (1.0 - at_knee / knee[j])
                        out[i, j, k] = fine

        out = np.zeros((SIDE,) * 3, np.uint8)
        seconds = in_turn({"": lambda: compiled(ankle, knee, hip, *loads, out)}, 20)[""]
        shape = study.grid.groups[0].chunk_shape
        assert np.array_equal(out[tuple(map(slice, shape))], stable)  # noqa: S101
        rows.append(Row("numba, parallel, the same closed form", seconds, SIDE**3, "points"))
    except ImportError:
        pass

    def verdict(ankle: float, knee: float, hip: float) -> bool:
        return sf.is_stable(body, sf.Stiffness(ankle, knee, hip), gravity=9.8)

    side = round(CALLS ** (1 / 3))
    axes = {joint: values[:side].tolist() for joint, values in AXES.items()}
    try:
        import xyzpy  # noqa: PLC0415

        runner = xyzpy.Runner(verdict, var_names=["stable"])
        seconds = in_turn({"": lambda: runner.run_combos(axes, verbosity=0)}, ROUNDS)[""]
        rows.append(Row("xyzpy, a call a point", seconds, side**3, "points"))
    except ImportError:
        pass
    try:
        from pipefunc import Pipeline, pipefunc  # noqa: PLC0415

        mapped = pipefunc(
            output_name="stable",
            mapspec="ankle[i], knee[j], hip[k] -> stable[i, j, k]",
        )(verdict)
        pipeline = Pipeline([mapped])
        seconds = in_turn({"": lambda: pipeline.map(axes, parallel=False, storage="dict")}, ROUNDS)[
            ""
        ]
        rows.append(Row("pipefunc, a call a point", seconds, side**3, "points"))
    except ImportError:
        pass
    return rows


def _segment_loads(body: sf.Body) -> tuple[float, float, float]:
    ms, mt, mb = body.segment_mass
    hs, ht = body.segment_length
    es, et, eb = body.segment_com
    return 9.8 * (ms * es + (mt + mb) * hs), 9.8 * (mt * et + mb * ht), 9.8 * (mb * eb)


if __name__ == "__main__":
    main()
