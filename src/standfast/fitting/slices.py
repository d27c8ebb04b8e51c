"""Persons of one value of the first coordinate, laid across the ridge until they weigh nothing.

The others stand around the most likely one there, a standard deviation of the Gaussian that the
likelihood resembles apart. One coordinate across is walked both ways until a person falls or weighs
nothing, since next to falling the weight may rise again; two stand on a fixed square.
"""

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from standfast.fitting.family import NOISE, PROPORTIONAL
from standfast.fitting.likelihood import Likelihood

# How far the others stand of two, and of one where a Gaussian is enough, in standard deviations:
# sums over a Gaussian in steps of one are exact to 1e-8, but for what lies further out, 3e-3.
SQUARE, USUAL = 3, 4
FURTHEST = 24  # steps that a walk takes
ASKED = 8  # of so many it is asked together who stands; who goes further asks one by one
NOTHING = 8.0  # of a logarithm: who weighs so much less ends a walk
# So many persons weigh at least e^−2 of the most of a line; with fewer its step is halved.
SHOWN, HALVED = 3, 5
WIDEST = 0.25  # of a coordinate's range: the most that its standard deviation is taken for
FAINT = 25.0  # of a logarithm: of who weighs so much less only the best of a slice is found
BETTER = 1e-6  # of −2 log L; a solver leaves less

Covered = Callable[[np.ndarray], bool]


class Slice(NamedTuple):
    """Persons of one value of the first coordinate.

    Attributes
    ----------
    centre : (coordinates,), most likely there, with its noise
    axes : (others, others), of which the columns are steps across
    first : the step of the first person of a line or square; they go on by one
    weight : (*across,), logarithms, a unit of the first coordinate and of steps across
    noise, error : (*across,), the most likely log σ, and its standard error
    """

    centre: np.ndarray
    axes: np.ndarray
    first: int
    weight: np.ndarray
    noise: np.ndarray
    error: np.ndarray

    def covers(self, steps: np.ndarray) -> bool:
        """Return whether steps from the centre are among those that were looked at."""
        last = self.first + (self.weight.shape[0] - 1 if self.weight.ndim else 0)
        return bool(((steps >= self.first) & (steps <= last)).all())


class Weights:
    """Weights of persons: their likelihood, and what is taken of them beforehand."""

    def __init__(self, likelihood: Likelihood, least: float) -> None:
        self.likelihood, self.least = likelihood, least
        self.free = likelihood.points.family.free
        self.keep = [k for k, name in enumerate(self.free) if name != NOISE]
        self.low, self.high = (each[self.keep] for each in likelihood.points.bounds)
        self.better: np.ndarray | None = None

    def at(self, coordinates: np.ndarray) -> tuple[float, float, float]:
        """Return the logarithm of the weight, log σ and its standard error; −inf who falls.

        Even in p, log d and log τ beforehand. A person more likely than all minima is remembered.
        """
        (point,) = self._points(coordinates[None])
        size, noise, error = self.likelihood.over_noise(point)
        within = (coordinates >= self.low).all() and (coordinates <= self.high).all()
        if within and size < self.least - BETTER:
            if NOISE in self.free:
                point[self.free.index(NOISE)] = noise
            self.better = point
        names = [self.free[k] for k in self.keep]
        beforehand = coordinates[names.index(PROPORTIONAL)] if PROPORTIONAL in names else 0.0
        error = error if error > 0.0 else 1.0
        return -0.5 * (size - self.least) + float(np.log(error) + beforehand), noise, error

    def ask(self, coordinates: np.ndarray) -> None:
        """Find who of many, (n, coordinates), stands, before each is asked for its weight."""
        self.likelihood.ask(self._points(coordinates))

    def _points(self, coordinates: np.ndarray) -> np.ndarray:
        """Return points, (n, coordinates), of coordinates without the noise."""
        if NOISE not in self.free:
            return np.array(coordinates)
        return np.insert(coordinates, self.free.index(NOISE), 0.0, axis=1)

    def axes(self, centre: np.ndarray) -> np.ndarray:
        """Return the root of the covariance of the coordinates across, in a slice."""
        others = [k for k in range(centre.size) if k in self.keep[1:]]
        moving = [k for k in range(centre.size) if k not in self.keep[:1]]
        slope = self.likelihood.slope(centre)[:, moving]
        information = slope.T @ slope
        places = [moving.index(k) for k in others]
        information[places, places] += (WIDEST * (self.high - self.low)[1:]) ** -2.0
        covariance = np.linalg.inv(information)[np.ix_(places, places)]
        root: np.ndarray = np.linalg.cholesky(covariance)
        return root


def laid(weights: Weights, centre: np.ndarray, covered: Covered) -> Slice:
    """Return the slice around its most likely person, without who is ``covered`` elsewhere."""
    axes, others = weights.axes(centre), len(weights.keep) - 1
    own = centre[weights.keep]
    here = weights.at(own)
    if others < 1:
        return Slice(centre, axes, 0, *(np.array(each) for each in here))
    if here[0] < -FAINT:
        width = SQUARE if others > 1 else USUAL
        steps = _square(others, width)
        weight = here[0] - 0.5 * (steps**2).sum(axis=-1) + _volume(axes)
        return Slice(centre, axes, -width, weight, *(np.full(weight.shape, x) for x in here[1:]))
    if others > 1:
        steps = _square(others, SQUARE)
        weights.ask(_points(own, axes, steps.reshape(-1, others)))
        found = np.apply_along_axis(lambda step: _at(weights, own, axes, step, covered), -1, steps)
        return Slice(centre, axes, -SQUARE, found[..., 0] + _volume(axes), *_rest(found))
    return _line(weights, centre, axes, covered)


def _line(weights: Weights, centre: np.ndarray, axes: np.ndarray, covered: Covered) -> Slice:
    """Return a slice with one coordinate across, in steps that show its greatest weight."""
    for halved in range(HALVED + 1):
        own = centre[weights.keep]
        weights.ask(_points(own, axes, np.arange(-ASKED, ASKED + 1.0)[:, None]))
        middle = _at(weights, own, axes, np.zeros(1), covered)
        below, above = (_walk(weights, own, way * axes, middle[0], covered) for way in (-1.0, 1.0))
        found, first = np.array([*reversed(below), middle, *above]), -len(below)
        top = int(np.argmax(found[:, 0]))
        if (found[:, 0] > found[top, 0] - 2.0).sum() >= SHOWN or halved == HALVED:
            break
        centre = centre.copy()
        centre[weights.keep[1]] += (first + top) * axes[0, 0]
        axes = 0.5 * axes
    return Slice(centre, axes, first, found[:, 0] + _volume(axes), *_rest(found))


def _walk(
    weights: Weights, own: np.ndarray, axes: np.ndarray, middle: float, covered: Covered
) -> list[tuple[float, float, float]]:
    """Return weights from step 1 on, up to one that falls, or weighs nothing beside the most."""
    found: list[tuple[float, float, float]] = []
    most = middle
    for step in range(1, FURTHEST + 1):
        found.append(_at(weights, own, axes, np.array([float(step)]), covered))
        most = max(most, found[-1][0])
        # not before a Gaussian would have ended
        if (step >= USUAL and found[-1][0] < most - NOTHING) or np.isneginf(found[-1][0]):
            break
    return found


def _at(
    weights: Weights, own: np.ndarray, axes: np.ndarray, step: np.ndarray, covered: Covered
) -> tuple[float, float, float]:
    (point,) = _points(own, axes, step[None])
    return (-np.inf, np.nan, np.nan) if covered(point) else weights.at(point)


def _points(own: np.ndarray, axes: np.ndarray, steps: np.ndarray) -> np.ndarray:
    """Return the coordinates at steps, (n, others), from a slice's own."""
    across = own[1:] + (steps[:, None] * axes).sum(axis=2)
    return np.concatenate([np.tile(own[:1], (len(steps), 1)), across], axis=1)


def _square(others: int, width: int) -> np.ndarray:
    return squared(np.arange(-width, width + 1.0), others)


def squared(across: np.ndarray, others: int) -> np.ndarray:
    """Return all combinations of steps of the others, (*across, others); one of none."""
    if not others:
        return np.zeros(0)
    return np.stack(np.meshgrid(*[across] * others, indexing="ij"), axis=-1)


def _volume(axes: np.ndarray) -> float:
    return float(np.log(np.diagonal(axes)).sum())


def _rest(found: np.ndarray) -> Sequence[np.ndarray]:
    """Return noise and error, of who falls none."""
    falls = np.isneginf(found[..., 0])
    return [np.where(falls, np.nan, found[..., k]) for k in (1, 2)]
