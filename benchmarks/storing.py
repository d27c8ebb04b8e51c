"""What does a sweep into a file cost, beside writing the finished array with others' means.

Run as ``python benchmarks/storing.py`` (about two minutes).
"""

import os
import tempfile
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import h5py
import numpy as np

import standfast as sf
from harness import ROOT, Demand, Report, Row, in_turn, ratio
from standfast.atlas.encoding import encoded
from standfast.engine.grid import Evaluator
from standfast.study.grid import Tile

ROUNDS = 3
QUICK_ROUNDS = 7
SIDE = 240  # 13.8 million values


def main() -> None:
    """Measure, and write the report."""
    with tempfile.TemporaryDirectory(dir=ROOT) as name:
        report = _verdicts(Path(name))
        _floats(Path(name), report)
    report.write(("hdf5plugin",))


def _writers(
    folder: Path, array: np.ndarray, chunks: tuple[int, ...]
) -> dict[str, Callable[[], None]]:
    """Return the ways to write a finished array."""

    def write(**storage: object) -> None:
        path = folder / "array.h5"
        with h5py.File(path, "w") as file:
            file.create_dataset("values", data=array, **storage)
        path.unlink()

    ways: dict[str, Callable[[], None]] = {
        "raw": write,
        "gzip": lambda: write(compression="gzip"),
        "gzip and shuffle": lambda: write(compression="gzip", shuffle=True, chunks=chunks),
        "gzip 1": lambda: write(
            compression="gzip", compression_opts=1, shuffle=True, chunks=chunks
        ),
    }
    try:
        import hdf5plugin  # noqa: PLC0415 - a peer that need not be there

        ways["blosc"] = lambda: write(chunks=chunks, **hdf5plugin.Blosc())
    except ImportError:
        pass
    return ways


def _sweeping(study: sf.Study, path: Path) -> Callable[[], None]:
    def sweep() -> None:
        sf.sweep(study, path)
        path.unlink()

    return sweep


def _steps(study: sf.Study) -> dict[str, Callable[[], None]]:
    """Return the two dearest steps of a sweep of numbers, each alone on all cores."""
    evaluate = Evaluator(study)
    tiles = [study.grid.tile(0, number) for number in range(study.grid.groups[0].tile_count)]
    chunks = [np.array(chunk) for tile in tiles for chunk in evaluate(tile)]

    def computed(tile: Tile) -> None:
        evaluate(tile)

    def computing() -> None:
        with ThreadPoolExecutor(os.cpu_count()) as pool:
            list(pool.map(computed, tiles))

    def compressing() -> None:
        with ThreadPoolExecutor(os.cpu_count()) as pool:
            list(pool.map(encoded, chunks))

    return {"computing": computing, "compressing": compressing}


WORDS = {
    "raw": "h5py, contiguous (finished array)",
    "gzip": "h5py, gzip (finished array)",
    "gzip and shuffle": "h5py, gzip and shuffle, same chunks (finished array)",
    "gzip 1": "h5py, gzip of level 1 and shuffle, same chunks (finished array)",
    "blosc": "hdf5plugin, blosc (finished array; needs the plugin to be read)",
}


def _verdicts(folder: Path) -> Report:
    study = sf.Study.from_toml(ROOT / "studies" / "billion.toml")
    atlas = sf.sweep(study, folder / "whole.h5")
    assert atlas is not None  # noqa: S101 - no part was asked for
    array = np.asarray(atlas["stable"])
    ways = _writers(folder, array, study.grid.groups[0].chunk_shape)
    middle = len(study.axes["knee_stiffness"]) // 2

    def read_h5py() -> None:
        with h5py.File(atlas.path) as file:
            np.count_nonzero(file["stable"][...])

    def slice_h5py() -> None:
        with h5py.File(atlas.path) as file:
            file["stable"][:, middle, :]

    sweep = _sweeping(study, folder / "again.h5")
    seconds = in_turn({"again": sweep, **ways}, ROUNDS)
    # in turn with nothing else, so that memory of the one is at hand for the other
    seconds |= in_turn({"sweep": sweep, "raw": ways["raw"]}, QUICK_ROUNDS)
    seconds |= in_turn(
        {
            "read": lambda: np.count_nonzero(np.asarray(atlas["stable"])),
            "read h5py": read_h5py,
            "slice": lambda: atlas["stable"][:, middle, :],
            "slice h5py": slice_h5py,
        },
        QUICK_ROUNDS,
    )
    work = study.points
    rows = [
        Row(
            "standfast: 10⁹ verdicts computed, certified, stored",
            seconds["sweep"],
            work,
            "points",
            f"{atlas.path.stat().st_size / 1e6:.1f} MB",
        ),
        *(Row(WORDS[way], seconds[way], work, "points") for way in ways),
        Row("Atlas: reading all of it and counting", seconds["read"], work, "points"),
        Row("h5py: reading all of it and counting", seconds["read h5py"], work, "points"),
        Row("Atlas: a plane out of it", seconds["slice"], work / 1000, "points"),
        Row("h5py: a plane out of it", seconds["slice h5py"], work / 1000, "points"),
    ]
    return Report(
        "storing",
        "What does a sweep into a file cost?",
        f"studies/billion.toml and a grid of {SIDE}³ numbers, {os.cpu_count()} cores",
        rows,
        [
            Demand("10⁹ verdicts against h5py's raw write", 2.0, ratio(seconds, "raw", "sweep")),
            Demand("10⁹ verdicts against h5py's gzip", 8.0, ratio(seconds, "gzip", "again")),
            Demand("reading all against h5py", 3.0, ratio(seconds, "read h5py", "read")),
        ],
        [
            "The peers write an array that is already in memory, unsynced. standfast computes, "
            "certifies, compresses, writes shards, syncs them, copies and verifies.",
            "A raw write and a read cost what the system needs to find a gigabyte of memory: from "
            "0.1 s when it has just been freed to 3 s. What is demanded is measured in turn with "
            "its peer alone.",
            "A sweep of numbers is bound by computing and compressing, which share the cores. One "
            "of more than 512 MiB before compression also writes all shards but the last, once "
            "more.",
            "Everything is in the page cache when it is read. What is read is counted through, so "
            "that memory which was never touched is paid for.",
            "h5py's gzip is its default, level 4; level 1, which standfast uses too, is beside it.",
        ],
    )


def _floats(folder: Path, report: Report) -> None:
    """Add numbers: a cheap quantity, a dearer one, and the three eigenvalues."""
    axis = {"start": 400.0, "stop": 3000.0, "num": SIDE}
    for names in (
        ["stability_determinant"],
        ["safety_factor"],
        ["eigenvalue_1", "eigenvalue_2", "eigenvalue_3"],
    ):
        study = sf.Study.from_dict(
            {
                "gravity": 9.8,
                "body": {"model": "edwards2007", "height": 1.753, "mass": 75.3},
                "stiffness": {"ankle": axis, "knee": axis, "hip": axis},
                "output": {"quantities": names},
            }
        )
        path = folder / "numbers.h5"
        atlas = sf.sweep(study, path)
        assert atlas is not None  # noqa: S101 - no part was asked for
        array = np.stack([np.asarray(atlas[name]) for name in names])
        size = path.stat().st_size
        path.unlink()
        ways = _writers(folder, array, (1, *study.grid.groups[0].chunk_shape))
        del ways["gzip"]
        pair = {"sweep": _sweeping(study, path), "gzip and shuffle": ways.pop("gzip and shuffle")}
        seconds = in_turn(pair, ROUNDS) | in_turn({**_steps(study), **ways}, ROUNDS)
        words = " and ".join(names) if len(names) < 3 else "three eigenvalues"
        report.rows.append(
            Row(
                f"standfast: {words}, computed and stored",
                seconds["sweep"],
                study.points,
                "values",
                f"{8 * study.points / size:.2f} : 1",
            )
        )
        report.rows += [
            Row(f"  of which {step}, alone", seconds[step], study.points, "values")
            for step in ("computing", "compressing")
        ]
        report.rows += [
            Row(f"  {WORDS[way]}", seconds[way], study.points, "values")
            for way in ("gzip and shuffle", *ways)
        ]
        report.demands.append(
            Demand(
                f"{words} against h5py's gzip and shuffle",
                10.0,
                ratio(seconds, "gzip and shuffle", "sweep"),
            )
        )


if __name__ == "__main__":
    main()
