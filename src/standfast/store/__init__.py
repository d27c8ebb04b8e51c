"""Atlas files: layout, shards, finishing, reading. Plain HDF5 that opens anywhere."""

from standfast.store.atlas import Atlas, Variable, open_atlas
from standfast.store.workplace import Workplace

__all__ = ["Atlas", "Variable", "Workplace", "open_atlas"]
