"""Memory that is used again."""

import sys
import threading

import numpy as np
from numpy.typing import DTypeLike


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
