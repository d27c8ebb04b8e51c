"""What glibc is asked to do with memory; other allocators take no notice."""

import ctypes
import os

ARENAS_A_CORE = 2  # instead of eight

# What XLA needs beside a tile of rotation ratios, the most of all, is 50 MB. Before glibc 2.35 the
# second is as much as may be asked for.
KEPT_BYTES = (2**26, 2**25)

M_TRIM_THRESHOLD, M_MMAP_THRESHOLD, M_ARENA_MAX = -1, -3, -8  # of <malloc.h>


def keep_freed_memory() -> None:
    """Let freed memory be kept for the next array, in few heaps, instead of given back.

    What is given back is mapped page by page when it is next written, which takes longer than
    computing what is written: sweeps of numbers are 1.1 to 1.3 times as fast
    (``results/benchmarks``, "tricks"), and rotation ratios are computed 1.8 times as fast as with
    the 32 MiB that glibc keeps of itself at most. Every heap keeps its own: the threads of one run
    after the other would fill all of them, 0.2 GB of populations on two cores.
    """
    mallopt = getattr(ctypes.CDLL(None), "mallopt", None)
    if mallopt is not None:
        kept = next((size for size in KEPT_BYTES if mallopt(M_MMAP_THRESHOLD, size)), 0)
        if kept:
            mallopt(M_TRIM_THRESHOLD, 2 * kept)
        mallopt(M_ARENA_MAX, ARENAS_A_CORE * max(os.cpu_count() or 1, 2))
