"""What is inside an atlas: datasets, axes, attributes, by name.

One dataset a quantity on exactly the axes that it depends on, each axis a dimension scale, each
parameter with one value a scalar; units and meanings as attributes after the CF conventions. Only
the filters built into HDF5 are used (shuffle and deflate). No clock, host or thread count enters,
so the same study always gives the same bytes. A dataset in memory has the same attributes.
"""

from typing import Any

import h5py
import numpy as np

from standfast.parameters import PARAMETERS
from standfast.quantities import QUANTITIES
from standfast.study.grid import Group
from standfast.study.study import Study
from standfast.version import __version__

FORMAT = "standfast atlas"
FORMAT_VERSION = 1

# The oldest layout whose metadata carry checksums; HDF5 1.8 (2008) and all since read it.
LIBRARIES = ("v108", "latest")

# Level 1 of isal is the fastest that still shrinks; its stream is plain deflate.
DEFLATE_LEVEL = 1


def file_attributes(study: Study) -> dict[str, Any]:
    """Return the attributes of a study's atlas itself."""
    return {
        "Conventions": "CF-1.11",
        "title": study.title,
        "format": FORMAT,
        "format_version": np.int32(FORMAT_VERSION),
        "standfast_version": __version__,
        "study": study.canonical,
        "study_sha256": study.fingerprint,
    }


def parameter_attributes(name: str) -> dict[str, Any]:
    """Return the attributes of an axis, or of a parameter with one value."""
    row = PARAMETERS[name]
    units = {} if row.choices else {"units": row.unit}
    return {**units, "long_name": row.words, "comment": row.meaning}


def quantity_attributes(name: str) -> dict[str, Any]:
    """Return the attributes of a quantity."""
    row = QUANTITIES[name]
    # a label of xarray has room for about 30 letters, with the unit
    attributes: dict[str, Any] = {
        "units": row.unit, "long_name": row.words, "comment": row.meaning,
    }  # fmt: skip
    if row.flags:
        attributes["flag_values"] = np.arange(len(row.flags), dtype=row.dtype)
        attributes["flag_meanings"] = " ".join(row.flags)
    return attributes


def write_layout(file: h5py.File, study: Study) -> None:
    """Create all datasets, without their chunks, and all attributes of a study's atlas."""
    set_attributes(file, file_attributes(study))
    for name, values in study.axes.items():
        _parameter(file, name, values).make_scale(name)
    for name, value in study.fixed.items():
        _parameter(file, name, np.asarray(value))
    for group in study.grid.groups:
        for quantity in group.quantities:
            _quantity(file, study, group, quantity)


def set_attributes(place: h5py.HLObject, attributes: dict[str, Any]) -> None:
    """Write attributes, texts by :func:`set_text`."""
    for name, value in attributes.items():
        if isinstance(value, str):
            set_text(place, name, value)
        else:
            place.attrs[name] = value


def set_text(place: h5py.HLObject, name: str, text: str) -> None:
    """Write a text attribute of fixed length: it lies in the object's header, under its checksum.

    Text of variable length lies in a heap without one, whose damage can hang HDF5.
    """
    encoded = text.encode()
    place.attrs.create(name, encoded, dtype=h5py.string_dtype("utf-8", max(len(encoded), 1)))


def get_text(place: h5py.HLObject, name: str) -> str | None:
    """Return a text attribute of :func:`set_text`, None if it is absent or of any other kind."""
    if name not in place.attrs or place.attrs.get_id(name).dtype.kind != "S":
        return None
    try:
        return bytes(place.attrs[name]).decode()
    except UnicodeDecodeError:
        return None


def _parameter(file: h5py.File, name: str, values: np.ndarray) -> h5py.Dataset:
    if PARAMETERS[name].choices:
        dataset = file.create_dataset(name, data=values.astype(object), dtype=h5py.string_dtype())
    else:
        dataset = file.create_dataset(name, data=values.astype(np.float64))
    set_attributes(dataset, parameter_attributes(name))
    return dataset


def _quantity(file: h5py.File, study: Study, group: Group, quantity: str) -> None:
    storage: dict[str, Any] = {}
    if group.axes:
        storage = {
            "chunks": group.chunk_shape,
            "compression": "gzip",
            "compression_opts": DEFLATE_LEVEL,
            "shuffle": group.dtype.itemsize > 1,
        }
    dataset = file.create_dataset(quantity, group.shape, group.dtype, **storage)
    fixed = {"coordinates": " ".join(study.fixed)} if study.fixed else {}
    set_attributes(dataset, {**quantity_attributes(quantity), **fixed})
    for number, axis in enumerate(group.axes):
        dataset.dims[number].attach_scale(file[axis])
