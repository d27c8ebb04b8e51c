"""A study: what is fixed, what varies, what is wanted, and how the grid is cut."""

from standfast.study.canonical import describe
from standfast.study.grid import CHUNK_BYTES, Grid, Group, Tile, chunk_shape
from standfast.study.study import Study
from standfast.study.values import axis_values

__all__ = [
    "CHUNK_BYTES",
    "Grid",
    "Group",
    "Study",
    "Tile",
    "axis_values",
    "chunk_shape",
    "describe",
]
