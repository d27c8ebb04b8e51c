"""Atlas files: layout, shards, finishing, reading. Plain HDF5 that opens anywhere."""

from standfast.store.atlas import Atlas, Variable, open_atlas
from standfast.store.workplace import Workplace, beginnings, tidy_up_after

__all__ = ["Atlas", "Variable", "Workplace", "beginnings", "open_atlas", "tidy_up_after"]
