"""What glibc is asked to do with memory; other allocators take no notice."""

import ctypes
import os

import numpy as np

ARENAS_A_CORE = 2  # instead of eight
M_ARENA_MAX = -8  # of <malloc.h>


def keep_freed_memory() -> None:
    """Let freed memory be kept for the next array, in few heaps, instead of given back.

    What is given back is mapped page by page when it is next written, which takes longer than
    computing what is written: sweeps of numbers are 1.1 to 1.3 times as fast
    (``results/benchmarks``, "tricks"). glibc gives back blocks above a limit, which it raises, up
    to 32 MiB, to the largest that was freed. Every heap keeps its own: the threads of one run after
    the other would fill all of them, 0.2 GB of populations on two cores.
    """
    np.empty(2**25 - 2**14, np.uint8)
    mallopt = getattr(ctypes.CDLL(None), "mallopt", None)
    if mallopt is not None:
        mallopt(M_ARENA_MAX, ARENAS_A_CORE * max(os.cpu_count() or 1, 2))
