"""The arrays in the file of a population: names, axes, shapes and types."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from standfast.parameters import JOINTS
from standfast.population.cohort.histograms import BMI_EDGES, HEIGHT_EDGES
from standfast.population.cohort.persons import kept_of
from standfast.population.people.builtin import AGE_CLASSES, ANSUR, NHANES
from standfast.population.people.classes import UNKNOWN, age_classes_of
from standfast.population.people.study import PopulationStudy
from standfast.population.people.words import SEXES
from standfast.quantities import QUANTITIES

# Shares of the population that are to stand, for which the stiffness is asked, or the delay.
STANDING_SHARES = (0.5, 0.9, 0.95, 0.99)
# Age classes in the order in which they are told.
BUILT_IN_AGES = dict.fromkeys(group.age for group in (*NHANES, *ANSUR))
AGES = tuple(dict.fromkeys((*(name for _, name in AGE_CLASSES), *BUILT_IN_AGES, UNKNOWN)))


def ages_of(study: PopulationStudy) -> tuple[str, ...]:
    """Return the age classes of a study in the order in which they are told."""
    population = study.content["population"]
    if "age_bands" not in population:
        return AGES
    return (*(name for _, name in age_classes_of(population)), UNKNOWN)


def _middles(edges: np.ndarray) -> np.ndarray:
    middles: np.ndarray = 0.5 * (edges[1:] + edges[:-1])
    return middles


@dataclass(frozen=True)
class Layout:
    """The arrays of one kind of population: values of the axes, and the axes of all arrays.

    ``shares`` are those arrays whose values lie between 0 and 1, NaN where there is nobody.
    """

    axes: Mapping[str, np.ndarray]
    shares: Mapping[str, tuple[str, ...]]
    others: Mapping[str, tuple[str, ...]]

    @property
    def arrays(self) -> dict[str, tuple[str, ...]]:
        """The axes of each array; an axis is its own."""
        return {**{name: (name,) for name in self.axes}, **self.shares, **self.others}


# Written only where somebody falls.
GROWTH = "growth_rate_below"
BODY_AXES = {"height": _middles(HEIGHT_EDGES), "bmi": _middles(BMI_EDGES)}
# By springs alone: what all stiffnesses would have to be.
OF_SPRINGS = Layout(
    {
        **BODY_AXES,
        "safety_factor": np.round(np.geomspace(0.1, 10.0, 401), 6),
        "multiple": np.round(np.geomspace(0.1, 10.0, 401), 6),
        "standing_share": np.array(STANDING_SHARES),
        "growth_rate": np.round(np.geomspace(0.05, 20.0, 401), 6),
    },
    {
        "risk": ("height", "bmi"),
        "survival": ("safety_factor",),
        **{f"risk_by_{joint}_multiple": ("multiple",) for joint in (*JOINTS, "all")},
        GROWTH: ("growth_rate",),
    },
    {
        "persons": ("height", "bmi"),
        **{
            f"required_{joint}_{kind}{end}": ("standing_share",)
            for joint in JOINTS
            for kind in ("stiffness", "multiple")
            for end in ("", "_lower", "_upper")
        },
    },
)
# With feedback: which delay they bear. Sexes are numbered as in SEXES, ages as in ages_of.
WITH_DELAY = Layout(
    {
        **BODY_AXES,
        "standing_share": np.array(STANDING_SHARES),
        "delay": np.round(np.linspace(0.0, 1.0, 501), 3),
        "sex": np.arange(len(SEXES), dtype=np.float64),
        "age": np.arange(len(AGES), dtype=np.float64),
    },
    {
        "risk": ("height", "bmi"),
        "standing": ("delay",),
        "standing_by_sex_and_age": ("sex", "age", "delay"),
    },
    {
        "persons": ("height", "bmi"),
        **{f"delay_borne{end}": ("standing_share",) for end in ("", "_lower", "_upper")},
    },
)
# The shares of persons below which values of sway lie.
SWAY_SHARES = np.round(np.linspace(0.005, 0.995, 199), 3)


def layout_of(study: PopulationStudy) -> Layout:
    """Return which arrays a population's file holds."""
    if not study.is_fed_back:
        return OF_SPRINGS
    ages = np.arange(len(ages_of(study)), dtype=np.float64)
    axes = {**WITH_DELAY.axes, "age": ages}
    if not study.sway:
        return replace(WITH_DELAY, axes=axes)
    others = dict(WITH_DELAY.others)
    for name in study.sway:
        others |= {name: ("quantile",), f"{name}_by_sex_and_age": ("sex", "age", "quantile")}
    return replace(WITH_DELAY, axes={**axes, "quantile": SWAY_SHARES}, others=others)


def kept_type(name: str) -> np.dtype[Any]:
    """Return the type of what is kept of every person."""
    return np.dtype(QUANTITIES[name].dtype if name in QUANTITIES else np.float64)


def identity_of(study: PopulationStudy) -> dict[str, np.dtype[Any] | None]:
    """Return what tells who each kept person is, with its type; None is a text."""
    of_all = {"person_sex": np.dtype(np.uint8), "person_age_class": np.dtype(np.uint8)}
    if "people" not in study.content["population"]:
        return {**of_all}
    return {**of_all, "person_age": np.dtype(np.float64), "person_id": None}


def arrays_of(study: PopulationStudy) -> dict[str, tuple[tuple[int, ...], np.dtype[Any] | None]]:
    """Return shape and type of all that a population's file holds, None of the text."""
    found: dict[str, tuple[tuple[int, ...], np.dtype[Any] | None]] = {"summary": ((), None)}
    layout = layout_of(study)
    for name, axes in layout.arrays.items():
        shape = tuple(layout.axes[axis].size for axis in axes)
        found[name] = shape, np.dtype(np.int64 if name == "persons" else np.float64)
    if study.keeps_persons:
        of_persons = {
            name: kept_type(name)
            for name in kept_of(dict(study.nerves), study.is_fed_back, study.sway)
        }
        found |= {f"person_{name}": ((study.size,), dtype) for name, dtype in of_persons.items()}
        found |= {name: ((study.size,), dtype) for name, dtype in identity_of(study).items()}
    return found
