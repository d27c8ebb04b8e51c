"""Files that are whole or not there: one way to write them, and to say how large they are."""

import contextlib
import os
import secrets
import socket
from collections.abc import Iterator
from pathlib import Path

PARTIAL = ".partial"


def partial_name(path: Path) -> Path:
    """Return a hidden name beside ``path`` that no other process, here or elsewhere, takes.

    Process numbers repeat between the machines that share a file system, so the name carries the
    host and a random part too.
    """
    host = socket.gethostname().partition(".")[0]
    return path.with_name(f".{path.name}.{host}.{os.getpid()}.{secrets.token_hex(4)}{PARTIAL}")


@contextlib.contextmanager
def whole_file(path: Path, *, synced: bool = False) -> Iterator[Path]:
    """Give a temporary name, and rename what is written there to ``path`` when the block ends.

    If the block fails nothing is left. ``synced`` makes file and name survive a power loss.
    """
    partial = partial_name(path)
    try:
        yield partial
        if synced:
            sync_file(partial)
        partial.replace(path)
    finally:
        with contextlib.suppress(OSError):
            partial.unlink(missing_ok=True)
    if synced:
        sync_folder(path.parent)


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


def in_bytes(size: float) -> str:
    """Return a number of bytes as people read it, for example ``12.6 MB``."""
    for unit in ("bytes", "kB", "MB", "GB"):
        if size < 1000.0:
            return f"{size:.3g} {unit}"
        size /= 1000.0
    return f"{size:.3g} TB"
