"""Atlases: computed by :mod:`.sweeping` (or :mod:`.memory`), read here without JAX."""

from standfast.atlas.opening import open_atlas
from standfast.atlas.reader import Atlas, Variable

__all__ = ["Atlas", "Variable", "open_atlas"]
