"""Compiled programs, kept from one command to the next in a private folder of the user's cache.

The second command of a kind compiles nothing: a sweep of ``studies/atlas.toml`` takes 1.5 s in
place of 2.9, a population of four million 3.6 s in place of 6.2.

JAX keeps the programs itself, its persistent compilation cache; it is asked to by the environment,
before it is imported. What it loads is machine code. So the folder must be the user's alone, kinds
of processors have a folder each, and an entry is loaded only if it is as it was written. JAX itself
writes without renaming and never replaces an entry that it could not read; and where it compresses
with zstd (Python 3.14, or the package zstandard), one bit turned over in each entry brought nine
runs of 27 down and gave wrong numbers in four. So the folder holds a list of checksums, and
what differs from it is removed first.
"""

import contextlib
import hashlib
import os
import platform
import stat
import warnings
from collections.abc import Iterator, Mapping
from pathlib import Path

from standfast.files import whole_file

SWITCH = "STANDFAST_COMPILE_CACHE"  # off, or another folder
FOLDER_OF_JAX = "JAX_COMPILATION_CACHE_DIR"
KEEP_ALL = {
    "JAX_PERSISTENT_CACHE_MIN_COMPILE_TIME_SECS": "0",
    "JAX_PERSISTENT_CACHE_MIN_ENTRY_SIZE_BYTES": "-1",
}

# A study's programs take 0.2 to 0.5 MB. JAX's own limit needs a package more.
LARGEST_BYTES = 32 * 2**20

ENTRIES = "*-cache"
CHECKSUMS = "SHA256SUMS"


@contextlib.contextmanager
def compiled_programs_kept() -> Iterator[None]:
    """Let JAX, if it is imported in this block, keep what it compiles, where that is safe.

    A user's own setting for JAX is left alone. Whatever is wrong with the folder, or with what is
    in it, costs the compiling anew and nothing else.
    """
    prepared = None if os.environ.get(FOLDER_OF_JAX) else _prepared()
    if prepared is None:
        yield
        return
    folder, verified = prepared
    os.environ.update({FOLDER_OF_JAX: str(folder), **KEEP_ALL})
    # an entry that cannot be read or written is no matter of the user's
    warnings.filterwarnings("ignore", "Error (reading|writing) persistent compilation cache")
    yield
    with contextlib.suppress(OSError):
        _write_checksums(folder, verified)


def _prepared() -> tuple[Path, dict[str, str]] | None:
    """Return the folder for this kind of processor and what is sound in it; None to do without."""
    switch = os.environ.get(SWITCH)
    if switch == "off":
        return None
    try:
        caches = Path(os.environ.get("XDG_CACHE_HOME") or "~/.cache").expanduser()
        folder = Path(switch or caches / "standfast").absolute() / f"compiled-{_processor()}"
        folder.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
        folder.mkdir(mode=0o700, exist_ok=True)
        return (folder, _verified(folder)) if _is_private(folder) else None
    except (OSError, RuntimeError):  # RuntimeError: no home
        return None


def _processor() -> str:
    """Return a short name for processors that run the same machine code."""
    try:
        with Path("/proc/cpuinfo").open(encoding="utf-8", errors="replace") as lines:
            known = next(line for line in lines if line.startswith(("flags", "Features")))
    except (OSError, StopIteration):
        known = platform.processor()
    return hashlib.sha256(f"{platform.machine()} {known}".encode()).hexdigest()[:16]


def _is_private(folder: Path) -> bool:
    """Return whether a folder is no link, the user's own, and not writable by others."""
    found = folder.lstat()
    own = stat.S_ISDIR(found.st_mode) and found.st_uid == os.geteuid()
    return own and not found.st_mode & (stat.S_IWGRP | stat.S_IWOTH)


def _verified(folder: Path) -> dict[str, str]:
    """Return the checksums of the entries that are as they were written; remove the others.

    Of too many the oldest are removed.
    """
    listed = _listed(folder)
    verified = {}
    room = LARGEST_BYTES
    for entry in sorted(folder.glob(ENTRIES), key=lambda path: -path.stat().st_mtime):
        content = entry.read_bytes()
        checksum = hashlib.sha256(content).hexdigest()
        if listed.get(entry.name) == checksum and len(content) <= room:
            verified[entry.name] = checksum
            room -= len(content)
        else:
            entry.unlink(missing_ok=True)
    return verified


def _listed(folder: Path) -> dict[str, str]:
    """Read the list of checksums, in the format of ``sha256sum``."""
    try:
        lines = (folder / CHECKSUMS).read_text(encoding="utf-8").splitlines()
    except (OSError, UnicodeDecodeError):
        return {}
    return {name: checksum for checksum, _, name in (line.partition("  ") for line in lines)}


def _write_checksums(folder: Path, verified: Mapping[str, str]) -> None:
    """List what was verified and what was written since."""
    found = {
        entry.name: verified.get(entry.name) or hashlib.sha256(entry.read_bytes()).hexdigest()
        for entry in sorted(folder.glob(ENTRIES))
    }
    if found != _listed(folder):
        with whole_file(folder / CHECKSUMS) as partial:
            text = "".join(f"{checksum}  {name}\n" for name, checksum in found.items())
            partial.write_text(text, encoding="utf-8")
