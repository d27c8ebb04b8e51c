"""Reading the file of a population: its summary in one dictionary, its arrays by name."""

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from standfast.atlas.checking import checked_dataset, opened, read_box
from standfast.atlas.layout import get_text
from standfast.errors import InputError
from standfast.population.people.study import PopulationStudy
from standfast.population.summary.answers import answers_of, fits
from standfast.population.summary.arrays import GROWTH, Layout, arrays_of, layout_of

FORMAT = "standfast population"
# Of springs alone, and with feedback and with noise, whose files hold other arrays.
FORMAT_VERSION, FED_BACK_VERSION, SWAY_VERSION = 3, 4, 5
ROUNDING = 1e-9  # by which a share may pass 0 or 1


@dataclass(frozen=True)
class Population:
    """A simulated population; made by :func:`.open_population`."""

    path: Path
    study: PopulationStudy
    version: str
    summary: dict[str, Any]  # all answers, as ``standfast population --json`` prints them

    def array(self, name: str) -> np.ndarray:
        """Read an array of the file by its name.

        Examples
        --------
        >>> import standfast as sf
        >>> sf.open_population("people.h5").array("risk").shape
        (40, 120)
        """
        with opened(self.path) as file:
            if name not in file:
                raise InputError(f"{self.path} has no {name!r} (inside: {', '.join(file)})")
            known = arrays_of(self.study)
            if name not in known:
                raise InputError(f"{self.path}: {name!r} is no array that its study promises")
            dataset = checked_dataset(self.path, file, name, *known[name])
            if dataset.chunks:
                return read_box(dataset, tuple(slice(0, length) for length in dataset.shape))
            return np.asarray(dataset[()])


def is_population(path: Path) -> bool:
    """Return whether a file says that it is a population; what is wrong with it is not asked."""
    try:
        with opened(path) as file:
            return get_text(file, "format") == FORMAT
    except InputError:
        return False


def open_population(path: str | Path) -> Population:
    """Open the file of a simulated population.

    Parameters
    ----------
    path
        a finished file of :func:`.simulate` or ``standfast population``.

    Returns
    -------
    Population: ``summary`` with all answers as ``standfast population --json`` prints them (shares
    of 1, N·m/rad, s), ``array(name)`` for what figures are made of, ``study``.

    Raises
    ------
    InputError
        if it is none, damaged, of another format version, or not as its study says.

    Examples
    --------
    >>> import standfast as sf
    >>> found = sf.open_population("people.h5")
    >>> low, high = found.summary["unstable_fraction_interval"]
    >>> low < found.summary["unstable_fraction"] < high
    True
    """
    path = Path(path)
    with opened(path) as file:
        if get_text(file, "format") != FORMAT:
            raise InputError(f"{path} is HDF5, but not a population of standfast")
        number = file.attrs.get("format_version")
        if number not in (FORMAT_VERSION, FED_BACK_VERSION, SWAY_VERSION):
            raise InputError(
                f"{path} has format version {number}; "
                f"this standfast reads {FORMAT_VERSION}, {FED_BACK_VERSION} and {SWAY_VERSION}"
            )
        try:
            study = PopulationStudy.from_canonical(get_text(file, "study") or "")
        except InputError as error:
            raise InputError(f"{path}: {error}") from None
        if get_text(file, "study_sha256") != study.fingerprint:
            raise InputError(f"{path}: the study inside does not match its fingerprint")
        if number != version_of(study):
            raise InputError(f"{path}: the study inside is of another format version")
        layout = layout_of(study)
        for name, known in arrays_of(study).items():
            if name != GROWTH or name in file:
                dataset = checked_dataset(path, file, name, *known)
                if name in layout.arrays:
                    _check_values(path, layout, name, dataset[()])
        summary = _summary(path, study, bytes(file["summary"][()]))
        version = get_text(file, "standfast_version") or "unknown"
    return Population(path, study, version, summary)


def version_of(study: PopulationStudy) -> int:
    """Return the format version of a study's file."""
    if study.sway:
        return SWAY_VERSION
    return FED_BACK_VERSION if study.is_fed_back else FORMAT_VERSION


def _check_values(path: Path, layout: Layout, name: str, values: np.ndarray) -> None:
    """Refuse an axis with other values, and shares that are none."""
    axis = name in layout.axes and not np.array_equal(values, layout.axes[name])
    if axis or (name in layout.shares and ((values < -ROUNDING) | (values > 1.0 + ROUNDING)).any()):
        raise InputError(f"{path} is damaged (values of {name!r} are none that it can have)")


def _summary(path: Path, study: PopulationStudy, raw: bytes) -> dict[str, Any]:
    """Read the answers; they are written one way alone, so whatever differs is damage."""
    found: dict[str, Any] = json.loads(raw)
    if not fits(found, answers_of(study)) or json.dumps(found, ensure_ascii=False).encode() != raw:
        raise InputError(f"{path} is damaged (its answers are not as they are written)")
    return found
