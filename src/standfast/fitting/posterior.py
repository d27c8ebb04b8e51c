"""What is known of a number once the measures are: 95 % of it, over all persons by their weights.

The density of a person is the likelihood times what is taken beforehand: all proportional gains
above the least that holds a person up as equally likely, and of all else the logarithms. Two quite
different persons may have the same measures; by weights both count, where a threshold of the
likelihood would leave out the one whose recordings vary more.

The persons stand on a lattice (:mod:`.ridge`). Within its cells numbers, and what the weight is
beside a Gaussian one, are interpolated linearly.
"""

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from scipy import optimize, stats

CONFIDENCE = 0.95
TAILS = (0.5 - 0.5 * CONFIDENCE, 0.5 + 0.5 * CONFIDENCE)
FAINT = 12.0  # of a logarithm: points with so much less weight need no numbers
NOTHING = 30.0  # the same, and are not counted at all
FINER = 8  # points a step of the lattice in sums
AT_LIMIT = 0.05  # of a coordinate's range
FAR = 9.0  # standard errors of the noise, beyond which nothing is


class Lattice(NamedTuple):
    """Points with weights, of all coordinates but the noise.

    Attributes
    ----------
    points : (*lattice, coordinates)
    weight : (*lattice,), logarithms, all relative to the same
    finer : (n,), those of the points of the finer lattice, with the volume of each
    noise, error : (n,), the most likely log σ there, and its standard error
    at_limit : (n, coordinates), whether each is next to a limit of the search
    """

    points: np.ndarray
    weight: np.ndarray
    finer: np.ndarray
    noise: np.ndarray
    error: np.ndarray
    at_limit: np.ndarray


class Posterior:
    """All lattices of a likelihood, of which each has its share of the weight."""

    def __init__(self, lattices: Sequence[Lattice]) -> None:
        self._lattices = lattices
        logarithm, noise, error, at_limit = (
            np.concatenate([each[k] for each in lattices]) for k in range(2, len(Lattice._fields))
        )
        self._some = logarithm > logarithm.max() - NOTHING
        weight = np.exp(logarithm[self._some] - logarithm.max())
        self._share = weight / weight.sum()
        self._noise, self._error = noise[self._some], error[self._some]
        self._at_limit = at_limit[self._some]

    def intervals(
        self, numbers: Callable[[np.ndarray], np.ndarray], count: int
    ) -> tuple[np.ndarray, np.ndarray]:
        """Return between what ``count`` functions of (n, coordinates) lie, (count, 2).

        The coordinates, or what grows with each, come first. Beside them whether an end is open:
        most of what lies beyond is at a limit of the search, of a coordinate at its own. Points for
        which a function has no number are left out of it.
        """
        largest = max(lattice.weight.max() for lattice in self._lattices)
        found = []
        for lattice in self._lattices:
            values = np.full((*lattice.weight.shape, count), np.nan)
            weighs = lattice.weight > largest - FAINT
            values[weighs] = numbers(lattice.points[weighs])
            found.append(np.stack([finer(each).ravel() for each in np.moveaxis(values, -1, 0)]))
        ends, open_ = np.full((count, 2), np.nan), np.zeros((count, 2), bool)
        for row, each in enumerate(np.concatenate(found, axis=1)[:, self._some]):
            known = ~np.isnan(each)
            if known.any():
                own, share = each[known], self._share[known]
                ends[row] = _quantiles(own, share)
                beyond = np.stack([own <= ends[row, 0], own >= ends[row, 1]]) * share
                limits = self._at_limit[known]
                own_limit = limits[:, row] if row < limits.shape[1] else limits.any(axis=1)
                open_[row] = _mostly(beyond, own_limit)
        return ends, open_

    def noise_interval(self) -> tuple[np.ndarray, np.ndarray]:
        """Return between what log σ lies, (2,), and whether these ends are open."""
        edges = (
            (self._noise - FAR * self._error).min(),
            (self._noise + FAR * self._error).max(),
        )

        def below(value: float) -> np.ndarray:
            found: np.ndarray = self._share * stats.norm.cdf((value - self._noise) / self._error)
            return found

        low, high = (
            float(optimize.brentq(lambda value, tail=tail: below(value).sum() - tail, *edges))
            for tail in TAILS
        )
        beyond = np.stack([below(low), self._share - below(high)])
        return np.array([low, high]), _mostly(beyond, self._at_limit.any(axis=1))


def lattice_of(
    first: np.ndarray,
    across: np.ndarray,
    limits: tuple[np.ndarray, np.ndarray],
    points: np.ndarray,
    weight: np.ndarray,
    noise: np.ndarray,
    error: np.ndarray,
) -> Lattice:
    """Return a lattice with the weights between its points.

    Parameters
    ----------
    first : (k,), of the first coordinate, ascending; across : (m,), standard deviations
        of the lattice, (k, m, m, …) with as many m as there are further coordinates; of no
        coordinate at all it is ().
    limits : (coordinates,), the least and the largest
    points : (*lattice, coordinates), of which some may lie beyond a limit
    weight : (*lattice,), logarithms, a unit of ``first`` and of ``across``
    """
    gaussian, fine_gaussian = np.zeros(weight.shape), np.zeros(finer(weight).shape)
    for axis in range(1, weight.ndim):
        shape = [-1 if k == axis else 1 for k in range(weight.ndim)]
        gaussian = gaussian - 0.5 * across.reshape(shape) ** 2
        fine_gaussian = fine_gaussian - 0.5 * finer(across).reshape(shape) ** 2
    logarithm = finer(weight - gaussian) + fine_gaussian
    logarithm -= max(weight.ndim - 1, 0) * np.log(FINER)
    if first.size > 1:
        widths = np.convolve(np.diff(finer(first)), [0.5, 0.5])
        logarithm += np.log(widths).reshape(-1, *[1] * (weight.ndim - 1))
    low, high = limits
    between = [finer(each).ravel() for each in np.moveaxis(points, -1, 0)]
    own = np.stack(between, axis=1) if between else np.zeros((logarithm.size, 0))
    outside = ((own < low) | (own > high)).any(axis=1)
    logarithm = np.where(outside, -np.inf, logarithm.ravel())
    below, above = near_limits(own, low, high)
    at_limit: np.ndarray = below | above
    # beyond a limit numbers are only needed to interpolate to it
    within = ((points >= low) & (points <= high)).all(axis=-1)
    weight = np.minimum(weight, weight[within].max(initial=-np.inf))
    return Lattice(points, weight, logarithm, finer(noise).ravel(), finer(error).ravel(), at_limit)


def near_limits(points: np.ndarray, low: np.ndarray, high: np.ndarray) -> np.ndarray:
    """Return which coordinates are next to the least and to the largest, (2, *points)."""
    near = AT_LIMIT * (high - low)
    return np.stack([points < low + near, points > high - near])


def finer(values: np.ndarray) -> np.ndarray:
    """Return values between those of a lattice, linear along each axis.

    Next to one that is not finite they are those of the nearer point.
    """
    for axis in range(values.ndim):
        own = np.moveaxis(values, axis, 0)
        if len(own) < 2:
            continue
        start, end = own[:-1, None], own[1:, None]
        share = (np.arange(FINER) / FINER).reshape(-1, *[1] * (own.ndim - 1))
        both = np.isfinite(start) & np.isfinite(end)
        change = np.where(both, end, 0.0) - np.where(both, start, 0.0)
        nearer = np.where(share < 0.5, start, end)
        cells = np.where(both, start + share * change, nearer).reshape(-1, *own.shape[1:])
        values = np.moveaxis(np.concatenate([cells, own[-1:]]), 0, axis)
    return values


def _mostly(beyond: np.ndarray, at_limit: np.ndarray) -> np.ndarray:
    """Return of each row of weights whether most of it is at a limit."""
    found: np.ndarray = beyond @ at_limit > 0.5 * beyond.sum(axis=1)
    return found


def _quantiles(values: np.ndarray, share: np.ndarray) -> np.ndarray:
    """Return between what values lie, but for the tails."""
    order = np.argsort(values)
    own, weight = values[order], share[order]
    below = (np.cumsum(weight) - 0.5 * weight) / weight.sum()
    found = np.interp(TAILS, below, own)
    # between a finite number and an infinite one is none
    nearer = own[[int(np.argmin(abs(below - tail))) for tail in TAILS]]
    return np.where(np.isfinite(found), found, nearer)
