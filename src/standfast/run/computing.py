"""One job's units, computed in threads, in order, and written shard by shard."""

import time
from collections import deque
from collections.abc import Callable, Generator, Hashable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import closing
from itertools import groupby, islice
from pathlib import Path
from typing import Any, Generic, Protocol, TypeVar

import numpy as np

from standfast.errors import InputError
from standfast.run.estimate import Estimate, disk_needed, free_bytes, sample
from standfast.run.folder import RunFolder
from standfast.run.machine import cores
from standfast.run.options import Progress
from standfast.run.shards import Work

# Batches under way or waiting to be written, for each thread.
AHEAD = 3

# What one run plans: 2·10¹² verdicts, or 2.6·10¹¹ numbers, 0.3 GB of plans.
MOST_UNITS = 1_000_000

# What is sent: a function that a worker can import. It gets the text of a job, the output, shard
# numbers, threads and the caller's version; it says which shards it wrote, or what went wrong.
Task = Callable[[str, str, Sequence[int], int, str], list[int] | str]

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

    @property
    def task(self) -> Task:
        """The function that does it elsewhere (:data:`Task`)."""

    @property
    def task_text(self) -> str:
        """What that function makes this job of again."""

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


def new_shard(
    job: Job[Unit, Piece, Result_co],
    folder: RunFolder[Work],
    number: int,
    computed: Iterator[Piece],
) -> Generator[Piece, None, None]:
    """Write the next pieces into a shard; hand on what it holds."""
    with folder.new_shard(number) as path:
        yield from job.into_shard(path, number, islice(computed, len(job.units(number))))


def write_shard(
    job: Job[Unit, Piece, Any], folder: RunFolder[Work], number: int, computed: Iterator[Piece]
) -> None:
    """Write the next pieces into a shard."""
    with closing(new_shard(job, folder, number, computed)) as written:
        deque(written, maxlen=0)


class Computing(Generic[Unit, Piece]):
    """The units of the shards that are missing: estimated, and computed in threads."""

    def __init__(
        self,
        job: Job[Unit, Piece, Any],
        missing: list[int],
        threads: int | None,
        progress: Progress | None = None,
    ) -> None:
        self.job, self.shards = job, len(missing)
        self.threads = threads or job.threads_a_core * cores()
        self.progress = progress
        units = (unit for number in missing for unit in job.units(number))
        self.units = list(islice(units, MOST_UNITS + 1))
        if len(self.units) > MOST_UNITS:
            raise InputError(
                f"{len(missing)} shards are more than one run can plan; share them among many, "
                "as --part i/N or with an executor"
            )
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
