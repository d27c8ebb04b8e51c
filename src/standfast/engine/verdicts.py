"""Verdicts: the ankle's threshold on every other axis, then one comparison a point, all certain."""

import math
import threading
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from standfast import stability
from standfast.arithmetic import Scalar
from standfast.certainty import SCALING_ROUNDING, exact_threshold, falling_below, near
from standfast.engine.mapping import Inputs, along_axis, in_whole_vectors, over_axes, person
from standfast.engine.memory import Recycled
from standfast.study import Group, Study, Tile

ANKLE = "ankle_stiffness"

# Thresholds that are kept between tiles, in bytes.
KEPT = 2**26


@dataclass(frozen=True, slots=True, eq=False)
class Thresholds:
    """How many values of the ankle's axis fall, on a chunk of the other axes.

    ``settled`` holds the places on the ankle's axis of the verdicts that needed exact arithmetic.
    """

    falling: np.ndarray
    lowest: int
    highest: int
    settled: np.ndarray

    def settled_within(self, start: int, stop: int) -> int:
        """Return how many verdicts of some places on the ankle's axis needed exact arithmetic."""
        if self.settled.size == 0:
            return 0
        first, last = np.searchsorted(self.settled, [start, stop])
        return int(last - first)


class Verdicts:
    """Computes the tiles of the verdict.

    Along the ankle's axis verdicts change once, from falling to standing, at a place that the
    thresholds tell. So a verdict is one comparison of small integers a point, done in NumPy about
    as fast as memory is written; a chunk of equal verdicts is known from the extremes.
    """

    def __init__(self, study: Study, group: Group, inputs: Inputs) -> None:
        self.study, self.group, self.inputs = study, group, inputs
        self.settled = 0
        self._lock = threading.Lock()
        self.others = tuple(name for name in group.axes if name != ANKLE)
        self.ankle = study.axes.get(ANKLE, np.array([study.fixed.get(ANKLE, math.nan)]))
        # an ankle of one stiffness is an axis of one value, behind all others
        self.axis = group.axes.index(ANKLE) if ANKLE in group.axes else len(group.axes)
        self.length = (*group.chunk_shape, 1)[self.axis]
        self.padded = self.length * -(-len(self.ankle) // self.length)
        self.ankle_values = self.ankle.tolist()
        behind = max(len(group.axes) - 1 - self.axis, 0)
        kind = np.int16 if self.padded < 2**15 else np.int64
        self.places = np.arange(self.padded, dtype=kind).reshape(-1, *(1,) * behind)
        self.shape = group.chunk_shape[: self.axis] + group.chunk_shape[self.axis + 1 :]
        self.memory = Recycled(group.chunk_shape, np.uint8)
        # the tiles of a study go through the thresholds again and again
        self.thresholds: Callable[[tuple[int, ...]], Thresholds] = lru_cache(
            maxsize=max(KEPT // (8 * max(math.prod(self.shape), 1)), 1)
        )(self._thresholds)

    def __call__(self, tile: Tile) -> tuple[np.ndarray, ...]:
        """Compute one tile; a chunk of equal verdicts comes as a view of one number."""
        found = self.thresholds(tile.chunk[: self.axis] + tile.chunk[self.axis + 1 :])
        start = self.length * (*tile.chunk, 0)[self.axis]
        stop = start + self.length
        with self._lock:
            self.settled += found.settled_within(start, stop)
        if found.lowest >= stop or found.highest <= start:
            one = np.uint8(found.highest <= start)
            return (np.broadcast_to(one, self.group.chunk_shape),)
        stable = self.memory.take()
        out = stable.view(bool)
        if self.axis == len(self.group.axes):
            out = out[..., None]
        falling = np.expand_dims(found.falling, self.axis)
        np.greater_equal(self.places[start:stop], falling, out=out)
        return (stable,)

    def _thresholds(self, chunk: tuple[int, ...]) -> Thresholds:
        """Compute the thresholds on one chunk of the other axes.

        Where an ankle stiffness of the study lies in the interval in which the exact threshold
        does, the threshold is settled in fractions.
        """
        counts = [len(self.study.axes[name]) for name in self.others]
        starts = [number * side for number, side in zip(chunk, self.shape, strict=True)]
        shape = in_whole_vectors(self.shape)
        at = dict(zip(self.others, map(along_axis, starts, shape, counts), strict=True))
        found = _compiled(self.others)(self.inputs.fixed, self.inputs.pieces(at), {})
        inside = tuple(slice(side) for side in self.shape)
        threshold, low, high = (np.asarray(each)[inside] for each in found)
        # searched backwards: stiffer joints have lower thresholds, and NumPy starts to look for a
        # larger number at the one before
        backwards = np.searchsorted(self.ankle, threshold.reshape(-1)[::-1], side="right")
        falling = np.ascontiguousarray(backwards[::-1]).reshape(threshold.shape)
        settled = []
        sizes = [
            min(side, count - start)
            for side, count, start in zip(self.shape, counts, starts, strict=True)
        ]
        in_doubt = near(self.ankle, falling, low, high)
        for index in map(tuple, np.argwhere(in_doubt) if in_doubt.any() else ()):
            varying = {
                name: self.study.axes[name][at[name][i]]
                for name, i in zip(self.others, index, strict=True)
            }
            exact = exact_threshold({**self.study.fixed, **varying})
            falling[index] = falling_below(self.ankle_values, exact)
            # values that are repeated beyond the end of an axis are counted once
            if all(i < size for i, size in zip(index, sizes, strict=True)):
                first = np.searchsorted(self.ankle, low[index], side="left")
                last = np.searchsorted(self.ankle, high[index], side="right")
                settled.append(np.arange(first, last))
        # what is repeated beyond the end of the ankle's axis is like its last value
        falling[falling == len(self.ankle)] = self.padded
        counted = np.sort(np.concatenate([*settled, np.empty(0, np.int64)]))
        lowest, highest = int(falling.min()), int(falling.max())
        return Thresholds(falling.astype(self.places.dtype), lowest, highest, counted)


@lru_cache(maxsize=64)
def _compiled(others: tuple[str, ...]) -> Callable[..., Any]:
    """Compile the thresholds over some axes; studies that differ in numbers alone share it."""
    return over_axes(_thresholds_of_one, others)


def _thresholds_of_one(parameters: dict[str, Any]) -> tuple[Scalar, Scalar, Scalar]:
    """Return one person's threshold, and the ends between which the exact one lies."""
    body, (_, knee, hip), gravity = person(parameters)
    return stability.threshold_interval(body, knee, hip, gravity, scaling=SCALING_ROUNDING)
