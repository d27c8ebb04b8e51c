"""Compressed chunks into atlases and shards, as they come, and out of them again."""

from collections.abc import Generator, Iterable, Iterator
from pathlib import Path

import h5py
import numpy as np

from standfast.store.layout import LIBRARIES, write_layout
from standfast.store.shards import HEADER_BYTES, shard_path
from standfast.store.workplace import Workplace, failures_of_hdf5
from standfast.study import Study, Tile

Packed = tuple[Tile, tuple[bytes, ...]]


def into_atlas(
    path: Path, study: Study, version: str, packed: Iterable[Packed]
) -> Generator[Packed, None, None]:
    """Make an atlas of compressed chunks; hand each on once it is written."""
    return _into_file(path, study, version, packed, None)


def into_shard(
    place: Workplace[Study], number: int, packed: Iterable[Packed]
) -> Generator[Packed, None, None]:
    """Make a shard of compressed chunks, an atlas with holes; hand each on once it is written."""
    with place.shard(number) as path:
        yield from _into_file(path, place.study, place.version, packed, HEADER_BYTES)


def _into_file(
    path: Path, study: Study, version: str, packed: Iterable[Packed], header: int | None
) -> Generator[Packed, None, None]:
    # what makes the chunks may fail too, and says so itself
    with failures_of_hdf5(path):
        file = h5py.File(path, "w", libver=LIBRARIES, userblock_size=header)
    try:
        with failures_of_hdf5(path):
            write_layout(file, study, version)
            datasets = _datasets(file, study)
        for tile, chunks in packed:
            group = study.groups[tile.group]
            with failures_of_hdf5(path):
                for dataset, raw in zip(datasets[tile.group], chunks, strict=True):
                    if group.axes:
                        dataset.id.write_direct_chunk(group.start(tile), raw)
                    else:
                        dataset[()] = np.frombuffer(raw, dataset.dtype)[0]
            yield tile, chunks
    finally:
        with failures_of_hdf5(path):
            file.close()


def out_of_shard(place: Workplace[Study], number: int) -> Iterator[Packed]:
    """Give the compressed chunks of a shard."""
    with h5py.File(shard_path(place.folder, number), "r") as file:
        yield from read_chunks(file, place.study, place.study.shard(number))


def read_chunks(file: h5py.File, study: Study, tiles: Iterable[Tile]) -> Iterator[Packed]:
    """Take compressed chunks out of an atlas or a shard."""
    datasets = _datasets(file, study)
    for tile in tiles:
        group = study.groups[tile.group]
        if group.axes:
            start = group.start(tile)
            yield tile, tuple(d.id.read_direct_chunk(start)[1] for d in datasets[tile.group])
        else:
            yield tile, tuple(np.asarray(d[()]).tobytes() for d in datasets[tile.group])


def _datasets(file: h5py.File, study: Study) -> list[list[h5py.Dataset]]:
    """Look every dataset up once; with thousands of chunks that is what takes time."""
    return [[file[quantity] for quantity in group.quantities] for group in study.groups]
