"""Shards computed by others: any executor, on this machine or on many that share a file system.

A task is small text in, shard numbers or a sentence out, and safe to run twice. Nothing that a
worker says is believed: what is done is what lies in the folder, valid. What is missing is sent
again, a few times; what no executor takes any more is left to the caller.
"""

import os
import time
from collections import Counter, deque
from collections.abc import Callable, Sequence
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, Future, wait
from contextlib import closing
from pathlib import Path
from typing import Any

from standfast.errors import InputError
from standfast.run.computing import Computing, Job, write_shard
from standfast.run.estimate import Estimate, disk_needed, free_bytes
from standfast.run.folder import RunFolder, parts_of
from standfast.run.options import RunOptions
from standfast.run.shards import Work, shard_path
from standfast.version import __version__

TRIES = 4  # of one shard
WINDOW = 256  # tasks under way at once
PATIENCE = 1800.0  # s without the end of any task, after which all are sent again
HEARTBEAT = 1.0  # s between calls of progress, so that who is called can stop the run

BORN = os.getpid()  # a process that is forked off has another


class WorkersError(OSError):
    """Workers failed at a shard again and again; the message is what they said last."""


def write_shards(
    job_of: Callable[[str], Job[Any, Any, Any]],
    study: str,
    output: str,
    numbers: Sequence[int],
    threads: int,
    version: str,
) -> list[int] | str:
    """Do a task: write the shards that are missing; what it may say wrong is one sentence."""
    if os.getpid() != BORN:
        return (
            "the executor forks its workers, which JAX does not survive; make it with "
            "ProcessPoolExecutor(mp_context=multiprocessing.get_context('spawn'))"
        )
    if version != __version__:
        return f"a worker has standfast {__version__}, and the caller {version}"
    try:
        job = job_of(study)
        target = Path(output)
        folder = RunFolder(target, job.study, parts_of(target))
        if not folder.is_of_its_study():
            return f"{folder.path} is not there for a worker; do all machines share that folder?"
        for number in folder.missing(numbers):
            with closing(Computing(job, [number], threads)) as run:
                write_shard(job, folder, number, run.pieces())
    except (InputError, OSError, MemoryError) as error:
        return str(error) or type(error).__name__
    return list(numbers)


class Sent:
    """The shards that are with an executor, and those that wait to go there.

    ``left`` are those that do not lie in the folder yet.
    """

    def __init__(
        self,
        job: Job[Any, Any, Any],
        folder: RunFolder[Work],
        missing: list[int],
        options: RunOptions,
        *,
        finishes: bool,
    ) -> None:
        given: Any = options["executor"]
        # of a Dask client the executor, so that there is one way to submit
        self.executor = given.get_executor(pure=False) if hasattr(given, "get_executor") else given
        self.job, self.folder, self.options, self.finishes = job, folder, options, finishes
        self.queue, self.left = deque(missing), set(missing)
        self.sizes = {number: sum(map(job.size, job.units(number))) for number in missing}
        self.total, self.done = sum(self.sizes.values()), 0
        self.tries: Counter[int] = Counter()
        self.waiting: dict[Future[list[int] | str], int] = {}
        self.began = time.perf_counter()

    def close(self) -> None:
        """Call back what no worker has begun."""
        for future in self.waiting:
            future.cancel()

    def wait_for(self, number: int) -> bool:
        """Wait until a shard lies in the folder; False if the executor is broken and leaves it.

        Whatever else ended meanwhile is looked at too, so that the workers never wait for work.

        Raises
        ------
        WorkersError
            if a shard failed as often as it may.
        InputError
            if the result does not fit the disk.
        """
        while self._fill():
            here = number not in self.left
            ended = [each for each in self.waiting if each.done()] if here else self._ended()
            if not ended:
                break
            for future in ended:
                self._take(future)
        return number not in self.left

    def _fill(self) -> bool:
        """Submit what is in the queue, as much as may be under way; return whether any is."""
        output, text = str(self.folder.target.absolute()), self.job.task_text
        threads = self.options.get("threads") or 1
        while self.queue and len(self.waiting) < WINDOW:
            number = self.queue[0]
            try:
                future = self.executor.submit(
                    self.job.task, text, output, (number,), threads, __version__
                )
            except (BrokenExecutor, RuntimeError, ConnectionError):
                break  # it is broken or shut down and takes nothing more
            self.waiting[future] = number
            self.tries[self.queue.popleft()] += 1
        return bool(self.waiting)

    def _ended(self) -> list["Future[list[int] | str]"]:
        """Wait for the end of some tasks; after too long for any, give up all."""
        began = time.monotonic()
        while time.monotonic() < began + PATIENCE:
            beat = min(HEARTBEAT, PATIENCE)
            if done := wait(self.waiting, timeout=beat, return_when=FIRST_COMPLETED).done:
                return list(done)
            self._tell()
        return list(self.waiting)

    def _take(self, future: "Future[list[int] | str]") -> None:
        """Look what became of a task that ended, or seems lost; send it again if it must be."""
        number = self.waiting.pop(future)
        said = _said(future)
        if not self.folder.missing([number]):
            self._count(number)
        elif self.tries[number] < TRIES:
            self.queue.appendleft(number)  # the file waits for it
        else:
            # a worker's own traceback, if there is one, is for whoever looks into a fault of ours
            raise WorkersError(
                f"shard {number} failed {TRIES} times; the last time: {said}"
            ) from _raised(future)

    def _count(self, number: int) -> None:
        first = self.done == 0
        self.left.remove(number)
        self.done += self.sizes[number]
        if first:
            found = self._estimate(number)
            found.require_room(self.folder.target, self.job.what)
            if announce := self.options.get("estimate"):
                announce(found)
        self._tell()

    def _tell(self) -> None:
        if progress := self.options.get("progress"):
            progress(self.done, self.total)

    def _estimate(self, number: int) -> Estimate:
        """Take the first shard that is done for the others, and those that run for the workers."""
        share = self.sizes[number] / self.total
        stored = shard_path(self.folder.path, number).stat().st_size
        content = stored / share
        there = self.folder.stored_bytes
        needed = disk_needed(content, len(self.sizes), stored=there, finishes=self.finishes)
        workers = 1 + sum(future.running() for future in self.waiting)
        seconds = (time.perf_counter() - self.began) * (1.0 / share - 1.0) / workers
        free = free_bytes(self.folder.path) + stored
        return Estimate(self.total, needed, seconds, free)


def _raised(future: "Future[list[int] | str]") -> BaseException | None:
    return future.exception() if future.done() and not future.cancelled() else None


def _said(future: "Future[list[int] | str]") -> str:
    """Return what a task said, or what was said of it, in one line."""
    if not future.done():
        future.cancel()
        return f"no answer for {PATIENCE:.0f} s"
    if future.cancelled():
        return "it was cancelled"
    if (error := future.exception()) is not None:  # a worker that died, a lost connection
        return f"{type(error).__name__}: {error}".splitlines()[0]
    answer = future.result()
    return answer if isinstance(answer, str) else "its shard did not appear"
