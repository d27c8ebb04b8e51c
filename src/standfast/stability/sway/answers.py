"""What is asked of persons who sway, each at each delay: (persons, delays)."""

from collections.abc import Callable

import numpy as np

from standfast.numerics.arrays import TURN
from standfast.parameters import JOINTS
from standfast.stability.delay.answers import FedBack
from standfast.stability.sway.density import COM, COP, COP_TIMES_OMEGA, COP_VELOCITY, PAIRS

# The rows of densities of whose integrals a quantity is made: a deviation is the root of its one.
ROWS = {
    **{f"{joint}_sway": (PAIRS.index((place, place)),) for place, joint in enumerate(JOINTS)},
    "com_sway": (COM,),
    "cop_sway": (COP,),
    "cop_velocity": (COP_VELOCITY,),
    "cop_frequency": (COP, COP_TIMES_OMEGA),
}


def deviation(row: int) -> Callable[[FedBack], np.ndarray]:
    """Return the answer that is the root of a variance, ``row`` of the densities."""

    def found(asked: FedBack) -> np.ndarray:
        size: np.ndarray = np.sqrt(asked.variances[row])
        return size

    return found


def mean_frequency(asked: FedBack) -> np.ndarray:
    """Return ∫ f S df / ∫ S df of the centre of pressure (Hz).

    It is NaN of who falls, where nothing sways, and too near to falling to say.
    """
    return frequency_of(asked.variances[COP], asked.variances[COP_TIMES_OMEGA])


def frequency_of(size: np.ndarray, times_omega: np.ndarray) -> np.ndarray:
    """Return :func:`mean_frequency` of variances of the CoP, and of the same times ω."""
    sways = np.isfinite(size) & (size > 0.0)
    found: np.ndarray = np.where(sways, times_omega, np.nan)
    frequency: np.ndarray = found / (TURN * np.where(sways, size, 1.0))
    return frequency
