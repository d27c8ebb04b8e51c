"""The folder ``<name>.parts`` in which an atlas is made: lock, study, shards, and the finishing.

The set of valid shards is the journal: whatever was killed, what is missing is what no valid shard
covers. The finished name appears by one rename of a synced file, or not at all.
"""

import contextlib
import fcntl
import os
import shutil
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import IO

import h5py
from isal import isal_zlib

from standfast.quantities import InputError
from standfast.store.layout import LIBRARY_VERSION, write_layout
from standfast.store.shards import (
    Packed,
    is_valid,
    read_chunks,
    shard_path,
    sync_folder,
    write_chunks,
    write_shard,
)
from standfast.study import Study

STUDY_FILE = "study.json"
LOCK_FILE = "lock"


class BusyError(InputError):
    """Another run holds the output."""


@dataclass(frozen=True)
class Workplace:
    """The place where one study's atlas is made; use :func:`Workplace.enter`."""

    target: Path
    study: Study
    version: str
    folder: Path

    @classmethod
    @contextlib.contextmanager
    def enter(
        cls, target: Path, study: Study, version: str, *, part: tuple[int, int] | None = None
    ) -> Iterator["Workplace"]:
        """Take the lock of an output and check that the folder belongs to this study.

        A whole run excludes every other; parts of one study (``(i, N)``) only themselves.

        Raises
        ------
        BusyError
            while another run holds the output.
        InputError
            if the folder holds another study's shards, naming what differs.
        OSError
            if the folder cannot be made.
        """
        folder = parts_of(target)
        if not target.parent.is_dir():
            raise InputError(f"{target.parent} is not a folder; make it first, or name another")
        folder.mkdir(exist_ok=True)
        with contextlib.ExitStack() as locks:
            kind = fcntl.LOCK_EX if part is None else fcntl.LOCK_SH
            locks.enter_context(_locked(folder / LOCK_FILE, kind, target))
            if part is not None:
                name = f"{LOCK_FILE}-{part[0]}-of-{part[1]}"
                locks.enter_context(_locked(folder / name, fcntl.LOCK_EX, target))
            place = cls(target, study, version, folder)
            place._claim()
            yield place

    def _claim(self) -> None:
        """Write the study down, or compare with the one that is there."""
        path = self.folder / STUDY_FILE
        with contextlib.suppress(FileNotFoundError):
            text = path.read_text(encoding="utf-8")
            if text == self.study.canonical:
                return
            try:
                change = self.study.difference(Study.from_canonical(text))
            except InputError:
                change = f"{path.name} there is not a study"
            raise InputError(
                f"{self.folder} holds the beginnings of another study ({change}); "
                "finish that one, remove the folder, or choose another output"
            )
        partial = path.with_name(f".{path.name}.{os.getpid()}.partial")
        partial.write_text(self.study.canonical, encoding="utf-8")
        partial.replace(path)

    def missing(self) -> list[int]:
        """Return the shards that no valid file covers."""
        return [
            number
            for number in range(len(self.study.shards))
            if not is_valid(self.folder, self.study, self.version, number)
        ]

    def write(self, number: int, packed: list[Packed]) -> None:
        """Write one shard."""
        write_shard(self.folder, self.study, self.version, number, packed)

    def _all_chunks(self) -> Iterator[Packed]:
        """Go through the chunks of all shards in canonical order."""
        for number in range(len(self.study.shards)):
            with h5py.File(shard_path(self.folder, number), "r") as shard:
                yield from read_chunks(shard, self.study, self.study.shard(number))

    def finish(self) -> None:
        """Copy all chunks in canonical order into one file, verify, sync, rename, tidy up.

        Raises
        ------
        OSError
            if the disk does not take it; the shards stay.
        """
        partial = self.folder / ".atlas.partial"
        size = sum(
            shard_path(self.folder, number).stat().st_size
            for number in range(len(self.study.shards))
        )
        _require_room(self.folder, size)
        with h5py.File(partial, "w", libver=(LIBRARY_VERSION, "latest")) as file:
            write_layout(file, self.study, self.version)
            written = _Checksum()
            write_chunks(file, self.study, written.of(self._all_chunks()))
        read_back = _Checksum()
        with h5py.File(partial, "r") as file:
            tiles = (t for n in range(len(self.study.shards)) for t in self.study.shard(n))
            for _ in read_back.of(read_chunks(file, self.study, tiles)):
                pass
        if read_back.value != written.value:
            raise OSError(f"{partial} does not read back as it was written; is the disk sound?")
        _sync_file(partial)
        partial.replace(self.target)
        sync_folder(self.target.parent)
        shutil.rmtree(self.folder)


def beginnings(target: Path) -> tuple[Study, int] | None:
    """Return the study of an unfinished atlas and how many of its shards are there; else None."""
    folder = parts_of(target)
    try:
        study = Study.from_canonical((folder / STUDY_FILE).read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError, InputError):
        return None
    return study, sum(shard_path(folder, n).is_file() for n in range(len(study.shards)))


def parts_of(target: Path) -> Path:
    """Return the folder in which an atlas is made."""
    return target.with_name(f"{target.name}.parts")


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


@contextlib.contextmanager
def _locked(path: Path, kind: int, target: Path) -> Iterator[IO[str]]:
    """Hold a lock that goes with the process, however it ends."""
    with path.open("a+", encoding="utf-8") as file:
        try:
            fcntl.flock(file, kind | fcntl.LOCK_NB)
        except BlockingIOError:
            file.seek(0)
            holder = file.read().strip()
            who = f" (process {holder})" if holder else ""
            raise BusyError(
                f"{target} is being written by another run{who}; "
                "wait for it or choose another output with -o"
            ) from None
        if kind == fcntl.LOCK_EX:
            file.truncate(0)
            file.write(str(os.getpid()))
            file.flush()
        yield file


def _require_room(folder: Path, size: int) -> None:
    free = shutil.disk_usage(folder).free
    if free < size:
        raise OSError(
            28,
            f"no space left on device: finishing needs {size} bytes, {free} are free",
            str(folder),
        )


def _sync_file(path: Path) -> None:
    with path.open("rb") as file:
        os.fsync(file.fileno())
