"""The sweep of a study into an atlas file: its tiles, computed and encoded in threads."""

from collections.abc import Generator, Hashable, Iterable, Iterator, Sequence
from functools import cached_property, lru_cache
from pathlib import Path
from typing import Any, Unpack, overload

import numpy as np

from standfast.atlas.encoding import encoded, encoded_constant
from standfast.atlas.opening import open_atlas
from standfast.atlas.reader import Atlas
from standfast.atlas.writer import EncodedTile, read_chunks, write_atlas, write_chunks
from standfast.engine.grid import Evaluator
from standfast.engine.own import check_own, own_quantities
from standfast.errors import InputError
from standfast.files import checked_path
from standfast.run.computing import Task
from standfast.run.loop import run_job
from standfast.run.options import Announce, Executor, Progress, RunOptions, checked_options
from standfast.run.shards import HEADER_BYTES
from standfast.run.workers import write_shards
from standfast.study.grid import Group, Tile
from standfast.study.study import GivenStudy, Study

# Tiles that a thread takes at once: most of verdicts are known sooner than a thread can be told.
STEPS_TOGETHER = 8


@overload
def sweep(
    study: GivenStudy, output: str | Path, *, part: None = None, **options: Unpack[RunOptions]
) -> Atlas: ...


@overload
def sweep(
    study: GivenStudy, output: str | Path, *, part: tuple[int, int], **options: Unpack[RunOptions]
) -> None: ...


def sweep(
    study: GivenStudy,
    output: str | Path,
    *,
    part: tuple[int, int] | None = None,
    threads: int | None = None,
    progress: Progress | None = None,
    estimate: Announce | None = None,
    executor: Executor | None = None,
) -> Atlas | None:
    """Compute a study into an atlas file; the same call resumes what was broken off.

    Parameters
    ----------
    study, output
        what to compute (a study, the path of its file, or its content as :meth:`.Study.from_dict`
        takes it), and the file to write.
    part
        ``(i, N)`` computes the i-th of N shares of the shards, 1 ≤ i ≤ N, and finishes nothing; a
        call without ``part`` does what is left.
    threads
        how many threads compute and compress (default: as many as cores, in a worker of an
        executor 1); the file does not depend on it.
    progress, estimate
        called after every tile with the values done and all, and once before the first with what
        the run will take (:class:`standfast.run.estimate.Estimate`); with an executor after every
        shard, and after the first.
    executor
        who computes the shards: any ``concurrent.futures.Executor`` whose workers are processes
        that are not forked, or a ``dask.distributed.Client``. All need the output's folder.

    Returns
    -------
    The finished atlas; None after a part.

    Raises
    ------
    InputError
        if the output belongs to another study or another run, the study does not fit the disk, or
        a quantity of one's own is not one number a person, or is sent to an executor.
    OSError
        if the disk fills up after all, or workers fail again and again; what is done stays and the
        same call goes on.

    Examples
    --------
    >>> import standfast as sf
    >>> atlas = sf.sweep("study.toml", "study.h5")
    >>> atlas["stable"].dims, atlas["stable"].shape
    (('ankle_stiffness', 'hip_stiffness'), (2, 3))
    """
    options = checked_options(part, threads, progress, estimate, executor)
    path = checked_path("output", output)
    study = Study.of(study)
    check_own(study)
    if executor is not None:
        _refuse_own(study)
    return run_job(_Sweep(study), path, part, options)


def _refuse_own(study: Study) -> None:
    if own := own_quantities(study):
        raise InputError(
            f"{own[0]} is a quantity of your own, which workers of an executor do not know; "
            "leave out executor (part = (i, N) shares a sweep among programs that add it)"
        )


def sweep_shards(
    study: str, output: str, numbers: Sequence[int], threads: int, version: str
) -> list[int] | str:
    """Compute shards where an executor sends them (:class:`standfast.run.computing.Task`)."""
    return write_shards(_sweep_of, study, output, numbers, threads, version)


@lru_cache(maxsize=1)  # a worker compiles once
def _sweep_of(canonical: str) -> "_Sweep":
    return _Sweep(Study.from_canonical(canonical))


class _Sweep:
    """A sweep as the loop takes it: a unit is a tile, a piece its encoded chunks."""

    what = "values"
    threads_a_core = 1

    def __init__(self, study: Study) -> None:
        self.study = study
        self.task_text = study.canonical

    @cached_property
    def _evaluate(self) -> Evaluator:
        return Evaluator(self.study)

    @property
    def task(self) -> Task:
        return sweep_shards

    def units(self, shard: int) -> list[Tile]:
        return self.study.grid.shard(shard)

    def size(self, unit: Tile) -> int:
        return self.study.grid.values_of(unit)

    def kind(self, unit: Tile) -> Hashable:
        return self.study.grid.groups[unit.group]

    def batch(self, kind: Hashable) -> int:
        return STEPS_TOGETHER if isinstance(kind, Group) and kind.by_steps else 1

    def compute(self, unit: Tile) -> EncodedTile:
        group = self.study.grid.groups[unit.group]
        value = self._evaluate.uniform(unit)
        if value is not None and group.axes:
            chunk = encoded_constant(group.dtype.str, int(value), int(np.prod(group.chunk_shape)))
            return EncodedTile(unit, (chunk,))
        arrays = self._evaluate(unit)
        if group.axes:
            return EncodedTile(unit, tuple(encoded(array) for array in arrays))
        return EncodedTile(unit, tuple(np.asarray(array).tobytes() for array in arrays))

    def stored_bytes(self, unit: Tile, piece: EncodedTile) -> float:
        del unit
        return sum(map(len, piece.chunks))

    def into_shard(
        self, path: Path | None, shard: int, pieces: Iterable[EncodedTile]
    ) -> Generator[EncodedTile, None, None]:
        del shard
        if path is None:
            yield from pieces
        else:
            yield from write_chunks(path, self.study, pieces, header=HEADER_BYTES)

    def out_of_shard(self, path: Path, shard: int) -> Iterator[EncodedTile]:
        return read_chunks(path, self.study, self.study.grid.shard(shard))

    def assemble(self, path: Path, pieces: Iterable[EncodedTile]) -> None:
        write_atlas(path, self.study, pieces)

    def open(self, path: Path) -> Atlas:
        atlas = open_atlas(path)
        if atlas.study.fingerprint != self.study.fingerprint:
            raise InputError(
                f"{atlas.path} is the atlas of another study "
                f"({self.study.difference(atlas.study)}); "
                "choose another output or move it away"
            )
        return atlas

    def log(self) -> dict[str, Any]:
        counted = "_evaluate" in vars(self)  # workers of an executor do not tell theirs
        return {
            "values": self.study.points,
            "verdicts_settled_by_exact_arithmetic": (
                self._evaluate.resolved_exactly if counted else None
            ),
            "points_with_feedback_left_open_by_rounding": (
                self._evaluate.left_open if counted else None
            ),
            "bytes_before_compression": self.study.raw_bytes,
        }
