"""Writing the file of a population: its summary, and the arrays that figures are made of.

The file is plain HDF5, labelled as an atlas is: named axes as dimension scales, units and meanings
as attributes. No clock enters, so the same study gives the same bytes.
"""

import json

import h5py
import numpy as np

from standfast.atlas.layout import set_attributes, set_text
from standfast.atlas.writer import reserve
from standfast.parameters import JOINTS, PARAMETERS, STIFFNESS_UNIT
from standfast.population.people.study import PopulationStudy
from standfast.population.people.words import SEXES
from standfast.population.summary.arrays import (
    GROWTH,
    OF_SPRINGS,
    STANDING_SHARES,
    SWAY_SHARES,
    WITH_DELAY,
    ages_of,
    layout_of,
)
from standfast.population.summary.estimators import Distribution
from standfast.population.summary.file import FORMAT, version_of
from standfast.population.summary.keeping import flags
from standfast.population.summary.summary import Summary
from standfast.population.summary.sway import SwayFound
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
    set_text(file["summary"], "long_name", "all answers, as JSON")
    _write_axes(file, study)
    _write_risk_map(file, summary)
    if study.is_fed_back:
        _write_delays(file, summary)
        if summary.sway is not None:
            _write_sway(file, study, summary.sway)
        return
    _write_curves(file, summary)
    for joint in JOINTS:
        details = "at which that share stands, the other joints as drawn"
        words = f"{joint} stiffness needed", details
        name = f"required_{joint}_stiffness"
        _write_borne(file, name, summary.threshold[joint], *words, STIFFNESS_UNIT)
        words = f"{joint} multiple needed", details
        _write_borne(file, f"required_{joint}_multiple", summary.multiple[joint], *words, "1")


def _write_axes(file: h5py.File, study: PopulationStudy) -> None:
    """Write the axes of all arrays as dimension scales."""
    layout, classes = layout_of(study), {"sex": SEXES, "age": ages_of(study)}
    labels = {
        "height": (PARAMETERS["height"].unit, "height"),
        "bmi": (PARAMETERS["bmi"].unit, "body mass index"),
        "safety_factor": ("1", "safety factor"),
        "multiple": ("1", "stiffness, as a multiple of the law"),
        "standing_share": ("1", "share of persons who stand"),
        "growth_rate": ("1/s", "growth rate of falls"),
        "delay": ("s", "delay of the feedback"),
        "sex": ("1", "sex"),
        "age": ("1", "age class, years"),
        "quantile": ("1", "share of persons who sway and have less"),
    }
    for name, values in layout.axes.items():
        unit, meaning = labels[name]
        scale = file.create_dataset(name, data=values)
        words = flags(classes.get(name, ()), np.float64)
        set_attributes(scale, {"units": unit, "long_name": meaning} | words)
        scale.make_scale(name)


def _write_risk_map(file: h5py.File, summary: Summary) -> None:
    """Write persons and fraction unstable over height and BMI."""
    inner = summary.classes.sum(axis=(0, 1))[1:-1, 1:-1]
    persons = inner.sum(axis=2)
    with np.errstate(invalid="ignore"):
        risk = inner[..., 1] / persons
    _array(file, "persons", persons, "persons simulated", "in the cell of height and BMI")
    _array(file, "risk", risk, "fraction unstable", "in the cell of height and BMI")


def _write_curves(file: h5py.File, summary: Summary) -> None:
    """Write distribution functions: of the safety factor, of multiples, of growth rates."""
    safety, growth = summary.safety, summary.growth
    share = 1.0 - safety.below(OF_SPRINGS.axes["safety_factor"])
    _array(file, "survival", share, "share of persons", "whose safety factor is higher")
    multiples = OF_SPRINGS.axes["multiple"]
    curves = {joint: 1.0 - summary.multiple[joint].below(multiples) for joint in JOINTS}
    curves["all"] = safety.below(1.0 / multiples)
    for joint, curve in curves.items():
        what = "all joints'" if joint == "all" else f"the {joint}'s"
        details = f"with {what} stiffness multiplied, the others as drawn"
        _array(file, f"risk_by_{joint}_multiple", curve, "fraction unstable", details)
    if growth.size:
        share = growth.below(OF_SPRINGS.axes["growth_rate"])
        _array(file, GROWTH, share, "share of falls", "that grow more slowly")


def _write_delays(file: h5py.File, summary: Summary) -> None:
    """Write which share stands up to which delay, of all and by sex and age."""
    delays = WITH_DELAY.axes["delay"]
    short, details = "share of persons who stand", "up to the delay: whose critical one is longer"
    _array(file, "standing", 1.0 - summary.critical_delay().below(delays), short, details)
    ages = ages_of(summary.study)
    by_both = np.full((len(SEXES), len(ages), delays.size), np.nan)
    for sex, age in summary.cohort.strata:
        found = summary.critical_delay(sex=sex, age=age)
        if found.size:
            by_both[SEXES.index(sex), ages.index(age)] = 1.0 - found.below(delays)
    _array(file, "standing_by_sex_and_age", by_both, short, f"{details}; NaN where nobody is")
    what = "delay borne", "up to which that share stands"
    _write_borne(file, "delay_borne", summary.critical_delay(), *what, "s", of_longer=True)


def _write_sway(file: h5py.File, study: PopulationStudy, sway: SwayFound) -> None:
    """Write quantiles of each quantity of sway, of all and by sex and age."""
    ages = ages_of(study)
    for name in study.sway:
        row = QUANTITIES[name]
        details = f"quantiles of the {row.meaning.partition(', ')[0]}, of who stands and is damped"
        short, everybody = name.replace("_", " "), _quantiles(sway.distribution(name))
        _array(file, name, everybody, short, details, row.unit, axes=("quantile",))
        by_both = np.full((len(SEXES), len(ages), SWAY_SHARES.size), np.nan)
        for sex, age in sway.strata:
            found = _quantiles(sway.distribution(name, sex, age))
            by_both[SEXES.index(sex), ages.index(age)] = found
        axes = ("sex", "age", "quantile")
        details += "; NaN where nobody is"
        _array(file, f"{name}_by_sex_and_age", by_both, short, details, row.unit, axes=axes)


def _quantiles(of: Distribution) -> np.ndarray:
    """Return the quantiles at SWAY_SHARES; NaN of nobody."""
    if not of.size:
        return np.full(SWAY_SHARES.size, np.nan)
    return np.array([of.at(share) for share in SWAY_SHARES])


def _write_borne(
    file: h5py.File,
    name: str,
    of: Distribution,
    short: str,
    details: str,
    unit: str,
    *,
    of_longer: bool = False,
) -> None:
    """Write at which value shares of all stand, with the ends of its interval."""
    found = [of.quantile(1.0 - share if of_longer else share) for share in STANDING_SHARES]
    ends = {"": ("value", ""), "_lower": ("low", ", lower end"), "_upper": ("high", ", upper end")}
    for suffix, (field, end) in ends.items():
        values = np.array([getattr(each, field) for each in found])
        _array(file, f"{name}{suffix}", values, short + end, details, unit)


def _array(
    file: h5py.File,
    name: str,
    values: np.ndarray,
    short: str,
    details: str,
    unit: str = "1",
    *,
    axes: tuple[str, ...] = (),
) -> None:
    """Write an array; the long name is short enough for readers that cut it, details follow."""
    dataset = file.create_dataset(name, data=values)
    set_attributes(dataset, {"units": unit, "long_name": short, "comment": details})
    axes = axes or OF_SPRINGS.arrays.get(name) or WITH_DELAY.arrays[name]
    for number, axis in enumerate(axes):
        dataset.dims[number].attach_scale(file[axis])
