"""The one loop, of sweeps and populations: what no shard covers is computed in threads, in order.

Read from the top: :func:`run_job` takes the folder, finds what is missing, estimates, computes,
writes shards, and lets the job assemble the finished file.
"""

import os
import time
from collections import deque
from collections.abc import Callable, Generator, Hashable, Iterable, Iterator, Mapping
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import closing
from itertools import groupby, islice
from pathlib import Path
from typing import Any, Generic, Protocol, TypedDict, TypeVar

import numpy as np

from standfast.errors import InputError
from standfast.run.estimate import Estimate, disk_needed, free_bytes, sample
from standfast.run.folder import RunFolder, tidy_up_after
from standfast.run.log import write_log
from standfast.run.shards import Work, shard_path

# Called after every unit with the values (or persons) done and all of the run.
Progress = Callable[[int, int], None]
# Called with the estimate before the first.
Announce = Callable[[Estimate], None]


class RunOptions(TypedDict, total=False):
    """How a run is done, which changes nothing in its file."""

    threads: int | None
    progress: Progress | None
    estimate: Announce | None


# Batches under way or waiting to be written, for each thread.
AHEAD = 3

Unit = TypeVar("Unit", bound=Hashable)
Piece = TypeVar("Piece")
Result_co = TypeVar("Result_co", covariant=True)


class Job(Protocol[Unit, Piece, Result_co]):
    """What is computed: units, each of which becomes a piece of the result, shard by shard."""

    @property
    def study(self) -> Work:
        """What the result is of."""

    @property
    def what(self) -> str:
        """What is counted: values, or persons."""

    @property
    def threads_a_core(self) -> int:
        """How many threads are started for each core if their number is not given."""

    def units(self, shard: int) -> list[Unit]:
        """Return the units of a shard, in order."""

    def size(self, unit: Unit) -> int:
        """Return how many values or persons a unit is."""

    def kind(self, unit: Unit) -> Hashable:
        """Return what tells units apart that take different times."""

    def batch(self, kind: Hashable) -> int:
        """Return how many units of a kind a thread takes at once."""

    def compute(self, unit: Unit) -> Piece:
        """Compute a unit; called in threads."""

    def stored_bytes(self, unit: Unit, piece: Piece) -> float:
        """Return what a piece takes on the disk."""

    def into_shard(
        self, path: Path | None, shard: int, pieces: Iterable[Piece]
    ) -> Generator[Piece, None, None]:
        """Write the pieces of a shard as they come, unless without a path; hand on what it holds.

        A path is a new shard's temporary file, to be written behind its header.
        """

    def out_of_shard(self, path: Path, shard: int) -> Iterator[Piece]:
        """Read what a finished shard holds."""

    def assemble(self, path: Path, pieces: Iterable[Piece]) -> None:
        """Write the finished file from what all shards hold, in order."""

    def open(self, path: Path) -> Result_co:
        """Open the finished file; refuse any that is not of this study."""

    def log(self) -> Mapping[str, Any]:
        """Return what the log says of this kind of job."""


def run_job(
    job: Job[Unit, Piece, Result_co],
    output: Path,
    part: tuple[int, int] | None,
    options: RunOptions,
) -> Result_co | None:
    """Compute a job into a file, or None of a part; the same call resumes what was broken off.

    Parameters and errors are those of :func:`standfast.sweep` and :func:`standfast.simulate`.
    """
    if output.exists():
        return _already_there(job, output)
    began = time.perf_counter()
    with RunFolder.enter(output, job.study, part=part) as folder:
        if output.exists():  # another run finished it just before this one took the lock
            return _already_there(job, output)
        missing = folder.missing()
        if part is not None:
            missing = [number for number in missing if number % part[1] == part[0] - 1]
        with closing(_Computing(job, missing, options)) as run:
            if missing:
                found = run.estimate(folder, finishes=part is None)
                found.require_room(output, job.what)
                if announce := options.get("estimate"):
                    announce(found)
            computed = run.pieces()
            if part is not None:
                for number in missing:
                    with closing(_new_shard(job, folder, number, computed)) as written:
                        deque(written, maxlen=0)
                return None
            with closing(_all_pieces(job, folder, missing, computed)) as pieces:
                folder.finish(lambda path: job.assemble(path, pieces))
    write_log(output, job.study, job.what, run.total, time.perf_counter() - began, job.log())
    return job.open(output)


def checked_options(
    part: tuple[int, int] | None,
    threads: int | None,
    progress: Progress | None,
    estimate: Announce | None,
) -> RunOptions:
    """Return the options of a run; refuse a number of threads or a share that is none."""
    if threads is not None and threads < 1:
        raise InputError(f"threads = {threads} is not a number of threads; give 1 or more")
    if part is not None and not 1 <= part[0] <= part[1]:
        raise InputError(f"part = {part[0]}/{part[1]} is not a share; give i/N with 1 ≤ i ≤ N")
    return {"threads": threads, "progress": progress, "estimate": estimate}


def _already_there(job: Job[Unit, Piece, Result_co], output: Path) -> Result_co:
    """Return the finished file of this very study; refuse any other."""
    found = job.open(output)
    tidy_up_after(output, job.study)
    return found


def _all_pieces(
    job: Job[Unit, Piece, Result_co],
    folder: RunFolder[Work],
    missing: list[int],
    computed: Iterator[Piece],
) -> Generator[Piece, None, None]:
    """Give what all shards hold, in order; what is computed is put into shards.

    The last goes into the file alone, which is about to be finished.
    """
    to_compute = set(missing)
    for number in range(job.study.shard_count):
        if number not in to_compute:
            yield from job.out_of_shard(shard_path(folder.path, number), number)
        elif number == missing[-1]:
            yield from job.into_shard(None, number, computed)
        else:
            yield from _new_shard(job, folder, number, computed)


def _new_shard(
    job: Job[Unit, Piece, Result_co],
    folder: RunFolder[Work],
    number: int,
    computed: Iterator[Piece],
) -> Generator[Piece, None, None]:
    """Write the next pieces into a shard; hand on what it holds."""
    with folder.new_shard(number) as path:
        yield from job.into_shard(path, number, islice(computed, len(job.units(number))))


class _Computing(Generic[Unit, Piece]):
    """The units of the shards that are missing: estimated, and computed in threads."""

    def __init__(self, job: Job[Unit, Piece, Any], missing: list[int], options: RunOptions) -> None:
        self.job, self.shards = job, len(missing)
        self.threads = options.get("threads") or job.threads_a_core * (os.cpu_count() or 1)
        self.progress = options.get("progress")
        self.units = [unit for number in missing for unit in job.units(number)]
        self.sizes = [job.size(unit) for unit in self.units]
        self.total = sum(self.sizes)
        self._known: dict[Unit, Piece] = {}
        self._pool = ThreadPoolExecutor(self.threads)

    def close(self) -> None:
        """Let go of the threads, and of what they have not begun."""
        self._pool.shutdown(cancel_futures=True)

    def estimate(self, folder: RunFolder[Work], *, finishes: bool) -> Estimate:
        """Compute some units of each kind, evenly spread, and take them for the rest."""
        seconds = size = 0.0
        kinds: dict[Hashable, list[Unit]] = {}
        for unit in self.units:
            kinds.setdefault(self.job.kind(unit), []).append(unit)
        for first, *rest in kinds.values():
            self._known[first] = self._pool.submit(self.job.compute, first).result()  # compiles
            sampled = [rest[number] for number in sample(len(rest))]
            # the median: one of them may compile what is for points in doubt
            timed = [*self._pool.map(self._timed, sampled)]
            seconds += float(np.median(timed or [0.0])) * len(rest) / self.threads
            sizes = [self.job.stored_bytes(unit, self._known[unit]) for unit in (first, *sampled)]
            size += sum(sizes) / len(sizes) * (1 + len(rest))
        stored = folder.stored_bytes
        disk = disk_needed(size, self.shards, stored=stored, finishes=finishes)
        return Estimate(self.total, disk, seconds, free_bytes(folder.path))

    def pieces(self) -> Generator[Piece, None, None]:
        """Compute the units in threads; give their pieces in order."""
        waiting: deque[Future[list[Piece]]] = deque()
        left = self._batches()
        sizes = iter(self.sizes)
        done = 0
        while True:
            for units in islice(left, AHEAD * self.threads - len(waiting)):
                waiting.append(self._pool.submit(self._compute, units))
            if not waiting:
                return
            for piece in waiting.popleft().result():
                done += next(sizes)
                if self.progress is not None:
                    self.progress(done, self.total)
                yield piece

    def _batches(self) -> Iterator[list[Unit]]:
        """Give the units that a thread takes at once."""
        for kind, members in groupby(self.units, self.job.kind):
            while units := list(islice(members, self.job.batch(kind))):
                yield units

    def _compute(self, units: list[Unit]) -> list[Piece]:
        return [
            self._known.pop(unit) if unit in self._known else self.job.compute(unit)
            for unit in units
        ]

    def _timed(self, unit: Unit) -> float:
        began = time.perf_counter()
        self._known[unit] = self.job.compute(unit)
        return time.perf_counter() - began
