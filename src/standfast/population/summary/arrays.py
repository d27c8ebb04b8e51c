"""The arrays in the file of a population: names, axes, shapes and types."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from standfast.parameters import JOINTS
from standfast.population.cohort.histograms import BMI_EDGES, HEIGHT_EDGES
from standfast.population.cohort.persons import KEPT
from standfast.population.people.study import PopulationStudy
from standfast.quantities import QUANTITIES

# Shares of the population that are to stand, for which the stiffness is asked.
STANDING_SHARES = (0.5, 0.9, 0.95, 0.99)


def _middles(edges: np.ndarray) -> np.ndarray:
    middles: np.ndarray = 0.5 * (edges[1:] + edges[:-1])
    return middles


AXES: Mapping[str, np.ndarray] = {
    "height": _middles(HEIGHT_EDGES),
    "bmi": _middles(BMI_EDGES),
    "safety_factor": np.round(np.geomspace(0.1, 10.0, 401), 6),
    "multiple": np.round(np.geomspace(0.1, 10.0, 401), 6),
    "standing_share": np.array(STANDING_SHARES),
    "growth_rate": np.round(np.geomspace(0.05, 20.0, 401), 6),
}
# Written only where somebody falls.
GROWTH = "growth_rate_below"
SHARES: Mapping[str, tuple[str, ...]] = {
    "risk": ("height", "bmi"),
    "survival": ("safety_factor",),
    **{f"risk_by_{joint}_multiple": ("multiple",) for joint in (*JOINTS, "all")},
    GROWTH: ("growth_rate",),
}
ARRAYS: Mapping[str, tuple[str, ...]] = {
    **{name: (name,) for name in AXES},
    "persons": ("height", "bmi"),
    **SHARES,
    **{
        f"required_{joint}_{kind}{end}": ("standing_share",)
        for joint in JOINTS
        for kind in ("stiffness", "multiple")
        for end in ("", "_lower", "_upper")
    },
}


def kept_type(name: str) -> np.dtype[Any]:
    """Return the type of what is kept of every person."""
    return np.dtype(QUANTITIES[name].dtype if name in QUANTITIES else np.float64)


def arrays_of(study: PopulationStudy) -> dict[str, tuple[tuple[int, ...], np.dtype[Any] | None]]:
    """Return shape and type of all that a population's file holds, None of the text."""
    found: dict[str, tuple[tuple[int, ...], np.dtype[Any] | None]] = {"summary": ((), None)}
    for name, axes in ARRAYS.items():
        shape = tuple(AXES[axis].size for axis in axes)
        found[name] = shape, np.dtype(np.int64 if name == "persons" else np.float64)
    for name in KEPT if study.keeps_persons else ():
        found[f"person_{name}"] = (study.size,), kept_type(name)
    return found
