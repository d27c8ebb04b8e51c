"""The finishing of an atlas: all chunks in canonical order into one file, which is read back."""

import errno
from collections.abc import Iterable, Iterator
from concurrent.futures import Executor, Future, ThreadPoolExecutor
from contextlib import closing
from pathlib import Path

import h5py
from isal import isal_zlib

from standfast.store.chunks import Packed, into_atlas, read_chunks
from standfast.store.shards import sync_file
from standfast.study import Study

SYNCED_BYTES = 2**24


def assemble(path: Path, study: Study, version: str, packed: Iterable[Packed]) -> None:
    """Write all chunks of an atlas, given in canonical order, and read them back.

    Raises
    ------
    OSError
        if the disk does not take the file, or it does not read back as it was written.
    """
    syncs: list[Future[None]] = []
    with ThreadPoolExecutor(1) as disk, closing(into_atlas(path, study, version, packed)) as grown:
        # the disk is at work while the file grows and is read back
        written = _checksum(_synced_as_it_grows(path, grown, disk, syncs))
        syncs.append(disk.submit(sync_file, path))
        with h5py.File(path, "r") as file:
            tiles = (tile for number in range(study.shard_count) for tile in study.shard(number))
            read_back = _checksum(read_chunks(file, study, tiles))
        for sync in syncs:  # a failure is told once, and to the first who asks
            sync.result()
    if read_back != written:
        raise OSError(errno.EIO, "the file does not read back as it was written", str(path))


def _synced_as_it_grows(
    path: Path, packed: Iterable[Packed], disk: Executor, syncs: list[Future[None]]
) -> Iterator[Packed]:
    """Hand chunks on, and let the disk take the file whenever it has taken the last part."""
    unsynced = 0
    for tile, chunks in packed:
        unsynced += sum(map(len, chunks))
        if unsynced > SYNCED_BYTES and (not syncs or syncs[-1].done()):
            syncs.append(disk.submit(sync_file, path))
            unsynced = 0
        yield tile, chunks


def _checksum(packed: Iterable[Packed]) -> int:
    """Return the CRC-32 of all chunks that go by."""
    value = 0
    for _, chunks in packed:
        for chunk in chunks:
            value = isal_zlib.crc32(chunk, value)
    return value
