"""A study: what is fixed, what varies, what is wanted, and how the grid is cut."""

from standfast.study.plan import CHUNK_BYTES, JOINTS, Group, Study, Tile, chunk_shape
from standfast.study.values import axis_values, describe

__all__ = [
    "CHUNK_BYTES",
    "JOINTS",
    "Group",
    "Study",
    "Tile",
    "axis_values",
    "chunk_shape",
    "describe",
]
