"""A billion verdicts, computed and stored, against writing the finished array with h5py.

Answers: what does the sweep into a compressed atlas cost beside plain ``h5py.create_dataset`` of an
array that is already there, and beside h5py's own gzip? Run as ``python benchmarks/billion.py``
(about a minute); writes ``results/billion/README.md``. All are measured in turn in one process, and
the medians and their ratios are what counts.
"""

import os
import platform
import statistics
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np

import standfast as sf

ROOT = Path(__file__).parents[1]
RESULTS = ROOT / "results" / "billion"
ROUNDS = 5


def timed(job: Callable[[Path], object], path: Path) -> float:
    """Return the seconds of a job that makes ``path``; the file is removed."""
    began = time.perf_counter()
    job(path)
    seconds = time.perf_counter() - began
    path.unlink()
    return seconds


def main() -> None:
    """Measure, and write the report."""
    study = sf.Study.from_toml(ROOT / "studies" / "billion.toml")
    with tempfile.TemporaryDirectory(dir=ROOT) as name:
        folder = Path(name)
        before = peak_memory()
        began = time.perf_counter()
        atlas = sf.sweep(study, folder / "first.h5")
        first = time.perf_counter() - began
        memory = peak_memory()
        assert atlas is not None  # noqa: S101 - no part was asked for
        size = atlas.path.stat().st_size
        array = np.asarray(atlas["stable"])

        def write(path: Path, **storage: object) -> None:
            with h5py.File(path, "w") as file:
                file.create_dataset("stable", data=array, **storage)

        chunks = study.groups[0].chunk_shape
        jobs: dict[str, Callable[[Path], object]] = {
            "standfast: compute and store": lambda path: sf.sweep(study, path),
            "h5py, plain (finished array)": write,
            "h5py, gzip (finished array)": lambda path: write(path, compression="gzip"),
            "h5py, gzip 1 + shuffle, same chunks (finished array)": lambda path: write(
                path, compression="gzip", compression_opts=1, shuffle=True, chunks=chunks
            ),
        }
        seconds: dict[str, list[float]] = {what: [] for what in jobs}
        for _ in range(ROUNDS):
            for what, job in jobs.items():
                seconds[what].append(timed(job, folder / "timed.h5"))
    ours = statistics.median(seconds["standfast: compute and store"])
    rows = [
        f"| {what} | {statistics.median(s):.2f} | {min(s):.2f} … {max(s):.2f} "
        f"| {statistics.median(s) / ours:.2f} |"
        for what, s in seconds.items()
    ]
    text = [
        "# A billion verdicts into a file",
        "",
        f"Made by `python benchmarks/billion.py`: standfast {sf.__version__}, Python "
        f"{platform.python_version()}, h5py {h5py.__version__}, {os.cpu_count()} cores, "
        f"{platform.machine()}.",
        f"{study.points:,} verdicts of `studies/billion.toml`; the atlas has {size / 1e6:.2f} MB.",
        f"The first sweep, which imports JAX and compiles, took {first:.2f} s; peak memory of the",
        f"process after it {memory:.0f} MB ({before:.0f} MB before).",
        "",
        f"| what | median of {ROUNDS}, s | range, s | ratio to standfast |",
        "|---|---|---|---|",
        *rows,
        "",
        "The h5py rows write an array that is already in memory and are not synced to the disk;",
        "standfast computes, compresses, writes shards, syncs them, copies and verifies.",
        "",
    ]
    RESULTS.mkdir(parents=True, exist_ok=True)
    (RESULTS / "README.md").write_text("\n".join(text), encoding="utf-8")
    print("\n".join(text))


def peak_memory() -> float:
    """Return the greatest memory this process has held, in MB."""
    import resource  # noqa: PLC0415 - POSIX only

    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e3


if __name__ == "__main__":
    main()
