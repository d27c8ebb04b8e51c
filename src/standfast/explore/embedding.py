"""The part of an atlas that an exported page holds: whole, or thinned out until it fits."""

import base64
import itertools
import math
import zlib
from collections.abc import Mapping, Sequence

import numpy as np

from standfast.explore.planes import Planes
from standfast.study.study import Study

EMBEDDED_BYTES = 24_000_000  # of the values; the text of a page takes a third more at most


def thinned(
    study: Study,
    quantities: Sequence[str],
    plane: Sequence[str],
    most: int,
    *,
    start: Mapping[str, float | str],
) -> dict[str, np.ndarray]:
    """Return places of each axis, spread evenly, so that all values take ``most`` bytes at most.

    The longest of the axes that are not of the plane loses values first; those of the plane only
    once each other one has a single value left, that of ``start``, which has one of each axis.
    """
    counts = {name: len(axis) for name, axis in study.axes.items()}
    groups = [
        (group.dtype.itemsize * len(set(group.quantities) & set(quantities)), group.axes)
        for group in study.grid.groups
    ]

    def size() -> int:
        return sum(item * math.prod(counts[name] for name in axes) for item, axes in groups)

    while size() > most:
        others = [name for name in counts if name not in plane and counts[name] > 1]
        longest = max(others or counts, key=lambda name: counts[name])
        counts[longest] -= max(1, counts[longest] // 50)
    return {
        name: np.rint(np.linspace(0, len(axis) - 1, counts[name])).astype(int)
        if counts[name] > 1 or len(axis) == 1
        else np.flatnonzero(axis == start[name])
        for name, axis in study.axes.items()
    }


def embedded(
    planes: Planes,
    quantities: Sequence[str],
    plane: Sequence[str],
    places: Mapping[str, np.ndarray],
) -> dict[str, str]:
    """Return quantities at some places of each axis as text, by name.

    That is base64 of their little-endian bytes, deflated; the axes in the study's order.
    """
    return {name: _encoded(_part_of(planes, name, plane, places)) for name in quantities}


def _part_of(
    planes: Planes, quantity: str, plane: Sequence[str], places: Mapping[str, np.ndarray]
) -> np.ndarray:
    """Return the values of a quantity at some places of each axis, its axes in study order."""
    dims = planes.atlas[quantity].dims
    values = np.empty([len(places[name]) for name in dims], planes.atlas[quantity].dtype)
    x, y = plane
    others = [name for name in dims if name not in plane]
    here = {name: places[name] if name in dims else np.zeros(1, int) for name in plane}
    for index in itertools.product(*(range(len(places[name])) for name in others)):
        number = dict(zip(others, index, strict=True))
        at = {name: int(places[name][i]) for name, i in number.items()}
        found = planes.plane(quantity, x, y, at)[np.ix_(here[y], here[x])]
        target = tuple(number.get(name, slice(None)) for name in dims)
        kept = [name for name in dims if name in plane]
        if kept == [x, y]:
            found = found.T
        values[target] = found.reshape([len(places[name]) for name in kept])
    return values


def _encoded(values: np.ndarray) -> str:
    little = np.ascontiguousarray(values, values.dtype.newbyteorder("<"))
    return base64.b64encode(zlib.compress(little.tobytes(), 6)).decode("ascii")
