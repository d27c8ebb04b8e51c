"""The folder ``<name>.parts`` in which a file is made: lock, study, shards, and the finishing.

The set of valid shards is the journal: whatever was killed, what is missing is what no valid shard
covers. The finished name appears at once and whole, or not at all.
"""

import contextlib
import errno
import json
import os
import shutil
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Generic, TypeVar

from standfast.errors import InputError
from standfast.files import PARTIAL, partial_name, sync_file, sync_folder, whole_file, writer_of
from standfast.run.lock import BusyError, holders, locked
from standfast.run.machine import kind_of_processor
from standfast.run.shards import Work, is_valid, new_shard, noted_processor, shard_path

W = TypeVar("W", bound=Work)

STUDY_FILE = "study.json"
LOCK_FILE = "lock"
LOG_FILE = "run.json"

# How file systems say that a file cannot have two names.
NO_LINKS = {errno.EPERM, errno.ENOTSUP, errno.EOPNOTSUPP, errno.ENOSYS, errno.EMLINK, 524}


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

        A whole run excludes every other; parts of one study (``(i, N)``) only themselves. What was
        refused before its first shard leaves no folder behind.

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
        if target.is_symlink() and not target.exists():
            raise InputError(f"{target} is a link to nothing; remove it, or name another output")
        path = parts_of(target)
        with contextlib.ExitStack() as locks:
            locks.enter_context(locked(path / LOCK_FILE, target, shared=part is not None))
            _require_one_disk(path, target)
            if part is not None:
                name = f"{LOCK_FILE}-{part[0]}-of-{part[1]}"
                locks.enter_context(locked(path / name, target))
            else:
                for leftover in path.glob(f".*{PARTIAL}"):  # of runs that were killed
                    leftover.unlink(missing_ok=True)
            folder = cls(target, study, path)
            folder._claim()
            try:
                yield folder
            except InputError:
                if part is None and not any(path.glob("shard-*")):
                    tidy(path)
                raise

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

    def is_of_its_study(self) -> bool:
        """Return whether the folder is there and says that it is of this study."""
        there = _study_in(self.path / STUDY_FILE, type(self.study))
        return there is not None and there.fingerprint == self.study.fingerprint

    def missing(self, numbers: Iterable[int]) -> list[int]:
        """Return those shards that no valid file covers.

        The folder is listed first: network file systems then ask anew what lies in it.
        """
        list(self.path.iterdir())
        return [number for number in numbers if not is_valid(self.path, self.study, number)]

    def processors(self) -> list[str]:
        """Return the kinds of processors that the shards there and this run were computed on."""
        noted = (noted_processor(path) for path in self.path.glob("shard-*"))
        return sorted({kind_of_processor(), *filter(None, noted)})

    @property
    def stored_bytes(self) -> int:
        """Size of all shards that are there, as far as they are of this study."""
        with os.scandir(self.path) as files:
            return sum(file.stat().st_size for file in files if file.name.startswith("shard-"))

    def new_shard(self, number: int) -> contextlib.AbstractContextManager[Path]:
        """Give the temporary file of a shard, which becomes the shard once the block ends."""
        return new_shard(self.path, self.study, number)

    def finish(self, assemble: Callable[[Path], None], log: Callable[[int], str]) -> None:
        """Let ``assemble`` write the file under a temporary name; sync, name it, tidy up.

        ``log`` gives the text of the run's log for the file's size. It is written first, so that
        whoever finds the finished file of a run that was killed can put its log beside it.

        Raises
        ------
        InputError
            if another file came to lie under the output's name meanwhile; the shards stay.
        OSError
            if the disk does not take it; the shards stay.
        """
        partial = self.path / f".whole{PARTIAL}"
        require_room(self.path, self.stored_bytes)
        try:
            assemble(partial)
            sync_file(partial)
            # a courtesy that a full disk may refuse
            with contextlib.suppress(OSError):
                text = log(partial.stat().st_size)
                (self.path / LOG_FILE).write_text(text, encoding="utf-8")
            _name_new(partial, self.target)
        except OSError as error:
            if error.filename == str(partial):
                error.filename = str(self.target)
            raise
        finally:
            partial.unlink(missing_ok=True)
        sync_folder(self.target.parent)
        _put_log_beside(self.target)
        tidy(self.path)


def unfinished(target: Path, kind: type[W]) -> tuple[W, list[int]] | None:
    """Return the study of an unfinished file and which of its shards are missing; else None."""
    folder = parts_of(target)
    study = _study_in(folder / STUDY_FILE, kind)
    if study is None:
        return None
    return study, [n for n in range(study.shard_count) if not shard_path(folder, n).is_file()]


def writers_of(target: Path) -> list[str]:
    """Say who writes an unfinished file: runs that hold its locks, processes with a shard begun."""
    folder = parts_of(target)
    words = [f"a run: {holder}" for holder in holders(folder)]
    for partial in sorted(folder.glob(f".shard-*{PARTIAL}")):
        host, process = writer_of(partial) or ("", 0)
        shard = partial.name.split(".")[1]
        words.append(f"process {process} on {host}: {shard}, begun")
    return words


def tidy_up_after(target: Path, study: Work) -> None:
    """Remove the folder of a finished file that a run killed at its very end left behind."""
    folder = parts_of(target)
    there = _study_in(folder / STUDY_FILE, type(study))
    if there is not None and there.fingerprint == study.fingerprint:
        with contextlib.suppress(BusyError, OSError), locked(folder / LOCK_FILE, target):
            _put_log_beside(target)
            tidy(folder)
    _remove_moved_away(folder)


def parts_of(target: Path) -> Path:
    """Return the folder in which a file is made."""
    return target.with_name(f"{target.name}.parts")


def tidy(folder: Path) -> None:
    """Remove a folder whose lock is held: moved away first, so that a straggler finds none."""
    with contextlib.suppress(OSError):
        folder.rename(partial_name(folder))
    _remove_moved_away(folder)


def _remove_moved_away(folder: Path) -> None:
    for moved in folder.parent.glob(f".{folder.name}.*{PARTIAL}"):
        shutil.rmtree(moved, ignore_errors=True)


def _put_log_beside(target: Path) -> None:
    log = parts_of(target) / LOG_FILE
    with contextlib.suppress(OSError):
        log.replace(target.with_name(f"{target.name.removesuffix('.h5')}.run.json"))


def _name_new(partial: Path, target: Path) -> None:
    """Give a file its name, unless one of that name is there: a second name, then no first."""
    try:
        os.link(partial, target)
    except OSError as error:
        there = error.errno == errno.EEXIST or (error.errno in NO_LINKS and os.path.lexists(target))
        if there:
            raise InputError(
                f"{target} came to be while it was computed, by other hands; move it away, then "
                "the same command finishes"
            ) from None
        if error.errno not in NO_LINKS:
            raise
        partial.rename(target)


def _require_one_disk(folder: Path, target: Path) -> None:
    """Refuse at the start what no rename could end."""
    if folder.is_symlink() or folder.stat().st_dev != target.parent.stat().st_dev:
        raise InputError(f"{folder} is a link, or on another file system than {target}; remove it")


def _study_in(path: Path, kind: type[W]) -> W | None:
    """Return the study in a folder, None if there is no plain file with one."""
    try:
        if not path.is_file():
            return None
        return kind.from_canonical(path.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError, InputError):
        return None


def _is_json(path: Path) -> bool:
    """Return whether a study file is whole, though not of the kind that is looked for."""
    try:
        return path.is_file() and "title" in json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError, TypeError, RecursionError):
        return False


def require_room(folder: Path, size: int) -> None:
    """Refuse to begin what the disk has no room to end."""
    free = shutil.disk_usage(folder).free
    if free < size:
        reason = f"no space left on device: finishing needs {size} bytes, {free} are free"
        raise OSError(errno.ENOSPC, reason, os.fspath(folder))
