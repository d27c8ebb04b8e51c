"""Shards: files with a part of a result, each whole or not there.

Behind 512 bytes that say in JSON which study and which shard it is, with a checksum of all that
follows, lies the content: of a sweep an atlas with holes, which HDF5 opens past this user block; of
a population its counts. A shard is written under a temporary name, synced and renamed. So a torn,
emptied, altered or foreign one is known before anything in it is believed.
"""

import contextlib
import hashlib
import json
import os
from collections.abc import Iterator
from pathlib import Path
from typing import BinaryIO, Protocol, Self

from isal import isal_zlib

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


@contextlib.contextmanager
def shard_in_making(folder: Path, work: Work, version: str, number: int) -> Iterator[Path]:
    """Give the temporary file of a shard, to be written from byte :data:`HEADER_BYTES` on.

    Once the block ends it gets its header, is synced and renamed; nothing is left of it if the
    block fails.

    Raises
    ------
    OSError
        if the disk does not take it.
    """
    path = shard_path(folder, number)
    partial = path.with_name(f".{path.name}.{os.getpid()}.partial")
    try:
        yield partial
        with partial.open("r+b") as file:
            file.seek(HEADER_BYTES)
            header = _header(work, version, number, _checksum(file))
            file.seek(0)
            file.write(header)
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
            return header == _header(work, version, number, _checksum(file))
    except OSError:
        return False


def shard_content(folder: Path, number: int) -> bytes:
    """Return what lies behind the header of a valid shard."""
    return shard_path(folder, number).read_bytes()[HEADER_BYTES:]


def sync_file(path: Path) -> None:
    """Wait until the disk has taken a file."""
    with path.open("rb") as file:
        os.fsync(file.fileno())


def sync_folder(folder: Path) -> None:
    """Make a rename in this folder survive a power loss."""
    descriptor = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


def _checksum(file: BinaryIO) -> str:
    """Return the SHA-256 of the CRC-32 of every mebibyte that is left of a file.

    What it guards against is accident; the SHA-256 of all of it would take as long as the writing.
    """
    digest = hashlib.sha256()
    while block := file.read(1 << 20):
        digest.update(isal_zlib.crc32(block).to_bytes(4, "big"))
    return digest.hexdigest()


def _header(work: Work, version: str, number: int, checksum: str) -> bytes:
    content = {
        "standfast_shard": number,
        "of": work.shard_count,
        "study": work.fingerprint,
        "version": version,
        "checksum": checksum,
    }
    return json.dumps(content).encode().ljust(HEADER_BYTES)
