"""Persons of every kind in one batch: rigid joints taken out, sorted by what their feedback is.

A rigid joint takes its row and column out. What is the same for many persons, how many joints are
free and of which rank their feedback is, makes one problem (:class:`.crossings.Problem`); each
person goes to its own.
"""

from collections.abc import Iterator
from itertools import combinations, permutations

import numpy as np

from standfast.numerics.arrays import ROUNDOFF
from standfast.stability.delay.crossings import crossings_of
from standfast.stability.delay.problem import Apply, Problem, Whom, directly
from standfast.stability.delay.rightmost import rightmost_roots
from standfast.stability.delay.table import Crossings

# Roundings of a minor of two by two whose terms cancel, in units of the larger term.
CANCELS = 8.0 * ROUNDOFF


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
    for problem, who, reduced in _problems(numbers, rigid):
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
    for problem, who, reduced in _problems(numbers, rigid):
        root[who], proven[who] = rightmost_roots(problem, reduced, delay[who], apply=apply)
    return root, proven


def _problems(
    numbers: np.ndarray, rigid: np.ndarray
) -> Iterator[tuple[Problem, np.ndarray, np.ndarray]]:
    """Give each problem, who has it, and their matrices of the free joints."""
    active = (numbers[3] != 0.0) | (numbers[4] != 0.0)
    active &= ~rigid[:, None] & ~rigid[None, :]
    bits = np.concatenate([rigid, active.reshape(9, -1)])
    kinds, kind_of = np.unique(2 ** np.arange(12) @ bits, return_inverse=True)
    by_problem: dict[tuple[tuple[int, ...], int], list[np.ndarray]] = {}
    for number in range(kinds.size):
        who = np.flatnonzero(kind_of == number)
        free = tuple(int(j) for j in np.flatnonzero(~rigid[:, who[0]]))
        if free:
            rank = _structural_rank(active[:, :, who[0]])
            by_problem.setdefault((free, rank), []).append(who)
    for (free, rank), members in by_problem.items():
        who = np.concatenate(members)
        reduced = numbers[:, free][:, :, free][..., who]
        one = _is_one_channel(reduced[3:]) if rank > 1 else np.zeros(who.size, bool)
        for channels, chosen in ((rank, ~one), (1, one)):
            if chosen.any():
                yield Problem(len(free), channels), who[chosen], reduced[..., chosen]


def _structural_rank(active: np.ndarray) -> int:
    """Return the largest rank of matrices that are 0 where ``active`` is not."""
    return max(
        sum(bool(active[row, column]) for row, column in enumerate(order))
        for order in permutations(range(3))
    )


def _is_one_channel(gains: np.ndarray) -> np.ndarray:
    """Return where P + D s is b (p + d s)ᵀ or (b + d s) pᵀ: minors of [P D] or [P; D] vanish."""
    one = []
    for wide in (np.concatenate([*gains], axis=1), np.concatenate([*gains.swapaxes(1, 2)], axis=1)):
        vanish = np.ones(gains.shape[-1], bool)
        for (a, b), (i, j) in (
            (rows, columns)
            for rows in combinations(range(wide.shape[0]), 2)
            for columns in combinations(range(wide.shape[1]), 2)
        ):
            first, second = wide[a, i] * wide[b, j], wide[a, j] * wide[b, i]
            larger = np.maximum(abs(first), abs(second))
            vanish &= abs(first - second) <= CANCELS * larger
        one.append(vanish)
    return one[0] | one[1]
