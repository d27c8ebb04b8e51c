"""Memory that is used again."""

import sys
import threading

import numpy as np
from numpy.typing import DTypeLike


def keep_freed_memory() -> None:
    """Let glibc keep freed memory for the next array instead of giving it back to the system.

    What is given back is mapped page by page when it is next written, which takes longer than
    computing what is written. glibc gives back blocks above a limit, which it raises, up to 32 MiB,
    to the largest that was freed; other allocators take no notice.
    """
    np.empty(2**25 - 2**14, np.uint8)


class Recycled:
    """Memory for arrays of one shape, used again once nobody holds the array any more.

    Fresh memory is mapped page by page when it is first written, which takes longer than writing.
    """

    def __init__(self, shape: tuple[int, ...], dtype: DTypeLike) -> None:
        self.shape, self.dtype = shape, dtype
        self._arrays: list[np.ndarray] = []
        self._lock = threading.Lock()

    def take(self) -> np.ndarray:
        """Return an array with any content."""
        with self._lock:
            for array in self._arrays:
                if sys.getrefcount(array) == UNSHARED:
                    return array[...]
            array = np.empty(self.shape, self.dtype)
            if len(self._arrays) < MOST_RECYCLED:
                self._arrays.append(array)
            return array[...]


# References to an array that nobody else holds: of the list, of the loop, of the asking.
UNSHARED = 3
MOST_RECYCLED = 32
