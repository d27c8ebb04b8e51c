"""How much single persons sway, as columns of their table."""

import math
from collections.abc import Mapping, Sequence

import numpy as np

from standfast.parameters import NOISES
from standfast.population.cohort.nerves import FedBackPersons
from standfast.population.cohort.sway import swayed
from standfast.population.people.keys import SWAY
from standfast.quantities import QUANTITIES

# How the names of columns say units.
UNITS = {
    "N·m/rad": "Nm_rad", "N·m·s/rad": "Nms_rad", "s": "s", "N·m·√s": "Nm_sqrt_s", "m/s": "m_s",
}  # fmt: skip


def columns_of_sway(
    pieces: Sequence[FedBackPersons], known: np.ndarray, there: Mapping[str, np.ndarray]
) -> dict[str, np.ndarray]:
    """Return how much persons sway whose noise is known too; nothing where nobody's is asked."""
    noisy = np.array([each for name, each in there.items() if name in NOISES])
    if not noisy.size:
        return {}
    found = [swayed(each.numbers, each.stands, SWAY) for each in pieces]
    sure = np.concatenate([each for _, each in found]) & known & noisy.all(axis=0)
    return {
        f"{name}_{UNITS.get(QUANTITIES[name].unit, QUANTITIES[name].unit)}": np.where(
            sure, np.concatenate([values[name] for values, _ in found]), math.nan
        )
        for name in SWAY
    }
