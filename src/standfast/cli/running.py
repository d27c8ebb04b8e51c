"""What runs in shards share: their options, bar, estimate and stop, and how one goes on."""

import argparse
import contextlib
import errno
import os
import shlex
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from standfast.cli.arrays import job_script, share_of_work
from standfast.cli.executors import add_executor_options, executor_of
from standfast.cli.parsing import (
    StoppedError,
    add_file_option,
    made_room,
    number_from_1,
    output_file,
)
from standfast.errors import InputError


def add_run_options(parser: argparse.ArgumentParser, work: str) -> None:
    """Declare a study and the options of a run that is done in shards."""
    parser.add_argument("study", type=Path, metavar="STUDY.toml")
    add_file_option(parser, "FILE.h5", "the study's name with .h5")
    parser.add_argument(
        "--part",
        type=share_of_work,
        metavar="i/N",
        help="compute the i-th of N shares only, in an array job auto; a later call finishes",
    )
    words = f"threads that {work} (default: all cores, of a worker one)"
    parser.add_argument("--threads", type=number_from_1, metavar="N", help=words)
    add_executor_options(parser)
    words = "print an array job with its finishing job"
    parser.add_argument("--job-script", choices=("slurm",), help=words)


def output_of(options: argparse.Namespace) -> Path:
    """Return the file that a run writes.

    Raises
    ------
    InputError
        if it is the study itself, or named like one, which nothing may write over.
    """
    name = Path(options.study.name).with_suffix(".h5").name
    output = output_file(options.output, name)
    if os.path.realpath(output) == os.path.realpath(options.study):
        raise InputError(
            f"{output} is the study itself; name another file for the result, as {name}"
        )
    if output.suffix == ".toml":
        raise InputError(
            f"{output} is the name of a study, and the output is HDF5; write -o "
            f"{output.with_suffix('.h5')}"
        )
    return output


def run_shards(
    compute: Callable[..., Any], study: Any, options: argparse.Namespace, what: str, **settings: Any
) -> Any:
    """Compute a study in shards, with a bar; say so if it was a share only, and return None.

    ``compute`` is called as :func:`standfast.sweep` is, with ``settings`` besides. What it imports
    is imported where Ctrl-C can wait.
    """
    from standfast.cli.progress import interruptible, progress_bar

    output = output_of(options)
    if options.job_script:
        print(job_script(options.command, options.study, output, study.shard_count), end="")
        return None
    _say_where_it_resumes(study, output)
    made_room(output, options.output)
    with progress_bar(what) as (show_estimate, show_progress), interruptible() as stop_if_asked:

        def after_estimate(estimate: Any) -> None:
            show_estimate(estimate)
            stop_if_asked()

        def after_unit(done: int, total: int) -> None:
            show_progress(done, total)
            stop_if_asked()

        settings |= {"threads": options.threads, "part": options.part}
        with kept_when_stopped(output), executor_of(options) as executor:
            settings |= {"progress": after_unit, "estimate": after_estimate, "executor": executor}
            found = compute(study, output, **settings)
    if found is None:
        number, count = options.part
        print(f"Share {number}/{count} of {output} ", end="")
        if number > study.shard_count:
            print(
                f"has no work: it is cut into {study.shard_count} shards, so take at most as many."
            )
        else:
            print("is done; without --part the same command finishes it.")
    return found


def _say_where_it_resumes(study: Any, output: Path) -> None:
    """Say how much of the study was done before, if a run of it was broken off or shared."""
    from standfast.run.folder import parts_of, unfinished

    found = unfinished(output, type(study))
    if found is None or found[0].fingerprint != study.fingerprint:
        return
    count = study.shard_count
    done = count - len(found[1])
    if done:
        words = f"{done} of {count} shards ({done / count:.0%}) are there"
        print(f"standfast: resumes from {parts_of(output)}: {words}", file=sys.stderr)


@contextlib.contextmanager
def kept_when_stopped(output: Path) -> Iterator[None]:
    """Say of a run that is interrupted, or whose disk fills up, what is kept and how to go on."""
    again = "standfast " + " ".join(shlex.quote(word) for word in sys.argv[1:])
    kept = f"shards that are done are kept in {output}.parts."
    try:
        yield
    except KeyboardInterrupt:
        raise StoppedError(f"stopped; {kept} To go on: {again}") from None
    except OSError as error:
        if error.errno != errno.ENOSPC:
            raise
        words = f"the disk is full; {kept} Make room, then go on: {again}"
        raise StoppedError(words) from None
