"""From a tile of a study to arrays: the only place with ``jit`` and ``vmap``.

Physics is written once, for one person; here it is mapped over the axes of a study and over the
persons of a population.
"""

import jax
import numpy as np

from standfast.engine.mapping import Inputs, over_persons
from standfast.engine.memory import keep_freed_memory
from standfast.engine.values import FUNCTIONS, Values
from standfast.engine.verdicts import Verdicts
from standfast.study import Study, Tile

__all__ = ["FUNCTIONS", "Evaluator", "over_persons"]

keep_freed_memory()


class Evaluator:
    """Computes the tiles of a study: one array of the chunk's shape a quantity.

    Chunks at the far edges of the grid are computed whole, on repeated last values, so that each
    group compiles once. A chunk of equal verdicts comes as a view of one number.
    """

    def __init__(self, study: Study) -> None:
        inputs = Inputs(study)
        self._groups = [
            (Verdicts if group.quantities == ("stable",) else Values)(study, group, inputs)
            for group in study.groups
        ]

    def __call__(self, tile: Tile) -> tuple[np.ndarray, ...]:
        """Compute one tile."""
        with jax.enable_x64(True):
            return self._groups[tile.group](tile)

    @property
    def settled(self) -> int:
        """Verdicts so far that rounding could have decided, and exact arithmetic did."""
        return sum(group.settled for group in self._groups if isinstance(group, Verdicts))
