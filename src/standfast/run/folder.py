"""The folder ``<name>.parts`` in which a file is made: lock, study, shards, and the finishing.

The set of valid shards is the journal: whatever was killed, what is missing is what no valid shard
covers. The finished name appears by one rename of a synced file, or not at all.
"""

import contextlib
import errno
import json
import os
import shutil
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Generic, TypeVar

from standfast.errors import InputError
from standfast.files import PARTIAL, sync_file, sync_folder, whole_file
from standfast.run.lock import BusyError, locked
from standfast.run.shards import Work, is_valid, new_shard, shard_path

W = TypeVar("W", bound=Work)

STUDY_FILE = "study.json"
LOCK_FILE = "lock"


@dataclass(frozen=True)
class RunFolder(Generic[W]):
    """The folder in which one study's file is made; use :func:`RunFolder.enter`."""

    target: Path
    study: W
    path: Path

    @classmethod
    @contextlib.contextmanager
    def enter(
        cls, target: Path, study: W, *, part: tuple[int, int] | None = None
    ) -> Iterator["RunFolder[W]"]:
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
        path = parts_of(target)
        with contextlib.ExitStack() as locks:
            locks.enter_context(locked(path / LOCK_FILE, target, shared=part is not None))
            if part is not None:
                name = f"{LOCK_FILE}-{part[0]}-of-{part[1]}"
                locks.enter_context(locked(path / name, target))
            else:
                for leftover in path.glob(f".*{PARTIAL}"):  # of runs that were killed
                    leftover.unlink(missing_ok=True)
            folder = cls(target, study, path)
            folder._claim()
            yield folder

    def _claim(self) -> None:
        """Write the study down, or compare with the one that is there.

        A study file that cannot be read is written again: shards carry the fingerprint themselves.
        """
        path = self.path / STUDY_FILE
        there = _study_in(path, type(self.study))
        if there is None and _is_json(path):
            raise InputError(
                f"{self.path} holds the beginnings of another kind of study; "
                "finish that one, remove the folder, or choose another output"
            )
        if there is None:
            with whole_file(path, synced=True) as partial:
                partial.write_text(self.study.canonical, encoding="utf-8")
        elif there.fingerprint != self.study.fingerprint:
            raise InputError(
                f"{self.path} holds the beginnings of another study "
                f"({self.study.difference(there)}); "
                "finish that one, remove the folder, or choose another output"
            )

    def missing(self) -> list[int]:
        """Return the shards that no valid file covers."""
        return [
            number
            for number in range(self.study.shard_count)
            if not is_valid(self.path, self.study, number)
        ]

    @property
    def stored_bytes(self) -> int:
        """Size of all shards that are there, as far as they are of this study."""
        shards = (shard_path(self.path, number) for number in range(self.study.shard_count))
        return sum(path.stat().st_size for path in shards if path.is_file())

    def new_shard(self, number: int) -> contextlib.AbstractContextManager[Path]:
        """Give the temporary file of a shard, which becomes the shard once the block ends."""
        return new_shard(self.path, self.study, number)

    def finish(self, assemble: Callable[[Path], None]) -> None:
        """Let ``assemble`` write the file under a temporary name; sync, rename, tidy up.

        Raises
        ------
        OSError
            if the disk does not take it; the shards stay.
        """
        partial = self.path / f".whole{PARTIAL}"
        require_room(self.path, self.stored_bytes)
        try:
            assemble(partial)
            sync_file(partial)
            partial.replace(self.target)
        finally:
            partial.unlink(missing_ok=True)
        sync_folder(self.target.parent)
        tidy(self.path)


def unfinished(target: Path, kind: type[W]) -> tuple[W, int] | None:
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
        with contextlib.suppress(BusyError, OSError), locked(folder / LOCK_FILE, target):
            tidy(folder)


def parts_of(target: Path) -> Path:
    """Return the folder in which a file is made."""
    return target.with_name(f"{target.name}.parts")


def tidy(folder: Path) -> None:
    """Remove a folder whose lock is held, the lock last; a newcomer's lock is left alone."""
    for item in folder.iterdir():
        if item.name != LOCK_FILE:
            shutil.rmtree(item) if item.is_dir() else item.unlink(missing_ok=True)
    with contextlib.suppress(OSError):
        (folder / LOCK_FILE).unlink()
        folder.rmdir()


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


def require_room(folder: Path, size: int) -> None:
    """Refuse to begin what the disk has no room to end."""
    free = shutil.disk_usage(folder).free
    if free < size:
        reason = f"no space left on device: finishing needs {size} bytes, {free} are free"
        raise OSError(errno.ENOSPC, reason, os.fspath(folder))
