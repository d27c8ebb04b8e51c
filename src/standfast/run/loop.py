"""The one loop, of sweeps and populations: what no shard covers is computed, here or elsewhere.

Read from the top: :func:`run_job` takes the folder, finds what is missing, has it made by an
executor or estimates and computes it in threads, writes shards, and lets the job assemble the
finished file.
"""

import time
from collections import deque
from collections.abc import Generator, Iterable, Iterator
from contextlib import closing
from itertools import chain, islice
from pathlib import Path

from standfast.run.computing import Computing, Job, Piece, Result_co, Unit, new_shard, write_shard
from standfast.run.folder import RunFolder, tidy, tidy_up_after
from standfast.run.log import log_text
from standfast.run.options import RunOptions
from standfast.run.shards import Work, shard_path
from standfast.run.workers import Sent


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
        with closing(_made(job, folder, missing, options, finishes=part is None)) as made:
            if part is not None:
                for number, computed in made:
                    if computed is not None:
                        write_shard(job, folder, number, computed)
                return None

            def log(size: int) -> str:
                seconds = time.perf_counter() - began
                done = sum(job.size(unit) for number in missing for unit in job.units(number))
                more = {**job.log(), "bytes": size, "processors_of_shards": folder.processors()}
                return log_text(job.study, job.what, done, seconds, more)

            # what does not fit the disk is refused here, before the file is begun
            first = list(islice(made, 1))
            with closing(_all_pieces(job, folder, missing, chain(first, made))) as pieces:
                folder.finish(lambda path: job.assemble(path, pieces), log)
    return job.open(output)


def _already_there(job: Job[Unit, Piece, Result_co], output: Path) -> Result_co:
    """Return the finished file of this very study; refuse any other."""
    found = job.open(output)
    tidy_up_after(output, job.study)
    return found


def _made(
    job: Job[Unit, Piece, Result_co],
    folder: RunFolder[Work],
    missing: list[int],
    options: RunOptions,
    *,
    finishes: bool,
) -> Generator[tuple[int, Iterator[Piece] | None], None, None]:
    """Give the missing shards in order: with None what an executor made, else with its pieces.

    Those of an executor are waited for one by one, so that the file grows while others are under
    way; what a broken one leaves is computed here.
    """
    here, coming = missing, deque(missing)
    if options.get("executor") is not None:
        with closing(Sent(job, folder, missing, options, finishes=finishes)) as sent:
            while coming and sent.wait_for(coming[0]):
                yield coming.popleft(), None
            here = sorted(sent.left)
    if not here:
        return
    with closing(Computing(job, here, options.get("threads"), options.get("progress"))) as run:
        found = run.estimate(folder, finishes=finishes)
        found.require_room(folder.target, job.what)
        if announce := options.get("estimate"):
            announce(found)
        computed, left = run.pieces(), set(here)
        for number in coming:
            yield number, computed if number in left else None


def _all_pieces(
    job: Job[Unit, Piece, Result_co],
    folder: RunFolder[Work],
    missing: list[int],
    made: Iterable[tuple[int, Iterator[Piece] | None]],
) -> Generator[Piece, None, None]:
    """Give what all shards hold, in order; what is computed here is put into shards.

    The last goes into the file alone, which is about to be finished.
    """
    were_missing, coming = set(missing), iter(made)
    for number in range(job.study.shard_count):
        computed = next(coming)[1] if number in were_missing else None
        if computed is None:
            yield from job.out_of_shard(shard_path(folder.path, number), number)
        elif number == missing[-1]:
            yield from job.into_shard(None, number, computed)
        else:
            yield from new_shard(job, folder, number, computed)
