"""Persons with delayed feedback: the equation of each, its crossings, who stands at which delay."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from standfast.anthropometry.body import Body
from standfast.engine.mapping import in_batches, map_over_batch
from standfast.mechanics.feedback import delay_of, equation_of
from standfast.mechanics.joints import Stiffness
from standfast.mechanics.matrices import joint_gravity
from standfast.numerics.arrays import Scalar, namespace
from standfast.parameters import JOINTS, NOISES, STIFFNESSES
from standfast.population.cohort.cohort import Cohort
from standfast.population.cohort.persons import CohortModel, near, person_of
from standfast.population.cohort.settling import settled
from standfast.stability.delay.persons import all_crossings
from standfast.stability.delay.problem import directly
from standfast.stability.springs import verdict

# Persons whose crossings are found together: more of them would only take memory.
TOGETHER = 2**14
ENTRIES = tuple(f"{matrix}{i}{j}" for matrix in "ABCPD" for i in range(3) for j in range(3))
# So many are judged before anything would be compiled.
FEW = 1000
# Where the critical delay is cut off for its variance: beyond all nerves (s).
LONGEST = 1.0


@dataclass(frozen=True)
class FedBackPersons:
    """Persons, and what becomes of them at any delay and at their own; (persons,) each."""

    numbers: Mapping[str, np.ndarray]  # of :func:`equation`
    critical_delay: np.ndarray  # s
    stands: np.ndarray  # at the own delay
    uncertain: np.ndarray  # rounding leaves something open
    undecided: np.ndarray  # it leaves open whether they stand at the own delay

    @property
    def delay_margin(self) -> np.ndarray:
        """By how much the own delay could grow before stability is first lost (s)."""
        margin: np.ndarray = self.critical_delay - self.numbers["feedback_delay"]
        return margin


def equation(model: CohortModel, given: Mapping[str, Scalar]) -> dict[str, Scalar]:
    """Return one person's A, B, C, P and D, entry by entry, and who it is.

    ``springs``: whether springs alone would hold it.
    """
    person = person_of(model, given)
    loads, _, _ = joint_gravity(person.body, model.gravity)
    return {
        **entries_of(person.body, person.stiffness, model.gravity, person.nerves),
        **{f"load_{joint}": load for joint, load in zip(JOINTS, loads, strict=True)},
        "height": person.height,
        "mass": person.mass,
        "stratum": person.stratum,
        "near": near(model, person),
    }


def entries_of(
    body: Body, stiffness: Stiffness, gravity: float, nerves: Mapping[str, Scalar]
) -> dict[str, Scalar]:
    """Return all that :func:`judged` asks of a person, its damping and gains; and of its noise."""
    xp = namespace(*body)
    parts = equation_of(body, stiffness, gravity, nerves)
    entries = [entry for part in parts for row in part for entry in row]
    named = {
        **dict(zip(ENTRIES, entries, strict=True)),
        **dict(zip(STIFFNESSES, stiffness.joints, strict=True)),
        **nerves,
        "feedback_delay": delay_of(nerves),
    }
    if not nerves.keys().isdisjoint(NOISES):  # what sway needs beside
        loads, _, _ = joint_gravity(body, gravity)
        named |= {f"load_{joint}": load for joint, load in zip(JOINTS, loads, strict=True)}
        named["weight"] = gravity * sum(body.segment_mass)
    found = {name: xp.asarray(number, np.float64) for name, number in named.items()}
    return {**found, "springs": verdict(body, stiffness, gravity)}


def fed_back(cohort: Cohort, numbers: np.ndarray, size: int) -> FedBackPersons:
    """Return what becomes of the first ``size`` persons of (names, persons)."""
    mapped = map_over_batch(equation, cohort.model, cohort.names)(numbers)
    found = {name: values[:size] for name, values in mapped.items()}
    if found["near"].any():
        rows, stand, _ = settled(cohort, numbers, found["near"])
        found["springs"] = found["springs"].copy()
        found["springs"][rows] = stand
    return judged(found)


def judged(found: Mapping[str, np.ndarray]) -> FedBackPersons:
    """Return what becomes of persons with numbers as :func:`entries_of` returns them."""
    size = found["springs"].size
    apply = in_batches if size > FEW else directly
    critical = np.empty(size)
    stands, uncertain, undecided = np.empty((3, size), bool)
    for first in range(0, size, TOGETHER):
        at = slice(first, min(first + TOGETHER, size))
        matrices = np.stack([found[name][at] for name in ENTRIES]).reshape(5, 3, 3, -1)
        rigid = np.array([np.isinf(found[name][at]) for name in STIFFNESSES])
        table = all_crossings(matrices, rigid, of="who may stand", apply=apply)
        critical[at] = table.critical_delay()
        stands[at] = table.stable_each(found["feedback_delay"][at])
        uncertain[at] = table.uncertain
        undecided[at] = table.open_each(found["feedback_delay"][at])
        # who has no feedback stands by springs, at every delay or at none
        alone, held = table.by_springs, found["springs"][at]
        stands[at][alone] = held[alone]
        critical[at][alone] = np.where(held[alone], np.inf, 0.0)
        uncertain[at][alone] = False
    return FedBackPersons(found, critical, stands, uncertain, undecided)


def delay_margins(cohort: Cohort, numbers: np.ndarray) -> dict[str, np.ndarray]:
    """Return what sensitivity is asked of: falling (1 or 0) and the delay margin.

    The critical delay is cut off at LONGEST, which only who stands anyway passes: it may be
    infinite, and would then have no variance.
    """
    found = fed_back(cohort, numbers, numbers.shape[1])
    own = found.numbers["feedback_delay"]
    return {
        "unstable": np.where(found.stands, 0.0, 1.0),
        "delay_margin": np.minimum(found.critical_delay, LONGEST) - own,
    }
