"""Writing the file of a population: its summary, and the arrays that figures are made of.

The file is plain HDF5, labelled as an atlas is: named axes as dimension scales, units and meanings
as attributes. No clock enters, so the same study gives the same bytes.
"""

import json
from collections.abc import Iterable

import h5py
import numpy as np

from standfast.atlas.layout import set_attributes, set_text
from standfast.atlas.writer import reserve
from standfast.parameters import JOINTS, PARAMETERS, STIFFNESS_UNIT
from standfast.population.people.study import PopulationStudy
from standfast.population.summary.arrays import ARRAYS, AXES, GROWTH, STANDING_SHARES, kept_type
from standfast.population.summary.estimators import Distribution
from standfast.population.summary.file import FORMAT, FORMAT_VERSION
from standfast.population.summary.summary import Summary
from standfast.quantities import QUANTITIES
from standfast.version import __version__

# More than all arrays take together.
ARRAYS_BYTES = 2**20


def write_summary(file: h5py.File, study: PopulationStudy, summary: Summary) -> None:
    """Write all attributes, the answers, and the arrays that figures are made of."""
    set_attributes(
        file,
        {
            "Conventions": "CF-1.11",
            "title": study.title,
            "format": FORMAT,
            "format_version": np.int32(FORMAT_VERSION),
            "standfast_version": __version__,
            "study": study.canonical,
            "study_sha256": study.fingerprint,
        },
    )
    text = json.dumps(summary.to_dict(), ensure_ascii=False).encode()
    reserve(file, len(text) + ARRAYS_BYTES)
    file["summary"] = np.array(text, dtype=f"S{len(text)}")
    set_text(file["summary"], "long_name", "all answers with their intervals, as JSON")
    _write_axes(file)
    _write_risk_map(file, summary)
    _write_curves(file, summary)
    for joint in JOINTS:
        _write_required(file, joint, "stiffness", summary.threshold[joint], STIFFNESS_UNIT)
        _write_required(file, joint, "multiple", summary.multiple[joint], "1")


def _write_axes(file: h5py.File) -> None:
    """Write the axes of all arrays as dimension scales."""
    labels = {
        "height": (PARAMETERS["height"].unit, "height"),
        "bmi": (PARAMETERS["bmi"].unit, "body mass index"),
        "safety_factor": ("1", QUANTITIES["safety_factor"].meaning),
        "multiple": ("1", "all stiffnesses of the law times this"),
        "standing_share": ("1", "share of the population that stands"),
        "growth_rate": ("1/s", "growth rate of falls"),
    }
    for name, (unit, meaning) in labels.items():
        scale = file.create_dataset(name, data=AXES[name])
        set_attributes(scale, {"units": unit, "long_name": meaning})
        scale.make_scale(name)


def _write_risk_map(file: h5py.File, summary: Summary) -> None:
    """Write persons and fraction unstable over height and BMI."""
    inner = summary.classes.sum(axis=(0, 1))[1:-1, 1:-1]
    persons = inner.sum(axis=2)
    with np.errstate(invalid="ignore"):
        risk = inner[..., 1] / persons
    _array(file, "persons", persons, "persons simulated in the cell")
    _array(file, "risk", risk, "fraction unstable in the cell")


def _write_curves(file: h5py.File, summary: Summary) -> None:
    """Write distribution functions: of the safety factor, of multiples, of growth rates."""
    safety, growth = summary.safety, summary.growth
    meaning = "share of persons whose safety factor is higher"
    _array(file, "survival", 1.0 - safety.below(AXES["safety_factor"]), meaning)
    multiples = AXES["multiple"]
    curves = {joint: 1.0 - summary.multiple[joint].below(multiples) for joint in JOINTS}
    curves["all"] = safety.below(1.0 / multiples)
    for joint, curve in curves.items():
        what = "all joints'" if joint == "all" else f"the {joint}'s"
        meaning = f"fraction unstable with {what} stiffness multiplied"
        _array(file, f"risk_by_{joint}_multiple", curve, meaning)
    if growth.size:
        meaning = "share of falls that grow more slowly"
        _array(file, GROWTH, growth.below(AXES["growth_rate"]), meaning)


def _write_required(file: h5py.File, joint: str, kind: str, of: Distribution, unit: str) -> None:
    """Write what a joint must have so that shares of all stand, with the ends of its interval."""
    found = [of.quantile(share) for share in STANDING_SHARES]
    meaning = f"{joint} {kind} at which that share stands, the other joints as drawn"
    for suffix, field in (("", "value"), ("_lower", "low"), ("_upper", "high")):
        values = np.array([getattr(each, field) for each in found])
        _array(file, f"required_{joint}_{kind}{suffix}", values, meaning, unit)


def _array(file: h5py.File, name: str, values: np.ndarray, meaning: str, unit: str = "1") -> None:
    dataset = file.create_dataset(name, data=values)
    set_attributes(dataset, {"units": unit, "long_name": meaning})
    for number, axis in enumerate(ARRAYS[name]):
        dataset.dims[number].attach_scale(file[axis])


def new_persons(file: h5py.File, size: int, names: Iterable[str]) -> None:
    """Create the datasets of what is kept of every person."""
    for name in names:
        row = QUANTITIES.get(name) or PARAMETERS[name]
        dataset = file.create_dataset(
            f"person_{name}",
            (size,),
            kept_type(name),
            chunks=True,
            compression="gzip",
            shuffle=True,
        )
        set_attributes(dataset, {"units": row.unit, "long_name": f"{row.meaning}, of each person"})
