"""A lattice of persons that follows the ridge of the likelihood, as fine as the weight needs it.

It consists of slices (:mod:`.slices`), each of one value of the first coordinate. The noise is no
coordinate of it: it is integrated exactly, since it moves the mean of the logarithms alone. Across,
persons stand around the most likely ones of a slice: thin ridges, as of long recordings, need no
more of them than wide ones. Between two slices that hold more than :data:`SHARE` of all weight
another is added. A person that no ridge leads to begins another.
"""

from collections.abc import Sequence

import numpy as np
from scipy import special

from standfast.fitting.likelihood import Likelihood
from standfast.fitting.posterior import Lattice, Posterior, lattice_of
from standfast.fitting.search import Grid, settled
from standfast.fitting.slices import Slice, Weights, laid, squared

FIRST = 16  # slices over the limits, before any is added
SHARE, MOST = 0.03, 200
SEEN = 8.0  # of a logarithm: minima that weigh so much less begin no ridge of their own
ROUGHLY = 3  # steps of the solver: a slice need not be centred exactly
SAME = 1e-3  # of a coordinate: two starts have ended at one minimum
CLOSEST = 1e-6  # that slices stand to each other


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
        better = [each for ridge in ridges if (each := ridge.weights.better) is not None]
        if not better:
            return Posterior([ridge.lattice() for ridge in ridges if ridge.weighs()]), minima[0]
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
    """The slices of one ridge, begun at a minimum; what an earlier one covers it leaves to that."""

    def __init__(
        self,
        likelihood: Likelihood,
        coarse: Grid,
        start: np.ndarray,
        best: np.ndarray,
        earlier: "Sequence[_Ridge]",
    ) -> None:
        self.weights = Weights(likelihood, likelihood.size(best))
        self.likelihood, self.coarse, self.earlier = likelihood, coarse, earlier
        self.keep = self.weights.keep
        self.slices: dict[float, Slice | None] = {}
        if not self.keep:
            self.slices[0.0] = laid(self.weights, start, self._covered)
            return
        self._add(float(start[self.keep[0]]), start)
        values = np.linspace(self.weights.low[0], self.weights.high[0], FIRST)
        for value in sorted(values, key=lambda each: abs(each - start[self.keep[0]])):
            self._add(float(value))
        self.fill()

    def fill(self) -> None:
        """Find slices between those that weigh."""
        while self.weights.better is None and len(self.slices) < MOST:
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
        found = self.slices[min(self.slices, key=lambda each: abs(each - value))]
        return found is not None and found.covers(self._steps(found, point[self.keep]))

    def covers(self, coordinates: np.ndarray) -> bool:
        """Return whether the slices on both sides of a point cover it."""
        known = np.array(sorted(self.slices))
        after = int(np.searchsorted(known, coordinates[0]))
        beside = [self.slices[each] for each in known[max(after - 1, 0) : after + 1]]
        return all(
            found is not None and found.covers(self._steps(found, coordinates)) for found in beside
        )

    def weighs(self) -> bool:
        """Return whether anything of the ridge is left to it."""
        return any(
            found is not None and np.isfinite(found.weight).any() for found in self.slices.values()
        )

    def lattice(self) -> Lattice:
        """Return all slices as one lattice."""
        first = np.array(sorted(self.slices))
        known = [found for found in self.slices.values() if found is not None]
        others = max(len(self.keep) - 1, 0)
        start = min(found.first for found in known)
        stop = max(found.first + (found.weight.shape[0] if others else 1) for found in known)
        across = np.arange(start, stop, dtype=float)
        shape = (*([first.size] if self.keep else []), *[across.size] * others)
        points = np.full((*shape, len(self.keep)), np.nan)
        weight, noise, error = (np.full(shape, none) for none in (-np.inf, np.nan, np.nan))
        steps = squared(across, others)
        for row, value in enumerate(first):
            found = self.slices[value]
            if found is None:
                continue
            one = (row,) if self.keep else ()
            points[one] = found.centre[self.keep]
            points[one][..., 1:] += steps @ found.axes.T
            begin = found.first - start
            looked_at = (*one, *[slice(begin, begin + n) for n in found.weight.shape])
            weight[looked_at], noise[looked_at], error[looked_at] = found[3:]
        limits = self.weights.low, self.weights.high
        return lattice_of(first, across, limits, points, weight, noise, error)

    def _between(self) -> np.ndarray:
        """Return the middles between slices that hold too much weight."""
        first = np.array(sorted(self.slices))
        total = np.array([
            -np.inf if found is None else special.logsumexp(found.weight)
            for found in map(self.slices.__getitem__, first)
        ])  # fmt: skip
        if not np.isfinite(total.max()):  # all of it is covered by an earlier one
            return np.zeros(0)
        density = np.exp(total - total.max())
        held = 0.5 * (density[1:] + density[:-1]) * np.diff(first)
        apart = np.diff(first) > 4.0 * CLOSEST
        middles: np.ndarray = (0.5 * (first[1:] + first[:-1]))[apart & (held > SHARE * held.sum())]
        return middles

    def _add(self, value: float, start: np.ndarray | None = None) -> None:
        """Find the slice at a value, from the nearest one that is known."""
        if any(abs(value - known) < CLOSEST for known in self.slices):
            return
        self.slices[value] = None
        for each in [start] if start is not None else self._starts(value):
            point = each.copy()
            point[self.keep[0]] = value
            if np.isfinite(self.likelihood.size(point)):
                centre = settled(self.likelihood, point, held=self.keep[0], steps=ROUGHLY)
                if not self._covered(centre[self.keep]):
                    self.slices[value] = laid(self.weights, centre, self._covered)
                return

    def _covered(self, coordinates: np.ndarray) -> bool:
        return any(ridge.covers(coordinates) for ridge in self.earlier)

    def _steps(self, found: Slice, coordinates: np.ndarray) -> np.ndarray:
        """Return how many steps across a slice a point lies from its centre."""
        steps: np.ndarray = np.linalg.solve(
            found.axes, coordinates[1:] - found.centre[self.keep][1:]
        )
        return steps

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
            starts.append(self.coarse.point((column, *map(int, place)), self.weights.free))
        return starts
