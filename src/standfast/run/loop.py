"""The one loop, of sweeps and populations: what no shard covers is computed, here or elsewhere.

Read from the top: :func:`run_job` takes the folder, finds what is missing, has it computed by an
executor or estimates and computes it in threads, writes shards, and lets the job assemble the
finished file.
"""

import time
from collections.abc import Generator, Iterator
from contextlib import closing
from pathlib import Path

from standfast.run.computing import Computing, Job, Piece, Result_co, Unit, new_shard, write_shard
from standfast.run.folder import RunFolder, tidy, tidy_up_after
from standfast.run.log import log_text
from standfast.run.options import RunOptions
from standfast.run.shards import Work, shard_path
from standfast.run.workers import compute_elsewhere


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
    if part is not None and part[0] > job.study.shard_count:
        return None
    began = time.perf_counter()
    with RunFolder.enter(output, job.study, part=part) as folder:
        if output.exists():  # another run finished it just before this one took the lock
            if part is None:
                tidy(folder.path)
            return _already_there(job, output)
        own = range(job.study.shard_count)
        missing = folder.missing(own if part is None else own[part[0] - 1 :: part[1]])
        elsewhere = 0
        if missing and options.get("executor") is not None:
            left = compute_elsewhere(job, folder, missing, options, finishes=part is None)
            elsewhere = sum(job.size(u) for n in set(missing) - set(left) for u in job.units(n))
            missing = left
        with closing(
            Computing(job, missing, options.get("threads"), options.get("progress"))
        ) as run:
            if missing:
                found = run.estimate(folder, finishes=part is None)
                found.require_room(output, job.what)
                if announce := options.get("estimate"):
                    announce(found)
            computed = run.pieces()
            if part is not None:
                for number in missing:
                    write_shard(job, folder, number, computed)
                return None

            def log(size: int) -> str:
                seconds = time.perf_counter() - began
                more = {**job.log(), "bytes": size, "processors_of_shards": folder.processors()}
                return log_text(job.study, job.what, run.total + elsewhere, seconds, more)

            with closing(_all_pieces(job, folder, missing, computed)) as pieces:
                folder.finish(lambda path: job.assemble(path, pieces), log)
    return job.open(output)


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
            yield from new_shard(job, folder, number, computed)
