"""The loop: what no shard covers goes through the engine, is compressed in threads, and is stored."""

import json
import os
import platform
import shutil
import time
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass
from importlib.metadata import version as version_of
from pathlib import Path

import numpy as np

from standfast.quantities import InputError
from standfast.store import Atlas, Workplace, open_atlas
from standfast.store.layout import compressed
from standfast.study import TILES_PER_SHARD, Study, Tile

# Called with the points done and the points of the whole run, after every tile.
Progress = Callable[[int, int], None]
Announce = Callable[["Forecast"], None]

# Tiles that are computed or compressed ahead of the one being stored.
AHEAD = 4


@dataclass(frozen=True, slots=True)
class Forecast:
    """What a run will take, estimated from a few of its tiles."""

    points: int
    stored_bytes: int
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
) -> Atlas | None:
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
    output = Path(output)
    if part is not None and not 1 <= part[0] <= part[1]:
        raise InputError(f"part = {part[0]}/{part[1]} is not a share; give i/N with 1 ≤ i ≤ N")
    if output.exists():
        return _already_there(study, output)
    from standfast import __version__ as version  # noqa: PLC0415 - the package imports this module

    began = time.perf_counter()
    with Workplace.enter(output, study, version, part=part) as place:
        missing = place.missing()
        if part is not None:
            missing = [number for number in missing if number % part[1] == part[0] - 1]
        if missing:
            run = _Run(study, place, threads or os.cpu_count() or 1, progress)
            run.compute(missing, announce)
        if part is not None:
            return None
        place.finish()
    _write_story(study, output, version, time.perf_counter() - began, len(missing))
    return open_atlas(output)


def _already_there(study: Study, output: Path) -> Atlas:
    """Return the finished atlas of this very study; refuse any other file."""
    atlas = open_atlas(output)
    if atlas.study.fingerprint != study.fingerprint:
        raise InputError(
            f"{output} is the atlas of another study ({study.difference(atlas.study)}); "
            "choose another output with -o or move it away"
        )
    return atlas


class _Run:
    """One run's state: engine, threads, counter."""

    def __init__(
        self, study: Study, place: Workplace, threads: int, progress: Progress | None
    ) -> None:
        from standfast.engine import evaluator  # noqa: PLC0415 - imports JAX, only when computing

        self.study = study
        self.place = place
        self.threads = threads
        self.progress = progress
        self.evaluate = evaluator(study)
        self.done = 0
        self.total = 0

    def compute(self, missing: list[int], announce: Announce | None) -> None:
        """Compute and store the missing shards, one after the other."""
        self.total = sum(self._points(tile) for n in missing for tile in self.study.shard(n))
        forecast = self._forecast(missing)
        if forecast.stored_bytes > forecast.free_bytes:
            raise InputError(
                f"the study needs about {_bytes(forecast.stored_bytes)} of disk while it is "
                f"finished, and {_bytes(forecast.free_bytes)} are free beside {self.place.target}; "
                "take fewer values or another disk"
            )
        if announce is not None:
            announce(forecast)
        with ThreadPoolExecutor(self.threads) as pool, ThreadPoolExecutor(1) as writer:
            written: Future[None] | None = None
            for number in missing:
                packed = self._shard(number, pool)
                if written is not None:
                    written.result()
                written = writer.submit(self.place.write, number, packed)
            if written is not None:
                written.result()

    def _shard(self, number: int, pool: ThreadPoolExecutor) -> list[tuple[Tile, tuple[bytes, ...]]]:
        packed: list[tuple[Tile, tuple[bytes, ...]]] = []
        waiting: list[tuple[Tile, Future[tuple[bytes, ...]]]] = []

        def take() -> None:
            tile, job = waiting.pop(0)
            packed.append((tile, job.result()))
            self.done += self._points(tile)
            if self.progress is not None:
                self.progress(self.done, self.total)

        for tile in self.study.shard(number):
            waiting.append((tile, pool.submit(_pack, self.study, tile, self.evaluate(tile))))
            if len(waiting) > AHEAD * self.threads:
                take()
        while waiting:
            take()
        return packed

    def _forecast(self, missing: list[int]) -> Forecast:
        """Compute three tiles of each group and take them for the rest."""
        seconds = stored = 0.0
        for number, group in enumerate(self.study.groups):
            count = int(np.prod(group.chunks))
            for flat in sorted({0, count // 2, count - 1}):
                chunk = tuple(int(i) for i in np.unravel_index(flat, group.chunks)) if count > 1 else tuple(0 for _ in group.chunks)
                tile = Tile(number, chunk)
                self.evaluate(tile)
                began = time.perf_counter()
                size = sum(map(len, _pack(self.study, tile, self.evaluate(tile))))
                share = count / len({0, count // 2, count - 1})
                seconds += share * (time.perf_counter() - began)
                stored += share * size
        left = len(missing) * TILES_PER_SHARD / max(self.study.tile_count, TILES_PER_SHARD)
        free = shutil.disk_usage(self.place.folder).free
        # shards and the finished file are on disk together, but shards that are there already are
        # counted in what is free
        return Forecast(self.total, int(stored * (1.0 + min(left, 1.0))), seconds * min(left, 1.0), free)

    def _points(self, tile: Tile) -> int:
        group = self.study.groups[tile.group]
        inside = (
            min(side, length - first)
            for side, length, first in zip(
                group.chunk_shape, group.shape, group.start(tile), strict=True
            )
        )
        return int(np.prod([*inside, len(group.quantities)]))


def _pack(study: Study, tile: Tile, arrays: tuple[np.ndarray, ...]) -> tuple[bytes, ...]:
    if study.groups[tile.group].axes:
        return tuple(compressed(array) for array in arrays)
    return tuple(np.asarray(array).tobytes() for array in arrays)


def _bytes(size: float) -> str:
    for unit in ("bytes", "kB", "MB", "GB"):
        if size < 1000.0:
            return f"{size:.3g} {unit}"
        size /= 1000.0
    return f"{size:.3g} TB"


def _write_story(study: Study, output: Path, version: str, seconds: float, shards: int) -> None:
    """Tell the run's story beside the file: what may differ from run to run."""
    story = {
        "study": study.title,
        "study_sha256": study.fingerprint,
        "points": study.points,
        "seconds": round(seconds, 3),
        "points_per_second": round(study.points / seconds) if seconds > 0 else None,
        "shards_computed": shards,
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
    path = output.with_name(output.name.removesuffix(".h5") + ".run.json")
    partial = path.with_name(f".{path.name}.partial")
    partial.write_text(json.dumps(story, indent=2) + "\n", encoding="utf-8")
    partial.replace(path)
