"""The folder ``<name>.parts`` in which a file is made: lock, study, shards, and the finishing.

The set of valid shards is the journal: whatever was killed, what is missing is what no valid shard
covers. The finished name appears by one rename of a synced file, or not at all.
"""

import contextlib
import errno
import fcntl
import json
import os
import shutil
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Generic, TypeVar

from standfast.quantities import InputError
from standfast.store.shards import (
    HEADER_BYTES,
    Work,
    is_valid,
    shard_in_making,
    shard_path,
    sync_file,
    sync_folder,
)

W = TypeVar("W", bound=Work)

STUDY_FILE = "study.json"
LOCK_FILE = "lock"
ATTEMPTS = 20


class BusyError(InputError):
    """Another run holds the output."""


@dataclass(frozen=True)
class Workplace(Generic[W]):
    """The place where one study's file is made; use :func:`Workplace.enter`."""

    target: Path
    study: W
    version: str
    folder: Path

    @classmethod
    @contextlib.contextmanager
    def enter(
        cls, target: Path, study: W, version: str, *, part: tuple[int, int] | None = None
    ) -> Iterator["Workplace[W]"]:
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
        if not target.parent.is_dir():
            raise InputError(f"{target.parent} is not a folder; make it first, or name another")
        folder = parts_of(target)
        with contextlib.ExitStack() as locks:
            kind = fcntl.LOCK_EX if part is None else fcntl.LOCK_SH
            locks.enter_context(_locked(folder / LOCK_FILE, kind, target))
            if part is not None:
                name = f"{LOCK_FILE}-{part[0]}-of-{part[1]}"
                locks.enter_context(_locked(folder / name, fcntl.LOCK_EX, target))
            else:
                for leftover in folder.glob(".*.partial"):  # of runs that were killed
                    leftover.unlink(missing_ok=True)
            place = cls(target, study, version, folder)
            place._claim()
            yield place

    def _claim(self) -> None:
        """Write the study down, or compare with the one that is there.

        A study file that cannot be read is written again: shards carry the fingerprint themselves.
        """
        path = self.folder / STUDY_FILE
        there = _study_in(path, type(self.study))
        if there is None and _is_json(path):
            raise InputError(
                f"{self.folder} holds the beginnings of another kind of study; "
                "finish that one, remove the folder, or choose another output"
            )
        if there is None:
            partial = path.with_name(f".{path.name}.{os.getpid()}.partial")
            partial.write_text(self.study.canonical, encoding="utf-8")
            sync_file(partial)
            partial.replace(path)
            sync_folder(self.folder)
        elif there.fingerprint != self.study.fingerprint:
            raise InputError(
                f"{self.folder} holds the beginnings of another study "
                f"({self.study.difference(there)}); "
                "finish that one, remove the folder, or choose another output"
            )

    def missing(self) -> list[int]:
        """Return the shards that no valid file covers."""
        return [
            number
            for number in range(self.study.shard_count)
            if not is_valid(self.folder, self.study, self.version, number)
        ]

    @property
    def stored_bytes(self) -> int:
        """Size of all shards that are there, as far as they are of this study."""
        shards = (shard_path(self.folder, number) for number in range(self.study.shard_count))
        return sum(path.stat().st_size for path in shards if path.is_file())

    def shard(self, number: int) -> contextlib.AbstractContextManager[Path]:
        """Give the temporary file of a shard, which becomes the shard once the block ends."""
        return shard_in_making(self.folder, self.study, self.version, number)

    def write(self, number: int, content: bytes) -> None:
        """Write one shard whose content is at hand."""
        with self.shard(number) as partial, partial.open("wb") as file:
            file.seek(HEADER_BYTES)
            file.write(content)

    def finish(self, assemble: Callable[[Path], None]) -> None:
        """Let ``assemble`` write the file under a temporary name; sync, rename, tidy up.

        Raises
        ------
        OSError
            if the disk does not take it; the shards stay.
        """
        partial = self.folder / ".whole.partial"
        _require_room(self.folder, self.stored_bytes)
        try:
            assemble(partial)
            sync_file(partial)
            partial.replace(self.target)
        finally:
            partial.unlink(missing_ok=True)
        sync_folder(self.target.parent)
        _tidy(self.folder)


@contextlib.contextmanager
def failures_of_hdf5(path: Path) -> Iterator[None]:
    """Turn those of HDF5's failures to write that h5py gives as RuntimeError into OSError."""
    try:
        yield
    except RuntimeError as error:
        reason = str(error).splitlines()[0]
        raise OSError(errno.EIO, f"HDF5 could not write ({reason})", str(path)) from None


def beginnings(target: Path, kind: type[W]) -> tuple[W, int] | None:
    """Return the study of an unfinished file and how many of its shards are there; else None."""
    folder = parts_of(target)
    study = _study_in(folder / STUDY_FILE, kind)
    if study is None:
        return None
    return study, sum(shard_path(folder, n).is_file() for n in range(study.shard_count))


def tidy_up_after(target: Path, study: Work) -> None:
    """Remove the folder of a finished file that a run killed at its very end left behind."""
    folder = parts_of(target)
    there = _study_in(folder / STUDY_FILE, type(study))
    if there is not None and there.fingerprint == study.fingerprint:
        with (
            contextlib.suppress(BusyError, OSError),
            _locked(folder / LOCK_FILE, fcntl.LOCK_EX, target),
        ):
            _tidy(folder)


def parts_of(target: Path) -> Path:
    """Return the folder in which a file is made."""
    return target.with_name(f"{target.name}.parts")


def _study_in(path: Path, kind: type[W]) -> W | None:
    try:
        return kind.from_canonical(path.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError, InputError):
        return None


def _is_json(path: Path) -> bool:
    """Return whether a study file is whole, though not of the kind that is looked for."""
    try:
        return "title" in json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError, TypeError, RecursionError):
        return False


def _tidy(folder: Path) -> None:
    """Remove a folder whose lock is held, the lock last; a newcomer's lock is left alone."""
    for item in folder.iterdir():
        if item.name != LOCK_FILE:
            shutil.rmtree(item) if item.is_dir() else item.unlink(missing_ok=True)
    with contextlib.suppress(OSError):
        (folder / LOCK_FILE).unlink()
        folder.rmdir()


@contextlib.contextmanager
def _locked(path: Path, kind: int, target: Path) -> Iterator[None]:
    """Hold a lock that goes with the process, however it ends.

    Between opening the file and locking it, another run may finish and remove it: then the lock is
    of no file any more, and is taken anew.
    """
    for _ in range(ATTEMPTS):
        path.parent.mkdir(exist_ok=True)
        with contextlib.suppress(FileNotFoundError), path.open("a+", encoding="utf-8") as file:
            try:
                fcntl.flock(file, kind | fcntl.LOCK_NB)
            except BlockingIOError:
                file.seek(0)
                raise BusyError(
                    f"{target} is being written by another run{_alive(file.read())}; "
                    "wait for it or choose another output with -o"
                ) from None
            if os.fstat(file.fileno()).st_ino != path.stat().st_ino:
                continue
            if kind == fcntl.LOCK_EX:
                file.truncate(0)
                file.write(str(os.getpid()))
                file.flush()
            yield
            return
    raise BusyError(f"{target} is being finished by another run; try again")


def _alive(holder: str) -> str:
    """Return the process that a lock names, in words, if it still runs."""
    if not holder.strip().isdecimal():
        return ""
    try:
        os.kill(int(holder), 0)
    except OSError:
        return ""
    return f" (process {holder.strip()})"


def _require_room(folder: Path, size: int) -> None:
    free = shutil.disk_usage(folder).free
    if free < size:
        reason = f"no space left on device: finishing needs {size} bytes, {free} are free"
        raise OSError(errno.ENOSPC, reason, str(folder))
