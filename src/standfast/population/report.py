"""From counts to answers: the file of a population, and its summary in one dictionary.

The file is plain HDF5, labelled as an atlas is: named axes as dimension scales, units and meanings
as attributes. No clock enters, so the same study gives the same bytes.
"""

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from standfast.population.answers import STANDING_SHARES, Answers
from standfast.population.crowd import Crowd
from standfast.population.drivers import Drivers
from standfast.population.laws import JOINTS
from standfast.population.simulation import KEPT, tally_shapes
from standfast.population.study import PopulationStudy
from standfast.population.tally import Tally, bmi_edges, height_edges
from standfast.quantities import PARAMETERS, QUANTITIES, STIFFNESS_UNIT, InputError
from standfast.store import Workplace
from standfast.store.atlas import opened
from standfast.store.layout import LIBRARIES, said, say
from standfast.store.shards import shard_content
from standfast.store.workplace import failures_of_hdf5

FORMAT = "standfast population"
FORMAT_VERSION = 1

SAFETY_AXIS = np.round(np.geomspace(0.1, 10.0, 401), 6)
MULTIPLE_AXIS = np.round(np.geomspace(0.1, 10.0, 401), 6)


@dataclass(frozen=True)
class Population:
    """A simulated population; made by :func:`open_population`.

    Attributes
    ----------
    summary
        all answers with their intervals, as ``standfast population --json`` prints them.
    """

    path: Path
    study: PopulationStudy
    version: str
    summary: dict[str, Any]

    def array(self, name: str) -> np.ndarray:
        """Read an array of the file by its name."""
        with h5py.File(self.path, "r") as file:
            if name not in file:
                raise InputError(f"{self.path} has no {name!r} (inside: {', '.join(file)})")
            values: np.ndarray = file[name][...]
        return values


def is_population(path: Path) -> bool:
    """Return whether a file says that it is a population; what is wrong with it is not asked."""
    try:
        with h5py.File(path, "r") as file:
            return said(file, "format") == FORMAT
    except OSError:
        return False


def open_population(path: str | Path) -> Population:
    """Open the file of a simulated population and check that it is one.

    Raises
    ------
    InputError
        if there is no such file, or it is another kind of file, or damaged.
    """
    path = Path(path)
    if not path.exists():
        raise InputError(f"{path}: there is no such file")
    with opened(path) as file:
        if said(file, "format") != FORMAT:
            raise InputError(f"{path} is HDF5, but not a population of standfast")
        study = PopulationStudy.from_canonical(said(file, "study") or "")
        if said(file, "study_sha256") != study.fingerprint:
            raise InputError(f"{path}: the study inside does not match its fingerprint")
        summary = json.loads(bytes(file["summary"][()]))
        version = said(file, "standfast_version") or "unknown"
    return Population(path, study, version, summary)


def write_population(
    place: Workplace[PopulationStudy], crowd: Crowd, drivers: Drivers, partial: Path
) -> None:
    """Add the shards up and write the finished file."""
    study = place.study
    tallies = _replicates(place, crowd)
    answers = Answers(study, crowd, tallies, drivers)
    with failures_of_hdf5(partial), h5py.File(partial, "w", libver=LIBRARIES) as file:
        say(file, "Conventions", "CF-1.11")
        say(file, "title", study.title)
        say(file, "format", FORMAT)
        file.attrs["format_version"] = np.int32(FORMAT_VERSION)
        say(file, "standfast_version", place.version)
        say(file, "study", study.canonical)
        say(file, "study_sha256", study.fingerprint)
        text = json.dumps(answers.summary(), ensure_ascii=False).encode()
        file["summary"] = np.array(text, dtype=f"S{len(text)}")
        say(file["summary"], "long_name", "all answers with their intervals, as JSON")
        _write_arrays(file, answers)
        if study.keeps_persons:
            _write_persons(file, place, crowd)


def _replicates(place: Workplace[PopulationStudy], crowd: Crowd) -> list[Tally]:
    """Add up the shards of each replicate, in order."""
    shapes = tally_shapes(crowd)
    tallies = [Tally.empty(*shapes) for _ in range(place.study.replicates)]
    for number, (replicate, _) in enumerate(place.study.shards):
        content = shard_content(place.folder, number)
        tallies[replicate].add(Tally.from_bytes(content, *shapes))
    return tallies


def _write_arrays(file: h5py.File, answers: Answers) -> None:
    """Write the arrays that figures are made of, each on its named axes."""
    heights, bmis = height_edges(), bmi_edges()
    inner = answers.cells.sum(axis=(0, 1))[1:-1, 1:-1]
    persons = inner.sum(axis=2)
    with np.errstate(invalid="ignore"):
        risk = inner[..., 1] / persons
    axes = {
        "height": (0.5 * (heights[1:] + heights[:-1]), PARAMETERS["height"].unit, "height"),
        "bmi": (0.5 * (bmis[1:] + bmis[:-1]), PARAMETERS["bmi"].unit, "body mass index"),
        "safety_factor": (SAFETY_AXIS, "1", QUANTITIES["safety_factor"].meaning),
        "multiple": (MULTIPLE_AXIS, "1", "all stiffnesses of the law times this"),
        "standing_share": (np.array(STANDING_SHARES), "1", "share of the population that stands"),
        "growth_rate": (np.round(np.geomspace(0.05, 20.0, 401), 6), "1/s", "growth rate of falls"),
    }
    for name, (values, unit, meaning) in axes.items():
        scale = file.create_dataset(name, data=values)
        say(scale, "units", unit)
        say(scale, "long_name", meaning)
        scale.make_scale(name)
    safety = answers.safety
    _array(file, "persons", ("height", "bmi"), persons, "1", "persons simulated in the cell")
    _array(file, "risk", ("height", "bmi"), risk, "1", "fraction unstable in the cell")
    _array(
        file,
        "survival",
        ("safety_factor",),
        1.0 - safety.below(SAFETY_AXIS),
        "1",
        "share of persons whose safety factor is higher",
    )
    curves = {joint: 1.0 - answers.multiple[joint].below(MULTIPLE_AXIS) for joint in JOINTS}
    curves["all"] = safety.below(1.0 / MULTIPLE_AXIS)
    for joint, curve in curves.items():
        what = "all joints'" if joint == "all" else f"the {joint}'s"
        _array(
            file,
            f"risk_by_{joint}_multiple",
            ("multiple",),
            curve,
            "1",
            f"fraction unstable with {what} stiffness multiplied",
        )
    if answers.growth.size:
        _array(
            file,
            "growth_rate_below",
            ("growth_rate",),
            answers.growth.below(axes["growth_rate"][0]),
            "1",
            "share of falls that grow more slowly",
        )
    for joint in JOINTS:
        for kind, of, unit in (
            ("stiffness", answers.threshold, STIFFNESS_UNIT),
            ("multiple", answers.multiple, "1"),
        ):
            found = [of[joint].quantile(share) for share in STANDING_SHARES]
            for suffix, values in (
                ("", [each.value for each in found]),
                ("_lower", [each.low for each in found]),
                ("_upper", [each.high for each in found]),
            ):
                _array(
                    file,
                    f"required_{joint}_{kind}{suffix}",
                    ("standing_share",),
                    np.array(values),
                    unit,
                    f"{joint} {kind} at which that share stands, the other joints as drawn",
                )


def _array(
    file: h5py.File, name: str, axes: tuple[str, ...], values: np.ndarray, unit: str, meaning: str
) -> None:
    dataset = file.create_dataset(name, data=values)
    say(dataset, "units", unit)
    say(dataset, "long_name", meaning)
    for number, axis in enumerate(axes):
        dataset.dims[number].attach_scale(file[axis])


def _write_persons(file: h5py.File, place: Workplace[PopulationStudy], crowd: Crowd) -> None:
    """Write what was kept of every person, shard by shard."""
    study = place.study
    rows = PARAMETERS | QUANTITIES
    for name in KEPT:
        kind = "uint8" if name == "stable" else "float64"
        dataset = file.create_dataset(
            f"person_{name}", (study.size,), kind, chunks=True, compression="gzip", shuffle=True
        )
        say(dataset, "units", rows[name].unit)
        say(dataset, "long_name", f"{rows[name].meaning}, of each person")
    offset = Tally.empty(*tally_shapes(crowd)).nbytes
    start = 0
    for number, (_, blocks) in enumerate(study.shards):
        raw = shard_content(place.folder, number)[offset:]
        at = 0
        for block in blocks:
            size = study.block_persons(block)
            end = at + 8 * len(KEPT) * size
            columns = np.frombuffer(raw[at:end], np.float64).reshape(len(KEPT), size)
            for name, column in zip(KEPT, columns, strict=True):
                file[f"person_{name}"][start : start + size] = column
            start, at = start + size, end
