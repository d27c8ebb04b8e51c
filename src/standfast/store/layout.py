"""What is inside an atlas file: datasets, axes, attributes, filters.

One dataset a quantity on exactly the axes that it depends on, each axis a dimension scale, each
parameter with one value a scalar; units and meanings as attributes after the CF conventions. Only
the filters built into HDF5 are used (shuffle and deflate). No clock, host or thread count enters,
so the same study always gives the same bytes.
"""

import struct
from collections.abc import Iterator
from typing import Any

import h5py
import numpy as np
from isal import isal_zlib

from standfast.quantities import PARAMETERS, QUANTITIES
from standfast.study import Group, Study

FORMAT = "standfast atlas"
FORMAT_VERSION = 1

# The oldest layout whose metadata carry checksums; HDF5 1.8 (2008) and all since read it.
LIBRARIES = ("v108", "latest")

# Level 1 of isal is the fastest that still shrinks; its stream is plain deflate.
DEFLATE_LEVEL = 1


def write_layout(file: h5py.File, study: Study, version: str) -> None:
    """Create all datasets, without their chunks, and all attributes of a study's atlas."""
    say(file, "Conventions", "CF-1.11")
    say(file, "title", study.title)
    say(file, "format", FORMAT)
    file.attrs["format_version"] = np.int32(FORMAT_VERSION)
    say(file, "standfast_version", version)
    say(file, "study", study.canonical)
    say(file, "study_sha256", study.fingerprint)
    for name, values in study.axes.items():
        scale = _parameter(file, name, values)
        scale.make_scale(name)
    for name, value in study.fixed.items():
        _parameter(file, name, np.asarray(value))
    for group in study.groups:
        for quantity in group.quantities:
            _quantity(file, study, group, quantity)


def say(place: h5py.HLObject, name: str, text: str) -> None:
    """Write a text attribute of fixed length: it lies in the object's header, under its checksum.

    Text of variable length lies in a heap without one, whose damage can hang HDF5.
    """
    encoded = text.encode()
    place.attrs.create(name, encoded, dtype=h5py.string_dtype("utf-8", max(len(encoded), 1)))


def said(place: h5py.HLObject, name: str) -> str | None:
    """Return a text attribute of :func:`say`, None if it is absent or of any other kind."""
    if name not in place.attrs or place.attrs.get_id(name).dtype.kind != "S":
        return None
    try:
        return bytes(place.attrs[name]).decode()
    except UnicodeDecodeError:
        return None


def compressed(values: np.ndarray) -> bytes:
    """Return a chunk as HDF5 stores it: shuffled if its items have several bytes, deflated."""
    if values.strides and not any(values.strides):
        return _constant(values.dtype.str, values.flat[0].item(), values.size)
    return _deflated(values)


def inflated(raw: bytes, dtype: np.dtype[Any], shape: tuple[int, ...]) -> np.ndarray:
    """Return the chunk behind :func:`compressed`."""
    flat = np.frombuffer(isal_zlib.decompress(raw), np.uint8)
    if dtype.itemsize > 1:
        flat = np.ascontiguousarray(flat.reshape(dtype.itemsize, -1).T)
    return flat.reshape(-1).view(dtype).reshape(shape)


def constant_in(raw: bytes, dtype: np.dtype[Any], size: int) -> np.uint8 | None:
    """Return the one verdict that fills a chunk, known by its compressed bytes; else None."""
    if dtype != np.uint8:
        return None
    for value in (0, 1):
        if raw == _constant(dtype.str, value, size):
            return np.uint8(value)
    return None


_constants: dict[tuple[str, Any, int], bytes] = {}


def _constant(dtype: str, value: Any, size: int) -> bytes:
    """Deflate a chunk of one repeated value once; most chunks of verdicts are of this kind."""
    key = (dtype, value, size)
    if key not in _constants:
        _constants[key] = _deflated(np.full(size, value, dtype))
    return _constants[key]


def _deflated(values: np.ndarray) -> bytes:
    """Deflate a chunk, shuffled if its items have several bytes.

    The lowest bytes of floating-point numbers are noise that does not shrink; after the shuffle
    they come first, and are stored as they are, which deflate allows and is several times faster.
    """
    size = values.dtype.itemsize
    if size == 1:
        packed: bytes = isal_zlib.compress(np.ascontiguousarray(values), DEFLATE_LEVEL)
        return packed
    as_bytes = values[..., None].view(np.uint8)
    planes = np.ascontiguousarray(np.moveaxis(as_bytes, -1, 0)).reshape(size, -1)
    noise = _planes_of_noise(planes)
    deflate = isal_zlib.compressobj(DEFLATE_LEVEL, wbits=-15)
    rest = deflate.compress(planes[noise:]) + deflate.flush()
    checksum = struct.pack(">I", isal_zlib.adler32(planes))
    return b"".join([ZLIB_HEADER, *_stored(planes[:noise]), rest, checksum])


# A zlib stream with the default window, written by the fastest method.
ZLIB_HEADER = b"\x78\x01"
LONGEST_STORED = 2**16 - 1

# A plane of bytes is worth deflating if its middle shrinks by a twentieth.
SAMPLE_BYTES, WORTH = 2**13, 0.95


def _planes_of_noise(planes: np.ndarray) -> int:
    """Return how many of the lowest planes of bytes do not shrink; the lower the less they do."""
    if _shrinks(planes[0]):  # rounded numbers, or few different ones
        return 0
    noise = len(planes) - 1
    while _shrinks(planes[noise - 1]):
        noise -= 1
    return noise


def _shrinks(plane: np.ndarray) -> bool:
    middle = max(plane.size - SAMPLE_BYTES, 0) // 2
    sample = plane[middle : middle + SAMPLE_BYTES]
    return len(isal_zlib.compress(sample, DEFLATE_LEVEL)) < WORTH * sample.size


def _stored(planes: np.ndarray) -> Iterator[bytes | memoryview]:
    """Give bytes as deflate blocks that are stored, none of them the last of the stream."""
    flat = planes.reshape(-1)
    for start in range(0, flat.size, LONGEST_STORED):
        block = flat[start : start + LONGEST_STORED]
        yield struct.pack("<BHH", 0, block.size, block.size ^ LONGEST_STORED)
        yield block.data


def _parameter(file: h5py.File, name: str, values: np.ndarray) -> h5py.Dataset:
    if name == "body_model":
        dataset = file.create_dataset(name, data=values.astype(object), dtype=h5py.string_dtype())
        say(dataset, "long_name", "table of segment parameters")
        return dataset
    row = PARAMETERS[name]
    dataset = file.create_dataset(name, data=values.astype(np.float64))
    say(dataset, "units", row.unit)
    say(dataset, "long_name", row.meaning)
    return dataset


def _quantity(file: h5py.File, study: Study, group: Group, quantity: str) -> None:
    row = QUANTITIES[quantity]
    storage: dict[str, Any] = {}
    if group.axes:
        storage = {
            "chunks": group.chunk_shape,
            "compression": "gzip",
            "compression_opts": DEFLATE_LEVEL,
            "shuffle": np.dtype(row.dtype).itemsize > 1,
        }
    dataset = file.create_dataset(quantity, group.shape, row.dtype, **storage)
    say(dataset, "units", row.unit)
    say(dataset, "long_name", row.meaning)
    if study.fixed:
        say(dataset, "coordinates", " ".join(study.fixed))
    if quantity == "stable":
        dataset.attrs["flag_values"] = np.array([0, 1], np.uint8)
        say(dataset, "flag_meanings", "unstable stable")
    for number, axis in enumerate(group.axes):
        dataset.dims[number].attach_scale(file[axis])
