"""What a run will take, estimated from a few of its units."""

import shutil
from dataclasses import dataclass
from pathlib import Path

from standfast.errors import InputError
from standfast.files import in_bytes

# One unit in so many of each kind is computed for the estimate, a few at most.
SAMPLED_SHARE, MOST_SAMPLED = 32, 8

# What a file needs beside its content.
LAYOUT_BYTES = 40_000


@dataclass(frozen=True, slots=True)
class Estimate:
    """What a run will take, estimated from some units of each kind; compiling is not counted.

    ``points`` are the values, or persons, that are to be computed.
    """

    points: int
    disk_bytes: int
    seconds: float
    free_bytes: int

    def require_room(self, target: Path, what: str) -> None:
        """Refuse a run that the disk cannot take.

        Raises
        ------
        InputError
            naming what is needed and what is free.
        """
        if self.disk_bytes > self.free_bytes:
            raise InputError(
                f"the study needs about {in_bytes(self.disk_bytes)} of disk until it is "
                f"finished, and {in_bytes(self.free_bytes)} are free beside {target}; "
                f"take fewer {what} or another disk"
            )


def sample(count: int) -> list[int]:
    """Return which of ``count`` units of one kind are computed for the estimate, evenly spread."""
    wanted = min(MOST_SAMPLED, -(-count // SAMPLED_SHARE))
    return [(2 * i + 1) * count // (2 * wanted) for i in range(wanted)]


def disk_needed(content: float, shards: int, *, stored: int, finishes: bool) -> int:
    """Return the bytes that a run needs until it is finished.

    ``content`` is what it computes, in ``shards``; ``stored`` what lies there already. All shards
    but the last that is computed lie beside the file until it is finished.
    """
    made = shards - 1 if finishes else shards
    disk = content * made / shards + LAYOUT_BYTES * made
    if finishes:
        disk += content + stored + LAYOUT_BYTES
    return int(disk)


def free_bytes(folder: Path) -> int:
    """Return what is free on a folder's disk."""
    return shutil.disk_usage(folder).free
