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
from standfast.population.people.words import SEXES
from standfast.population.summary.arrays import (
    AGES,
    GROWTH,
    OF_SPRINGS,
    STANDING_SHARES,
    WITH_DELAY,
    Layout,
    kept_type,
    layout_of,
)
from standfast.population.summary.estimators import Distribution
from standfast.population.summary.file import FORMAT, version_of
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
            "format_version": np.int32(version_of(study)),
            "standfast_version": __version__,
            "study": study.canonical,
            "study_sha256": study.fingerprint,
        },
    )
    text = json.dumps(summary.to_dict(), ensure_ascii=False).encode()
    reserve(file, len(text) + ARRAYS_BYTES)
    file["summary"] = np.array(text, dtype=f"S{len(text)}")
    set_text(file["summary"], "long_name", "all answers with their intervals, as JSON")
    _write_axes(file, layout_of(study))
    _write_risk_map(file, summary)
    if study.is_fed_back:
        _write_delays(file, summary)
        return
    _write_curves(file, summary)
    for joint in JOINTS:
        what = f"{joint} stiffness at which that share stands, the other joints as drawn"
        name = f"required_{joint}_stiffness"
        _write_borne(file, name, summary.threshold[joint], what, STIFFNESS_UNIT)
        what = what.replace("stiffness", "multiple", 1)
        _write_borne(file, f"required_{joint}_multiple", summary.multiple[joint], what, "1")


def _write_axes(file: h5py.File, layout: Layout) -> None:
    """Write the axes of all arrays as dimension scales."""
    labels = {
        "height": (PARAMETERS["height"].unit, "height"),
        "bmi": (PARAMETERS["bmi"].unit, "body mass index"),
        "safety_factor": ("1", QUANTITIES["safety_factor"].meaning),
        "multiple": ("1", "all stiffnesses of the law times this"),
        "standing_share": ("1", "share of the population that stands"),
        "growth_rate": ("1/s", "growth rate of falls"),
        "delay": ("s", "delay of the feedback"),
        "sex": ("1", f"sex: {_numbered(SEXES)}"),
        "age": ("1", f"age class in years: {_numbered(AGES)}"),
    }
    for name, values in layout.axes.items():
        unit, meaning = labels[name]
        scale = file.create_dataset(name, data=values)
        set_attributes(scale, {"units": unit, "long_name": meaning})
        scale.make_scale(name)


def _numbered(words: Iterable[str]) -> str:
    return ", ".join(f"{number} {word}" for number, word in enumerate(words))


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
    _array(file, "survival", 1.0 - safety.below(OF_SPRINGS.axes["safety_factor"]), meaning)
    multiples = OF_SPRINGS.axes["multiple"]
    curves = {joint: 1.0 - summary.multiple[joint].below(multiples) for joint in JOINTS}
    curves["all"] = safety.below(1.0 / multiples)
    for joint, curve in curves.items():
        what = "all joints'" if joint == "all" else f"the {joint}'s"
        meaning = f"fraction unstable with {what} stiffness multiplied"
        _array(file, f"risk_by_{joint}_multiple", curve, meaning)
    if growth.size:
        meaning = "share of falls that grow more slowly"
        _array(file, GROWTH, growth.below(OF_SPRINGS.axes["growth_rate"]), meaning)


def _write_delays(file: h5py.File, summary: Summary) -> None:
    """Write which share stands up to which delay, of all and by sex and age."""
    delays = WITH_DELAY.axes["delay"]
    meaning = "share of persons whose critical delay is longer"
    _array(file, "standing", 1.0 - summary.critical_delay().below(delays), meaning)
    by_both = np.full((len(SEXES), len(AGES), delays.size), np.nan)
    for sex, age in summary.cohort.strata:
        found = summary.critical_delay(sex=sex, age=age)
        if found.size:
            by_both[SEXES.index(sex), AGES.index(age)] = 1.0 - found.below(delays)
    _array(file, "standing_by_sex_and_age", by_both, f"{meaning}, NaN where there is nobody")
    what = "delay up to which that share stands"
    _write_borne(file, "delay_borne", summary.critical_delay(), what, "s", of_longer=True)


def _write_borne(
    file: h5py.File,
    name: str,
    of: Distribution,
    meaning: str,
    unit: str,
    *,
    of_longer: bool = False,
) -> None:
    """Write at which value shares of all stand, with the ends of its interval."""
    found = [of.quantile(1.0 - share if of_longer else share) for share in STANDING_SHARES]
    for suffix, field in (("", "value"), ("_lower", "low"), ("_upper", "high")):
        values = np.array([getattr(each, field) for each in found])
        _array(file, f"{name}{suffix}", values, meaning, unit)


def _array(file: h5py.File, name: str, values: np.ndarray, meaning: str, unit: str = "1") -> None:
    dataset = file.create_dataset(name, data=values)
    set_attributes(dataset, {"units": unit, "long_name": meaning})
    axes = OF_SPRINGS.arrays.get(name) or WITH_DELAY.arrays[name]
    for number, axis in enumerate(axes):
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
