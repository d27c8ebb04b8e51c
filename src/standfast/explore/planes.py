"""Planes of an atlas for the page: chunks decoded once, kept, and read ahead.

A plane cuts through a row of chunks, which decode to a slab of many planes. Whoever moves a slider
sees one plane of it after the other, and then those of the slab beside it, which is read meanwhile.
"""

import math
import threading
from collections import OrderedDict
from collections.abc import Mapping
from concurrent.futures import Future, ThreadPoolExecutor
from typing import Any

import numpy as np

from standfast.atlas.reader import Atlas, Variable
from standfast.errors import InputError, nearest_name, shortened

KEPT_BYTES = 512 * 2**20
# A slab larger than this is read in parts, so that several find room.
SLAB_BYTES = KEPT_BYTES // 3

# Of a quantity's other axes the first and one past the last place that a slab holds.
Slab = tuple[str, str, str, tuple[tuple[int, int], ...]]


class Planes:
    """Planes of an atlas, of which some decoded slabs are kept, those used last.

    Safe to be asked from several threads.
    """

    def __init__(self, atlas: Atlas) -> None:
        self.atlas = atlas
        self._kept: OrderedDict[Slab, Future[np.ndarray]] = OrderedDict()
        self._last: dict[str, int] = {}
        self._lock = threading.Lock()
        self.reader = ThreadPoolExecutor(1)

    def plane(self, quantity: str, x: str, y: str, at: Mapping[str, Any]) -> np.ndarray:
        """Return a quantity on a plane, (len y, len x); along axes without influence it repeats.

        ``at`` are the places, from 0, on the quantity's other axes; more are ignored.

        Raises
        ------
        InputError
            for names that the atlas does not have, or a place beyond its axis.
        """
        variable = self.atlas[quantity]
        axes = self.atlas.axes
        for name in (x, y, *at):
            if name not in axes:
                raise InputError(
                    f"the atlas has no axis {shortened(name)}{nearest_name(name, axes)} "
                    f"(axes: {', '.join(axes)})"
                )
        if x == y:
            raise InputError(f"a plane needs two axes, and {x} is given twice")
        others = [name for name in variable.dims if name not in (x, y)]
        place = {name: _place(name, at.get(name), len(axes[name])) for name in others}
        values = self._slab_plane(variable, x, y, place)
        dims = [name for name in variable.dims if name in (x, y)]
        if dims == [x, y]:
            values = values.T
        elif dims == [y]:
            values = values[:, None]
        return np.broadcast_to(values, (len(axes[y]), len(axes[x])))

    def close(self) -> None:
        """End reading ahead, and the waiting for what is not being read yet."""
        self.reader.shutdown(wait=False, cancel_futures=True)
        with self._lock:
            for future in self._kept.values():
                future.cancel()

    def _slab_plane(
        self, variable: Variable, x: str, y: str, place: Mapping[str, int]
    ) -> np.ndarray:
        """Return the plane at a place on the other axes, its axes in the study's order."""
        sides = _sides(variable, place)
        slab = _slab_at(variable, x, y, place, sides)
        future, new = self._future(slab)
        if new:
            self._read(variable, slab, future)
        values = future.result()
        if (ahead := self._beside(variable, slab, place)) is not None:
            future, new = self._future(ahead)
            if new:
                self.reader.submit(self._read, variable, ahead, future)
        starts = iter(slab[3])
        inside = tuple(
            place[name] - next(starts)[0] if name in place else slice(None)
            for name in variable.dims
        )
        plane: np.ndarray = values[inside]
        return plane

    def _read(self, variable: Variable, slab: Slab, future: "Future[np.ndarray]") -> None:
        """Read a slab; what goes wrong is told whoever waits for it, and the next reads it anew."""
        if not future.set_running_or_notify_cancel():
            return
        ranges = iter(slab[3])
        box = tuple(
            slice(None) if name in slab[1:3] else slice(*next(ranges)) for name in variable.dims
        )
        try:
            future.set_result(variable[box])
        except BaseException as error:
            with self._lock:
                if self._kept.get(slab) is future:
                    del self._kept[slab]
            future.set_exception(error)

    def _future(self, slab: Slab) -> tuple["Future[np.ndarray]", bool]:
        """Return what a slab will be, and whether it must be read; forget those used long ago."""
        with self._lock:
            new = slab not in self._kept
            if new:
                self._kept[slab] = Future()
            self._kept.move_to_end(slab)
            future = self._kept[slab]
            while len(self._kept) > 1 and self.kept_bytes() > KEPT_BYTES:
                self._kept.popitem(last=False)
        return future, new

    def kept_bytes(self) -> int:
        """Return what the slabs take that are kept or on their way."""
        return sum(
            math.prod(
                [high - low for low, high in ranges]
                + [len(self.atlas.axes[n]) for n in {x, y} & {*self.atlas[quantity].dims}]
            )
            * self.atlas[quantity].dtype.itemsize
            for quantity, x, y, ranges in self._kept
        )

    def _beside(self, variable: Variable, slab: Slab, place: Mapping[str, int]) -> Slab | None:
        """Return the slab towards which the last slider moved; None if it has not."""
        with self._lock:
            moved = [name for name in place if self._last.get(name, place[name]) != place[name]]
            ahead = [place[name] > self._last[name] for name in moved]
            self._last = dict(place)
        if len(moved) != 1:
            return None
        (name,), (up,) = moved, ahead
        low, high = slab[3][list(place).index(name)]
        next_place = high if up else low - 1
        if not 0 <= next_place < len(self.atlas.axes[name]):
            return None
        there = {**place, name: next_place}
        return _slab_at(variable, slab[1], slab[2], there, _sides(variable, place))


def _place(name: str, given: Any, count: int) -> int:
    """Check a place on an axis."""
    if given is None:
        raise InputError(f"a place on the axis {name} is missing")
    if isinstance(given, bool) or not isinstance(given, int) or not 0 <= given < count:
        raise InputError(
            f"{name}: {shortened(given)} is not a place on its axis, a whole number from 0 to "
            f"{count - 1}"
        )
    return given


def _sides(variable: Variable, place: Mapping[str, int]) -> dict[str, int]:
    """Return along each other axis how many places a slab holds: those of a chunk, or fewer."""
    sides = dict(zip(variable.dims, variable.group.chunk_shape, strict=True))
    lengths = zip(variable.dims, variable.shape, strict=True)
    plane = math.prod(length for name, length in lengths if name not in place)
    others = {name: sides[name] for name in place}
    while others and max(others.values()) > 1:
        if plane * math.prod(others.values()) * variable.dtype.itemsize <= SLAB_BYTES:
            break
        longest = max(others, key=lambda name: others[name])
        others[longest] = -(-others[longest] // 2)
    return others


def _slab_at(
    variable: Variable, x: str, y: str, place: Mapping[str, int], sides: Mapping[str, int]
) -> Slab:
    lengths = dict(zip(variable.dims, variable.shape, strict=True))
    chunks = dict(zip(variable.dims, variable.group.chunk_shape, strict=True))
    ranges = []
    for name, at in place.items():
        # parts of a chunk begin with it, so that no slab reaches into two
        begin = at // chunks[name] * chunks[name]
        low = begin + (at - begin) // sides[name] * sides[name]
        end = min(begin + chunks[name], lengths[name])
        ranges.append((low, min(low + sides[name], end)))
    return variable.quantity.name, min(x, y), max(x, y), tuple(ranges)
