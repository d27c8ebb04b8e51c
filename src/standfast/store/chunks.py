"""Compressed chunks in and out of atlas files, and the image of a shard that holds some of them."""

from collections.abc import Iterable, Iterator
from typing import Any

import h5py
import numpy as np

from standfast.store.layout import LIBRARY_VERSION, write_layout
from standfast.study import Study, Tile

Packed = tuple[Tile, tuple[bytes, ...]]


def shard_image(study: Study, version: str, packed: Iterable[Packed]) -> bytes:
    """Return an atlas with holes, made in memory: the disk sees one plain write, or none."""
    settings: dict[str, Any] = {"driver": "core", "backing_store": False, "block_size": 1 << 22}
    with h5py.File("shard", "w", libver=(LIBRARY_VERSION, "latest"), **settings) as file:
        write_layout(file, study, version)
        write_chunks(file, study, packed)
        file.flush()
        image: bytes = file.id.get_file_image()
    return image


def write_chunks(file: h5py.File, study: Study, packed: Iterable[Packed]) -> None:
    """Put compressed chunks into an atlas or a shard."""
    datasets = _datasets(file, study)
    for tile, chunks in packed:
        group = study.groups[tile.group]
        for dataset, raw in zip(datasets[tile.group], chunks, strict=True):
            if group.axes:
                dataset.id.write_direct_chunk(group.start(tile), raw)
            else:
                dataset[()] = np.frombuffer(raw, dataset.dtype)[0]


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
