"""Shards: files with a part of a result, each whole or not there.

Behind 512 bytes that say in JSON which study and which shard it is, with the SHA-256 of all that
follows, lies the content: of a sweep an atlas with holes, which HDF5 opens past this user block; of
a population its counts. A shard is written under a temporary name, synced and renamed. So a torn,
emptied, altered or foreign one is known before anything in it is believed.
"""

import contextlib
import hashlib
import json
import os
from pathlib import Path
from typing import Protocol, Self

HEADER_BYTES = 512


class Work(Protocol):
    """What is computed shard by shard: a sweep's study or a population's."""

    @property
    def canonical(self) -> str:
        """The one text that says all."""

    @property
    def fingerprint(self) -> str:
        """Its SHA-256."""

    @property
    def shard_count(self) -> int:
        """How many shards it is cut into."""

    @classmethod
    def from_canonical(cls, text: str) -> Self:
        """Read the text back; InputError if it is none."""

    def difference(self, other: Self) -> str:
        """Say in words what differs."""


def shard_path(folder: Path, number: int) -> Path:
    """Return where a shard lies."""
    return folder / f"shard-{number:06d}.h5"


def write_shard(folder: Path, work: Work, version: str, number: int, content: bytes) -> None:
    """Write a shard whole: temporary name, sync, rename, sync of the folder.

    Raises
    ------
    OSError
        if the disk does not take it; nothing is left behind.
    """
    header = _header(work, version, number, hashlib.sha256(content).hexdigest())
    path = shard_path(folder, number)
    partial = path.with_name(f".{path.name}.{os.getpid()}.partial")
    try:
        with partial.open("wb") as file:
            file.write(header)
            file.write(content)
            file.flush()
            os.fsync(file.fileno())
        partial.replace(path)
    except BaseException:
        with contextlib.suppress(OSError):
            partial.unlink(missing_ok=True)
        raise
    sync_folder(folder)


def is_valid(folder: Path, work: Work, version: str, number: int) -> bool:
    """Return whether a shard is there, of this study, and as it was written."""
    try:
        with shard_path(folder, number).open("rb") as file:
            header = file.read(HEADER_BYTES)
            digest = hashlib.sha256()
            while block := file.read(1 << 20):
                digest.update(block)
    except OSError:
        return False
    return header == _header(work, version, number, digest.hexdigest())


def shard_content(folder: Path, number: int) -> bytes:
    """Return what lies behind the header of a valid shard."""
    return shard_path(folder, number).read_bytes()[HEADER_BYTES:]


def sync_folder(folder: Path) -> None:
    """Make a rename in this folder survive a power loss."""
    descriptor = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


def _header(work: Work, version: str, number: int, digest: str) -> bytes:
    content = {
        "standfast_shard": number,
        "of": work.shard_count,
        "study": work.fingerprint,
        "version": version,
        "sha256": digest,
    }
    return json.dumps(content).encode().ljust(HEADER_BYTES)
