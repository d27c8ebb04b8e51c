"""What is asked of persons with delayed feedback: answers from their crossings and roots.

An answer has the shape (persons,), or (persons, delays) where it depends on the delay.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from standfast.stability.delay.table import Crossings


@dataclass(frozen=True)
class FedBack:
    """Persons with delayed feedback: the delays that are asked, their crossings, their roots.

    ``find_crossings`` gives the crossings of whom the quantities need; ``find_roots`` the rightmost
    root of each person at each delay, (persons, delays), and whether it is proven;
    ``find_variances`` the integrals of rows of the densities of sway, (persons, delays) each. Each
    is asked once, and only by who needs it.
    """

    delays: np.ndarray
    find_crossings: Callable[[], Crossings]
    find_roots: Callable[[], tuple[np.ndarray, np.ndarray]]
    find_variances: Callable[[], Mapping[int, np.ndarray]]

    @cached_property
    def crossings(self) -> Crossings:
        """The crossings of each person."""
        return self.find_crossings()

    @cached_property
    def roots(self) -> np.ndarray:
        """Rightmost roots (1/s), imaginary part ≥ 0."""
        return self.find_roots()[0]

    @cached_property
    def variances(self) -> Mapping[int, np.ndarray]:
        """Integrals of densities by row."""
        return self.find_variances()


def stands(asked: FedBack) -> np.ndarray:
    """Return whether no root has a real part ≥ 0."""
    return asked.crossings.stable_at(asked.delays)


def unstable_roots(asked: FedBack) -> np.ndarray:
    """Return the number of roots with a positive real part."""
    return asked.crossings.unstable_at(asked.delays)


def critical_delay(asked: FedBack) -> np.ndarray:
    """Return the smallest delay at which stability is lost (s)."""
    return asked.crossings.critical_delay()


def delay_margin(asked: FedBack) -> np.ndarray:
    """Return by how much the delay could grow before stability is first lost (s)."""
    margin: np.ndarray = asked.crossings.critical_delay()[:, None] - asked.delays
    return margin


def decay_rate(asked: FedBack) -> np.ndarray:
    """Return −Re of the rightmost root (1/s)."""
    return -asked.roots.real


def sway_frequency(asked: FedBack) -> np.ndarray:
    """Return Im of the rightmost root as a frequency (Hz)."""
    frequency: np.ndarray = asked.roots.imag / (2.0 * np.pi)
    return frequency


def damping_ratio(asked: FedBack) -> np.ndarray:
    """Return −Re s/|s| of the rightmost root, negative where the person falls."""
    size = np.abs(asked.roots)
    ratio: np.ndarray = -asked.roots.real / np.where(size > 0.0, size, 1.0)
    # with three rigid joints nothing moves, and all motion has died out at once
    return np.where(np.isinf(size), 1.0, ratio)
