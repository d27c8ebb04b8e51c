"""The simulation of a population: blocks of persons, counted in threads, into a file."""

import dataclasses
import json
from collections.abc import Generator, Hashable, Iterable, Iterator, Mapping, Sequence
from functools import lru_cache
from pathlib import Path
from typing import Any, TypeAlias, Unpack, overload

import h5py
import numpy as np

from standfast.atlas.writer import new_file, reserve
from standfast.engine.memory import keep_freed_memory
from standfast.errors import InputError
from standfast.files import checked_path
from standfast.population.cohort.cohort import Cohort, cohort_of
from standfast.population.cohort.counting import (
    Block,
    Counts,
    count_block,
    histogram_shapes,
    is_detailed,
)
from standfast.population.cohort.histograms import Histograms
from standfast.population.people.records import People
from standfast.population.people.study import PopulationStudy
from standfast.population.summary.file import Population, open_population
from standfast.population.summary.keeping import identities, new_persons
from standfast.population.summary.sensitivity import drivers_of
from standfast.population.summary.summary import Summary
from standfast.population.summary.writing import write_summary
from standfast.run.computing import Task
from standfast.run.loop import run_job
from standfast.run.options import Announce, Executor, Progress, RunOptions, checked_options
from standfast.run.shards import HEADER_BYTES
from standfast.run.workers import write_shards
from standfast.study.study import study_given

# What a study may be given as: itself, the path of its file, or its content.
GivenPopulation: TypeAlias = PopulationStudy | str | Path | Mapping[str, Any]


@overload
def simulate(
    study: GivenPopulation,
    output: str | Path,
    *,
    part: None = None,
    strict: bool = False,
    **options: Unpack[RunOptions],
) -> Population: ...


@overload
def simulate(
    study: GivenPopulation,
    output: str | Path,
    *,
    part: tuple[int, int],
    strict: bool = False,
    **options: Unpack[RunOptions],
) -> None: ...


def simulate(
    study: GivenPopulation,
    output: str | Path,
    *,
    part: tuple[int, int] | None = None,
    strict: bool = False,
    threads: int | None = None,
    progress: Progress | None = None,
    estimate: Announce | None = None,
    executor: Executor | None = None,
) -> Population | None:
    """Simulate a population into a file; the same call resumes what was broken off.

    Parameters
    ----------
    study, output
        who and how many (a study, the path of its file, or its content; files of people are then
        relative to that file, or to the working folder), and the file to write.
    part
        ``(i, N)`` counts the i-th of N shares, 1 ≤ i ≤ N, and finishes nothing.
    strict
        stop at the first row of a file of people that cannot be used.
    threads, progress, estimate, executor
        as of :func:`standfast.sweep`, with persons in place of values; workers read the files of
        people by the same paths.

    Returns
    -------
    The finished population; None after a part.

    Raises
    ------
    InputError
        if the people cannot be read, or the output belongs to another study or another run.
    OSError
        if the disk does not take it, or workers fail again and again; what is done stays and the
        same call goes on.

    Examples
    --------
    >>> import standfast as sf
    >>> study = {
    ...     "population": {"builtin": "nhanes-2017-2018", "size": 2000, "seed": 1},
    ...     "stiffness": {
    ...         "ankle": {"distribution": "fixed", "relative_to": "mgh", "value": 1.2},
    ...         "knee": {"distribution": "fixed", "value": float("inf")},
    ...         "hip": {"distribution": "fixed", "value": 600},
    ...     },
    ... }
    >>> population = sf.simulate(study, "adults.h5")
    >>> print(f"{100 * population.summary['unstable_fraction']:.1f} % would fall")
    2.8 % would fall
    """
    options = checked_options(part, threads, progress, estimate, executor)
    path, study = checked_path("output", output), _study_of(study)
    job = _Simulation(study, study.read_people(strict=strict))
    return run_job(job, path, part, options)


def _study_of(given: GivenPopulation) -> PopulationStudy:
    """Return a study that is given as one, as the path of its file, or as its content."""
    words = "is no study of a population; give a PopulationStudy"
    found: PopulationStudy = study_given(PopulationStudy, given, words)
    return found


def simulate_shards(
    study: str, output: str, numbers: Sequence[int], threads: int, version: str
) -> list[int] | str:
    """Count shards where an executor sends them (:class:`standfast.run.computing.Task`)."""
    return write_shards(_simulation_of, study, output, numbers, threads, version)


@lru_cache(maxsize=1)  # a worker reads the people and compiles once
def _simulation_of(text: str) -> "_Simulation":
    content = json.loads(text)
    study = PopulationStudy.from_canonical(content["study"])
    study = dataclasses.replace(study, files=tuple(map(Path, content["files"])))
    return _Simulation(study, study.read_people())


class _Simulation:
    """A population as the loop takes it: a unit is a block of persons, a piece its counts.

    A shard holds the sums of its blocks, then what was kept of every person, block by block.
    """

    what = "persons"
    threads_a_core = 2  # one that waits for compiled code leaves its core to another

    def __init__(self, study: PopulationStudy, people: People | None) -> None:
        keep_freed_memory()
        self.study = study
        files = [str(path.absolute()) for path in study.files]
        self.task_text = json.dumps({"study": study.canonical, "files": files})
        self.cohort: Cohort = cohort_of(study, people)

    @property
    def task(self) -> Task:
        return simulate_shards

    def units(self, shard: int) -> list[Block]:
        replicate, numbers = self.study.shards[shard]
        return [Block(replicate, number) for number in numbers]

    def size(self, unit: Block) -> int:
        return self.study.block_persons(unit.number)

    def kind(self, unit: Block) -> Hashable:
        return is_detailed(self.study, unit)

    def batch(self, _kind: Hashable) -> int:
        return 1

    def compute(self, unit: Block) -> Counts:
        return count_block(self.study, self.cohort, unit)

    def stored_bytes(self, _unit: Block, piece: Counts) -> float:
        return self._empty().nbytes / len(self.study.shards[0][1]) + len(piece.kept)

    def into_shard(
        self, path: Path | None, _shard: int, pieces: Iterable[Counts]
    ) -> Generator[Counts, None, None]:
        together, kept = self._empty(), []
        for piece in pieces:
            together.add(piece.histograms)
            kept.append(piece.kept)
        whole = Counts(vars(together), b"".join(kept))
        if path is not None:
            with path.open("wb") as file:
                file.seek(HEADER_BYTES)
                file.write(together.to_bytes() + whole.kept)
        yield whole

    def out_of_shard(self, path: Path, shard: int) -> Iterator[Counts]:
        content = path.read_bytes()[HEADER_BYTES:]
        blocks = self.study.shards[shard][1] if self.study.keeps_persons else ()
        kept = 8 * len(self.cohort.kept) * sum(map(self.study.block_persons, blocks))
        if len(content) != self._empty().nbytes + kept:
            raise InputError(f"{path} is not of its size; remove it, the same command then goes on")
        histograms = Histograms.from_bytes(content, *histogram_shapes(self.cohort))
        yield Counts(vars(histograms), content[histograms.nbytes :])

    def assemble(self, path: Path, pieces: Iterable[Counts]) -> None:
        study, start = self.study, 0
        replicates = [self._empty() for _ in range(study.replicates)]
        with new_file(path) as file:
            if study.keeps_persons:
                new_persons(file, study, self.cohort.model.kept, self.cohort.people)
            for (replicate, numbers), piece in zip(study.shards, pieces, strict=True):
                replicates[replicate].add(piece.histograms)
                if study.keeps_persons:
                    start = self._write_persons(file, start, numbers, piece.kept)
            drivers = drivers_of(self.cohort, study.seed)
            write_summary(file, study, Summary(study, self.cohort, replicates, drivers))

    def _write_persons(self, file: h5py.File, start: int, blocks: range, kept: bytes) -> int:
        """Write what was kept of the persons of a shard's blocks; return where the next begin."""
        at, names, cohort = 0, self.cohort.kept, self.cohort
        reserve(file, len(kept))
        for block in blocks:
            size = self.study.block_persons(block)
            end = at + 8 * len(names) * size
            columns = np.frombuffer(kept[at:end], np.float64).reshape(len(names), size)
            found = dict(zip(names, columns, strict=True))
            told = {f"person_{name}": found[name] for name in cohort.model.kept}
            told |= identities(self.study, cohort.strata, cohort.people, found)
            for name, column in told.items():
                file[name][start : start + size] = column
            start, at = start + size, end
        return start

    def _empty(self) -> Histograms:
        return Histograms.empty(*histogram_shapes(self.cohort))

    def open(self, path: Path) -> Population:
        found = open_population(path)
        if found.study.fingerprint != self.study.fingerprint:
            raise InputError(
                f"{path} is of another study ({self.study.difference(found.study)}); "
                "choose another output, or move or remove it"
            )
        return found

    def log(self) -> dict[str, Any]:
        return {"persons": self.study.size}
