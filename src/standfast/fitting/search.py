"""The most likely point: a coarse grid, and from the best of it least squares by our derivatives.

The measures of two quite different persons may be alike, so that a search from one start may end at
the wrong one: the grid covers all of the limits, and it is gone on from many of its places.
"""

from itertools import product
from typing import NamedTuple

import numpy as np
from scipy import ndimage, optimize

from standfast.fitting.family import NOISE
from standfast.fitting.likelihood import Likelihood

# Values a coordinate, by how many coordinates a grid has.
COARSE = {0: 1, 1: 64, 2: 22, 3: 11}
STARTS = 16  # places of the grid from which it is gone on
STEPS = 60  # of the solver from a start; more are only taken along the edge of standing


class Grid(NamedTuple):
    """−2 log L on a grid of all coordinates but the noise, with the most likely noise at each.

    Attributes
    ----------
    axes : a row of values a coordinate; none where the noise alone is open
    size : −2 log L; infinite where the person falls
    noise : log σ
    """

    axes: tuple[np.ndarray, ...]
    size: np.ndarray
    noise: np.ndarray

    def point(self, place: tuple[int, ...], free: tuple[str, ...]) -> np.ndarray:
        """Return the point at a place of the grid."""
        values = [float(axis[k]) for axis, k in zip(self.axes, place, strict=True)]
        if NOISE in free:
            values.insert(free.index(NOISE), float(self.noise[place]))
        return np.array(values)


def coarse_grid(likelihood: Likelihood) -> Grid:
    """Return a grid over all of the limits."""
    free, (low, high) = likelihood.points.family.free, likelihood.points.bounds
    keep = [k for k, name in enumerate(free) if name != NOISE]
    axes = tuple(np.linspace(low[k], high[k], COARSE[len(keep)]) for k in keep)
    shape = tuple(axis.size for axis in axes)
    size, noise = np.zeros(shape), np.zeros(shape)
    points = np.array(list(product(*axes)))
    if NOISE in free:
        points = np.insert(points, free.index(NOISE), 0.0, axis=1)
    likelihood.ask(points)
    for place, point in zip(np.ndindex(*shape), points, strict=True):
        size[place], noise[place], _ = likelihood.over_noise(point)
    return Grid(axes, size, noise)


def minima_of(likelihood: Likelihood, grid: Grid) -> list[np.ndarray]:
    """Return the most likely points near the best places of a grid, none if nobody of it stands.

    They are the local minima, and the best at each value of each coordinate: of a long recording
    a minimum may be narrower than a step of the grid.
    """
    free = likelihood.points.family.free
    lowest = ndimage.minimum_filter(grid.size, 3) if grid.axes else grid.size
    start = np.isfinite(grid.size) & (grid.size == lowest)
    for axis in range(len(grid.axes)):
        others = tuple(k for k in range(len(grid.axes)) if k != axis)
        start |= np.isfinite(grid.size) & (grid.size == grid.size.min(axis=others, keepdims=True))
    places = [tuple(map(int, place)) for place in np.argwhere(start)]
    places.sort(key=lambda place: float(grid.size[place]))
    return [settled(likelihood, grid.point(place, free)) for place in places[:STARTS]]


def settled(
    likelihood: Likelihood, start: np.ndarray, *, held: int | None = None, steps: int = STEPS
) -> np.ndarray:
    """Return the most likely point near a start, of those with its coordinate ``held`` if given."""
    low, high = likelihood.points.bounds
    moving = [k for k in range(start.size) if k != held]
    point = start.astype(float)
    if not moving:
        return point
    if [likelihood.points.family.free[k] for k in moving] == [NOISE]:  # in closed form
        point[moving] = np.clip(likelihood.over_noise(point)[1], low[moving], high[moving])
        return point

    def whole(coordinates: np.ndarray) -> np.ndarray:
        point[moving] = coordinates
        return point

    found = optimize.least_squares(
        lambda coordinates: likelihood.residual(whole(coordinates)),
        np.clip(start, low + 1e-9, high - 1e-9)[moving],
        lambda coordinates: likelihood.slope(whole(coordinates))[:, moving],
        bounds=(low[moving], high[moving]),
        max_nfev=steps,
    )
    return whole(found.x)
