"""Writing the file of a population: its summary, and the arrays that figures are made of.

The file is plain HDF5, labelled as an atlas is: named axes as dimension scales, units and meanings
as attributes. No clock enters, so the same study gives the same bytes.
"""

import json
from collections.abc import Iterable

import h5py
import numpy as np

from standfast.atlas.layout import set_attributes, set_text
from standfast.parameters import JOINTS, PARAMETERS, STIFFNESS_UNIT
from standfast.population.cohort.histograms import BMI_EDGES, HEIGHT_EDGES
from standfast.population.people.study import PopulationStudy
from standfast.population.summary.estimators import Distribution
from standfast.population.summary.file import FORMAT, FORMAT_VERSION
from standfast.population.summary.summary import STANDING_SHARES, Summary
from standfast.quantities import QUANTITIES, Quantity
from standfast.version import __version__

SAFETY_AXIS = np.round(np.geomspace(0.1, 10.0, 401), 6)
MULTIPLE_AXIS = np.round(np.geomspace(0.1, 10.0, 401), 6)
GROWTH_AXIS = np.round(np.geomspace(0.05, 20.0, 401), 6)


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
    file["summary"] = np.array(text, dtype=f"S{len(text)}")
    set_text(file["summary"], "long_name", "all answers with their intervals, as JSON")
    _write_axes(file)
    _write_risk_map(file, summary)
    _write_curves(file, summary)
    for joint in JOINTS:
        for kind, of, unit in (
            ("stiffness", summary.threshold[joint], STIFFNESS_UNIT),
            ("multiple", summary.multiple[joint], "1"),
        ):
            _write_required(file, joint, kind, of, unit)


def _write_axes(file: h5py.File) -> None:
    """Write the axes of all arrays as dimension scales."""
    heights, bmis = HEIGHT_EDGES, BMI_EDGES
    axes = {
        "height": (0.5 * (heights[1:] + heights[:-1]), PARAMETERS["height"].unit, "height"),
        "bmi": (0.5 * (bmis[1:] + bmis[:-1]), PARAMETERS["bmi"].unit, "body mass index"),
        "safety_factor": (SAFETY_AXIS, "1", QUANTITIES["safety_factor"].meaning),
        "multiple": (MULTIPLE_AXIS, "1", "all stiffnesses of the law times this"),
        "standing_share": (np.array(STANDING_SHARES), "1", "share of the population that stands"),
        "growth_rate": (GROWTH_AXIS, "1/s", "growth rate of falls"),
    }
    for name, (values, unit, meaning) in axes.items():
        scale = file.create_dataset(name, data=values)
        set_attributes(scale, {"units": unit, "long_name": meaning})
        scale.make_scale(name)


def _write_risk_map(file: h5py.File, summary: Summary) -> None:
    """Write persons and fraction unstable over height and BMI."""
    inner = summary.classes.sum(axis=(0, 1))[1:-1, 1:-1]
    persons = inner.sum(axis=2)
    with np.errstate(invalid="ignore"):
        risk = inner[..., 1] / persons
    _array(file, "persons", ("height", "bmi"), persons, "1", "persons simulated in the cell")
    _array(file, "risk", ("height", "bmi"), risk, "1", "fraction unstable in the cell")


def _write_curves(file: h5py.File, summary: Summary) -> None:
    """Write distribution functions: of the safety factor, of multiples, of growth rates."""
    safety = summary.safety
    _array(
        file,
        "survival",
        ("safety_factor",),
        1.0 - safety.below(SAFETY_AXIS),
        "1",
        "share of persons whose safety factor is higher",
    )
    curves = {joint: 1.0 - summary.multiple[joint].below(MULTIPLE_AXIS) for joint in JOINTS}
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
    if summary.growth.size:
        _array(
            file,
            "growth_rate_below",
            ("growth_rate",),
            summary.growth.below(GROWTH_AXIS),
            "1",
            "share of falls that grow more slowly",
        )


def _write_required(file: h5py.File, joint: str, kind: str, of: Distribution, unit: str) -> None:
    """Write what a joint must have so that shares of all stand, with the ends of its interval."""
    found = [of.quantile(share) for share in STANDING_SHARES]
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
    set_attributes(dataset, {"units": unit, "long_name": meaning})
    for number, axis in enumerate(axes):
        dataset.dims[number].attach_scale(file[axis])


def new_persons(file: h5py.File, size: int, names: Iterable[str]) -> None:
    """Create the datasets of what is kept of every person."""
    for name in names:
        row = QUANTITIES.get(name) or PARAMETERS[name]
        kind = row.dtype if isinstance(row, Quantity) else "float64"
        dataset = file.create_dataset(
            f"person_{name}", (size,), kind, chunks=True, compression="gzip", shuffle=True
        )
        set_attributes(dataset, {"units": row.unit, "long_name": f"{row.meaning}, of each person"})
