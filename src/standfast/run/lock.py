"""Locks on an output: they go with the process where the file system can, and name who holds them.

``flock`` is asked first. Network file systems that answer that they have none get a lock by link:
making a name is atomic everywhere. Its file says host, process and when that process began, so a
lock whose process died on this host is taken over; of another host nothing is known, and a person
must decide.
"""

import contextlib
import errno
import fcntl
import os
import socket
import stat
from collections.abc import Iterator
from pathlib import Path
from typing import IO

from standfast.errors import InputError
from standfast.files import is_running, partial_name

ATTEMPTS = 20

# How file systems say that they have no flock; 524 is the kernel's own ENOTSUPP, which NFS leaks.
NO_FLOCK = {errno.ENOTSUP, errno.EOPNOTSUPP, errno.ENOLCK, errno.ENOSYS, 524}


class BusyError(InputError):
    """Another run holds the output.

    Examples
    --------
    >>> import standfast as sf
    >>> try:
    ...     atlas = sf.open_atlas("running.h5")
    ... except sf.BusyError:
    ...     print("try again later")
    ... except sf.InputError as error:
    ...     print(error)
    running.h5: there is no such file
    """


@contextlib.contextmanager
def locked(path: Path, target: Path, *, shared: bool = False) -> Iterator[None]:
    """Hold the lock ``path`` of the output ``target``, with others who share it or alone.

    Raises
    ------
    BusyError
        while another run holds it.
    InputError
        if something else than a lock lies under its name.
    """
    with contextlib.ExitStack() as held:
        for _ in range(ATTEMPTS):
            path.parent.mkdir(exist_ok=True)
            try:
                taken = _flocked(held, path, target, shared=shared)
            except OSError as error:
                if error.errno not in NO_FLOCK:
                    raise
                taken = _linked(held, path, target, shared=shared)
            if taken:
                break
        else:
            raise BusyError(f"{target} is being finished by another run; try again")
        yield


def holders(folder: Path) -> list[str]:
    """Say which runs hold locks in a folder, as far as their locks tell."""
    texts = [_holder(path) for path in sorted(folder.glob("lock*"))]
    names = (_in_words(text) for text in texts if text and _may_live(text))
    return list(dict.fromkeys(filter(None, names)))


def _flocked(held: contextlib.ExitStack, path: Path, target: Path, *, shared: bool) -> bool:
    """Try to lock by flock; False if the lock's file went meanwhile, with a run that ended."""
    try:
        file = held.enter_context(_opened(path))
    except FileNotFoundError:
        return False
    try:
        fcntl.flock(file, (fcntl.LOCK_SH if shared else fcntl.LOCK_EX) | fcntl.LOCK_NB)
    except BlockingIOError:
        raise _busy(target, file.read()) from None
    try:
        if os.fstat(file.fileno()).st_ino != path.stat(follow_symlinks=False).st_ino:
            return False
    except FileNotFoundError:
        return False
    if not shared:
        file.truncate(0)
        file.write(_myself())
        file.flush()
    return True


def _opened(path: Path) -> IO[str]:
    """Open a lock's file; never through a link, and never anything but a plain file."""
    flags = os.O_RDWR | os.O_CREAT | os.O_APPEND | os.O_NOFOLLOW | os.O_NONBLOCK | os.O_CLOEXEC
    try:
        descriptor = os.open(path, flags, 0o666)
    except OSError as error:
        if error.errno in {errno.ELOOP, errno.EISDIR, errno.ENXIO}:
            raise InputError(f"{path} is not the file of a lock; remove it") from None
        raise
    if not stat.S_ISREG(os.fstat(descriptor).st_mode):
        os.close(descriptor)
        raise InputError(f"{path} is not the file of a lock; remove it")
    file = os.fdopen(descriptor, "a+", encoding="utf-8", errors="replace")
    file.seek(0)
    return file


def _linked(held: contextlib.ExitStack, path: Path, target: Path, *, shared: bool) -> bool:
    """Try to lock by link: one name for who is alone, a name of its own for each who shares."""
    own = partial_name(path)
    own.write_text(_myself(), encoding="utf-8")
    held.callback(own.unlink, missing_ok=True)
    alone = path.with_name(f"{path.name}.alone")
    mine = path.with_name(f"{path.name}.shared{own.suffixes[-2]}") if shared else alone
    try:
        os.link(own, mine)
    except FileExistsError:
        _require_dead(mine, target)
        return False
    held.callback(mine.unlink, missing_ok=True)
    # whoever comes second sees the first: each makes its name, then looks for the other kind
    others = [alone] if shared else list(path.parent.glob(f"{path.name}.shared.*"))
    for other in others:
        if other.exists():
            _require_dead(other, target)
    return True


def _require_dead(lock: Path, target: Path) -> None:
    """Remove the lock of a run that died on this host; refuse if it may live."""
    text = _read(lock)
    if text is None:
        return
    if _may_live(text):
        raise _busy(target, text, by_hand=lock)
    # moved away before it is removed: of two that found it dead, one moves it
    grave = partial_name(lock)
    with contextlib.suppress(FileNotFoundError):
        lock.rename(grave)
        grave.unlink()


def _read(path: Path) -> str | None:
    """Return what a lock says, None if it is gone."""
    try:
        descriptor = os.open(path, os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK | os.O_CLOEXEC)
    except OSError:
        return None
    with os.fdopen(descriptor, encoding="utf-8", errors="replace") as file:
        return file.read(200)


def _holder(path: Path) -> str | None:
    """Return what a lock says, None if nobody holds it."""
    with contextlib.suppress(OSError, InputError), _opened(path) as file:
        try:
            fcntl.flock(file, fcntl.LOCK_SH | fcntl.LOCK_NB)
        except OSError as error:  # held, or a file system where its being there is all
            if isinstance(error, BlockingIOError) or error.errno in NO_FLOCK:
                return file.read(200)
    return None


def _myself() -> str:
    return f"{socket.gethostname()} {os.getpid()} {_began(os.getpid())}"


def _began(process: int) -> str:
    """Return when a process began, in ticks since boot, ``-`` where the system does not say."""
    try:
        text = Path(f"/proc/{process}/stat").read_text(encoding="utf-8", errors="replace")
    except OSError:
        return "-"
    return text.rpartition(")")[2].split()[19]


def _may_live(holder: str) -> bool:
    """Return whether who a lock names may still run: on another host nobody can tell."""
    host, process, began = (*holder.split(), "", "", "")[:3]
    if host != socket.gethostname() or not process.isdecimal():
        return True
    return is_running(int(process)) and began == _began(int(process))


def _in_words(holder: str) -> str:
    """Name who holds a lock; empty if it does not say."""
    host, process = (*holder.split(), "", "")[:2]
    return f"process {process} on {host}" if process.isdecimal() else ""


def _busy(target: Path, holder: str, *, by_hand: Path | None = None) -> BusyError:
    name = _in_words(holder)
    who = f" ({name})" if name and _may_live(holder) else ""
    hint = f"; if that run is certainly dead, remove {by_hand}" if by_hand is not None else ""
    return BusyError(
        f"{target} is being written by another run{who}; wait for it or choose another output{hint}"
    )
