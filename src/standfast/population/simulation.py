"""The loop over a population: blocks of persons, counted in threads, shard by shard."""

import os
import threading
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_EXCEPTION, ThreadPoolExecutor, wait
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from standfast.engine import over_persons
from standfast.population.crowd import Crowd, crowd_of
from standfast.population.drivers import find_drivers
from standfast.population.persons import growth, outcome
from standfast.population.study import PopulationStudy
from standfast.population.tally import Tally, bin_of, cell, counted, load_sums, places
from standfast.quantities import InputError

if TYPE_CHECKING:
    from standfast.population.report import Population

# Called with the persons done and all persons, after every block.
Progress = Callable[[int, int], None]

# Of so many persons the distributions are kept: more of them would add no digit that any model of
# standing bears, and the rest are only asked whether they fall.
DETAILED = 2**20

# Of those who fall in a block, at most so many have their growth rate computed.
MOST_FALLS = 8192

# What is kept of every person when asked, beside whether they stand.
KEPT = (
    "height",
    "mass",
    "ankle_stiffness",
    "knee_stiffness",
    "hip_stiffness",
    "safety_factor",
    "stable",
)


def simulate(
    study: PopulationStudy,
    output: str | Path,
    *,
    threads: int | None = None,
    part: tuple[int, int] | None = None,
    strict: bool = False,
    progress: Progress | None = None,
) -> "Population | None":
    """Simulate a population into a file; the same call resumes what was broken off.

    Parameters
    ----------
    study, output
        who and how many, and the file to write.
    threads
        how many threads count (default: as many as cores). The file does not depend on it.
    part
        ``(i, N)`` counts the i-th of N shares, 1 ≤ i ≤ N, and finishes nothing.
    strict
        stop at the first row of a file of people that cannot be used.
    progress
        called after every block with the persons done and all persons.

    Returns
    -------
    The finished population; None after a part.

    Raises
    ------
    InputError
        if the people cannot be read, or the output belongs to another study or another run.
    OSError
        if the disk does not take it; what is done stays and the same call goes on.
    """
    from standfast import __version__  # noqa: PLC0415 - the package imports this module
    from standfast.population.report import write_population  # noqa: PLC0415 - imports h5py
    from standfast.store import Workplace  # noqa: PLC0415 - imports h5py

    output = Path(output)
    if threads is not None and threads < 1:
        raise InputError(f"threads = {threads} is not a number of threads; give 1 or more")
    if part is not None and not 1 <= part[0] <= part[1]:
        raise InputError(f"part = {part[0]}/{part[1]} is not a share; give i/N with 1 ≤ i ≤ N")
    people = study.read_people(strict=strict)
    if not output.exists():
        with Workplace.enter(output, study, __version__, part=part) as place:
            if output.exists():  # another run finished it just before this one took the lock
                return _already_there(output, study)
            crowd = crowd_of(study, people)
            missing = place.missing()
            if part is not None:
                missing = [number for number in missing if number % part[1] == part[0] - 1]
            counted = _counted(study, crowd, missing, threads, progress)
            for number, content in zip(missing, counted, strict=True):
                place.write(number, content)
            if part is not None:
                return None
            drivers = find_drivers(crowd, study.seed)
            place.finish(partial(write_population, place, crowd, drivers))
    return _already_there(output, study)


def _already_there(output: Path, study: PopulationStudy) -> "Population":
    """Return the finished population of this very study; refuse any other."""
    from standfast.population.report import open_population  # noqa: PLC0415 - imports h5py
    from standfast.store import tidy_up_after  # noqa: PLC0415 - imports h5py

    found = open_population(output)
    if found.study.fingerprint != study.fingerprint:
        raise InputError(
            f"{output} is of another study ({study.difference(found.study)}); "
            "choose another output, or move or remove it"
        )
    tidy_up_after(output, study)
    return found


def tally_shapes(crowd: Crowd) -> tuple[int, int]:
    """Return the sizes of a tally: strata, and rows of a file of people."""
    return len(crowd.strata), crowd.rows


def _counted(
    study: PopulationStudy,
    crowd: Crowd,
    numbers: Sequence[int],
    threads: int | None,
    progress: Progress | None,
) -> Iterator[bytes]:
    """Count the persons of some shards; give the content of each shard."""
    # a thread that waits for the compiled kernel leaves its core to another
    workers = WAITING * (threads or os.cpu_count() or 1)
    total = sum(study.block_persons(b) for n in numbers for b in study.shards[n][1])
    done = 0
    stop = threading.Event()
    with ThreadPoolExecutor(workers) as pool:
        try:
            for number in numbers:
                replicate, blocks = study.shards[number]
                shares = [_Share(study, crowd, replicate, stop) for _ in range(workers)]
                # one iterator for all: who is done first takes the next block
                left = iter(blocks)
                jobs = {pool.submit(share.count, left) for share in shares}
                while jobs:
                    finished, jobs = wait(jobs, timeout=REFRESH, return_when=FIRST_EXCEPTION)
                    for job in finished:
                        job.result()
                    if progress is not None:
                        progress(done + sum(share.done for share in shares), total)
                done += sum(share.done for share in shares)
                yield _together(shares)
        finally:
            stop.set()


WAITING = 2
REFRESH = 0.1  # s between two looks at the progress


class _Share:
    """One thread's share of a shard: some of its blocks, and what was counted in them."""

    def __init__(
        self, study: PopulationStudy, crowd: Crowd, replicate: int, stop: threading.Event
    ) -> None:
        self.study, self.crowd, self.replicate, self.stop = study, crowd, replicate, stop
        self.tally = Tally.empty(*tally_shapes(crowd))
        self.load_sums: dict[int, np.ndarray] = {}
        self.kept: dict[int, bytes] = {}
        self.done = 0

    def count(self, blocks: Iterator[int]) -> None:
        """Draw and count the persons of blocks, as long as there are any."""
        study, crowd, tally = self.study, self.crowd, self.tally
        for block in blocks:
            if self.stop.is_set():
                return
            scores = crowd.sampler.scores(self.replicate, block, study.block_size)
            numbers = crowd.numbers(scores)
            size = study.block_persons(block)
            if block * study.block_size * study.replicates < DETAILED:
                found = over_persons(places, crowd.model, crowd.names)(numbers)
                tally.count_details(found, size)
                self.load_sums[block] = load_sums(found, size)
                self._count_growth(numbers, found["cell"][:size] & 1)
            else:
                found = over_persons(cell, crowd.model, crowd.names)(numbers)
            tally.count_cells(found["cell"], size)
            if crowd.rows:
                fallen = found["cell"][:size] & 1
                tally.count_rows(2 * crowd.rows_of(scores)[:size] + fallen)
            if study.keeps_persons:
                self.kept[block] = self._persons(numbers, size)
            self.done += size

    def _count_growth(self, numbers: np.ndarray, fallen: np.ndarray) -> None:
        """Count the growth rates of the first who fall."""
        rows = np.flatnonzero(fallen)[:MOST_FALLS]
        if rows.size:
            padded = np.resize(rows, MOST_FALLS)
            of_falls = over_persons(growth, self.crowd.model, self.crowd.names)
            rates = of_falls(np.ascontiguousarray(numbers[:, padded]))["growth_rate"]
            self.tally.growth_rate += counted(bin_of(rates[: rows.size]))

    def _persons(self, numbers: np.ndarray, size: int) -> bytes:
        """Return what is kept of every person, as columns of float64."""
        found = over_persons(outcome, self.crowd.model, self.crowd.names)(numbers)
        return np.array([found[name][:size] for name in KEPT], np.float64).tobytes()


def _together(shares: Sequence[_Share]) -> bytes:
    """Put the shares of a shard together; sums of loads in the order of the blocks."""
    first, *others = shares
    for other in others:
        first.tally.add(other.tally)
        first.load_sums |= other.load_sums
        first.kept |= other.kept
    for block in sorted(first.load_sums):
        first.tally.load_sums += first.load_sums[block]
    return first.tally.to_bytes() + b"".join(first.kept[block] for block in sorted(first.kept))
