"""The machine that a run is on: its cores, and its kind of processor."""

import contextlib
import os
import platform
from functools import cache

import numpy as np


def cores() -> int:
    """Return how many cores this process may use: as SLURM says, else as the system does.

    A task of a cluster is often bound to some of a machine's cores; the machine's count is then too
    many.
    """
    asked = os.environ.get("SLURM_CPUS_PER_TASK", "")
    if asked.isascii() and asked.isdecimal() and int(asked) > 0:
        return int(asked)
    with contextlib.suppress(AttributeError, OSError):  # not on every system
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


@cache
def kind_of_processor() -> str:
    """Return the architecture and its widest instruction set, as NumPy finds it.

    Last digits may differ between kinds, since compiled code contracts and orders arithmetic by it.
    """
    found: list[str] = []
    with contextlib.suppress(KeyError, TypeError):
        simd = np.show_config(mode="dicts")["SIMD Extensions"]
        found = [*simd.get("baseline", []), *simd.get("found", [])]
    return " ".join([platform.machine(), *found[-1:]])
