"""The loop: what no shard covers is computed and compressed in threads, and stored in order."""

import contextlib
import json
import math
import os
import platform
import shutil
import time
from collections import deque
from collections.abc import Callable, Generator, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import closing
from dataclasses import dataclass
from itertools import groupby, islice
from operator import attrgetter
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from standfast.quantities import InputError, in_bytes
from standfast.study import Study, Tile

# h5py and JAX are imported by the functions that use them: `import standfast` stays quick, and
# `standfast.sweep` is this module's function from the start.
if TYPE_CHECKING:
    from standfast.engine import Evaluator
    from standfast.store import Atlas, Workplace

# Called with the values done and the values of the whole run, after every tile.
Progress = Callable[[int, int], None]
Announce = Callable[["Forecast"], None]
Packed = tuple[Tile, tuple[bytes, ...]]

# Jobs under way or waiting to be written, for each thread. A job is one tile, or several of
# verdicts, most of which are known sooner than a thread can be told.
AHEAD = 3
VERDICTS_TOGETHER = 8

# The forecast computes one tile in so many of each group, a few at most.
SAMPLED_SHARE, MOST_SAMPLED = 32, 8

# What a file needs beside its chunks.
LAYOUT_BYTES = 40_000


@dataclass(frozen=True, slots=True)
class Forecast:
    """What a run will take, estimated from some tiles of each group; compiling is not counted."""

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
        how many threads compute and compress (default: as many as cores); the file does not depend
        on it.
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
    from standfast.store import (  # noqa: PLC0415 - imports h5py
        Workplace,
        assemble,
        into_shard,
        open_atlas,
    )

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
        run = _Run(study, missing, threads or os.cpu_count() or 1)
        if missing:
            run.foresee(place, announce, finishes=part is None)
        with closing(run.packed(progress)) as computed:
            if part is not None:
                for number in missing:
                    with closing(into_shard(place, number, _next(computed, study, number))) as made:
                        deque(made, maxlen=0)
                return None
            with closing(_all_chunks(place, missing, computed)) as chunks:
                place.finish(lambda path: assemble(path, study, __version__, chunks))
    with contextlib.suppress(OSError):  # the atlas is whole; its story is a courtesy
        seconds = time.perf_counter() - began
        _write_story(study, output, __version__, seconds, run)
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


def _all_chunks(
    place: "Workplace[Study]", missing: list[int], computed: Iterator[Packed]
) -> Generator[Packed, None, None]:
    """Give the chunks of all shards in canonical order; what is computed is put into shards.

    The last goes into the file alone, which is about to be finished.
    """
    from standfast.store import into_shard, out_of_shard  # noqa: PLC0415 - imports h5py

    to_compute = set(missing)
    for number in range(place.study.shard_count):
        if number not in to_compute:
            yield from out_of_shard(place, number)
        elif number == missing[-1]:
            yield from computed
        else:
            yield from into_shard(place, number, _next(computed, place.study, number))


def _next(computed: Iterator[Packed], study: Study, number: int) -> Iterator[Packed]:
    """Give the chunks of the next shard."""
    return islice(computed, len(study.shard(number)))


class _Run:
    """The tiles of the shards that are missing: foreseen, computed and compressed in threads."""

    def __init__(self, study: Study, missing: list[int], threads: int) -> None:
        self.study, self.threads, self.shards = study, threads, len(missing)
        self.tiles = [tile for number in missing for tile in study.shard(number)]
        self.points = [_points(study, tile) for tile in self.tiles]
        self.total = sum(self.points)
        self._known: dict[Tile, tuple[bytes, ...]] = {}
        self._evaluate: Evaluator | None = None

    @property
    def settled(self) -> int:
        """Verdicts that exact arithmetic had to settle."""
        return 0 if self._evaluate is None else self._evaluate.settled

    def foresee(
        self, place: "Workplace[Study]", announce: Announce | None, *, finishes: bool
    ) -> None:
        """Forecast what the run will take, and see whether it fits the disk."""
        from standfast.engine import Evaluator  # noqa: PLC0415 - imports JAX

        self._evaluate = Evaluator(self.study)
        forecast = self._forecast(place, finishes=finishes)
        if forecast.disk_bytes > forecast.free_bytes:
            raise InputError(
                f"the study needs about {in_bytes(forecast.disk_bytes)} of disk until it is "
                f"finished, and {in_bytes(forecast.free_bytes)} are free beside {place.target}; "
                "take fewer values or another disk"
            )
        if announce is not None:
            announce(forecast)

    def packed(self, progress: Progress | None) -> Generator[Packed, None, None]:
        """Compute and compress the tiles in threads; give them in order."""
        waiting: deque[tuple[list[Tile], Future[list[tuple[bytes, ...]]]]] = deque()
        left = self._jobs()
        points = iter(self.points)
        done = 0
        pool = ThreadPoolExecutor(self.threads)
        try:
            while True:
                for tiles in islice(left, AHEAD * self.threads - len(waiting)):
                    waiting.append((tiles, pool.submit(self._pack_all, tiles)))
                if not waiting:
                    return
                tiles, job = waiting.popleft()
                for tile, packed in zip(tiles, job.result(), strict=True):
                    done += next(points)
                    if progress is not None:
                        progress(done, self.total)
                    yield tile, packed
        finally:
            pool.shutdown(cancel_futures=True)

    def _jobs(self) -> Iterator[list[Tile]]:
        """Give the tiles that a thread takes at once."""
        for group, members in groupby(self.tiles, attrgetter("group")):
            verdicts = self.study.groups[group].quantities == ("stable",)
            count = VERDICTS_TOGETHER if verdicts else 1
            while tiles := list(islice(members, count)):
                yield tiles

    def _pack_all(self, tiles: list[Tile]) -> list[tuple[bytes, ...]]:
        return [self._pack(tile) for tile in tiles]

    def _pack(self, tile: Tile) -> tuple[bytes, ...]:
        from standfast.store.layout import compressed  # noqa: PLC0415 - imports h5py

        assert self._evaluate is not None  # noqa: S101 - foresee() came first
        if tile in self._known:
            return self._known.pop(tile)
        arrays = self._evaluate(tile)
        if self.study.groups[tile.group].axes:
            return tuple(compressed(array) for array in arrays)
        return tuple(np.asarray(array).tobytes() for array in arrays)

    def _forecast(self, place: "Workplace[Study]", *, finishes: bool) -> Forecast:
        """Compute some tiles of each group, evenly spread, and take them for the rest."""
        seconds = size = 0.0
        with ThreadPoolExecutor(self.threads) as pool:
            for _, members in groupby(self.tiles, attrgetter("group")):
                first, *rest = members
                self._known[first] = self._pack(first)  # compiles
                count = len(rest)
                wanted = min(MOST_SAMPLED, -(-count // SAMPLED_SHARE))
                sample = [rest[(2 * i + 1) * count // (2 * wanted)] for i in range(wanted)]
                # the median: one of them may compile what is for points in doubt
                timed = [*pool.map(self._timed, sample)]
                seconds += float(np.median(timed or [0.0])) * count / self.threads
                sizes = [sum(map(len, self._known[tile])) for tile in (first, *sample)]
                size += sum(sizes) / len(sizes) * (1 + count)
        # all shards but the last that is computed lie beside the file until it is finished
        made = self.shards - 1 if finishes else self.shards
        disk = size * made / self.shards + LAYOUT_BYTES * made
        if finishes:
            disk += size + place.stored_bytes + LAYOUT_BYTES
        return Forecast(self.total, int(disk), seconds, shutil.disk_usage(place.folder).free)

    def _timed(self, tile: Tile) -> float:
        began = time.perf_counter()
        self._known[tile] = self._pack(tile)
        return time.perf_counter() - began


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


def _write_story(study: Study, output: Path, version: str, seconds: float, run: "_Run") -> None:
    """Tell the run's story beside the file: what may differ from run to run."""
    from importlib.metadata import version as version_of  # noqa: PLC0415 - a tenth of --help

    story = {
        "study": study.title,
        "study_sha256": study.fingerprint,
        "values": study.points,
        "seconds": round(seconds, 3),
        "values_computed_in_this_run": run.total,
        "values_per_second": round(run.total / seconds),
        "verdicts_settled_by_exact_arithmetic": run.settled,
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
