"""A lock on an output that goes with the process, however it ends."""

import contextlib
import fcntl
import os
from collections.abc import Iterator
from pathlib import Path

from standfast.errors import InputError

ATTEMPTS = 20


class BusyError(InputError):
    """Another run holds the output."""


@contextlib.contextmanager
def locked(path: Path, target: Path, *, shared: bool = False) -> Iterator[None]:
    """Hold the lock ``path`` of the output ``target``, with others who share it or alone.

    Between opening the file and locking it, another run may finish and remove it: then the lock is
    of no file any more, and is taken anew.

    Raises
    ------
    BusyError
        while another run holds it.
    """
    for _ in range(ATTEMPTS):
        path.parent.mkdir(exist_ok=True)
        with contextlib.suppress(FileNotFoundError), path.open("a+", encoding="utf-8") as file:
            try:
                fcntl.flock(file, (fcntl.LOCK_SH if shared else fcntl.LOCK_EX) | fcntl.LOCK_NB)
            except BlockingIOError:
                file.seek(0)
                raise BusyError(
                    f"{target} is being written by another run{_alive(file.read())}; "
                    "wait for it or choose another output with -o"
                ) from None
            if os.fstat(file.fileno()).st_ino != path.stat().st_ino:
                continue
            if not shared:
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
