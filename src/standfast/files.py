"""Files that are whole or not there: one way to write them, and to say how large they are."""

import contextlib
import difflib
import errno
import glob
import os
import secrets
import socket
import stat
from collections.abc import Iterator
from pathlib import Path
from typing import Any, BinaryIO, TextIO

from standfast.errors import InputError, shortened

PARTIAL = ".partial"
# How alike two names are, from 0 to 1, of which one may be a slip for the other.
NEAR = 0.6
# How the names of columns of a table say units.
COLUMN_UNITS = {
    "mm²": "mm2", "mm/s": "mm_s", "m/s": "m_s", "°": "deg", "1/s": "per_s", "N·m/rad": "Nm_rad",
    "N·m·s/rad": "Nms_rad", "N·m·√s": "Nm_sqrt_s",
}  # fmt: skip


def checked_path(name: str, given: Any) -> Path:
    """Return the path of a file that a user gives as a text or a ``Path``."""
    if not isinstance(given, str | os.PathLike):
        raise InputError(f"{name} = {shortened(given)} is not the name of a file")
    return Path(given)


def nearest_file(path: Path, suffix: str) -> str:
    """Return ``"; did you mean 'x.toml'?"`` if a file of that name nearly lies in the folder.

    Only files that end in ``suffix`` are named. Their names are compared without it, as it would
    make all of them alike.
    """
    names = {each.stem: each.name for each in path.parent.glob(f"*{glob.escape(suffix)}")}
    close = difflib.get_close_matches(path.stem, names, n=1, cutoff=NEAR)
    return f"; did you mean {str(path.with_name(names[close[0]]))!r}?" if close else ""


def partial_name(path: Path) -> Path:
    """Return a hidden name beside ``path`` that no other process, here or elsewhere, takes.

    Process numbers repeat between the machines that share a file system, so the name carries the
    host and a random part too.
    """
    return path.with_name(f".{path.name}.{_host()}.{os.getpid()}.{secrets.token_hex(4)}{PARTIAL}")


def writer_of(partial: Path) -> tuple[str, int] | None:
    """Return host and process that a name of :func:`partial_name` carries; None of any other."""
    *_, host, process, _, _ = ["", "", "", *partial.name.split(".")]
    return (host, int(process)) if process.isdecimal() and partial.suffix == PARTIAL else None


def _host() -> str:
    return socket.gethostname().partition(".")[0]


@contextlib.contextmanager
def whole_file(path: Path, *, synced: bool = False) -> Iterator[Path]:
    """Give a temporary name, and rename what is written there to ``path`` when the block ends.

    If the block fails nothing is left; what killed processes of this host left is removed.
    ``synced`` makes file and name survive a power loss.

    Raises
    ------
    OSError
        if the disk does not take it, or anything but a plain file is there; it names ``path``.
    """
    _require_plain(path)
    partial = partial_name(path)
    _remove_orphans(path)
    try:
        yield partial
        if synced:
            sync_file(partial)
        partial.replace(path)
    except OSError as error:
        if error.filename is None or Path(os.fsdecode(error.filename)) == partial:
            error.filename, error.filename2 = str(path), None
        raise
    finally:
        with contextlib.suppress(OSError):
            partial.unlink(missing_ok=True)
    if synced:
        sync_folder(path.parent)


def column_name(name: str, unit: str) -> str:
    """Return the name of a table's column with its unit, as ``sd_ap_mm``; of 1 the name alone."""
    return name if unit == "1" else f"{name}_{COLUMN_UNITS.get(unit, unit)}"


def require_replaceable(table: Path, header: str, kind: str = "table") -> None:
    """Refuse a name under which anything lies but a table, or another kind, with this ``header``.

    Raises
    ------
    InputError
        if another file is there; what is no plain file is left to :func:`whole_file`.
    """
    try:
        with opened_plainly(table) as file:
            first = file.read(len(header.encode()) + 2).decode(errors="replace")
    except FileNotFoundError:
        return
    except OSError:  # a folder or a device, or not to be read
        _require_plain(table)
        first = ""
    whole_names = first[len(header) :][:1] in ("", ",", "\r", "\n")
    if not first.startswith(header) or not whole_names:
        raise InputError(
            f"{table} is there and is no {kind} of standfast of this kind; choose another name or "
            "remove it"
        )


@contextlib.contextmanager
def whole_table(path: Path, header: str) -> Iterator[TextIO]:
    """Give a text file for a table whose first line begins with ``header``.

    It is whole or not there, and replaces nothing but a table with the same header.
    """
    require_replaceable(path, header)
    with whole_file(path) as partial, partial.open("w", encoding="utf-8", newline="") as file:
        yield file


def _require_plain(path: Path) -> None:
    """Refuse to replace a folder, a pipe, a device or a link to nothing."""
    try:
        mode = path.stat().st_mode
    except FileNotFoundError:
        if path.is_symlink():
            raise OSError(errno.ENOENT, "a link to nothing", str(path)) from None
        return
    if not stat.S_ISREG(mode):
        raise OSError(errno.EINVAL, "not a plain file", str(path))


def _remove_orphans(path: Path) -> None:
    """Remove what processes of this host that are gone left of a file."""
    for orphan in path.parent.glob(f".{glob.escape(path.name)}.*{PARTIAL}"):
        host, process = writer_of(orphan) or ("", 0)
        if host == _host() and not is_running(process):
            with contextlib.suppress(OSError):
                orphan.unlink()


def is_running(process: int) -> bool:
    """Return whether a process of this host runs."""
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    except OSError:  # it is another's
        return True
    return True


def opened_plainly(path: Path) -> BinaryIO:
    """Open a plain file for reading; never wait for a pipe or a device.

    Raises
    ------
    OSError
        if there is none, or it is anything but a plain file.
    """
    descriptor = os.open(path, os.O_RDONLY | os.O_NONBLOCK | os.O_CLOEXEC)
    mode = os.fstat(descriptor).st_mode
    if not stat.S_ISREG(mode):
        os.close(descriptor)
        if stat.S_ISDIR(mode):
            raise IsADirectoryError(errno.EISDIR, "it is a folder", str(path))
        raise OSError(errno.EINVAL, "not a plain file", str(path))
    return os.fdopen(descriptor, "rb")


def for_spreadsheets(text: str) -> str:
    """Return a text with an apostrophe before it if a spreadsheet would run it as a formula."""
    return f"'{text}" if text.startswith(("=", "+", "-", "@", "\t", "\r")) else text


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
