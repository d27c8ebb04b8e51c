"""Sensitivity of the risk: the factors of a population and their Sobol indices."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from standfast.engine.mapping import map_over_batch
from standfast.parameters import JOINTS
from standfast.population.cohort.cohort import Cohort
from standfast.population.cohort.persons import margins
from standfast.population.people.sampling import Sampler
from standfast.population.people.sobol import REPLICATES, sobol_block
from standfast.population.summary.estimators import NoVarianceError, SobolIndices, sobol_indices

# Persons a scrambling, on which sensitivity is asked.
SENSITIVITY_SIZE = 2**13
FEWEST_EVENTS = 200  # falls or non-falls, below which indices of falling are chance
SENSITIVITY_SEED = 2**63  # added to the study's, so that sensitivity has numbers of its own


@dataclass(frozen=True)
class Sensitivity:
    """Which factors drive falling and the safety factor; a sentence where nothing does."""

    factors: tuple[str, ...]
    indices: Mapping[str, SobolIndices]
    remarks: Mapping[str, str]


def sensitivity_of(cohort: Cohort, seed: int) -> Sensitivity:
    """Estimate Sobol indices of all factors by independent scramblings."""
    factors = factors_of(cohort.sampler)
    dimensions = len(cohort.sampler.coordinates)
    outputs: dict[str, list[list[np.ndarray]]] = {"unstable": [], "safety_factor": []}
    of_margins = map_over_batch(margins, cohort.model, cohort.names)
    for replicate in range(REPLICATES):
        points = sobol_block(
            seed + SENSITIVITY_SEED, replicate, 0, 2 * dimensions, SENSITIVITY_SIZE
        )
        first, second = points[:dimensions], points[dimensions:]
        samples = [first, second]
        for rows in factors.values():
            mixed = first.copy()
            mixed[list(rows)] = second[list(rows)]
            samples.append(mixed)
        found = [
            of_margins(cohort.numbers(cohort.sampler.from_uniform(sample.copy())))
            for sample in samples
        ]
        for name, collected in outputs.items():
            collected.append([each[name] for each in found])
    indices, remarks = {}, {}
    for name, collected in outputs.items():
        values = np.array(collected)  # replicate, sample, person
        rare = min(values.sum(), values.size - values.sum()) if name == "unstable" else math.inf
        if 0 < rare < FEWEST_EVENTS:
            remarks[name] = (
                f"only {rare:.0f} of {values.size:,} differ in whether they fall, too few to say "
                "what drives it"
            )
            continue
        if not np.isfinite(values).all():
            remarks[name] = f"{name} is infinite for some persons, so it has no variance to explain"
            continue
        try:
            indices[name] = sobol_indices(values[:, 0], values[:, 1], values[:, 2:])
        except NoVarianceError:
            same = f"{values.flat[0]:.4g}"
            remarks[name] = f"{name} is {same} for all {values.size:,} looked at; nothing drives it"
    return Sensitivity(tuple(factors), indices, remarks)


def factors_of(sampler: Sampler) -> dict[str, tuple[int, ...]]:
    """Return the independent factors of risk, each with its coordinates.

    Correlated joints are one factor, and so are both segments' proportions.
    """
    words = {"group": "age and sex", "shank": "proportions", "thigh": "proportions"}
    words |= {"bmi": "BMI", **{joint: f"{joint} stiffness" for joint in JOINTS}}
    together = sampler.correlated
    joined = _listed([sampler.coordinates[row].name for row in together])
    factors: dict[str, tuple[int, ...]] = {}
    for row, coordinate in enumerate(sampler.coordinates):
        name = words.get(coordinate.name, coordinate.name)
        if row in together:
            name = f"{joined} stiffness"
        factors[name] = (*factors.get(name, ()), row)
    return factors


def _listed(words: Sequence[str]) -> str:
    return " and ".join([", ".join(words[:-1]), words[-1]]) if len(words) > 1 else "".join(words)
