"""Reading a finished atlas: by name, lazily, in threads, and without trusting the file."""

import math
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import cached_property
from itertools import product
from pathlib import Path
from typing import Any, Self

import h5py
import numpy as np

from standfast.atlas.checking import hdf5_file, one_sentence, opened, read_box
from standfast.atlas.indexing import box_of, listed_axis, within_box
from standfast.errors import InputError, UnknownNameError, nearest_name
from standfast.quantities import QUANTITIES, Quantity
from standfast.study.grid import Group
from standfast.study.study import Study

PLANE_BYTES = 2**28


class Atlas(Mapping[str, "Variable"]):
    """A finished atlas: its quantities by name; made by :func:`open_atlas`.

    Nothing is read before it is asked for. ``with open_atlas(…) as atlas:`` keeps the file open
    meanwhile; else it is opened for every reading.

    Attributes
    ----------
    path, study, version
        the file, what it was computed from, and by which standfast.

    Examples
    --------
    >>> import standfast as sf
    >>> study = {
    ...     "body": {"height": 1.66, "mass": 68},
    ...     "stiffness": {"ankle": [800, 900], "knee": 1500, "hip": [300, 400, 500]},
    ...     "output": {"quantities": ["stable", "safety_factor"]},
    ... }
    >>> with sf.sweep(study, "example.h5") as atlas:
    ...     print(atlas.quantities, list(atlas.axes))
    ...     print(atlas["stable"].dims, atlas["stable"][1])
    ('stable', 'safety_factor') ['ankle_stiffness', 'hip_stiffness']
    ('ankle_stiffness', 'hip_stiffness') [0 1 1]
    """

    def __init__(self, path: Path, study: Study, version: str) -> None:
        self.path, self.study, self.version = path, study, version
        self._open: h5py.File | None = None

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Atlas) and self._identity == other._identity

    def __hash__(self) -> int:
        return hash(self._identity)

    @property
    def _identity(self) -> tuple[Path, str, str]:
        return self.path, self.study.fingerprint, self.version

    def __repr__(self) -> str:
        return f"<Atlas {self.path}: {', '.join(self.quantities)}>"

    @property
    def quantities(self) -> tuple[str, ...]:
        """Names of the quantities inside."""
        return self.study.quantities

    @property
    def axes(self) -> dict[str, np.ndarray]:
        """Names and values of the axes, in the study's order."""
        return self.study.axes

    def __getitem__(self, quantity: str) -> "Variable":
        if quantity not in self.study.quantities:
            raise UnknownNameError(
                f"{self.path} has no {quantity!r}{nearest_name(quantity, self.quantities)} "
                f"(inside: {', '.join(self.quantities)})"
            )
        group = next(g for g in self.study.grid.groups if quantity in g.quantities)
        return Variable(self, QUANTITIES[quantity], group)

    def __iter__(self) -> Iterator[str]:
        return iter(self.study.quantities)

    def __len__(self) -> int:
        return len(self.study.quantities)

    def __enter__(self) -> Self:
        self._open = hdf5_file(self.path)
        return self

    def __exit__(self, *error: object) -> None:
        if self._open is not None:
            self._open.close()
            self._open = None

    @contextmanager
    def file(self) -> Iterator[h5py.File]:
        """Give the open file; say in one sentence if it is broken.

        Examples
        --------
        >>> import standfast as sf
        >>> study = {
        ...     "body": {"height": 1.66, "mass": 68},
        ...     "stiffness": {"ankle": [800, 900], "knee": 1500, "hip": [300, 400, 500]},
        ...     "output": {"quantities": ["stable", "safety_factor"]},
        ... }
        >>> atlas = sf.sweep(study, "example.h5")
        >>> with atlas.file() as file:
        ...     print(file["safety_factor"].attrs["long_name"])
        b'safety factor'
        """
        if self._open is not None:
            with one_sentence(self.path):
                yield self._open
        else:
            with opened(self.path) as file:
                yield file

    def to_xarray(self) -> Any:
        """Return the atlas as a lazy ``xarray.Dataset`` (needs the extra ``standfast[xarray]``).

        Raises
        ------
        InputError
            if xarray or h5netcdf is not installed.

        Examples
        --------
        >>> import standfast as sf
        >>> study = {
        ...     "body": {"height": 1.66, "mass": 68},
        ...     "stiffness": {"ankle": [800, 900], "knee": 1500, "hip": [300, 400, 500]},
        ...     "output": {"quantities": ["stable", "safety_factor"]},
        ... }
        >>> ds = sf.sweep(study, "example.h5").to_xarray()
        >>> ds.stable.sel(ankle_stiffness=900).values
        array([0, 1, 1], dtype=uint8)
        """
        try:
            import h5netcdf  # noqa: F401, PLC0415 - an extra, which xarray reads with
            import xarray  # noqa: PLC0415 - an extra
        except ImportError as error:
            raise InputError(
                f"to_xarray needs {error.name}: pip install 'standfast[xarray]'"
            ) from None
        return xarray.open_dataset(self.path, engine="h5netcdf")


@dataclass(frozen=True)
class Variable:
    """One quantity of an atlas: ``variable[index]`` reads a piece, ``numpy.asarray`` all of it."""

    atlas: Atlas = field(repr=False)
    quantity: Quantity
    group: Group

    @property
    def dims(self) -> tuple[str, ...]:
        """Names of the axes."""
        return self.group.axes

    @property
    def shape(self) -> tuple[int, ...]:
        """Lengths of the axes."""
        return self.group.shape

    @cached_property
    def dtype(self) -> np.dtype[Any]:
        """Type of the values."""
        return np.dtype(self.quantity.dtype)

    @property
    def units(self) -> str:
        """Unit of the values."""
        return self.quantity.unit

    def __repr__(self) -> str:
        axes = ", ".join(f"{a} {n}" for a, n in zip(self.dims, self.shape, strict=True))
        return f"<Variable {self.quantity.name} ({axes}) in {self.units}: {self.atlas.path}>"

    def __len__(self) -> int:
        if not self.shape:
            raise TypeError(f"{self.quantity.name} is one number, without a length")
        return self.shape[0]

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> np.ndarray:
        del copy  # what is read from a file is always new
        return np.asarray(self[...], dtype)

    def __getitem__(self, index: Any) -> np.ndarray:
        """Read a piece: integers and slices are read chunk by chunk in threads."""
        if not self.group.axes:
            with self.atlas.file() as file:
                value = np.asarray(file[self.quantity.name][()])
            return np.asarray(value[index])
        box = box_of(index, self.shape)
        if box is None:
            return self._listed(index)
        with self.atlas.file() as file:
            values = read_box(file[self.quantity.name], box)
        piece: np.ndarray = values[within_box(index, len(self.shape))]
        return piece

    def _listed(self, index: Any) -> np.ndarray:
        """Read by an index with a list in it, the rows of a chunk together; or by a mask of all."""
        if isinstance(index, np.ndarray) and index.shape == self.shape and index.dtype == bool:
            masked: np.ndarray = np.asarray(self)[index]
            return masked
        items, axis = listed_axis(index, len(self.shape))
        listed = np.asarray(items[axis])
        rows = np.arange(self.shape[axis])[listed if listed.size else listed.astype(int)]
        unique, places = np.unique(rows, return_inverse=True)
        kept = sum(isinstance(item, slice) for item in items[:axis])
        pieces = []
        for run in np.split(
            unique, np.flatnonzero(np.diff(unique // self.group.chunk_shape[axis])) + 1
        ):
            low, high = (run[0], run[-1] + 1) if run.size else (0, 0)
            items[axis] = slice(low, high)
            pieces.append(self[tuple(items)].take(run - low, kept))
        return np.concatenate(pieces, kept).take(places, kept)

    def planes(self, *, along: tuple[str, ...]) -> Iterator[tuple[dict[str, int], np.ndarray]]:
        """Go through the grid plane by plane: all of the axes ``along``, one place of the others.

        Yields the index of each other axis by name, and the plane with its axes in study order.
        Planes are read as many at a time as share their chunks, within ``PLANE_BYTES``.
        """
        others = [number for number, axis in enumerate(self.dims) if axis not in along]
        sides = [self.group.chunk_shape[number] for number in others]
        plane = self.dtype.itemsize * math.prod(
            length for axis, length in zip(self.dims, self.shape, strict=True) if axis in along
        )
        while sides and max(sides) > 1 and plane * math.prod(sides) > PLANE_BYTES:
            longest = sides.index(max(sides))
            sides[longest] = -(-sides[longest] // 2)
        starts = (range(0, self.shape[n], side) for n, side in zip(others, sides, strict=True))
        for corner in product(*starts):
            box: list[slice] = [slice(None)] * len(self.dims)
            for number, first, side in zip(others, corner, sides, strict=True):
                box[number] = slice(first, first + side)
            values = self[tuple(box)]
            for within in product(*(range(values.shape[number]) for number in others)):
                at: list[Any] = [slice(None)] * len(self.dims)
                for number, index in zip(others, within, strict=True):
                    at[number] = index
                where = zip(others, corner, within, strict=True)
                yield {self.dims[n]: low + index for n, low, index in where}, values[tuple(at)]
