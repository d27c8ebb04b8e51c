"""How the grid of a study is cut: groups of quantities, chunks, tiles and shards.

Everything follows from the study alone, nothing from the machine, so the same study always gives
the same file.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from standfast.quantities import QUANTITIES

# A chunk is the unit of compression and of reading: 2 MiB before compression. A shard, the unit of
# resuming and of sharing among machines, is a run of chunks: 10⁹ verdicts, or 17 million numbers,
# which take as long. Each costs a sync, and all but the last are written twice: four times as many
# for 66 million safety factors made the sweep 8 % slower.
CHUNK_BYTES = 2 * 2**20
SHARD_WORK = 512
WORK = {"steps": 1, "numbers": 8, "fed back": 64}  # of a chunk

# With delayed feedback a person takes microseconds, and a rightmost root at one delay a tenth of a
# millisecond: a chunk is kept to about a second.
FED_BACK_PERSONS, FED_BACK_NUMBERS = 2**14, 2**14
DELAY = "feedback_delay"


@dataclass(frozen=True, slots=True)
class Tile:
    """One chunk of the grid of every quantity of a group; the unit of computing."""

    group: int
    chunk: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class Group:
    """Quantities on the same axes and of the same type, which share chunks.

    A quantity that is computed by its steps (:class:`standfast.quantities.Step`) is a group alone.
    ``way`` is how they are computed (:meth:`standfast.quantities.Quantity.way`).
    """

    quantities: tuple[str, ...]
    axes: tuple[str, ...]
    shape: tuple[int, ...]
    chunk_shape: tuple[int, ...]
    way: str

    @property
    def by_steps(self) -> bool:
        """Whether its one quantity is computed by comparisons along an axis."""
        return self.way == "steps"

    @property
    def dtype(self) -> np.dtype[np.generic]:
        """Type of all values."""
        return np.dtype(QUANTITIES[self.quantities[0]].dtype)

    @property
    def chunks(self) -> tuple[int, ...]:
        """Number of chunks along each axis."""
        return tuple(-(-n // c) for n, c in zip(self.shape, self.chunk_shape, strict=True))

    @property
    def tile_count(self) -> int:
        """Number of tiles."""
        return math.prod(self.chunks)

    @property
    def tile_work(self) -> int:
        """What a tile counts in a shard."""
        return WORK[self.way] * len(self.quantities)

    @property
    def points(self) -> int:
        """Number of grid points of one quantity."""
        return math.prod(self.shape)

    def start(self, tile: Tile) -> tuple[int, ...]:
        """Return the first index of a tile along each axis."""
        return tuple(i * c for i, c in zip(tile.chunk, self.chunk_shape, strict=True))

    def inside(self, tile: Tile) -> tuple[slice, ...]:
        """Return the part of the tile's chunk that lies inside the grid."""
        sides = zip(self.chunk_shape, self.shape, self.start(tile), strict=True)
        return tuple(slice(min(side, length - first)) for side, length, first in sides)


@dataclass(frozen=True)
class Grid:
    """The grid of a study; made by :attr:`standfast.Study.grid`."""

    groups: tuple[Group, ...]

    @classmethod
    def of(
        cls,
        axes: Mapping[str, np.ndarray],
        axes_of: Mapping[str, Sequence[str]],
        ways: Mapping[str, str],
    ) -> "Grid":
        """Cut the grid of some axes for quantities, each on its own axes and in its own way."""
        members: dict[tuple[tuple[str, ...], str, str, str], list[str]] = {}
        for name, own in axes_of.items():
            way = ways[name]
            alone = name if way == "steps" else ""
            kind = (tuple(own), QUANTITIES[name].dtype, way, alone)
            members.setdefault(kind, []).append(name)
        groups = []
        for (own, dtype, way, _), quantities in members.items():
            shape = tuple(len(axes[name]) for name in own)
            most = CHUNK_BYTES // np.dtype(dtype).itemsize
            if way == "fed back":
                sides = _fed_back_chunk(own, shape, most if dtype == "uint8" else FED_BACK_NUMBERS)
            else:
                sides = chunk_shape(shape, most)
            groups.append(Group(tuple(quantities), own, shape, sides, way))
        return cls(tuple(groups))

    @cached_property
    def shards(self) -> tuple[tuple[tuple[int, range], ...], ...]:
        """Of each shard the groups in it, and the numbers of its tiles within each group."""
        shards: list[list[tuple[int, range]]] = [[]]
        room = SHARD_WORK
        for index, group in enumerate(self.groups):
            first = 0
            while first < group.tile_count:
                least = 0 if shards[-1] else 1  # a tile larger than a shard is one
                fitting = max(room // group.tile_work, least)
                if fitting:
                    count = min(fitting, group.tile_count - first)
                    shards[-1].append((index, range(first, first + count)))
                    first += count
                    room -= count * group.tile_work
                else:
                    shards.append([])
                    room = SHARD_WORK
        return tuple(map(tuple, shards))

    @property
    def shard_count(self) -> int:
        """Number of shards."""
        return len(self.shards)

    def shard(self, number: int) -> list[Tile]:
        """Return the tiles of a shard, in canonical order: the last axis fastest."""
        return [self.tile(index, flat) for index, tiles in self.shards[number] for flat in tiles]

    def tile(self, group: int, number: int) -> Tile:
        """Return a tile by its number within its group."""
        return Tile(group, tuple(map(int, np.unravel_index(number, self.groups[group].chunks))))

    def values_of(self, tile: Tile) -> int:
        """Return how many values of a tile lie inside the grid."""
        group = self.groups[tile.group]
        inside = (int(part.stop) for part in group.inside(tile))
        return math.prod(inside) * len(group.quantities)


def _fed_back_chunk(axes: tuple[str, ...], shape: tuple[int, ...], most: int) -> tuple[int, ...]:
    """Cut few persons and many delays: all delays of a person come from one table."""
    if DELAY not in axes:
        return chunk_shape(shape, min(most, FED_BACK_PERSONS))
    place = axes.index(DELAY)
    others = shape[:place] + shape[place + 1 :]
    (delays,) = chunk_shape(shape[place : place + 1], most)
    persons = chunk_shape(others, min(max(most // delays, 1), FED_BACK_PERSONS))
    return (*persons[:place], delays, *persons[place:])


def chunk_shape(shape: tuple[int, ...], limit: int) -> tuple[int, ...]:
    """Cut a grid into chunks of at most ``limit`` points, as cubic and as even as possible.

    The longest side is cut into one piece more until the chunk fits.
    """
    pieces = [1] * len(shape)
    sides = list(shape)
    while math.prod(sides) > limit:
        axis = sides.index(max(sides))
        pieces[axis] += 1
        sides[axis] = -(-shape[axis] // pieces[axis])
    return tuple(sides)
