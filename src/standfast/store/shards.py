"""Shards: small HDF5 files, each with a run of an atlas's chunks, each whole or not there.

A shard is an atlas with holes, behind a user block of 512 bytes that says in JSON which study and
which shard it is, with the SHA-256 of all that follows. It is written under a temporary name,
synced and renamed. So a torn, emptied, altered or foreign shard is known before HDF5 opens it.
"""

import contextlib
import hashlib
import json
import os
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from standfast.store.layout import LIBRARY_VERSION, write_layout
from standfast.study import Study, Tile

HEADER_BYTES = 512
Packed = tuple[Tile, tuple[bytes, ...]]


def shard_path(folder: Path, number: int) -> Path:
    """Return where a shard lies."""
    return folder / f"shard-{number:06d}.h5"


def write_shard(
    folder: Path, study: Study, version: str, number: int, packed: Iterable[Packed]
) -> None:
    """Write a shard whole: temporary name, sync, rename, sync of the folder.

    Raises
    ------
    OSError
        if the disk does not take it; nothing is left behind.
    """
    image = _image(study, version, packed)
    header = _header(study, version, number, hashlib.sha256(image).hexdigest())
    path = shard_path(folder, number)
    partial = path.with_name(f".{path.name}.{os.getpid()}.partial")
    try:
        with partial.open("wb") as file:
            file.write(header)
            file.write(image)
            file.flush()
            os.fsync(file.fileno())
        partial.replace(path)
    except BaseException:
        with contextlib.suppress(OSError):
            partial.unlink(missing_ok=True)
        raise
    sync_folder(folder)


def is_valid(folder: Path, study: Study, version: str, number: int) -> bool:
    """Return whether a shard is there, of this study, and as it was written."""
    try:
        with shard_path(folder, number).open("rb") as file:
            header = file.read(HEADER_BYTES)
            digest = hashlib.sha256()
            while block := file.read(1 << 20):
                digest.update(block)
    except OSError:
        return False
    return header == _header(study, version, number, digest.hexdigest())


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


def sync_folder(folder: Path) -> None:
    """Make a rename in this folder survive a power loss."""
    descriptor = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


def _image(study: Study, version: str, packed: Iterable[Packed]) -> bytes:
    """Make the shard in memory, so that the disk sees one plain write that fails plainly."""
    settings: dict[str, Any] = {"driver": "core", "backing_store": False, "block_size": 1 << 22}
    with h5py.File("shard", "w", libver=(LIBRARY_VERSION, "latest"), **settings) as file:
        write_layout(file, study, version)
        write_chunks(file, study, packed)
        file.flush()
        image: bytes = file.id.get_file_image()
    return image


def _header(study: Study, version: str, number: int, digest: str) -> bytes:
    content = {
        "standfast_shard": number,
        "of": len(study.shards),
        "study": study.fingerprint,
        "version": version,
        "sha256": digest,
    }
    return json.dumps(content).encode().ljust(HEADER_BYTES)
