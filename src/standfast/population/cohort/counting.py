"""Blocks of a cohort, sampled, judged and counted: the unit of a population's work."""

import math
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from standfast.engine.mapping import map_over_batch
from standfast.parameters import JOINTS
from standfast.population.cohort.cohort import Cohort
from standfast.population.cohort.histograms import (
    EXTREMES,
    EXTREMES_FED_BACK,
    NO_SWAY,
    OPEN_SWAY,
    SWAY_BINS,
    SWAY_BINS_PER_UNIT,
    VALUE_BINS,
    bin_of,
    bins_of,
    class_of,
    class_shape,
    classes_of,
    counted,
    signed_bin_of,
)
from standfast.population.cohort.nerves import FedBackPersons, fed_back
from standfast.population.cohort.persons import growth, outcome
from standfast.population.cohort.settling import settle_bins, settle_persons
from standfast.population.cohort.sway import swayed
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


def histogram_shapes(cohort: Cohort) -> tuple[int, int, bool, int]:
    """Return what histograms are of: strata, rows of a file, whether fed back, kinds of sway."""
    model = cohort.model
    return len(cohort.strata), cohort.rows, bool(model.nerves), len(model.sway)


def is_detailed(study: PopulationStudy, block: Block) -> bool:
    """Return whether distributions are kept of a block's persons; with noise those of sway."""
    if study.is_fed_back and not study.sway:  # the critical delay is found with every verdict
        return True
    if study.sway and study.keeps_persons:
        return True
    return block.number * study.block_size * study.replicates < DETAILED


def count_block(study: PopulationStudy, cohort: Cohort, block: Block) -> Counts:
    """Sample and count the persons of one block."""
    variates = cohort.sampler.variates(block.replicate, block.number, study.block_size)
    numbers = cohort.numbers(variates)
    size = study.block_persons(block.number)
    if cohort.model.nerves:
        sways = bool(study.sway) and is_detailed(study, block)
        return _count_fed_back(study, cohort, variates, numbers, size, sways=sways)
    detailed = is_detailed(study, block)
    if detailed:
        mapped = map_over_batch(bins_of, cohort.model, cohort.names)(numbers)
        found = {name: values[:size] for name, values in mapped.items()}
    else:
        judge = map_over_batch(class_of, cohort.model, cohort.names)
        found = classes_of(judge, numbers, size)
    settled = settle_bins(cohort, numbers, found)
    shape = class_shape(len(cohort.strata))
    classes = np.bincount(found["class"], minlength=math.prod(shape))
    counts: dict[str, np.ndarray] = {"classes": classes.reshape(shape), "settled": settled}
    fallen = found["class"] & 1
    if detailed:
        counts |= _details(found)
        counts["growth_rate"] = _growth_rates(cohort, numbers, fallen)
    counts |= _rows(cohort, variates, fallen)
    kept = _persons(cohort, variates, numbers, size) if study.keeps_persons else b""
    return Counts(counts, kept)


def _rows(cohort: Cohort, variates: np.ndarray, fallen: np.ndarray) -> dict[str, np.ndarray]:
    """Count how often each person of a file stood and fell; nothing for a built-in population."""
    if not cohort.rows:
        return {}
    rows = cohort.rows_of(variates)[: fallen.size]
    counts = np.bincount(2 * rows + fallen, minlength=2 * cohort.rows)
    return {"rows": counts.reshape(cohort.rows, 2)}


def _count_fed_back(
    study: PopulationStudy,
    cohort: Cohort,
    variates: np.ndarray,
    numbers: np.ndarray,
    size: int,
    *,
    sways: bool,
) -> Counts:
    """Count the persons of a block who have feedback, by their verdict at their own delay."""
    classed = classes_of(map_over_batch(class_of, cohort.model, cohort.names), numbers, size)
    settled = settle_bins(cohort, numbers, classed)
    of_springs = classed["class"]
    found = fed_back(cohort, numbers, size)
    fallen = (~found.stands).astype(of_springs.dtype)
    shape = class_shape(len(cohort.strata))
    # a class is even, and 1 more for who falls
    classes = np.bincount(of_springs - (of_springs & 1) + fallen, minlength=math.prod(shape))
    stratum = of_springs // math.prod(shape[1:])
    bins = (VALUE_BINS + 2) * stratum + bin_of(found.critical_delay)
    delays = np.bincount(bins, minlength=(VALUE_BINS + 2) * len(cohort.strata))
    margins = signed_bin_of(found.delay_margin)
    counts = {
        "classes": classes.reshape(shape),
        "load_sums": _load_sums(found.numbers),
        "critical_delay": delays.reshape(len(cohort.strata), -1),
        "delay_margin": np.bincount(margins, minlength=2 * VALUE_BINS + 3),
        "by_springs": np.bincount(of_springs & 1, minlength=2),
        "left_open": np.array([found.uncertain.sum()]),
        "settled": settled,
        "extremes": _extremes(
            {**vars(found), "delay_margin": found.delay_margin}, EXTREMES_FED_BACK
        ),
        **_rows(cohort, variates, fallen),
    }
    of_sway: dict[str, np.ndarray] = {}
    if sways:
        of_sway, sure = swayed(found, study.sway)
        counts["sway"] = np.array(
            [_counted_sway(each, sure, stratum, cohort) for each in of_sway.values()]
        )
        counts["left_open"] += (~sure & ~found.uncertain).sum()
    return Counts(counts, _kept(cohort, variates, found, of_sway) if study.keeps_persons else b"")


def _counted_sway(
    values: np.ndarray, sure: np.ndarray, stratum: np.ndarray, cohort: Cohort
) -> np.ndarray:
    """Count a quantity of sway by stratum, (strata, SWAY_BINS)."""
    there, strata = np.isfinite(values), len(cohort.strata)
    bins = np.where(there, bin_of(SWAY_BINS_PER_UNIT * np.where(there, values, 1.0)), NO_SWAY)
    bins = np.where(np.isnan(values) & ~sure, OPEN_SWAY, bins)
    found = np.bincount(SWAY_BINS * stratum + bins, minlength=SWAY_BINS * strata)
    return found.reshape(strata, -1)


def _load_sums(found: Mapping[str, np.ndarray]) -> np.ndarray:
    """Return the sums of the joints' loads and of their squares."""
    loads = np.array([found[f"load_{joint}"] for joint in JOINTS])
    return np.array([loads.sum(axis=1), np.square(loads).sum(axis=1)])


def _extremes(values: Mapping[str, np.ndarray], names: Sequence[str]) -> np.ndarray:
    """Return the least of each, and the least of each with the other sign."""
    return np.array([[(sign * values[n]).min() for n in names] for sign in (1.0, -1.0)])


def _details(found: Mapping[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Count the margins and thresholds of a block's persons, and add up their loads."""
    required = [
        [counted(found[f"critical_{joint}"]), counted(found[f"multiple_{joint}"])]
        for joint in JOINTS
    ]
    return {
        "safety_factor": counted(found["safety_factor"]),
        "required": np.array(required),
        "extremes": _extremes({name: found[f"value_of_{name}"] for name in EXTREMES}, EXTREMES),
        "load_sums": _load_sums(found),
    }


def _growth_rates(cohort: Cohort, numbers: np.ndarray, fallen: np.ndarray) -> np.ndarray:
    """Count the growth rates of the first who fall."""
    rows = np.flatnonzero(fallen)[:MOST_FALLS]
    if rows.size == 0:
        return counted(rows)
    rates = map_over_batch(growth, cohort.model, cohort.names)(numbers[:, rows])["growth_rate"]
    return counted(bin_of(rates))


def _persons(cohort: Cohort, variates: np.ndarray, numbers: np.ndarray, size: int) -> bytes:
    """Return what is kept of every person, as columns of float64."""
    mapped = map_over_batch(outcome, cohort.model, cohort.names)(numbers)
    found = {name: values[:size] for name, values in mapped.items()}
    settle_persons(cohort, numbers, found)
    return _columns(cohort, variates, found)


def _columns(cohort: Cohort, variates: np.ndarray, found: Mapping[str, np.ndarray]) -> bytes:
    """Return what is kept of persons, and which rows of a file they are, as float64."""
    columns = dict(found)
    if cohort.rows:
        columns["row"] = cohort.rows_of(variates)[: found["stable"].size]
    return np.array([columns[name] for name in cohort.kept], np.float64).tobytes()


def _kept(
    cohort: Cohort,
    variates: np.ndarray,
    found: FedBackPersons,
    of_sway: Mapping[str, np.ndarray],
) -> bytes:
    """Return what is kept of every person with feedback, as columns of float64."""
    columns = {
        **found.numbers,
        **of_sway,
        "critical_delay": found.critical_delay,
        "stable": found.stands,
    }
    return _columns(cohort, variates, columns)
