"""The finishing of an atlas: the chunks of all shards, in canonical order, into one file."""

import errno
from collections.abc import Iterable, Iterator
from pathlib import Path

import h5py
from isal import isal_zlib

from standfast.store.chunks import Packed, read_chunks, write_chunks
from standfast.store.layout import LIBRARY_VERSION, write_layout
from standfast.store.shards import shard_path
from standfast.store.workplace import Workplace
from standfast.study import Study


def assemble(place: Workplace[Study], partial: Path) -> None:
    """Copy all chunks into one file and read it back.

    Raises
    ------
    OSError
        if the file does not read back as it was written.
    """
    study = place.study
    with h5py.File(partial, "w", libver=(LIBRARY_VERSION, "latest")) as file:
        write_layout(file, study, place.version)
        written = _Checksum()
        write_chunks(file, study, written.of(_all_chunks(place)))
    read_back = _Checksum()
    with h5py.File(partial, "r") as file:
        tiles = (t for n in range(study.shard_count) for t in study.shard(n))
        for _ in read_back.of(read_chunks(file, study, tiles)):
            pass
    if read_back.value != written.value:
        raise OSError(errno.EIO, "the file does not read back as it was written", str(partial))


def _all_chunks(place: Workplace[Study]) -> Iterator[Packed]:
    """Go through the chunks of all shards in canonical order."""
    for number in range(place.study.shard_count):
        with h5py.File(shard_path(place.folder, number), "r") as shard:
            yield from read_chunks(shard, place.study, place.study.shard(number))


class _Checksum:
    """The CRC-32 of all chunks that went by."""

    def __init__(self) -> None:
        self.value = 0

    def of(self, packed: Iterable[Packed]) -> Iterator[Packed]:
        """Hand chunks on and add them up."""
        for tile, chunks in packed:
            for chunk in chunks:
                self.value = isal_zlib.crc32(chunk, self.value)
            yield tile, chunks
