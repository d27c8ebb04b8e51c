"""Files: written through shards that survive a kill, finished whole, read lazily."""

from standfast.store.assembly import assemble
from standfast.store.atlas import Atlas, Variable, open_atlas
from standfast.store.workplace import Workplace, beginnings, tidy_up_after

__all__ = [
    "Atlas",
    "Variable",
    "Workplace",
    "assemble",
    "beginnings",
    "open_atlas",
    "tidy_up_after",
]
