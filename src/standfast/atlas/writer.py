"""Encoded chunks into atlases and shards, as they come, and out of them again."""

import contextlib
import errno
import os
import traceback
from collections.abc import Generator, Iterable, Iterator
from concurrent.futures import Executor, Future, ThreadPoolExecutor
from contextlib import closing
from pathlib import Path
from typing import NamedTuple

import h5py
import numpy as np
from isal import isal_zlib

from standfast.atlas.checking import one_sentence, reading
from standfast.atlas.layout import LIBRARIES, write_layout
from standfast.errors import InputError
from standfast.files import sync_file
from standfast.study.grid import Tile
from standfast.study.study import Study

SYNCED_BYTES = 2**24

# What HDF5 may put between two blocks of numbers: headers, attributes, lists of names.
BETWEEN_BYTES = 2**18


class EncodedTile(NamedTuple):
    """A tile's chunks as the file stores them, one a quantity; raw numbers in a grid of no axes."""

    tile: Tile
    chunks: tuple[bytes, ...]


def write_chunks(
    path: Path, study: Study, tiles: Iterable[EncodedTile], *, header: int = 0
) -> Generator[EncodedTile, None, None]:
    """Make an atlas, behind ``header`` bytes, of encoded tiles; hand each on once it is written."""
    # what makes the tiles may fail too, and says so itself
    with failures_of_hdf5(path):
        file = h5py.File(path, "w", libver=LIBRARIES, userblock_size=header or None, locking=False)
    try:
        with failures_of_hdf5(path):
            write_layout(file, study)
            datasets = _datasets(file, study)
        for encoded in tiles:
            group = study.grid.groups[encoded.tile.group]
            with failures_of_hdf5(path):
                for dataset, raw in zip(datasets[encoded.tile.group], encoded.chunks, strict=True):
                    if group.axes:
                        dataset.id.write_direct_chunk(group.start(encoded.tile), raw)
                    else:
                        dataset[()] = np.frombuffer(raw, dataset.dtype)[0]
            yield encoded
    finally:
        with failures_of_hdf5(path):
            file.close()


def read_chunks(path: Path, study: Study, tiles: Iterable[Tile]) -> Iterator[EncodedTile]:
    """Take encoded chunks out of an atlas or a shard."""
    with one_sentence(path), reading(path) as file:
        datasets = _datasets(file, study)
        for tile in tiles:
            group = study.grid.groups[tile.group]
            if group.axes:
                start = group.start(tile)
                chunks = (d.id.read_direct_chunk(start)[1] for d in datasets[tile.group])
            else:
                chunks = (np.asarray(d[()]).tobytes() for d in datasets[tile.group])
            yield EncodedTile(tile, tuple(chunks))


def write_atlas(path: Path, study: Study, tiles: Iterable[EncodedTile]) -> None:
    """Write all chunks of an atlas, given in canonical order, and read them back.

    Raises
    ------
    OSError
        if the disk does not take the file, or it does not read back as it was written.
    """
    syncs: list[Future[None]] = []
    grown = write_chunks(path, study, tiles)
    with ThreadPoolExecutor(1) as disk, closing(grown):
        # the disk is at work while the file grows and is read back
        written = _checksum(_synced_as_it_grows(path, grown, disk, syncs))
        syncs.append(disk.submit(sync_file, path))
        everything = (t for number in range(study.shard_count) for t in study.grid.shard(number))
        try:
            read_back = _checksum(read_chunks(path, study, everything))
        except InputError:
            read_back = -1
        for sync in syncs:  # a failure is told once, and to the first who asks
            sync.result()
    if read_back != written:
        raise OSError(errno.EIO, "the file does not read back as it was written", str(path))


@contextlib.contextmanager
def new_file(path: Path) -> Iterator[h5py.File]:
    """Make an HDF5 file of which every block is announced to :func:`reserve`."""
    path.write_bytes(bytes(BETWEEN_BYTES))  # a disk that is full already says so here
    with failures_of_hdf5(path), h5py.File(path, "w", libver=LIBRARIES) as file:
        reserve(file, 0)
        yield file
        file.flush()
        os.truncate(path, file.id.get_filesize())


def reserve(file: h5py.File, size: int) -> None:
    """Take room on the disk for what is written next.

    HDF5 writes some of it as an object is closed. If that fails, h5py prints what it cannot raise,
    and the process may die of it; so the disk is full here, or not at all.
    """
    with Path(file.filename).open("r+b") as room:
        room.seek(file.id.get_filesize())
        room.write(bytes(size + BETWEEN_BYTES))


@contextlib.contextmanager
def failures_of_hdf5(path: Path) -> Iterator[None]:
    """Turn those of HDF5's failures to write that h5py gives as RuntimeError into OSError.

    One that others raise meanwhile, who are called as it is written, is theirs.
    """
    try:
        yield
    except RuntimeError as error:
        *_, (raised, _) = traceback.walk_tb(error.__traceback__)
        if not str(raised.f_globals.get("__name__")).startswith("h5py."):
            raise
        reason = str(error).splitlines()[0]
        raise OSError(errno.EIO, f"HDF5 could not write ({reason})", str(path)) from None


def _synced_as_it_grows(
    path: Path, tiles: Iterable[EncodedTile], disk: Executor, syncs: list[Future[None]]
) -> Iterator[EncodedTile]:
    """Hand tiles on, and let the disk take the file whenever it has taken the last part."""
    unsynced = 0
    for encoded in tiles:
        unsynced += sum(map(len, encoded.chunks))
        if unsynced > SYNCED_BYTES and (not syncs or syncs[-1].done()):
            syncs.append(disk.submit(sync_file, path))
            unsynced = 0
        yield encoded


def _checksum(tiles: Iterable[EncodedTile]) -> int:
    """Return the CRC-32 of all chunks that go by."""
    value = 0
    for encoded in tiles:
        for chunk in encoded.chunks:
            value = isal_zlib.crc32(chunk, value)
    return value


def _datasets(file: h5py.File, study: Study) -> list[list[h5py.Dataset]]:
    """Look every dataset up once; with thousands of chunks that is what takes time."""
    return [[file[quantity] for quantity in group.quantities] for group in study.grid.groups]
