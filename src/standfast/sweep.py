"""The loop: what no shard covers goes through the engine, is compressed in threads and stored."""

import contextlib
import json
import math
import os
import platform
import shutil
import time
from collections import deque
from collections.abc import Callable, Iterable
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass
from importlib.metadata import version as version_of
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from standfast.quantities import InputError, in_bytes
from standfast.study import Study, Tile

# h5py and JAX are imported by the functions that use them: `import standfast` stays quick, and
# `standfast.sweep` is this module's function from the start.
if TYPE_CHECKING:
    from standfast.store import Atlas, Workplace

# Called with the values done and the values of the whole run, after every tile.
Progress = Callable[[int, int], None]
Announce = Callable[["Forecast"], None]
Evaluate = Callable[[Tile], tuple[np.ndarray, ...]]
Packed = tuple[Tile, tuple[bytes, ...]]

# Tiles computed ahead of those being compressed, for each thread that compresses.
AHEAD = 2

# The forecast computes one tile in so many of each group, a few at most: they are computed again.
SAMPLED_SHARE, MOST_SAMPLED = 16, 8

# What a file needs beside its chunks.
LAYOUT_BYTES = 40_000


@dataclass(frozen=True, slots=True)
class Forecast:
    """What a run will take, estimated from some tiles of each group, once they are compiled."""

    points: int
    disk_bytes: int
    seconds: float
    free_bytes: int


def sweep(
    study: Study,
    output: str | Path,
    *,
    threads: int | None = None,
    part: tuple[int, int] | None = None,
    progress: Progress | None = None,
    announce: Announce | None = None,
) -> "Atlas | None":
    """Compute a study into an atlas file; the same call resumes what was broken off.

    Parameters
    ----------
    study, output
        what to compute, and the file to write.
    threads
        how many threads compress (default: as many as cores). The file does not depend on it.
    part
        ``(i, N)`` computes the i-th of N shares of the shards, 1 ≤ i ≤ N, and finishes nothing; a
        call without ``part`` does what is left.
    progress, announce
        called after every tile, and once with the forecast before the first.

    Returns
    -------
    The finished atlas; None after a part.

    Raises
    ------
    InputError
        if the output belongs to another study or another run, or the study does not fit the disk.
    OSError
        if the disk fills up after all; what is done stays and the same call goes on.
    """
    from standfast import __version__  # noqa: PLC0415 - the package imports this module
    from standfast.store import Workplace, assemble, open_atlas  # noqa: PLC0415 - imports h5py

    output = Path(output)
    if threads is not None and threads < 1:
        raise InputError(f"threads = {threads} is not a number of threads; give 1 or more")
    if part is not None and not 1 <= part[0] <= part[1]:
        raise InputError(f"part = {part[0]}/{part[1]} is not a share; give i/N with 1 ≤ i ≤ N")
    if output.exists():
        return _already_there(study, open_atlas(output))
    began = time.perf_counter()
    with Workplace.enter(output, study, __version__, part=part) as place:
        if output.exists():  # another run finished it just before this one took the lock
            return _already_there(study, open_atlas(output))
        missing = place.missing()
        if part is not None:
            missing = [number for number in missing if number % part[1] == part[0] - 1]
        values = sum(_points(study, tile) for number in missing for tile in study.shard(number))
        settled = 0
        if missing:
            workers = threads or os.cpu_count() or 1
            settled = _compute(study, place, missing, values, workers, progress, announce)
        if part is not None:
            return None
        place.finish(lambda partial: assemble(place, partial))
    with contextlib.suppress(OSError):  # the atlas is whole; its story is a courtesy
        seconds = time.perf_counter() - began
        _write_story(study, output, __version__, seconds, values, settled)
    return open_atlas(output)


def _already_there(study: Study, atlas: "Atlas") -> "Atlas":
    """Return the finished atlas of this very study; refuse any other."""
    from standfast.store import tidy_up_after  # noqa: PLC0415 - imports h5py

    if atlas.study.fingerprint != study.fingerprint:
        raise InputError(
            f"{atlas.path} is the atlas of another study ({study.difference(atlas.study)}); "
            "choose another output or move it away"
        )
    tidy_up_after(atlas.path, study)
    return atlas


def _compute(
    study: Study,
    place: "Workplace[Study]",
    missing: list[int],
    total: int,
    threads: int,
    progress: Progress | None,
    announce: Announce | None,
) -> int:
    """Compute the missing shards, ``total`` values; one is written while the next is computed.

    Returns how many verdicts exact arithmetic had to settle.
    """
    from standfast.engine import Evaluator  # noqa: PLC0415 - imports JAX

    evaluate = Evaluator(study)
    forecast = _forecast(study, evaluate, place.folder, total)
    known = evaluate.settled  # of the forecast's tiles, which are computed again
    if forecast.disk_bytes > forecast.free_bytes:
        raise InputError(
            f"the study needs about {in_bytes(forecast.disk_bytes)} of disk until it is finished, "
            f"and {in_bytes(forecast.free_bytes)} are free beside {place.target}; "
            "take fewer values or another disk"
        )
    if announce is not None:
        announce(forecast)
    done = 0
    with ThreadPoolExecutor(threads) as pool, ThreadPoolExecutor(1) as writer:
        written: Future[None] | None = None
        for number in missing:
            packed = []
            for tile, chunks in _packed(study, study.shard(number), evaluate, pool, threads):
                packed.append((tile, chunks))
                done += _points(study, tile)
                if progress is not None:
                    progress(done, total)
            if written is not None:
                written.result()
            written = writer.submit(_write, place, number, packed)
        if written is not None:
            written.result()
    return evaluate.settled - known


def _write(place: "Workplace[Study]", number: int, packed: list[Packed]) -> None:
    from standfast.store.chunks import shard_image  # noqa: PLC0415 - imports h5py

    place.write(number, shard_image(place.study, place.version, packed))


def _packed(
    study: Study,
    tiles: Iterable[Tile],
    evaluate: Evaluate,
    pool: ThreadPoolExecutor,
    threads: int,
) -> Iterable[Packed]:
    """Compute tiles here and compress them in the pool; give them back in order."""
    waiting: deque[tuple[Tile, Future[tuple[bytes, ...]]]] = deque()
    for tile in tiles:
        waiting.append((tile, pool.submit(_pack, study, tile, evaluate(tile))))
        if len(waiting) > AHEAD * threads:
            oldest, job = waiting.popleft()
            yield oldest, job.result()
    for oldest, job in waiting:
        yield oldest, job.result()


def _pack(study: Study, tile: Tile, arrays: tuple[np.ndarray, ...]) -> tuple[bytes, ...]:
    from standfast.store.layout import compressed  # noqa: PLC0415 - imports h5py

    if study.groups[tile.group].axes:
        return tuple(compressed(array) for array in arrays)
    return tuple(np.asarray(array).tobytes() for array in arrays)


def _forecast(study: Study, evaluate: Evaluate, folder: Path, total: int) -> Forecast:
    """Compute some tiles of each group, evenly spread, and take them for the rest."""
    seconds = size = 0.0
    for index, group in enumerate(study.groups):
        count = group.tile_count
        wanted = min(MOST_SAMPLED, 1 + count // SAMPLED_SHARE)
        sample = [(2 * i + 1) * count // (2 * wanted) for i in range(wanted)]
        evaluate(study.tile(index, 0))  # compiles
        for number in sample:
            tile = study.tile(index, number)
            began = time.perf_counter()
            size += sum(map(len, _pack(study, tile, evaluate(tile)))) * count / len(sample)
            seconds += (time.perf_counter() - began) * count / len(sample)
    share = total / study.points
    # shards and the finished file are on the disk together for a moment
    stored = size + LAYOUT_BYTES
    shards = size * share + LAYOUT_BYTES * study.shard_count
    return Forecast(total, int(stored + shards), seconds * share, shutil.disk_usage(folder).free)


def _points(study: Study, tile: Tile) -> int:
    """Count the values of a tile that lie inside the grid."""
    group = study.groups[tile.group]
    inside = (
        min(side, length - first)
        for side, length, first in zip(
            group.chunk_shape, group.shape, group.start(tile), strict=True
        )
    )
    return math.prod(inside) * len(group.quantities)


def _write_story(
    study: Study, output: Path, version: str, seconds: float, values: int, settled: int
) -> None:
    """Tell the run's story beside the file: what may differ from run to run."""
    story = {
        "study": study.title,
        "study_sha256": study.fingerprint,
        "values": study.points,
        "seconds": round(seconds, 3),
        "values_computed_in_this_run": values,
        "values_per_second": round(values / seconds),
        "verdicts_settled_by_exact_arithmetic": settled,
        "shards": study.shard_count,
        "bytes_before_compression": study.raw_bytes,
        "bytes": output.stat().st_size,
        "finished": time.strftime("%Y-%m-%dT%H:%M:%S%z"),
        "machine": platform.machine(),
        "system": platform.system(),
        "cores": os.cpu_count(),
        "python": platform.python_version(),
        "versions": {
            "standfast": version,
            **{name: version_of(name) for name in ("jax", "numpy", "h5py", "isal")},
        },
    }
    path = output.with_name(f"{output.name.removesuffix('.h5')}.run.json")
    partial = path.with_name(f".{path.name}.partial")
    partial.write_text(json.dumps(story, indent=2) + "\n", encoding="utf-8")
    partial.replace(path)
