"""All points that the measures do not speak against, and what any number may be among them.

The region holds the points with −2 log L ≤ its least + χ²(0.95; 1). The interval of a number, a
parameter or a margin, is from the least to the largest that it has in the region: its likelihood
profile. The region may have several parts, and reach to the limits of the search, where the
interval is open. It is laid on a grid, of which the box is drawn closer twice; between two
neighbours of which one is inside, its end is where the root of the excess over the least, nearly
linear, has its value.
"""

from collections.abc import Callable, Iterator
from typing import NamedTuple

import numpy as np
from scipy import stats

from standfast.fitting.family import NOISE
from standfast.fitting.likelihood import Likelihood
from standfast.fitting.search import Grid, graded

CONFIDENCE = 0.95
RISE = float(stats.chi2.ppf(CONFIDENCE, 1))
# Values a coordinate, by how many there are, first and last time.
FINE = {0: (1, 1), 1: (64, 64), 2: (13, 21), 3: (9, 11)}
# How much higher than inside a point of a coarse grid may be, and the region still be near.
SLACK = 12.0


class Region(NamedTuple):
    """The region on a grid.

    Attributes
    ----------
    grid
    excess : −2 log L over its least
    inside : whether a point is
    open : (coordinates, 2), whether the region reaches the lower and the upper limit
    """

    grid: Grid
    excess: np.ndarray
    inside: np.ndarray
    open: np.ndarray

    def noise(self) -> tuple[float, float]:
        """Return between what log σ may be."""
        left = np.sqrt(np.where(self.inside, RISE - self.excess, 0.0))[self.inside]
        middle, error = self.grid.noise[self.inside], self.grid.error[self.inside]
        return float((middle - error * left).min()), float((middle + error * left).max())

    def intervals(self, numbers: Callable[[np.ndarray], np.ndarray], count: int) -> np.ndarray:
        """Return between what ``count`` functions of the coordinates but noise may be, (count, 2).

        What a point has no number for is left out of it.
        """
        values = np.full((*self.excess.shape, count), np.nan)
        seen = np.zeros(self.excess.shape, bool)

        def at(place: tuple[int, ...]) -> np.ndarray:
            if not seen[place]:
                values[place], seen[place] = numbers(self.grid.point(place, ())), True
            own: np.ndarray = values[place]
            return own

        found = [at(tuple(map(int, place))) for place in np.argwhere(self.inside)]
        for place, other in self._ends():
            share = _share(float(self.excess[place]), float(self.excess[other]))
            low, high = at(place), at(other)
            both = np.isfinite(low) & np.isfinite(high)
            found.append(np.where(both, low + share * np.where(both, high - low, 0.0), np.nan))
        return np.stack([np.nanmin(found, axis=0), np.nanmax(found, axis=0)], axis=1)

    def _ends(self) -> Iterator[tuple[tuple[int, ...], tuple[int, ...]]]:
        """Give neighbours of which the first is inside, and the other is not, but stands."""
        for place in np.argwhere(self.inside):
            for axis in range(place.size):
                for step in (-1, 1):
                    other = place.copy()
                    other[axis] += step
                    if not 0 <= other[axis] < self.inside.shape[axis]:
                        continue
                    there = tuple(map(int, other))
                    if not self.inside[there] and np.isfinite(self.excess[there]):
                        yield tuple(map(int, place)), there


def region_of(likelihood: Likelihood, coarse: Grid, best: np.ndarray) -> Region:
    """Return the region around the most likely point, with all its parts."""
    free = likelihood.points.family.free
    keep = [k for k, name in enumerate(free) if name != NOISE]
    limits = np.stack(likelihood.points.bounds)[:, keep]
    least, grid, slack = likelihood.size(best), coarse, SLACK
    for count in FINE[len(keep)]:
        near = grid.size - least <= RISE + slack
        grid, slack = graded(likelihood, _closer(grid, near, best[keep], count)), 0.0
    excess = np.maximum(grid.size - least, 0.0)
    inside = excess <= RISE
    reaches = np.zeros((len(keep), 2), bool)
    for axis, values in enumerate(grid.axes):
        others = tuple(k for k in range(len(keep)) if k != axis)
        anywhere = inside.any(axis=others)
        at_limit = np.isclose(values, limits[0, axis]), np.isclose(values, limits[1, axis])
        reaches[axis] = [(anywhere & at).any() for at in at_limit]
    return Region(grid, excess, inside, reaches)


def _closer(grid: Grid, near: np.ndarray, best: np.ndarray, count: int) -> tuple[np.ndarray, ...]:
    """Return axes of a box around what is near and the best point, one step of the grid wider."""
    axes = []
    for axis, values in enumerate(grid.axes):
        others = tuple(k for k in range(len(grid.axes)) if k != axis)
        places = np.flatnonzero(near.any(axis=others))
        own = np.searchsorted(values, best[axis])
        first = max(min([*places, own - 1]) - 1, 0)
        last = min(max([*places, own]) + 1, values.size - 1)
        axes.append(np.linspace(values[first], values[last], count))
    return tuple(axes)


def _share(inside: float, outside: float) -> float:
    """Return how far the end lies from a point inside towards one outside."""
    low, end, high = np.sqrt([inside, RISE, outside])
    return float((end - low) / (high - low))
