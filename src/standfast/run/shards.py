"""Shards: files with a part of a result, each whole or not there.

Behind 512 bytes that say in JSON which study and which shard it is, with a checksum of all that
follows, lies the content: of a sweep an atlas with holes, which HDF5 opens past this user block; of
a population its counts. A shard is written under a temporary name, synced and renamed. So a torn,
emptied, altered or foreign one is known before anything in it is believed.
"""

import contextlib
import hashlib
import json
from collections.abc import Iterator
from pathlib import Path
from typing import BinaryIO, Protocol, Self

from isal import isal_zlib

from standfast.files import opened_plainly, whole_file
from standfast.run.machine import kind_of_processor
from standfast.version import __version__

HEADER_BYTES = 512


class Work(Protocol):
    """What is computed shard by shard: a sweep's study or a population's."""

    @property
    def title(self) -> str:
        """What it is called."""

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
def new_shard(folder: Path, work: Work, number: int) -> Iterator[Path]:
    """Give the temporary file of a shard, to be written from byte :data:`HEADER_BYTES` on.

    Once the block ends it gets its header, is synced and renamed; nothing is left of it if the
    block fails.

    Raises
    ------
    OSError
        if the disk does not take it.
    """
    with whole_file(shard_path(folder, number), synced=True) as partial:
        yield partial
        with partial.open("r+b") as file:
            file.seek(HEADER_BYTES)
            header = _header(work, number, kind_of_processor(), _checksum(file))
            file.seek(0)
            file.write(header)


def is_valid(folder: Path, work: Work, number: int) -> bool:
    """Return whether a shard is there, of this study and version, and as it was written.

    The kind of processor does not matter: verdicts are the same on all, numbers as accurate.
    """
    path = shard_path(folder, number)
    processor = noted_processor(path)
    if processor is None:
        return False
    try:
        with opened_plainly(path) as file:
            header = file.read(HEADER_BYTES)
            return header == _header(work, number, processor, _checksum(file))
    except OSError:
        return False


def noted_processor(shard: Path) -> str | None:
    """Return the kind of processor that a shard says it was computed on, if it says so."""
    try:
        with opened_plainly(shard) as file:
            return str(json.loads(file.read(HEADER_BYTES))["processor"])
    except (OSError, ValueError, TypeError, KeyError):
        return None


def _checksum(file: BinaryIO) -> str:
    """Return the SHA-256 of the CRC-32 of every mebibyte that is left of a file.

    What it guards against is accident; the SHA-256 of all of it would take as long as the writing.
    """
    digest = hashlib.sha256()
    while block := file.read(1 << 20):
        digest.update(isal_zlib.crc32(block).to_bytes(4, "big"))
    return digest.hexdigest()


def _header(work: Work, number: int, processor: str, checksum: str) -> bytes:
    content = {
        "standfast_shard": number,
        "of": work.shard_count,
        "study": work.fingerprint,
        "version": __version__,
        "processor": processor,
        "checksum": checksum,
    }
    return json.dumps(content).encode().ljust(HEADER_BYTES)
