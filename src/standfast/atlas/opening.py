"""Opening a finished atlas: that it is one, whole, and as its study says."""

import math
from pathlib import Path

import h5py
import numpy as np

from standfast.atlas.layout import FORMAT, FORMAT_VERSION, get_text
from standfast.atlas.reader import Atlas, opened
from standfast.errors import InputError
from standfast.quantities import QUANTITIES
from standfast.study.grid import Group
from standfast.study.study import Study

HDF5_SIGNATURE = b"\x89HDF\r\n\x1a\n"
BUILT_IN_FILTERS = {h5py.h5z.FILTER_DEFLATE, h5py.h5z.FILTER_SHUFFLE}


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
        if get_text(file, "format") != FORMAT:
            kind = get_text(file, "format") or ""
            hint = ": it is a population, see standfast info" if "population" in kind else ""
            raise InputError(f"{path} is HDF5, but not an atlas of standfast{hint}")
        number = file.attrs.get("format_version")
        if number != FORMAT_VERSION:
            raise InputError(
                f"{path} has format version {number}; this standfast reads {FORMAT_VERSION}"
            )
        text = get_text(file, "study")
        if text is None:
            raise InputError(f"{path}: the study inside the file cannot be read")
        try:
            study = Study.from_canonical(text)
        except InputError as error:
            raise InputError(f"{path}: {error}") from None
        if get_text(file, "study_sha256") != study.fingerprint:
            raise InputError(f"{path}: the study inside does not match its fingerprint")
        for group in study.grid.groups:
            for quantity in group.quantities:
                _check_dataset(path, file, group, quantity)
        return Atlas(path, study, get_text(file, "standfast_version") or "unknown")


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
