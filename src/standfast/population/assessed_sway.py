"""How much single persons sway, as columns of their table."""

import math
from collections.abc import Mapping, Sequence

import numpy as np

from standfast.files import column_name
from standfast.parameters import NOISES
from standfast.population.cohort.nerves import FedBackPersons
from standfast.population.cohort.sway import swayed
from standfast.population.people.keys import SWAY
from standfast.quantities import QUANTITIES


def columns_of_sway(
    pieces: Sequence[FedBackPersons], known: np.ndarray, there: Mapping[str, np.ndarray]
) -> dict[str, np.ndarray]:
    """Return how much persons sway whose noise is known too; nothing where nobody's is asked."""
    noisy = np.array([each for name, each in there.items() if name in NOISES])
    if not noisy.size:
        return {}
    found = [swayed(each, SWAY) for each in pieces]
    told = known & noisy.all(axis=0)
    return {
        column_name(name, QUANTITIES[name].unit): np.where(
            told, np.concatenate([values[name] for values, _ in found]), math.nan
        )
        for name in SWAY
    }
