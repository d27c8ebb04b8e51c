"""Opening a finished atlas: that it is one, whole, and as its study says."""

from pathlib import Path

from standfast.atlas.checking import checked_dataset, opened
from standfast.atlas.layout import FORMAT, FORMAT_VERSION, get_text
from standfast.atlas.reader import Atlas
from standfast.errors import InputError
from standfast.files import checked_path
from standfast.study.study import Study


def open_atlas(path: str | Path) -> Atlas:
    """Open a finished atlas and check that it is one.

    Raises
    ------
    InputError
        if there is no such file, or it is not HDF5, not an atlas, of another format version, or
        does not hold what its study says.

    Examples
    --------
    >>> import standfast as sf
    >>> study = {
    ...     "body": {"height": [1.6, 1.7], "bmi": 24},
    ...     "stiffness": {"ankle": 900, "knee": 1500, "hip": 400},
    ...     "output": {"quantities": ["safety_factor"]},
    ... }
    >>> atlas = sf.sweep(study, "heights.h5")
    >>> sf.open_atlas("heights.h5")["safety_factor"][:].round(3)
    array([1.205, 1.005])
    """
    path = checked_path("path", path)
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
                shape, chunks = group.shape, group.chunk_shape if group.axes else None
                dataset = checked_dataset(path, file, quantity, shape, group.dtype)
                if dataset.chunks != chunks:
                    raise InputError(f"{path}: the dataset {quantity!r} is not as its study says")
        return Atlas(path, study, get_text(file, "standfast_version") or "unknown")
