"""A lattice of persons that follows the ridge of the likelihood, as fine as the weight needs it.

It consists of *slices*, each of one value of the first coordinate (the noise is none: it is
integrated exactly, since it moves the mean of the logarithms alone). In a slice the others stand
around the most likely ones there, a standard deviation apart, along the axes of the Gaussian that
the likelihood resembles there: thin ridges, as of long recordings, need no more points than wide
ones. Between two slices that hold more than :data:`SHARE` of all weight another is added.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from scipy import special

from standfast.fitting.family import NOISE, PROPORTIONAL
from standfast.fitting.likelihood import Likelihood
from standfast.fitting.posterior import Lattice, Posterior, lattice_of
from standfast.fitting.search import Grid, settled

FIRST = 16  # slices over the limits, before any is added
SHARE, MOST = 0.03, 200
# Where the others of a slice stand, in standard deviations, by how many they are: sums over a
# Gaussian in steps of one are exact to 1e-8, but for what lies further out, 6e-5 and 3e-3.
ACROSS = {0: np.zeros(1), 1: np.arange(-4.0, 5.0), 2: np.arange(-3.0, 4.0)}
WIDEST = 0.25  # of a coordinate's range: the most that its standard deviation is taken for
SEEN = 8.0  # of a logarithm: minima that weigh so much less begin no ridge of their own
FAINT = 25.0  # of a logarithm: of who weighs so much less only the best of a slice is found
ROUGHLY = 3  # steps of the solver: a slice need not be centred exactly
BETTER = 1e-6  # of −2 log L; a solver leaves less
SAME = 1e-3  # of a coordinate: two starts have ended at one minimum
CLOSEST = 1e-6  # that slices stand to each other


class Slice(NamedTuple):
    """Persons of one value of the first coordinate.

    Attributes
    ----------
    centre : (coordinates,), the most likely there, with its noise
    axes : (others, others), of which the columns are steps across
    points : (*across, coordinates), without the noise
    weight : (*across,), logarithms, a unit of the first coordinate and of steps across
    noise, error : (*across,), the most likely log σ, and its standard error
    """

    centre: np.ndarray
    axes: np.ndarray
    points: np.ndarray
    weight: np.ndarray
    noise: np.ndarray
    error: np.ndarray


def posterior_of(
    likelihood: Likelihood, coarse: Grid, minima: Sequence[np.ndarray]
) -> tuple[Posterior, np.ndarray]:
    """Return the weights of all persons, and the most likely of them.

    A minimum that no ridge leads to begins another. Where a lattice has a more likely person than
    all minima, the search goes on from there.
    """
    while True:
        minima = _apart(likelihood, minima)
        ridges: list[_Ridge] = []
        for point in minima:
            if not any(ridge.leads_to(point) for ridge in ridges):
                ridges.append(_Ridge(likelihood, coarse, point, minima[0], tuple(ridges)))
        for ridge in ridges:
            ridge.fill()
        better = [ridge.better for ridge in ridges if ridge.better is not None]
        if not better:
            return Posterior([ridge.lattice() for ridge in ridges]), minima[0]
        minima = [*minima, *better, *(settled(likelihood, point) for point in better)]


def _apart(likelihood: Likelihood, minima: Sequence[np.ndarray]) -> list[np.ndarray]:
    """Return minima that weigh anything, the most likely first, each once."""
    kept: list[np.ndarray] = []
    for point in sorted(minima, key=likelihood.size):
        weighs = not kept or likelihood.size(point) - likelihood.size(kept[0]) < 2.0 * SEEN
        if weighs and all(abs(point - other).max() > SAME for other in kept):
            kept.append(point)
    return kept


class _Ridge:
    """The slices of one ridge, begun at a minimum; where it joins an earlier one it ends."""

    def __init__(
        self,
        likelihood: Likelihood,
        coarse: Grid,
        start: np.ndarray,
        best: np.ndarray,
        earlier: "Sequence[_Ridge]",
    ) -> None:
        self.likelihood, self.coarse, self.start, self.earlier = likelihood, coarse, start, earlier
        self.free = likelihood.points.family.free
        self.keep = [k for k, name in enumerate(self.free) if name != NOISE]
        self.low, self.high = (each[self.keep] for each in likelihood.points.bounds)
        self.least = likelihood.size(best)
        self.across = ACROSS[max(len(self.keep) - 1, 0)]
        self.slices: dict[float, Slice | None] = {}
        self.better: np.ndarray | None = None
        if self.keep:
            self._add(float(start[self.keep[0]]), start)
            values = np.linspace(self.low[0], self.high[0], FIRST)
            for value in sorted(values, key=lambda each: abs(each - start[self.keep[0]])):
                self._add(float(value))
        else:
            self.slices[0.0] = self._laid(start)
        self.fill()

    def fill(self) -> None:
        """Find slices between those that weigh."""
        while self.better is None and len(self.slices) < MOST:
            values = self._between()
            if not values.size:
                return
            for value in values:
                self._add(float(value))

    def leads_to(self, point: np.ndarray) -> bool:
        """Return whether a point lies on this ridge; it has a slice there then."""
        if not self.keep:
            return True
        value = float(point[self.keep[0]])
        self._add(value)
        nearest = min(self.slices, key=lambda each: abs(each - value))
        found = self.slices[nearest]
        return found is not None and self._holds(found, point)

    def _holds(self, found: Slice, point: np.ndarray) -> bool:
        others = self.keep[1:]
        steps = np.linalg.solve(found.axes, point[others] - found.centre[others])
        return bool((abs(steps) <= self.across.max()).all())

    def lattice(self) -> Lattice:
        """Return all slices as one lattice."""
        first = np.array(sorted(self.slices))
        shape = (self.across.size,) * max(len(self.keep) - 1, 0)
        nobody = Slice(
            np.zeros(0), np.zeros(0), np.full((*shape, len(self.keep)), np.nan),
            np.full(shape, -np.inf), np.zeros(shape), np.ones(shape),
        )  # fmt: skip
        found = [self.slices[value] or nobody for value in first]
        points, weight, noise, error = (
            np.stack([each[k] for each in found]) for k in range(2, len(nobody))
        )
        if not self.keep:
            points, weight, noise, error = points[0], weight[0], noise[0], error[0]
        limits = self.low, self.high
        return lattice_of(first, self.across, limits, points, weight, noise, error)

    def _between(self) -> np.ndarray:
        """Return the middles between slices that hold too much weight."""
        first = np.array(sorted(self.slices))
        total = np.array([
            -np.inf if found is None else special.logsumexp(found.weight)
            for found in map(self.slices.__getitem__, first)
        ])  # fmt: skip
        if not np.isfinite(total.max()):  # it has joined an earlier one at once
            return np.zeros(0)
        density = np.exp(total - total.max())
        held = 0.5 * (density[1:] + density[:-1]) * np.diff(first)
        middles: np.ndarray = (0.5 * (first[1:] + first[:-1]))[held > SHARE * held.sum()]
        return middles

    def _add(self, value: float, start: np.ndarray | None = None) -> None:
        """Find the slice at a value, from the nearest one that is known."""
        if any(abs(value - known) < CLOSEST for known in self.slices):
            return
        starts = [start] if start is not None else self._starts(value)
        for each in starts:
            point = each.copy()
            point[self.keep[0]] = value
            if np.isfinite(self.likelihood.size(point)):
                centre = settled(self.likelihood, point, held=self.keep[0], steps=ROUGHLY)
                joined = any(ridge.leads_to(centre) for ridge in self.earlier)
                self.slices[value] = None if joined else self._laid(centre)
                return
        self.slices[value] = None

    def _starts(self, value: float) -> list[np.ndarray]:
        """Return where a slice may be begun: as the nearest one, or where the coarse grid says."""
        known = sorted(each for each, found in self.slices.items() if found is not None)
        after = int(np.searchsorted(known, value))
        beside = known[max(after - 1, 0) : after + 1]
        near = [found.centre for found in map(self.slices.get, beside) if found is not None]
        starts = []
        if len(near) == 2:
            share = (value - known[after - 1]) / (known[after] - known[after - 1])
            starts.append((1.0 - share) * near[0] + share * near[1])
            near = near[::-1] if share > 0.5 else near
        starts += near
        column = int(np.argmin(abs(self.coarse.axes[0] - value)))
        size = self.coarse.size[column]
        if np.isfinite(size).any():
            place = np.unravel_index(np.argmin(size), size.shape)
            starts.append(self.coarse.point((column, *map(int, place)), self.free))
        return starts

    def _laid(self, centre: np.ndarray) -> Slice:
        """Return the slice around its most likely person."""
        others = self.keep[1:]
        steps = np.stack(np.meshgrid(*[self.across] * len(others), indexing="ij"), axis=-1) if (
            others) else np.zeros(0)  # fmt: skip
        axes = self._axes(centre)
        points = np.broadcast_to(centre[self.keep], (*steps.shape[:-1], len(self.keep))).copy()
        points[..., 1:] += steps @ axes.T
        volume = float(np.log(np.diagonal(axes)).sum())
        shape = points.shape[:-1]
        size, noise, error = np.full(shape, np.inf), np.zeros(shape), np.ones(shape)
        here = self._of(centre[self.keep])
        if 0.5 * (here[0] - self.least) > FAINT:
            size = here[0] + (steps**2).sum(axis=-1)
            noise, error = np.full(shape, here[1]), np.full(shape, here[2])
        else:
            for place in np.ndindex(*shape):
                size[place], noise[place], error[place] = self._of(points[place])
        weight = volume - 0.5 * size + np.log(error) + self._beforehand(points)
        return Slice(centre, axes, points, weight, noise, error)

    def _axes(self, centre: np.ndarray) -> np.ndarray:
        """Return the root of the covariance of the coordinates across, in a slice."""
        others = [k for k in range(centre.size) if k in self.keep[1:]]
        moving = [k for k in range(centre.size) if k not in self.keep[:1]]
        slope = self.likelihood.slope(centre)[:, moving]
        widest = WIDEST * (self.high - self.low)[1:]
        information = slope.T @ slope
        places = [moving.index(k) for k in others]
        information[places, places] += widest**-2.0
        covariance = np.linalg.inv(information)[np.ix_(places, places)]
        root: np.ndarray = np.linalg.cholesky(covariance)
        return root

    def _of(self, coordinates: np.ndarray) -> tuple[float, float, float]:
        """Return −2 log L, log σ and its standard error, and remember who is better than all."""
        point = np.array(coordinates)
        place = self.free.index(NOISE) if NOISE in self.free else None
        if place is not None:
            point = np.insert(point, place, 0.0)
        size, noise, error = self.likelihood.over_noise(point)
        within = (coordinates >= self.low).all() and (coordinates <= self.high).all()
        if within and size < self.least - BETTER:
            if place is not None:
                point[place] = noise
            self.better = point
        return size, noise, error if error > 0.0 else 1.0

    def _beforehand(self, points: np.ndarray) -> np.ndarray:
        """Return the logarithm of what is taken beforehand: even in p, log d and log τ."""
        names = [self.free[k] for k in self.keep]
        found = np.zeros(points.shape[:-1])
        if PROPORTIONAL in names:
            found = found + points[..., names.index(PROPORTIONAL)]
        return found
