"""All points that the measures do not speak against, and what any number may be among them.

The region holds the points with −2 log L ≤ its least + χ²(0.95; 1). The interval of a number, a
parameter or a margin, is from the least to the largest that it has in the region: its likelihood
profile. The region may have several parts, and reach to the limits of the search or of standing,
where the interval is open. It is laid on a grid, of which the box is drawn closer twice, and on
until enough points are inside; between two neighbours of which one is inside, its end is where the
root of the excess over the least, nearly linear, has its value. Where a grid has a point better
than the least, the search goes on from there, and the region is laid anew.
"""

import math
from collections.abc import Callable, Iterator
from typing import NamedTuple

import numpy as np
from scipy import stats

from standfast.fitting.family import NOISE
from standfast.fitting.likelihood import Likelihood
from standfast.fitting.search import Grid, graded, settled

CONFIDENCE = 0.95
RISE = float(stats.chi2.ppf(CONFIDENCE, 1))
# Values a coordinate, by how many there are, first and last time.
FINE = {0: (1, 1), 1: (64, 64), 2: (13, 21), 3: (9, 11)}
# How many points inside show the ends; with fewer the box is drawn closer, and where that does not
# help, as along a thin ridge, the grid is made finer, up to so many points.
ENOUGH = {0: 1, 1: 8, 2: 20, 3: 30}
ROUNDS, GROWTH, MOST = 5, 1.4, 5000
# How much higher than inside a point of a coarse grid may be, and the region still be near.
SLACK = 12.0
BETTER = 1e-6  # of −2 log L; a solver leaves less
SAME = 1e-3  # of a coordinate: two starts have ended at one minimum


class Region(NamedTuple):
    """The region on a grid.

    Attributes
    ----------
    grid
    excess : −2 log L over its least
    inside : whether a point is
    open : (coordinates, 2), whether the region reaches the lower and the upper limit
    edge : whether a point is at a limit of the search, or next to someone who falls
    minima : (minima, coordinates), most likely points of its parts, noise left out; best first
    noises : (minima, 3), their excess, log σ and its standard error
    """

    grid: Grid
    excess: np.ndarray
    inside: np.ndarray
    open: np.ndarray
    edge: np.ndarray
    minima: np.ndarray
    noises: np.ndarray

    def noise(self) -> tuple[np.ndarray, np.ndarray]:
        """Return between what log σ may be, (2,), and whether these ends are open."""
        inside = self.inside
        excess, middle, error = np.concatenate(
            [
                np.stack([self.excess[inside], self.grid.noise[inside], self.grid.error[inside]]),
                self.noises.T,
            ],
            axis=1,
        )
        edge = np.append(self.edge[inside], np.zeros(len(self.noises), bool))
        reach = error * np.sqrt(np.maximum(RISE - excess, 0.0))
        least, largest = np.argmin(middle - reach), np.argmax(middle + reach)
        ends = np.array([(middle - reach)[least], (middle + reach)[largest]])
        return ends, edge[[least, largest]]

    def intervals(
        self, numbers: Callable[[np.ndarray], np.ndarray], count: int
    ) -> tuple[np.ndarray, np.ndarray]:
        """Return between what ``count`` functions of the coordinates but noise may be, (count, 2).

        Beside them, whether these ends are open: of a point at a limit of the search, or next to
        someone who falls. What a point has no number for is left out of it.
        """
        values = np.full((*self.excess.shape, count), np.nan)
        seen = np.zeros(self.excess.shape, bool)

        def at(place: tuple[int, ...]) -> np.ndarray:
            if not seen[place]:
                values[place], seen[place] = numbers(self.grid.point(place, ())), True
            own: np.ndarray = values[place]
            return own

        found = [numbers(point) for point in self.minima]
        edge = [False] * len(found)
        for where in np.argwhere(self.inside):
            found.append(at(tuple(map(int, where))))
            edge.append(bool(self.edge[tuple(where)]))
        for place, other in self._ends():
            share = _share(float(self.excess[place]), float(self.excess[other]))
            low, high = at(place), at(other)
            both = np.isfinite(low) & np.isfinite(high)
            found.append(np.where(both, low + share * np.where(both, high - low, 0.0), np.nan))
            edge.append(bool(self.edge[place] and self.edge[other]))
        rows, open_ = np.stack(found), np.array(edge)
        low = np.argmin(np.where(np.isnan(rows), np.inf, rows), axis=0)
        high = np.argmax(np.where(np.isnan(rows), -np.inf, rows), axis=0)
        each = np.arange(count)
        ends = np.stack([rows[low, each], rows[high, each]], axis=1)
        return ends, np.stack([open_[low], open_[high]], axis=1)

    def _ends(self) -> Iterator[tuple[tuple[int, ...], tuple[int, ...]]]:
        """Give neighbours of which the first is inside, and the other is not, but stands."""
        for place, there in _neighbours(self.inside):
            if not self.inside[there] and np.isfinite(self.excess[there]):
                yield place, there


def region_of(
    likelihood: Likelihood, coarse: Grid, minima: list[np.ndarray]
) -> tuple[Region, np.ndarray]:
    """Return the region around the most likely of some minima, with all its parts, and that point.

    Where a grid shows a more likely point, it is settled again from there.
    """
    while True:
        minima = sorted(minima, key=likelihood.size)
        least = likelihood.size(minima[0])
        within = [point for point in minima if likelihood.size(point) - least <= RISE]
        minima = []
        for point in within:
            if all(abs(point - other).max() > SAME for other in minima):
                minima.append(point)
        found = _laid(likelihood, coarse, minima)
        if isinstance(found, Region):
            return found, minima[0]
        better = settled(likelihood, found)
        minima = [min(better, found, key=likelihood.size), *minima]


def _laid(likelihood: Likelihood, coarse: Grid, minima: list[np.ndarray]) -> Region | np.ndarray:
    """Return the region; or a point that is more likely than all minima."""
    free = likelihood.points.family.free
    keep = [k for k, name in enumerate(free) if name != NOISE]
    least, within = likelihood.size(minima[0]), np.stack(minima)[:, keep]
    grid, slack, counts, count = coarse, SLACK, FINE[len(keep)], 1
    for turn in range(ROUNDS):
        if turn < len(counts):
            count = counts[turn]
        else:
            count = min(math.ceil(GROWTH * count), int(MOST ** (1.0 / len(keep))))
        grid = graded(likelihood, _closer(grid, grid.size - least <= RISE + slack, within, count))
        place = np.unravel_index(np.argmin(grid.size), grid.size.shape)
        if grid.size[place] < least - BETTER:
            return grid.point(tuple(map(int, place)), free)
        excess, slack = grid.size - least, 0.0
        inside = excess <= RISE
        if turn + 1 >= len(counts) and inside.sum() >= ENOUGH[len(keep)]:
            break
    noises = np.array([likelihood.over_noise(point) for point in minima]) - [least, 0.0, 0.0]
    edge, reaches = edges_of(likelihood, grid, keep)
    inside_at = [(reaches[axis] & inside).any() for axis in np.ndindex(len(keep), 2)]
    open_ = np.array(inside_at, bool).reshape(len(keep), 2)
    return Region(grid, np.maximum(excess, 0.0), inside, open_, edge, within, noises)


def edges_of(likelihood: Likelihood, grid: Grid, keep: list[int]) -> tuple[np.ndarray, np.ndarray]:
    """Return which points are at an edge, and, (coordinates, 2, …), which at each limit."""
    limits = np.stack(likelihood.points.bounds)[:, keep]
    shape = grid.size.shape
    reaches = np.zeros((len(keep), 2, *shape), bool)
    for axis, values in enumerate(grid.axes):
        for end in (0, 1):
            at = np.isclose(values, limits[end, axis])
            reaches[axis, end] = at.reshape([-1 if k == axis else 1 for k in range(len(keep))])
    edge = np.array(reaches.any(axis=(0, 1)), bool).reshape(shape)
    for place, there in _neighbours(np.isfinite(grid.size)):
        edge[place] |= bool(np.isinf(grid.size[there]))
    return edge, reaches


def _neighbours(mask: np.ndarray) -> Iterator[tuple[tuple[int, ...], tuple[int, ...]]]:
    """Give places of a mask, each with each of its neighbours on the grid."""
    for place in np.argwhere(mask):
        for axis in range(place.size):
            for step in (-1, 1):
                other = place.copy()
                other[axis] += step
                if 0 <= other[axis] < mask.shape[axis]:
                    yield tuple(map(int, place)), tuple(map(int, other))


def _closer(grid: Grid, near: np.ndarray, minima: np.ndarray, count: int) -> tuple[np.ndarray, ...]:
    """Return axes of a box around what is near and the minima, one step of the grid wider."""
    axes = []
    for axis, values in enumerate(grid.axes):
        others = tuple(k for k in range(len(grid.axes)) if k != axis)
        places = np.flatnonzero(near.any(axis=others))
        own = np.searchsorted(values, minima[:, axis])
        first = max(min([*places, *(own - 1)]) - 1, 0)
        last = min(max([*places, *own]) + 1, values.size - 1)
        axes.append(np.linspace(values[first], values[last], count))
    return tuple(axes)


def _share(inside: float, outside: float) -> float:
    """Return how far the end lies from a point inside towards one outside."""
    low, end, high = np.sqrt([inside, RISE, outside])
    return float((end - low) / (high - low))
