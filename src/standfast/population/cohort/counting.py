"""Blocks of a cohort, sampled, judged and counted: the unit of a population's work."""

import math
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from standfast.engine.mapping import map_over_batch
from standfast.parameters import JOINTS
from standfast.population.cohort.cohort import Cohort
from standfast.population.cohort.histograms import bin_of, bins_of, class_of, class_shape, counted
from standfast.population.cohort.persons import KEPT, growth, outcome
from standfast.population.people.study import PopulationStudy

# Of so many persons the distributions are kept: more of them would add no digit that any model of
# standing bears, and the rest are only asked whether they fall.
DETAILED = 2**20
MOST_FALLS = 8192  # of those in a block, at most so many have their growth rate computed


class Block(NamedTuple):
    """A block of persons: its replicate and its number there."""

    replicate: int
    number: int


class Counts(NamedTuple):
    """What is known of some persons: counts by histogram, and what was kept of every one."""

    histograms: Mapping[str, np.ndarray]
    kept: bytes


def histogram_shapes(cohort: Cohort) -> tuple[int, int]:
    """Return the sizes of histograms: strata, and rows of a file of people."""
    return len(cohort.strata), cohort.rows


def is_detailed(study: PopulationStudy, block: Block) -> bool:
    """Return whether distributions are kept of a block's persons."""
    return block.number * study.block_size * study.replicates < DETAILED


def count_block(study: PopulationStudy, cohort: Cohort, block: Block) -> Counts:
    """Sample and count the persons of one block."""
    variates = cohort.sampler.variates(block.replicate, block.number, study.block_size)
    numbers = cohort.numbers(variates)
    size = study.block_persons(block.number)
    detailed = is_detailed(study, block)
    judge = bins_of if detailed else class_of
    found = map_over_batch(judge, cohort.model, cohort.names)(numbers)
    found = {name: values[:size] for name, values in found.items()}
    shape = class_shape(len(cohort.strata))
    classes = np.bincount(found["class"], minlength=math.prod(shape))
    counts: dict[str, np.ndarray] = {"classes": classes.reshape(shape)}
    fallen = found["class"] & 1
    if detailed:
        counts |= _details(found)
        counts["growth_rate"] = _growth_rates(cohort, numbers, fallen)
    if cohort.rows:
        rows = np.bincount(2 * cohort.rows_of(variates)[:size] + fallen, minlength=2 * cohort.rows)
        counts["rows"] = rows.reshape(cohort.rows, 2)
    return Counts(counts, _persons(cohort, numbers, size) if study.keeps_persons else b"")


def _details(found: Mapping[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Count the margins and thresholds of a block's persons, and add up their loads."""
    required = [
        [counted(found[f"critical_{joint}"]), counted(found[f"multiple_{joint}"])]
        for joint in JOINTS
    ]
    loads = np.array([found[f"load_{joint}"] for joint in JOINTS])
    return {
        "safety_factor": counted(found["safety_factor"]),
        "required": np.array(required),
        "load_sums": np.array([loads.sum(axis=1), np.square(loads).sum(axis=1)]),
    }


def _growth_rates(cohort: Cohort, numbers: np.ndarray, fallen: np.ndarray) -> np.ndarray:
    """Count the growth rates of the first who fall."""
    rows = np.flatnonzero(fallen)[:MOST_FALLS]
    if rows.size == 0:
        return counted(rows)
    of_falls = np.ascontiguousarray(numbers[:, np.resize(rows, MOST_FALLS)])
    rates = map_over_batch(growth, cohort.model, cohort.names)(of_falls)["growth_rate"]
    return counted(bin_of(rates[: rows.size]))


def _persons(cohort: Cohort, numbers: np.ndarray, size: int) -> bytes:
    """Return what is kept of every person, as columns of float64."""
    found = map_over_batch(outcome, cohort.model, cohort.names)(numbers)
    return np.array([found[name][:size] for name in KEPT], np.float64).tobytes()
