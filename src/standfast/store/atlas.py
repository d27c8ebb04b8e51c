"""Reading a finished atlas: by name, lazily, in threads, and without trusting the file."""

import math
import os
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cached_property
from itertools import product
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from standfast.quantities import QUANTITIES, InputError, Quantity, nearest_name
from standfast.store.layout import FORMAT, FORMAT_VERSION, constant_in, inflated, said
from standfast.study import Group, Study

HDF5_SIGNATURE = b"\x89HDF\r\n\x1a\n"
SLAB_BYTES = 2**28
BUILT_IN_FILTERS = {h5py.h5z.FILTER_DEFLATE, h5py.h5z.FILTER_SHUFFLE}


@dataclass(frozen=True)
class Atlas:
    """A finished atlas; made by :func:`open_atlas`. Nothing is read before it is asked for."""

    path: Path
    study: Study
    version: str

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
            raise InputError(
                f"{self.path} has no {quantity!r}{nearest_name(quantity, self.quantities)} "
                f"(inside: {', '.join(self.quantities)})"
            )
        group = next(g for g in self.study.groups if quantity in g.quantities)
        return Variable(self.path, QUANTITIES[quantity], group)

    def to_xarray(self) -> Any:
        """Return the atlas as a lazy ``xarray.Dataset`` (needs the extra ``standfast[xarray]``).

        Raises
        ------
        InputError
            if xarray or h5netcdf is not installed.
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

    path: Path
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

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> np.ndarray:
        del copy  # what is read from a file is always new
        return np.asarray(self[...], dtype)

    def __getitem__(self, index: Any) -> np.ndarray:
        """Read a piece: integers and slices are read chunk by chunk in threads."""
        box = _box(index, self.shape)
        with opened(self.path) as file:
            dataset = file[self.quantity.name]
            if not self.group.axes or box is None:
                return _read_as_h5py_does(dataset, index)
            values = _read_box(dataset, self.group, self.dtype, box)
        piece: np.ndarray = values[_within(index, len(self.shape))]
        return piece

    def slabs(self, *, along: tuple[str, ...]) -> Iterator[tuple[dict[str, int], np.ndarray]]:
        """Go through the grid plane by plane: all of the axes ``along``, one place of the others.

        Yields the index of each other axis by name, and the plane with its axes in study order.
        Planes are read as many at a time as share their chunks, within ``SLAB_BYTES``.
        """
        others = [number for number, axis in enumerate(self.dims) if axis not in along]
        sides = [self.group.chunk_shape[number] for number in others]
        plane = self.dtype.itemsize * math.prod(
            length for axis, length in zip(self.dims, self.shape, strict=True) if axis in along
        )
        while sides and max(sides) > 1 and plane * math.prod(sides) > SLAB_BYTES:
            longest = sides.index(max(sides))
            sides[longest] = -(-sides[longest] // 2)
        starts = (range(0, self.shape[n], side) for n, side in zip(others, sides, strict=True))
        for corner in product(*starts):
            box: list[slice] = [slice(None)] * len(self.dims)
            for number, first, side in zip(others, corner, sides, strict=True):
                box[number] = slice(first, first + side)
            slab = self[tuple(box)]
            for within in product(*(range(slab.shape[number]) for number in others)):
                at: list[Any] = [slice(None)] * len(self.dims)
                for number, place in zip(others, within, strict=True):
                    at[number] = place
                places = zip(others, corner, within, strict=True)
                yield {self.dims[n]: low + place for n, low, place in places}, slab[tuple(at)]


def open_atlas(path: str | Path) -> Atlas:
    """Open a finished atlas and check that it is one.

    Raises
    ------
    InputError
        if there is no such file, or it is not HDF5, not an atlas, of another format version, or
        does not hold what its study says.
    """
    path = Path(path)
    try:
        with path.open("rb") as raw:
            signature = raw.read(len(HDF5_SIGNATURE))
    except FileNotFoundError:
        parts = path.with_name(path.name + ".parts")
        hint = (
            ", only the beginnings of it: run the same command again to finish"
            if parts.is_dir()
            else ""
        )
        raise InputError(f"{path}: there is no such file{hint}") from None
    except OSError as error:
        raise InputError(f"{path} cannot be read: {error.strerror}") from None
    if signature != HDF5_SIGNATURE:
        hint = "; it looks like a study, sweep it first" if path.suffix == ".toml" else ""
        raise InputError(f"{path} is not an HDF5 file{hint}")
    with opened(path) as file:
        if said(file, "format") != FORMAT:
            kind = said(file, "format") or ""
            hint = ": it is a population, see standfast info" if "population" in kind else ""
            raise InputError(f"{path} is HDF5, but not an atlas of standfast{hint}")
        number = file.attrs.get("format_version")
        if number != FORMAT_VERSION:
            raise InputError(
                f"{path} has format version {number}; this standfast reads {FORMAT_VERSION}"
            )
        text = said(file, "study")
        if text is None:
            raise InputError(f"{path}: the study inside the file cannot be read")
        try:
            study = Study.from_canonical(text)
        except InputError as error:
            raise InputError(f"{path}: {error}") from None
        if said(file, "study_sha256") != study.fingerprint:
            raise InputError(f"{path}: the study inside does not match its fingerprint")
        for group in study.groups:
            for quantity in group.quantities:
                _check_dataset(path, file, group, quantity)
        return Atlas(path, study, said(file, "standfast_version") or "unknown")


@contextmanager
def opened(path: Path) -> Iterator[h5py.File]:
    """Open for reading and turn what HDF5 says of a broken file into one sentence."""
    try:
        with h5py.File(path, "r") as file:
            yield file
    except (InputError, IndexError):
        raise
    except Exception as error:  # HDF5 reports damage by almost any exception
        reason = str(error).splitlines()[0] if str(error) else type(error).__name__
        raise InputError(f"{path} is damaged or cut short ({reason})") from None


def _check_dataset(path: Path, file: h5py.File, group: Group, name: str) -> None:
    """Refuse a dataset that is not as written: link, shape, type, storage, filters, chunks."""
    link = file.get(name, getlink=True)
    if not isinstance(link, h5py.HardLink) or not isinstance(file[name], h5py.Dataset):
        raise InputError(f"{path} lacks the dataset {name!r} that its study promises")
    dataset = file[name]
    settings = dataset.id.get_create_plist()
    filters = {settings.get_filter(number)[0] for number in range(settings.get_nfilters())}
    sound = (
        dataset.shape == group.shape
        and dataset.dtype == np.dtype(QUANTITIES[name].dtype)
        and dataset.chunks == (group.chunk_shape if group.axes else None)
        and not dataset.is_virtual
        and dataset.external is None
        and filters <= BUILT_IN_FILTERS
    )
    if not sound:
        raise InputError(f"{path}: the dataset {name!r} is not as its study says")
    if group.axes and dataset.id.get_num_chunks() != math.prod(group.chunks):
        raise InputError(f"{path}: chunks of {name!r} are missing")


def _read_as_h5py_does(dataset: h5py.Dataset, index: Any) -> np.ndarray:
    """Read by an index that is not made of integers and rising slices."""
    try:
        return np.asarray(dataset[index])
    except (TypeError, ValueError) as error:
        raise IndexError(str(error)) from None


def _box(index: Any, shape: tuple[int, ...]) -> tuple[slice, ...] | None:
    """Return the range of every axis that an index touches; None if it is not such an index."""
    items = _items(index, len(shape))
    if items is None:
        return None
    box = []
    for item, length in zip(items, shape, strict=True):
        if isinstance(item, slice):
            steps = range(*item.indices(length))
            ends = (min(steps, default=0), max(steps, default=-1))
            box.append(slice(ends[0], ends[1] + 1))
        else:
            at = item + length if item < 0 else item
            if not 0 <= at < length:
                raise IndexError(f"index {item} is outside an axis of length {length}")
            box.append(slice(at, at + 1))
    return tuple(box)


def _within(index: Any, count: int) -> tuple[Any, ...]:
    """Return the index that picks, inside its box, what the whole index asked for."""
    return tuple(
        slice(None, None, item.step) if isinstance(item, slice) else 0
        for item in _items(index, count) or ()
    )


def _items(index: Any, count: int) -> tuple[Any, ...] | None:
    """Return one slice or integer for every axis; None for any other kind of index."""
    items = index if isinstance(index, tuple) else (index,)
    if sum(item is Ellipsis for item in items) > 1:
        return None
    at = next((n for n, item in enumerate(items) if item is Ellipsis), None)
    if at is not None:
        items = items[:at] + (slice(None),) * (count - len(items) + 1) + items[at + 1 :]
    items = items + (slice(None),) * (count - len(items))
    plain = all(
        isinstance(item, slice | int | np.integer) and not isinstance(item, bool) for item in items
    )
    return items if plain and len(items) == count else None


def _read_box(
    dataset: h5py.Dataset, group: Group, dtype: np.dtype[Any], box: tuple[slice, ...]
) -> np.ndarray:
    """Read a box: raw chunks one after the other, inflated in threads."""
    # zeroed memory is not touched before something else is written to it
    values = np.zeros([part.stop - part.start for part in box], dtype)
    sides = group.chunk_shape

    def place(start: tuple[int, ...], raw: bytes) -> None:
        alike = constant_in(raw, dtype, math.prod(sides))
        if alike == 0:
            return
        chunk = inflated(raw, dtype, sides) if alike is None else np.broadcast_to(alike, sides)
        source, target = [], []
        for first, side, part in zip(start, sides, box, strict=True):
            low, high = max(first, part.start), min(first + side, part.stop)
            source.append(slice(low - first, high - first))
            target.append(slice(low - part.start, high - part.start))
        values[tuple(target)] = chunk[tuple(source)]

    touched = (
        range(part.start // side, -(-part.stop // side))
        for part, side in zip(box, sides, strict=True)
    )
    workers = os.cpu_count() or 1
    with ThreadPoolExecutor(workers) as pool:
        waiting = []
        for chunk in product(*touched):
            start = tuple(i * side for i, side in zip(chunk, sides, strict=True))
            waiting.append(pool.submit(place, start, dataset.id.read_direct_chunk(start)[1]))
            if len(waiting) > 4 * workers:
                waiting.pop(0).result()
        for job in waiting:
            job.result()
    return values
