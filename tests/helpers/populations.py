"""Studies of populations for the tests, and how to count one without a file."""

import copy
import math
from typing import Any

import numpy as np

from standfast.engine.mapping import map_over_batch
from standfast.parameters import JOINTS, STIFFNESSES
from standfast.population.cohort.cohort import Cohort, cohort_of
from standfast.population.cohort.counting import Block, count_block, histogram_shapes
from standfast.population.cohort.histograms import Histograms
from standfast.population.cohort.persons import outcome
from standfast.population.people.study import PopulationStudy

RIGID = {"distribution": "fixed", "value": math.inf}


def law(distribution: str, relative_to: str = "absolute", **numbers: float) -> dict[str, Any]:
    return {"distribution": distribution, "relative_to": relative_to, **numbers}


GOOD: dict[str, Any] = {
    "title": "Women under a stiff law",
    "gravity": 9.81,
    "population": {
        "builtin": "nhanes-2017-2018",
        "sex": "female",
        "age": "20+",
        "size": 40_000,
        "seed": 5,
    },
    "stiffness": {
        "ankle": law("normal", "single_joint_critical", mean=1.8, sd=0.3),
        "knee": law("lognormal", "mgh", mean=2.0, sd=0.5),
        "hip": law("uniform", low=200.0, high=900.0),
    },
}


def changed(key: str, value: Any, base: dict[str, Any] = GOOD) -> dict[str, Any]:
    """Return a study with one key, written ``table.key``, set to a value; None removes it."""
    content = copy.deepcopy(base)
    *tables, last = key.split(".")
    place = content
    for table in tables:
        place = place.setdefault(table, {})
    if value is None:
        del place[last]
    else:
        place[last] = value
    return content


# One free joint: ankles that never hold alone, and a delay that a third does not bear.
ANKLES = changed("stiffness", {"ankle": law("normal", "mgh", mean=0.6, sd=0.06)})
ANKLES["stiffness"] |= {"knee": RIGID, "hip": RIGID}
ANKLES |= {
    "damping": {"ankle": law("uniform", low=5.0, high=40.0)},
    "feedback": {
        "delay": law("lognormal", mean=0.3, sd=0.08),
        "proportional": {"ankle": law("lognormal", "mgh", mean=0.7, sd=0.15)},
        "derivative": {"ankle": law("normal", "single_joint_critical", mean=0.35, sd=0.1)},
    },
}


def of(content: dict[str, Any], **population: Any) -> PopulationStudy:
    """Return a checked study with some keys of its population changed."""
    content = copy.deepcopy(content)
    content["population"] |= population
    return PopulationStudy.from_dict(content)


WHO = ("height", "mass", "stratum", *STIFFNESSES, *(f"{joint}_load" for joint in JOINTS))


def drawn(cohort: Cohort, numbers: np.ndarray) -> dict[str, np.ndarray]:
    """Return who the persons of some numbers are, of all that ``outcome`` says of them.

    What becomes of them, which is most of it, is not compiled.
    """
    return map_over_batch(_who, cohort.model, cohort.names)(numbers)


def _who(model: Any, given: Any) -> dict[str, Any]:
    found = outcome(model, given)
    return {name: found[name] for name in WHO}


def counted(study: PopulationStudy) -> list[Histograms]:
    """Count a study without a file; histograms of each replicate."""
    cohort = cohort_of(study, study.read_people())
    shapes = histogram_shapes(cohort)
    found = [Histograms.empty(*shapes) for _ in range(study.replicates)]
    for replicate, blocks in study.shards:
        of_shard = Histograms.empty(*shapes)
        for block in blocks:
            of_shard.add(count_block(study, cohort, Block(replicate, block)).histograms)
        found[replicate].add(vars(of_shard))
    return found


def events(found: list[Histograms]) -> tuple[np.ndarray, np.ndarray]:
    """Return falls and persons of each replicate."""
    verdicts = np.array([each.classes.sum(axis=(0, 1, 2)) for each in found])
    return verdicts[:, 1], verdicts.sum(axis=1)
