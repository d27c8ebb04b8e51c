"""Random persons who stand under delayed feedback, with noise, as densities of sway need them."""

from typing import NamedTuple

import numpy as np

import standfast as sf
from delay_people import Persons, random_persons
from standfast.stability.delay.persons import all_crossings
from standfast.stability.delay.problem import directly
from standfast.stability.sway.density import PAIRS, Swaying
from standfast.stability.sway.persons import swaying_of

FEEDING_BACK = ("diagonal", "full", "one channel", "ankle only")
# The rows of variances of the joints' rotations.
VARIANCES = tuple(row for row, (i, j) in enumerate(PAIRS) if i == j)
# Of a nominal adult, for all: what CoM and CoP weigh rotations with.
ADULT = sf.Body.edwards2007()
LOADS = -np.asarray(sf.stiffness_matrix(ADULT, sf.Stiffness(0.0, 0.0, 0.0), 9.81))[0]
WEIGHT = 9.81 * float(np.sum(ADULT.segment_mass))


class Standing(NamedTuple):
    """Persons who stand, each at its delay (s), and its noise (N·m·√s), (3, persons)."""

    people: Persons
    delay: np.ndarray
    noise: np.ndarray

    def __getitem__(self, chosen):
        if not isinstance(chosen, slice | np.ndarray):
            return tuple.__getitem__(self, chosen)
        return Standing(self.people[chosen], self.delay[chosen], self.noise[:, chosen])

    @property
    def swaying(self) -> Swaying:
        loads = np.repeat(LOADS[:, None], self.delay.size, axis=1)
        weight = np.full(self.delay.size, WEIGHT)
        return swaying_of(
            self.people.numbers, self.people.rigid, self.delay, self.noise, loads, weight
        )


def standing_people(
    rng, size: int, longest: float, *, rigid_share: float = 0.4, apply=directly
) -> Standing:
    """Those of random persons who stand at delays up to the longest (s)."""
    delay = rng.uniform(0.0, longest, size)
    people = random_persons(rng, size, FEEDING_BACK, rigid_share=rigid_share)
    table = all_crossings(people.numbers, people.rigid, of="who may stand", apply=apply)
    stands = np.flatnonzero(table.stable_each(delay) & ~table.uncertain)
    noise = rng.uniform(0.2, 2.0, (3, stands.size))
    return Standing(people[stands], delay[stands], noise)
