"""The tiles of a study: each group by its steps or as numbers."""

from collections.abc import Callable

import jax
import numpy as np

from standfast.engine.delays import Delays
from standfast.engine.mapping import Inputs
from standfast.engine.memory import keep_freed_memory
from standfast.engine.steps import Steps
from standfast.engine.values import Values
from standfast.study.grid import Group, Tile
from standfast.study.study import Study

WAYS: dict[str, Callable[[Study, Group, Inputs], Steps | Values | Delays]] = {
    "steps": Steps,
    "numbers": Values,
    "fed back": Delays,
}


class Evaluator:
    """Computes the tiles of a study: one array of the chunk's shape a quantity.

    Chunks at the far edges of the grid are computed whole, on repeated last values, so that each
    group compiles once.
    """

    def __init__(self, study: Study) -> None:
        keep_freed_memory()
        inputs = Inputs(study)
        self._groups = [WAYS[group.way](study, group, inputs) for group in study.grid.groups]

    def __call__(self, tile: Tile) -> tuple[np.ndarray, ...]:
        """Compute one tile."""
        with jax.enable_x64(True):
            return self._groups[tile.group](tile)

    def uniform(self, tile: Tile) -> np.uint8 | None:
        """Return the one value that fills a tile of verdicts, if it is known without computing."""
        group = self._groups[tile.group]
        if not isinstance(group, Steps):
            return None
        with jax.enable_x64(True):
            return group.uniform(tile)

    @property
    def resolved_exactly(self) -> int:
        """Verdicts so far that rounding could have decided, and exact arithmetic did."""
        return sum(group.resolved for group in self._groups if isinstance(group, Steps))

    @property
    def left_open(self) -> int:
        """Persons with delayed feedback so far of whom rounding left something open."""
        return sum(group.left_open for group in self._groups if isinstance(group, Delays))
