"""Reading the file of a population: its summary in one dictionary, its arrays by name."""

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from standfast.atlas.layout import get_text
from standfast.atlas.reader import opened
from standfast.errors import InputError
from standfast.population.people.study import PopulationStudy

FORMAT = "standfast population"
FORMAT_VERSION = 1


@dataclass(frozen=True)
class Population:
    """A simulated population; made by :func:`open_population`."""

    path: Path
    study: PopulationStudy
    version: str
    summary: dict[str, Any]  # all answers, as ``standfast population --json`` prints them

    def array(self, name: str) -> np.ndarray:
        """Read an array of the file by its name."""
        with h5py.File(self.path, "r") as file:
            if name not in file:
                raise InputError(f"{self.path} has no {name!r} (inside: {', '.join(file)})")
            return np.asarray(file[name])


def is_population(path: Path) -> bool:
    """Return whether a file says that it is a population; what is wrong with it is not asked."""
    try:
        with h5py.File(path, "r") as file:
            return get_text(file, "format") == FORMAT
    except OSError:
        return False


def open_population(path: str | Path) -> Population:
    """Open the file of a simulated population and check that it is one."""
    path = Path(path)
    if not path.exists():
        raise InputError(f"{path}: there is no such file")
    with opened(path) as file:
        if get_text(file, "format") != FORMAT:
            raise InputError(f"{path} is HDF5, but not a population of standfast")
        study = PopulationStudy.from_canonical(get_text(file, "study") or "")
        if get_text(file, "study_sha256") != study.fingerprint:
            raise InputError(f"{path}: the study inside does not match its fingerprint")
        summary = json.loads(bytes(file["summary"][()]))
        version = get_text(file, "standfast_version") or "unknown"
    return Population(path, study, version, summary)
