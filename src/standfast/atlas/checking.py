"""HDF5 files that cannot be trusted: the one way to open them, to check and to read a dataset.

All that reads goes through here, so that damage is one sentence, and neither a pipe, a link to
another file nor a few bytes that inflate to gigabytes are followed. HDF5's locks are not insisted
upon: network file systems may refuse them, and a finished file is never written again.
"""

import math
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from itertools import product
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from standfast.atlas.encoding import constant_in, decoded
from standfast.errors import InputError
from standfast.files import nearest_file, opened_plainly
from standfast.run.machine import cores
from standfast.study.grid import CHUNK_BYTES

HDF5_SIGNATURE = b"\x89HDF\r\n\x1a\n"
# Bytes are shuffled where a value has several; of single ones it changes nothing.
FILTERS = [[h5py.h5z.FILTER_DEFLATE], [h5py.h5z.FILTER_SHUFFLE, h5py.h5z.FILTER_DEFLATE]]


@contextmanager
def one_sentence(path: Path) -> Iterator[None]:
    """Turn what HDF5 says of a broken file into one sentence."""
    try:
        yield
    except InputError:
        raise
    except Exception as error:  # HDF5 reports damage by almost any exception
        reason = str(error).splitlines()[0] if str(error) else type(error).__name__
        raise InputError(f"{path} is damaged or cut short ({reason})") from None


def hdf5_file(path: Path) -> h5py.File:
    """Open a plain HDF5 file for reading.

    Raises
    ------
    InputError
        if there is no such file, or it is no plain one, or not HDF5, or broken.
    """
    try:
        with opened_plainly(path) as raw:
            signature = raw.read(len(HDF5_SIGNATURE))
    except FileNotFoundError:
        begun = path.with_name(path.name + ".parts").is_dir()
        hint = (
            ", only the beginnings of it: run the same command again to finish"
            if begun
            else nearest_file(path, ".h5")
        )
        raise InputError(f"{path}: there is no such file{hint}") from None
    except OSError as error:
        raise InputError(f"{path} cannot be read: {error.strerror}") from None
    if signature != HDF5_SIGNATURE:
        hint = "; it looks like a study, sweep it first" if path.suffix == ".toml" else ""
        raise InputError(f"{path} is not an HDF5 file{hint}")
    with one_sentence(path):
        return reading(path)


def reading(path: Path) -> h5py.File:
    """Open for reading by whichever way of locking is not refused."""
    try:
        return h5py.File(path, "r")
    except OSError:
        # Locked by others, or on a file system without locks. HDF5 opens a file only one way in a
        # process, and the first is what other readers take.
        return h5py.File(path, "r", locking=False)


@contextmanager
def opened(path: Path) -> Iterator[h5py.File]:
    """Open for reading; say in one sentence if the file is broken."""
    with one_sentence(path), hdf5_file(path) as file:
        yield file


def checked_dataset(
    path: Path, file: h5py.File, name: str, shape: tuple[int, ...], dtype: np.dtype[Any] | None
) -> h5py.Dataset:
    """Return a dataset; refuse one that is not as written: link, shape, type, storage, filters.

    Without a ``dtype`` it is a text of any length that the file holds.
    """
    link = file.get(name, getlink=True)
    if not isinstance(link, h5py.HardLink) or not isinstance(file[name], h5py.Dataset):
        raise InputError(f"{path} lacks the dataset {name!r} that its study promises")
    dataset = file[name]
    settings = dataset.id.get_create_plist()
    filters = [settings.get_filter(number)[0] for number in range(settings.get_nfilters())]
    width, sides, stored = dataset.dtype.itemsize, dataset.chunks, dataset.id.get_storage_size()
    sound = (
        dataset.shape == shape
        and (dataset.dtype == dtype if dtype else dataset.dtype.kind == "S")
        and not dataset.is_virtual
        and dataset.external is None
        and filters in (FILTERS[width > 1 :] if sides else [[]])
        and (sides is None or math.prod(sides) * width <= CHUNK_BYTES)
        and stored <= path.stat().st_size
    )
    if not sound:
        raise InputError(f"{path}: the dataset {name!r} is not as its study says")
    if sides is None and stored != dataset.nbytes:
        raise InputError(f"{path}: values of {name!r} are missing")
    if sides is not None:
        chunks = (-(-length // side) for length, side in zip(shape, sides, strict=True))
        if dataset.id.get_num_chunks() != math.prod(chunks):
            raise InputError(f"{path}: chunks of {name!r} are missing")
    return dataset


def read_box(dataset: h5py.Dataset, box: tuple[slice, ...]) -> np.ndarray:
    """Read a box of a chunked dataset: raw chunks one after the other, inflated in threads."""
    dtype, sides = dataset.dtype, dataset.chunks
    # zeroed memory is not touched before something else is written to it
    values = np.zeros([part.stop - part.start for part in box], dtype)
    # the bit of the last filter, in the mask of those that a chunk went without
    deflate = 1 << dataset.id.get_create_plist().get_nfilters() - 1

    def place(start: tuple[int, ...], mask: int, raw: bytes) -> None:
        alike = constant_in(raw, dtype, math.prod(sides))
        if alike == 0:
            return
        if mask not in (0, deflate):
            raise ValueError("a chunk is not shuffled")
        if alike is None:
            chunk = decoded(raw, dtype, sides, stored=mask == deflate)
        else:
            chunk = np.broadcast_to(alike, sides)
        source, target = [], []
        for first, side, part in zip(start, sides, box, strict=True):
            low, high = max(first, part.start), min(first + side, part.stop)
            source.append(slice(low - first, high - first))
            target.append(slice(low - part.start, high - part.start))
        values[tuple(target)] = chunk[tuple(source)]

    touched = (
        range(part.start // side, -(-part.stop // side))
        for part, side in zip(box, sides, strict=True)
    )
    workers = cores()
    with ThreadPoolExecutor(workers) as pool:
        waiting = []
        for chunk in product(*touched):
            start = tuple(i * side for i, side in zip(chunk, sides, strict=True))
            waiting.append(pool.submit(place, start, *dataset.id.read_direct_chunk(start)))
            if len(waiting) > 4 * workers:
                waiting.pop(0).result()
        for job in waiting:
            job.result()
    return values
