"""From a tile of a study to arrays: the only place with ``jit`` and ``vmap``."""

from standfast.engine.grid import Evaluator
from standfast.engine.mapping import map_over_batch
from standfast.engine.memory import keep_freed_memory

__all__ = ["Evaluator", "keep_freed_memory", "map_over_batch"]
