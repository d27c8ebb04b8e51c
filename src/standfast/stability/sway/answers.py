"""What is asked of persons who sway, each at each delay: (persons, delays)."""

from collections.abc import Callable

import numpy as np

from standfast.numerics.arrays import TURN
from standfast.stability.delay.answers import FedBack
from standfast.stability.sway.density import COP, COP_TIMES_OMEGA


def deviation(row: int) -> Callable[[FedBack], np.ndarray]:
    """Return the answer that is the root of a variance, ``row`` of the densities."""

    def found(asked: FedBack) -> np.ndarray:
        size: np.ndarray = np.sqrt(asked.variances[row])
        return size

    return found


def mean_frequency(asked: FedBack) -> np.ndarray:
    """Return ∫ f S df / ∫ S df of the centre of pressure (Hz).

    It is NaN of who falls, and where nothing sways.
    """
    size = asked.variances[COP]
    sways = np.isfinite(size) & (size > 0.0)
    times_omega = np.where(sways, asked.variances[COP_TIMES_OMEGA], np.nan)
    frequency: np.ndarray = times_omega / (TURN * np.where(sways, size, 1.0))
    return frequency
