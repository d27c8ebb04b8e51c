"""Persons of every kind in one batch: rigid joints taken out, sorted by what their feedback is.

A rigid joint takes its row and column out. What is the same for many persons, how many joints are
free and of which rank their feedback is, makes one problem (:class:`.crossings.Problem`); each
person goes to its own.
"""

from collections.abc import Iterator
from itertools import permutations

import numpy as np

from standfast.stability.delay.crossings import crossings_of
from standfast.stability.delay.one_channel import is_one_channel
from standfast.stability.delay.problem import Apply, Problem, Whom, directly
from standfast.stability.delay.rightmost import rightmost_roots
from standfast.stability.delay.table import Crossings


def all_crossings(
    numbers: np.ndarray,
    rigid: np.ndarray,
    *,
    of: Whom = "everybody",
    apply: Apply = directly,
) -> Crossings:
    """Return the crossings of persons with any joints rigid.

    ``numbers`` holds A, B, C, P, D, (5, 3, 3, persons), in which rows and columns of a rigid joint
    may be anything; ``rigid`` is (3, persons). Others as of :func:`crossings_of`.
    """
    persons = numbers.shape[-1]
    unstable = np.zeros(persons, np.int32)
    marks = np.zeros((4, persons), bool)
    tables = []
    for problem, who, reduced in _problems(numbers, rigid, apply):
        found = crossings_of(problem, reduced, of=of, apply=apply)
        unstable[who] = found.unstable
        marks[:, who] = found.on_axis, found.neutral, found.uncertain, found.by_springs
        tables.append((who[found.person], found.frequency, found.angle, found.direction))
    empty = [(np.zeros(0, np.intp), np.zeros(0), np.zeros(0), np.zeros(0))]
    columns = (np.concatenate(each) for each in zip(*(tables or empty), strict=True))
    return Crossings(unstable, *marks, *columns)


def all_rightmost(
    numbers: np.ndarray, rigid: np.ndarray, delay: np.ndarray, *, apply: Apply = directly
) -> tuple[np.ndarray, np.ndarray]:
    """Return the rightmost root of each person at its delay (1/s), and whether it is proven.

    With three rigid joints nothing moves: −inf.
    """
    root = np.full(delay.size, -np.inf, complex)
    proven = np.ones(delay.size, bool)
    for problem, who, reduced in _problems(numbers, rigid, apply):
        root[who], proven[who] = rightmost_roots(problem, reduced, delay[who], apply=apply)
    return root, proven


def _problems(
    numbers: np.ndarray, rigid: np.ndarray, apply: Apply
) -> Iterator[tuple[Problem, np.ndarray, np.ndarray]]:
    """Give each problem, who has it, and their matrices of the free joints."""
    members: dict[Problem, list[tuple[tuple[int, ...], np.ndarray]]] = {}
    for free, rank, who in _kinds(numbers, rigid):
        channels = {rank: who}
        if rank > 1:
            gains = _of_joints(numbers[3:], free, who)
            one = np.asarray(apply(is_one_channel, Problem(len(free), rank), gains), bool)
            channels = {rank: who[~one], 1: who[one]}
        for count, chosen in channels.items():
            if chosen.size:
                members.setdefault(Problem(len(free), count), []).append((free, chosen))
    for problem, parts in members.items():
        # one batch, whichever joints are free
        reduced = [_of_joints(numbers, free, who) for free, who in parts]
        yield problem, np.concatenate([who for _, who in parts]), np.concatenate(reduced, axis=-1)


def _kinds(
    numbers: np.ndarray, rigid: np.ndarray
) -> Iterator[tuple[tuple[int, ...], int, np.ndarray]]:
    """Give the free joints and the largest rank of gains that are 0 at the same places; and whose.

    Persons without a free joint are left out.
    """
    active = (numbers[3] != 0.0) | (numbers[4] != 0.0)
    active &= ~rigid[:, None] & ~rigid[None, :]
    kind = np.zeros(rigid.shape[1], np.int16)
    for bit, marked in enumerate((*rigid, *active.reshape(9, -1))):
        kind |= marked.astype(np.int16) << bit
    for number in np.flatnonzero(np.bincount(kind)):
        who = np.flatnonzero(kind == number)
        free = tuple(int(joint) for joint in np.flatnonzero(~rigid[:, who[0]]))
        if free:
            yield free, _structural_rank(active[:, :, who[0]]), who


def _of_joints(matrices: np.ndarray, free: tuple[int, ...], who: np.ndarray) -> np.ndarray:
    """Return the matrices of the free joints of some persons."""
    if len(free) < len(matrices[0]):
        matrices = matrices[:, free][:, :, free]
    flat = matrices.reshape(-1, matrices.shape[-1])
    return np.take(flat, who, axis=1).reshape(*matrices.shape[:-1], who.size)


def _structural_rank(active: np.ndarray) -> int:
    """Return the largest rank of matrices that are 0 where ``active`` is not."""
    return max(
        sum(bool(active[row, column]) for row, column in enumerate(order))
        for order in permutations(range(3))
    )
