"""Random persons with delayed feedback, of every kind, always from a seeded generator."""

import itertools
from typing import NamedTuple

import numpy as np

import standfast as sf

# Moment arms (m) of muscles that span two joints, each with a stiffness k: K gains k r rᵀ.
TWO_JOINT_ARMS = np.array([[0.05, 0.05, 0.0], [0.0, 0.05, 0.08], [0.0, 0.04, 0.08]])
PATTERNS = tuple(itertools.product((False, True), repeat=3))[:-1]  # all but three rigid joints
KINDS = (
    "diagonal",  # each joint senses itself
    "full",  # every joint senses all
    "one channel",  # b (p + d s)ᵀ: one signal to all joints
    "ankle only",
    "proportional",  # D = 0
    "derivative",  # P = 0
    "undamped",  # B = 0
    "one ratio",  # B = 0, D a multiple of P: all roots z have the same or opposite angles
    "modal",  # P and D multiples of C or of A, B = 0: the modes stay apart
)


class Persons(NamedTuple):
    """A, B, C, P, D as (5, 3, 3, persons), rigid joints as (3, persons), and their kinds."""

    numbers: np.ndarray
    rigid: np.ndarray
    kind: np.ndarray

    def __getitem__(self, chosen):
        if not isinstance(chosen, slice | np.ndarray | list):
            return tuple.__getitem__(self, chosen)
        return Persons(self.numbers[..., chosen], self.rigid[:, chosen], self.kind[chosen])

    @property
    def free(self) -> np.ndarray:
        return ~self.rigid

    def matrices(self, person: int) -> np.ndarray:
        """A, B, C, P, D of one person, (5, n, n), of the free joints alone."""
        free = np.flatnonzero(~self.rigid[:, person])
        return self.numbers[..., person][:, free][:, :, free]


def random_persons(
    rng: np.random.Generator,
    size: int,
    kinds: tuple[str, ...] = KINDS,
    *,
    rigid_share: float = 0.4,
    bodies: int = 64,
) -> Persons:
    """Persons of some bodies, stiffnesses and gains, of the kinds in turn.

    A share of them has one or two joints rigid; half of them have coupled joints.
    """
    inertia, gravity = _bodies(rng, size, bodies)
    loads = np.stack([gravity[0, 0], gravity[1, 1], gravity[2, 2]])
    springs = _symmetric(
        np.stack([rng.uniform(0.0, 1.2, size) * loads[0],
                  10.0 ** rng.uniform(2.3, 4.0, size),
                  10.0 ** rng.uniform(2.0, 3.5, size)])
    )  # fmt: skip
    coupled = rng.random(size) < 0.5
    muscle = rng.uniform(0.0, 2e4, (len(TWO_JOINT_ARMS), size)) * coupled
    springs += np.einsum("mi,mj,mp->ijp", TWO_JOINT_ARMS, TWO_JOINT_ARMS, muscle)
    damping = _symmetric(10.0 ** rng.uniform(0.0, 1.8, (3, size)))
    kind = np.resize(np.array(kinds), size)
    damping[..., np.isin(kind, ("undamped", "one ratio", "modal"))] = 0.0
    proportional = _gains(rng, kind, loads, np.array([1.5, 0.5, 1.0]), 0.3)
    derivative = _gains(rng, kind, loads, np.array([0.5, 0.1, 0.2]), 0.1)
    one = kind == "one channel"
    to_joint = rng.uniform(-0.4, 1.0, (3, one.sum()))
    to_joint[0] = 1.0
    # powers of two keep the product of rank one to the last bit
    to_joint = 2.0 ** np.rint(np.log2(abs(to_joint))) * np.sign(to_joint)
    for gains in (proportional, derivative):
        gains[..., one] = to_joint[:, None] * gains[0][:, one][None]
    proportional[..., kind == "derivative"] = 0.0
    derivative[..., kind == "proportional"] = 0.0
    stiffness = springs - gravity
    ratio, of_one = rng.uniform(0.02, 0.5, size), kind == "one ratio"
    derivative[..., of_one] = (ratio * proportional)[..., of_one]
    modal, by_inertia = kind == "modal", rng.random(size) < 0.5
    shape = np.where(by_inertia, inertia * rng.uniform(5.0, 60.0, size), gravity)
    proportional[..., modal] = (rng.uniform(0.7, 2.0, size) * shape)[..., modal]
    derivative[..., modal] = (ratio * rng.uniform(0.3, 2.0, size) * shape)[..., modal]
    rigid = np.array(PATTERNS[1:]).T[:, rng.integers(len(PATTERNS) - 1, size=size)]
    rigid = rigid & (rng.random(size) < rigid_share)
    numbers = np.stack([inertia, damping, stiffness, proportional, derivative])
    return Persons(numbers, rigid, kind)


def one_link(
    inertia: float,
    load: float,
    *,
    stiffness: float = 0.0,
    damping: float = 0.0,
    proportional: float = 0.0,
    derivative: float = 0.0,
) -> Persons:
    """A pendulum of given numbers: the ankle alone is free."""
    numbers = np.zeros((5, 3, 3, 1))
    numbers[:, 0, 0, 0] = inertia, damping, stiffness - load, proportional, derivative
    return Persons(numbers, np.array([[False], [True], [True]]), np.array(["one link"]))


def of_matrices(*five: np.ndarray) -> Persons:
    """A person of n ≤ 3 joints of given A, B, C, P, D."""
    n = len(five[0])
    numbers = np.zeros((5, 3, 3, 1))
    for place, matrix in enumerate(five):
        numbers[place, :n, :n, 0] = matrix
    return Persons(numbers, (np.arange(3) >= n)[:, None], np.array(["given"]))


def _bodies(rng, size: int, count: int) -> tuple[np.ndarray, np.ndarray]:
    """A and G of bodies from a small teenager to a tall, heavy adult."""
    found = []
    for number in range(count):
        height = rng.uniform(1.4, 2.0)
        body = sf.Body.from_height_mass(
            height, height**2 * rng.uniform(17.0, 36.0), sf.BODY_MODELS[number % 4]
        )
        springless = sf.stiffness_matrix(body, sf.Stiffness(0.0, 0.0, 0.0), rng.uniform(9.7, 9.9))
        found.append((sf.inertia_matrix(body), -np.asarray(springless)))
    whose = rng.integers(count, size=size)
    a, g = (np.stack(each, axis=-1)[..., whose] for each in zip(*found, strict=True))
    return a, g


def _symmetric(diagonal: np.ndarray) -> np.ndarray:
    matrix = np.zeros((3, *diagonal.shape))
    matrix[range(3), range(3)] = diagonal
    return matrix


def _gains(rng, kind, loads, own: np.ndarray, cross: float) -> np.ndarray:
    """Gains relative to what gravity asks of each joint; (3, 3, persons)."""
    size = kind.size
    gains = rng.uniform(-cross, cross, (3, 3, size)) * loads[2]
    gains[range(3), range(3)] = rng.uniform(0.0, own[:, None], (3, size)) * loads
    diagonal = (kind == "diagonal") | ((kind == "undamped") & (rng.random(size) < 0.5))
    off = ~np.eye(3, dtype=bool)
    gains[off] *= ~diagonal
    only = np.zeros((3, 3), bool)
    only[0, 0] = True
    gains[~only] *= kind != "ankle only"
    return gains
