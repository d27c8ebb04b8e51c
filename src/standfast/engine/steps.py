"""Quantities that step from 0 to 1 along an axis: one comparison a point, all certain.

The place of the step is computed on every other axis, with proven ends between which the exact
place lies; where a value of the axis lies between them, exact arithmetic follows. So the verdict
along the ankle's axis is a comparison of small integers a point, about as fast as memory is
written, instead of a stability analysis.
"""

import math
import threading
from bisect import bisect_right
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache
from typing import Any

import numpy as np

from standfast.engine.mapping import Inputs, along_axis, in_whole_vectors, map_over_grid
from standfast.numerics.arrays import Vector
from standfast.quantities import QUANTITIES, Person, Step
from standfast.study.grid import Group, Tile
from standfast.study.study import Study

# Places of steps that are kept between tiles, in bytes.
KEPT = 2**26


@dataclass(frozen=True, slots=True, eq=False)
class Places:
    """How many values of the stepped axis lie below the step, on a chunk of the other axes.

    ``resolved`` holds the indices on the stepped axis that needed exact arithmetic, one a point.
    """

    below: np.ndarray
    lowest: int
    highest: int
    resolved: np.ndarray


class Steps:
    """Computes the tiles of a quantity that steps; one of equal values is known at once."""

    def __init__(self, study: Study, group: Group, inputs: Inputs) -> None:
        self.study, self.group, self.inputs = study, group, inputs
        step = QUANTITIES[group.quantities[0]].step
        if step is None:
            raise ValueError(f"{group.quantities[0]} has no step")
        self.step = step
        self.resolved = 0
        self._lock = threading.Lock()
        self.others = tuple(name for name in group.axes if name != step.along)
        self.values = study.axes.get(step.along, np.array([study.fixed.get(step.along, math.nan)]))
        # a parameter of one value is an axis of one value, behind all others
        self.axis = group.axes.index(step.along) if step.along in group.axes else len(group.axes)
        self.length = (*group.chunk_shape, 1)[self.axis]
        self.padded = self.length * -(-len(self.values) // self.length)
        behind = max(len(group.axes) - 1 - self.axis, 0)
        kind = np.int16 if self.padded < 2**15 else np.int64
        self.indices = np.arange(self.padded, dtype=kind).reshape(-1, *(1,) * behind)
        self.shape = group.chunk_shape[: self.axis] + group.chunk_shape[self.axis + 1 :]
        # the tiles of a study go through the places again and again
        self.places: Callable[[tuple[int, ...]], Places] = lru_cache(
            maxsize=max(KEPT // (8 * max(math.prod(self.shape), 1)), 1)
        )(self._places)

    def uniform(self, tile: Tile) -> np.uint8 | None:
        """Return the one value that fills a tile, if it is known without computing it."""
        found, start, stop = self._of(tile)
        if found.highest <= start:
            value = 1
        elif found.lowest >= stop:
            value = 0
        else:
            return None
        self._count(found, start, stop)
        return np.uint8(value)

    def __call__(self, tile: Tile) -> tuple[np.ndarray, ...]:
        """Compute one tile."""
        found, start, stop = self._of(tile)
        self._count(found, start, stop)
        values = np.empty(self.group.chunk_shape, np.uint8)
        out = values.view(bool)
        if self.axis == len(self.group.axes):
            out = out[..., None]
        below = np.expand_dims(found.below, self.axis)
        np.greater_equal(self.indices[start:stop], below, out=out)
        return (values,)

    def _of(self, tile: Tile) -> tuple[Places, int, int]:
        """Return the places of a tile, and its first and last index on the stepped axis."""
        start = self.length * (*tile.chunk, 0)[self.axis]
        chunk = tile.chunk[: self.axis] + tile.chunk[self.axis + 1 :]
        return self.places(chunk), start, start + self.length

    def _count(self, found: Places, start: int, stop: int) -> None:
        if found.resolved.size:
            first, last = np.searchsorted(found.resolved, [start, stop])
            with self._lock:
                self.resolved += int(last - first)

    def _places(self, chunk: tuple[int, ...]) -> Places:
        """Find the steps on one chunk of the other axes, exactly."""
        counts = [len(self.study.axes[name]) for name in self.others]
        starts = [number * side for number, side in zip(chunk, self.shape, strict=True)]
        shape = in_whole_vectors(self.shape)
        at = dict(zip(self.others, map(along_axis, starts, shape, counts), strict=True))
        found = _compiled(self.step, self.others)(self.inputs.fixed, self.inputs.pieces(at))
        inside = tuple(slice(side) for side in self.shape)
        place, low, high = (np.asarray(each)[inside] for each in found)
        # searched backwards: along an axis of stiffness places fall, and NumPy starts to look for a
        # larger number at the one before
        backwards = np.searchsorted(self.values, place.reshape(-1)[::-1], side="right")
        below = np.ascontiguousarray(backwards[::-1]).reshape(place.shape)
        sizes = [
            min(side, count - start)
            for side, count, start in zip(self.shape, counts, starts, strict=True)
        ]
        resolved = []
        uncertain = between(self.values, below, low, high)
        for index in map(tuple, np.argwhere(uncertain) if uncertain.any() else ()):
            varying = {
                name: self.study.axes[name][at[name][i]]
                for name, i in zip(self.others, index, strict=True)
            }
            exact = self.step.exact({**self.inputs.plainly, **varying})
            below[index] = count_below(self.values, exact)
            # values that are repeated beyond the end of an axis are counted once
            if all(i < size for i, size in zip(index, sizes, strict=True)):
                first = np.searchsorted(self.values, low[index], side="left")
                last = np.searchsorted(self.values, high[index], side="right")
                resolved.append(np.arange(first, last))
        # what is repeated beyond the end of the stepped axis is like its last value
        below[below == len(self.values)] = self.padded
        counted = np.sort(np.concatenate([*resolved, np.empty(0, np.int64)]))
        lowest, highest = int(below.min()), int(below.max())
        return Places(below.astype(self.indices.dtype), lowest, highest, counted)


@lru_cache(maxsize=64)
def _compiled(step: Step, others: tuple[str, ...]) -> Callable[..., Any]:
    """Compile the places over some axes; studies that differ in numbers alone share it."""

    def interval(given: dict[str, Any]) -> Vector:
        return step.interval(Person.of(given))

    return map_over_grid(interval, others)


def between(axis: np.ndarray, below: np.ndarray, low: np.ndarray, high: np.ndarray) -> np.ndarray:
    """Return where a value of a rising axis lies in the interval [low, high].

    ``below`` is how many of them lie at or below a number inside the interval, so only its
    neighbours need be looked at. An interval at infinity stands for a certain 0.
    """
    before = axis[np.maximum(below - 1, 0)]
    after = axis[np.minimum(below, len(axis) - 1)]
    inside: np.ndarray = ((low <= before) & (before <= high)) | ((low <= after) & (after <= high))
    return inside & (low < np.inf)


def count_below(axis: Sequence[float] | np.ndarray, place: Fraction | None) -> int:
    """Return how many values of a rising axis are not above an exact place."""
    return len(axis) if place is None else bisect_right(axis, place)
