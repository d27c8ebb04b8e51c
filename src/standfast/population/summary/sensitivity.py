"""Sensitivity of the risk: the factors of a population and their Sobol indices."""

from collections.abc import Iterable
from functools import partial
from typing import Any

import numpy as np

from standfast.engine.mapping import map_over_batch
from standfast.parameters import JOINTS
from standfast.population.cohort.cohort import Cohort
from standfast.population.cohort.nerves import delay_margins
from standfast.population.cohort.persons import margins
from standfast.population.cohort.settling import settle_persons
from standfast.population.people.sampling import Sampler
from standfast.population.people.sections import NERVES
from standfast.population.people.sobol import REPLICATES, sobol_block
from standfast.population.summary.estimators import sobol_indices

SENSITIVITY_SIZE = 2**13  # persons a scrambling, on which sensitivity is asked
FED_BACK_SIZE = 2**11  # the same with feedback of several free joints, where a person takes longer
FEWEST_EVENTS = 200  # falls or non-falls, below which indices of falling are chance
SAME = 1e-12  # a relative spread that is rounding
SENSITIVITY_SEED = 2**63  # added to the study's, so that sensitivity has numbers of its own


def drivers_of(cohort: Cohort, seed: int) -> dict[str, dict[str, Any]]:
    """Return the Sobol indices of falling and of a margin by factor, or a remark.

    The margin is the safety factor; with feedback the delay margin.
    """
    factors = factors_of(cohort.sampler)
    dimensions = 2 * len(cohort.sampler.coordinates)
    margin = "delay_margin" if cohort.model.nerves else "safety_factor"
    outputs: dict[str, list[list[np.ndarray]]] = {"unstable": [], margin: []}
    of_margins = partial(delay_margins if cohort.model.nerves else _of_springs, cohort)
    slow = cohort.model.nerves and cohort.model.free_joints > 1
    size = FED_BACK_SIZE if slow else SENSITIVITY_SIZE
    for replicate in range(REPLICATES):
        points = sobol_block(seed + SENSITIVITY_SEED, replicate, 0, dimensions, size)
        first, second = np.split(points, 2)
        samples = [first, second]
        for rows in factors.values():
            mixed = first.copy()
            mixed[list(rows)] = second[list(rows)]
            samples.append(mixed)
        variates = map(cohort.sampler.from_uniform, samples)
        found = [of_margins(cohort.numbers(each)) for each in variates]
        for name, collected in outputs.items():
            collected.append([each[name] for each in found])
    # replicate, sample, person
    return {name: _drivers(name, factors, np.array(values)) for name, values in outputs.items()}


def _of_springs(cohort: Cohort, numbers: np.ndarray) -> dict[str, np.ndarray]:
    """Return :func:`.margins` of many persons, settled where rounding could decide."""
    found = map_over_batch(margins, cohort.model, cohort.names)(numbers)
    found["stable"] = found["unstable"] == 0.0
    settle_persons(cohort, numbers, found)
    return {**found, "unstable": np.where(found["stable"], 0.0, 1.0)}


def _drivers(name: str, factors: Iterable[str], values: np.ndarray) -> dict[str, Any]:
    """Return the indices of one output (replicates, samples, persons) by factor, or a remark."""
    if name == "unstable" and 0 < (rare := min(values.sum(), (1.0 - values).sum())) < FEWEST_EVENTS:
        few = f"only {rare:.0f} of {values.size:,} differ in whether they fall"
        return {"remark": f"{few}, too few to say what drives it"}
    if not np.isfinite(values).all():
        return {"remark": f"{name} is infinite for some persons, so it has no variance to explain"}
    low, high = float(values.min()), float(values.max())
    if high - low <= SAME * max(abs(low), abs(high)):
        looked = f"{values.size:,} looked at"
        same = f"{name.replace('_', ' ')} is {0.5 * (low + high):.4g} for all {looked}"
        if name == "unstable":
            same = f"all {looked} fall" if high > 0.0 else f"none of {looked} falls"
        return {"remark": f"{same}; nothing drives it"}
    indices = sobol_indices(values[:, 0], values[:, 1], values[:, 2:])
    pairs = zip(factors, indices.first, indices.total, strict=True)
    return {factor: first.told("first") | total.told("total") for factor, first, total in pairs}


def factors_of(sampler: Sampler) -> dict[str, tuple[int, ...]]:
    """Return the independent factors of risk, each with its coordinates.

    Correlated joints are one factor, and so are both segments' proportions.
    """
    words = {"group": "age and sex", "shank": "proportions", "thigh": "proportions"}
    words |= {"bmi": "BMI", **{joint: f"{joint} stiffness" for joint in JOINTS}}
    together = [sampler.coordinates[row].name for row in sampler.correlated]
    joined = ", ".join([*together[:-2], " and ".join(together[-2:])])
    words |= dict.fromkeys(together, f"{joined} stiffness")
    words |= {name: name.replace("_", " ") for name in NERVES}
    factors: dict[str, tuple[int, ...]] = {}
    for row, coordinate in enumerate(sampler.coordinates):
        name = words.get(coordinate.name, coordinate.name)
        factors[name] = (*factors.get(name, ()), row)
    return factors
