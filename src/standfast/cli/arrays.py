"""Array jobs of clusters: which share a task is, and the script that starts them all."""

import argparse
import os
import shlex
from collections.abc import Mapping
from pathlib import Path

from standfast.errors import InputError

# Of each scheduler: the variables with a task's number, the first, the last and the step.
ARRAYS = {
    "SLURM": (
        "SLURM_ARRAY_TASK_ID", "SLURM_ARRAY_TASK_MIN", "SLURM_ARRAY_TASK_MAX",
        "SLURM_ARRAY_TASK_STEP",
    ),
    "SGE": ("SGE_TASK_ID", "SGE_TASK_FIRST", "SGE_TASK_LAST", "SGE_TASK_STEPSIZE"),
    "LSF": ("LSB_JOBINDEX", "", "LSB_JOBINDEX_END", "LSB_JOBINDEX_STEP"),
    "PBS": ("PBS_ARRAY_INDEX", "", "", ""),
    "Torque": ("PBS_ARRAYID", "", "", ""),
}  # fmt: skip
MOST_SHARES = 100


def share_of_work(text: str) -> tuple[int, int]:
    """Read ``i/N``, ``auto``, or ``auto/N`` for schedulers that do not say how many tasks are."""
    first, slash, last = text.partition("/")
    if first == "auto" and (not slash or _is_count(last)):
        try:
            return share_of_array(os.environ, int(last) if slash else None)
        except InputError as error:
            raise argparse.ArgumentTypeError(str(error)) from None
    if not (_is_count(first) and _is_count(last) and int(first) <= int(last)):
        raise argparse.ArgumentTypeError(
            f"{text!r} is not a share; give i/N, for example 2/8, or auto in an array job"
        )
    return int(first), int(last)


def share_of_array(environment: Mapping[str, str], count: int | None = None) -> tuple[int, int]:
    """Return the share of a task of an array job, from the variables that its scheduler sets.

    With ``count``, the tasks are numbered from 0 or from 1, one by one.

    Raises
    ------
    InputError
        outside an array job, or if the variables do not say how many tasks there are.
    """
    for scheduler, names in ARRAYS.items():
        number, first, last, step = (_number(environment.get(name, "")) for name in names)
        if number is None or (scheduler == "LSF" and number == 0):  # 0: a job that is no array
            continue
        if count is not None:
            if number > count:
                raise InputError(f"task {number} of {scheduler} is none of {count} shares")
            return number % count + 1, count
        if last is None:
            raise InputError(
                f"{scheduler} does not say how many tasks the array has; give --part auto/N"
            )
        first, step = 1 if first is None else first, step or 1
        told = _number(environment.get("SLURM_ARRAY_TASK_COUNT", ""))
        shares = (last - first) // step + 1
        if (number - first) % step or not first <= number <= last or told not in {None, shares}:
            raise InputError(
                f"the tasks of the array of {scheduler} are not evenly numbered; "
                "take a range, for example 1-8"
            )
        return (number - first) // step + 1, shares
    raise InputError(
        "--part auto is for array jobs of SLURM, SGE, LSF and PBS, and none of their variables is "
        "set; give i/N"
    )


def job_script(command: str, study: Path, output: Path, shards: int) -> str:
    """Return a script for SLURM: an array job with a share a task, and the job that finishes.

    Raises
    ------
    InputError
        if there is nothing to share.
    """
    if shards == 1:
        raise InputError(f"{study} is one shard of work, a second or so; run it without an array")
    words = shlex.join(["standfast", command, str(study), "-o", str(output)])
    return f"""\
#!/bin/bash
# {study} in {min(shards, MOST_SHARES)} shares, then the job that finishes {output}.
# Add what your cluster wants (account, time, memory), then run this file: bash FILE
set -e
shares=$(sbatch --parsable --job-name=standfast --array=1-{min(shards, MOST_SHARES)} \\
  --cpus-per-task=2 <<'END'
#!/bin/bash
{words} --part auto
END
)
# whatever became of the shares: what is missing is computed by the last job
sbatch --job-name=standfast-finish --cpus-per-task=2 --dependency="afterany:${{shares%%;*}}" <<'END'
#!/bin/bash
{words}
END
"""


def _is_count(text: str) -> bool:
    return text.isascii() and text.isdecimal() and int(text) >= 1


def _number(text: str) -> int | None:
    return int(text) if text.isascii() and text.isdecimal() else None
