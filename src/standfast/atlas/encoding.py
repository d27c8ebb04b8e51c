"""Chunks as HDF5 stores them: shuffled if their items have several bytes, and deflated.

Encoded here in threads and handed to HDF5 as they are; any reader inflates them. Two tricks: a
chunk of one repeated value is deflated once, and bytes that do not shrink are stored, which makes
encoding numbers 1.6 times as fast (``results/benchmarks``, "tricks").
"""

import math
import struct
from collections.abc import Iterator
from functools import lru_cache
from typing import Any

import numpy as np
from isal import isal_zlib

from standfast.atlas.layout import DEFLATE_LEVEL


def encoded(values: np.ndarray) -> bytes:
    """Return a chunk as HDF5 stores it.

    The lowest bytes of floating-point numbers are noise that does not shrink; after the shuffle
    they come first, and are stored as they are, which deflate allows and is several times faster.
    """
    size = values.dtype.itemsize
    if size == 1:
        packed: bytes = isal_zlib.compress(np.ascontiguousarray(values), DEFLATE_LEVEL)
        return packed
    as_bytes = values[..., None].view(np.uint8)
    planes = np.ascontiguousarray(np.moveaxis(as_bytes, -1, 0)).reshape(size, -1)
    noise = _planes_of_noise(planes)
    rest = isal_zlib.compress(planes[noise:], DEFLATE_LEVEL, RAW_DEFLATE)
    checksum = struct.pack(">I", isal_zlib.adler32(planes))
    return b"".join([ZLIB_HEADER, *_stored(planes[:noise]), rest, checksum])


def decoded(
    raw: bytes, dtype: np.dtype[Any], shape: tuple[int, ...], *, stored: bool = False
) -> np.ndarray:
    """Return the chunk behind :func:`encoded`, or one that is shuffled alone.

    Raises
    ------
    ValueError
        if it does not inflate to its size; it is never inflated beyond.
    """
    size = math.prod(shape) * dtype.itemsize
    stream = isal_zlib.decompressobj()
    content = raw if stored else stream.decompress(raw, size + 1)
    if len(content) != size or not (stored or stream.eof):
        raise ValueError("a chunk is not of its size")
    flat = np.frombuffer(content, np.uint8)
    if dtype.itemsize > 1:
        flat = np.ascontiguousarray(flat.reshape(dtype.itemsize, -1).T)
    return flat.reshape(-1).view(dtype).reshape(shape)


@lru_cache(maxsize=64)
def encoded_constant(dtype: str, value: int, size: int) -> bytes:
    """Return a chunk of ``size`` equal whole numbers; most chunks of verdicts are of this kind."""
    return encoded(np.full(size, value, dtype))


def constant_in(raw: bytes, dtype: np.dtype[Any], size: int) -> np.uint8 | None:
    """Return the one verdict that fills a chunk, known by its encoded bytes; else None."""
    if dtype != np.uint8:
        return None
    for value in (0, 1):
        if raw == encoded_constant(dtype.str, value, size):
            return np.uint8(value)
    return None


# A zlib stream with the default window, written by the fastest method.
ZLIB_HEADER = b"\x78\x01"
LONGEST_STORED = 2**16 - 1
RAW_DEFLATE = -15  # as zlib names it: neither header nor checksum

# A plane of bytes is worth deflating if its middle shrinks by a twentieth.
SAMPLE_BYTES, WORTH = 2**13, 0.95


def _planes_of_noise(planes: np.ndarray) -> int:
    """Return how many of the lowest planes of bytes do not shrink; the lower the less they do."""
    if _shrinks(planes[0]):  # rounded numbers, or few different ones
        return 0
    noise = len(planes) - 1
    while _shrinks(planes[noise - 1]):
        noise -= 1
    return noise


def _shrinks(plane: np.ndarray) -> bool:
    middle = max(plane.size - SAMPLE_BYTES, 0) // 2
    sample = plane[middle : middle + SAMPLE_BYTES]
    return len(isal_zlib.compress(sample, DEFLATE_LEVEL)) < WORTH * sample.size


def _stored(planes: np.ndarray) -> Iterator[bytes | memoryview]:
    """Give bytes as deflate blocks that are stored, none of them the last of the stream."""
    flat = planes.reshape(-1)
    for start in range(0, flat.size, LONGEST_STORED):
        block = flat[start : start + LONGEST_STORED]
        yield struct.pack("<BHH", 0, block.size, block.size ^ LONGEST_STORED)
        yield block.data
