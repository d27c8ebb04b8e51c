"""Files: written through shards that survive a kill, finished whole, read lazily."""

from standfast.store.assembly import assemble
from standfast.store.atlas import Atlas, Variable, open_atlas
from standfast.store.chunks import into_shard, out_of_shard
from standfast.store.workplace import Workplace, beginnings, tidy_up_after

__all__ = [
    "Atlas",
    "Variable",
    "Workplace",
    "assemble",
    "beginnings",
    "into_shard",
    "open_atlas",
    "out_of_shard",
    "tidy_up_after",
]
