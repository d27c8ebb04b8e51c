"""Freed memory kept for the next array."""

import numpy as np


def keep_freed_memory() -> None:
    """Let glibc keep freed memory for the next array instead of giving it back to the system.

    What is given back is mapped page by page when it is next written, which takes longer than
    computing what is written: sweeps of numbers are 1.2 to 1.3 times as fast
    (``results/benchmarks``, "tricks"). glibc gives back blocks above a limit, which it raises, up
    to 32 MiB, to the largest that was freed; other allocators take no notice.
    """
    np.empty(2**25 - 2**14, np.uint8)
