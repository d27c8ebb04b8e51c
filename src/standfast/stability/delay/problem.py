"""What is computed of a person with delayed feedback, step by step: pure, element by element.

Each function takes the :class:`Problem` that is the same for all persons of a batch, and arrays
with the persons last. Whoever has them compiled hands them in as ``apply``.
"""

from collections.abc import Callable, Iterable
from typing import Any, Literal, NamedTuple, TypeAlias, get_args

import numpy as np

from standfast.numerics.arrays import Array, Scalar, namespace
from standfast.numerics.polynomials import Polynomial
from standfast.stability.delay import one_channel, resultant
from standfast.stability.delay.characteristic import (
    Matrices,
    highest_crossing,
    quasi_polynomial,
    right_of_axis,
    undelayed,
)
from standfast.stability.delay.one_joint import OneJoint, crossings

# Steps of Chandrupatla's method: before Newton's first, and in each call where that was too early.
FIRST_STEPS, STEPS = 6, 4
NOISE = 1e-13  # of the scaled resultant


class Problem(NamedTuple):
    """What is one and the same for all persons of a batch."""

    joints: int  # n, free
    rank: int  # m, of the feedback

    def quasi(self, coefficients: Array) -> list[Polynomial]:
        """Take the columns of coefficients apart: q0 … qm in rising powers."""
        found, start = [], 0
        for order in range(self.rank + 1):
            stop = start + 2 * self.joints - order + 1
            found.append([coefficients[row] for row in range(start, stop)])
            start = stop
        return found


# Of whom crossings are wanted, from few to all. Real roots cross at 0 alone, so that an odd number
# of roots to the right stays odd: such a person stands at no delay.
Whom: TypeAlias = Literal["nobody", "who stands at once", "who may stand", "everybody"]


def most_of(needs: Iterable[Whom]) -> Whom:
    """Return of whom crossings are wanted where several needs are to be met."""
    few_to_all: tuple[Whom, ...] = get_args(Whom)
    return max(needs, key=few_to_all.index)


Apply: TypeAlias = Callable[..., Any]


def directly(function: Callable[..., Any], problem: Problem, *arrays: np.ndarray) -> Any:
    """Apply a function to arrays as it is, without compiling."""
    with np.errstate(all="ignore"):
        return function(problem, *arrays)


def prepared(problem: Problem, numbers: Array) -> Array:
    """Return the coefficients of q0 … qm, (all of them, persons).

    ``numbers`` are the matrices of :class:`Matrices`, (5, n, n, persons).
    """
    quasi = quasi_polynomial(_matrices(problem, numbers), problem.rank)
    rows = [c for q in quasi for c in q]
    return namespace(*rows).stack(rows)


def highest(problem: Problem, numbers: Array) -> Scalar:
    """Return ω² above which nothing crosses."""
    return highest_crossing(_matrices(problem, numbers)) ** 2


def examined(problem: Problem, coefficients: Array) -> tuple[Array, Array]:
    """Return how many roots are unstable without delay, and whether that is uncertain."""
    return right_of_axis(undelayed(problem.quasi(coefficients)))


def sought(problem: Problem, coefficients: Array) -> Array:
    """Return the coefficients in which crossings of one channel are looked for, R and S."""
    rows = one_channel.search_of(problem.quasi(coefficients))
    return namespace(*rows).stack(rows)


def _matrices(problem: Problem, numbers: Array) -> Matrices:
    n = problem.joints
    return Matrices(*([[numbers[k][i][j] for j in range(n)] for i in range(n)] for k in range(5)))


def classified(problem: Problem, search: Array, low: Scalar, high: Scalar) -> Scalar:
    """Return how many crossings lie in a cell of ω²: 0, 1, or 2 where it must be split."""
    if problem.rank == 1:
        return one_channel.roots_on_cell(search, low, high)
    return resultant.roots_on_cell(problem.quasi(search), low, high)


def evaluated(problem: Problem, search: Array, x: Scalar) -> Scalar:
    """Return the scaled resultant at x = ω²."""
    if problem.rank == 1:
        return one_channel.resultant_at(search, x)
    return resultant.resultant_at(problem.quasi(search), x)


def bracketed(problem: Problem, search: Array, low: Scalar, high: Scalar) -> Array:
    """Return a bracket, as of :func:`narrowed`, of the crossing in a cell that holds one."""
    f_low, f_high = evaluated(problem, search, low), evaluated(problem, search, high)
    found = _narrower(problem, search, (high, f_high, low, f_low, low, f_low), FIRST_STEPS)
    return namespace(*found).stack(found)


def narrowed(problem: Problem, search: Array, state: Array) -> Array:
    """Return a bracket of a root after some steps of Chandrupatla's method.

    ``state`` has the rows x1, f1 (the newest), x2, f2 (of the other sign), x3, f3 (the one before).
    """
    found = _narrower(problem, search, tuple(state[row] for row in range(6)), STEPS)
    return namespace(*found).stack(found)


def _narrower(
    problem: Problem, search: Array, state: tuple[Scalar, ...], steps: int
) -> tuple[Scalar, ...]:
    """Narrow a bracket by inverse quadratic interpolation where that is safe, else bisection.

    Chandrupatla, Adv. Eng. Softw. 28 (1997) 145-149.
    """
    x1, f1, x2, f2, x3, f3 = state
    xp = namespace(x1)
    for _ in range(steps):
        xi, phi = (x1 - x2) / (x3 - x2), (f1 - f2) / (f3 - f2)
        safe = (phi**2 < xi) & ((1.0 - phi) ** 2 < 1.0 - xi)
        t = f1 / (f2 - f1) * f3 / (f2 - f3)
        t = t + (x3 - x1) / (x2 - x1) * f1 / (f3 - f1) * f2 / (f3 - f2)
        t = xp.where(safe & xp.isfinite(t), t, 0.5)
        least = 2.0**-53 * xp.maximum(abs(x1), abs(x2)) / abs(x2 - x1)
        t = xp.clip(t, least, 1.0 - least)
        x = x1 + t * (x2 - x1)
        f = evaluated(problem, search, x)
        # in rounding's reach a compiler may find two signs of one number
        done = abs(f1) < NOISE
        same = (f > 0.0) == (f1 > 0.0)
        older, other = xp.where(same, x1, x2), xp.where(same, x2, x1)
        f_older, f_other = xp.where(same, f1, f2), xp.where(same, f2, f1)
        x3, f3 = xp.where(done, x3, older), xp.where(done, f3, f_older)
        x2, f2 = xp.where(done, x2, other), xp.where(done, f2, f_other)
        x1, f1 = xp.where(done, x1, x), xp.where(done, f1, f)
    return x1, f1, x2, f2, x3, f3


def polished(problem: Problem, coefficients: Array, x: Scalar) -> Array:
    """Return ω, θ, direction and last correction of crossings, (4, …)."""
    way = one_channel if problem.rank == 1 else resultant
    return namespace(x).stack(way.crossing_at(problem.quasi(coefficients), x))


def of_one_joint(problem: Problem, numbers: Array) -> Array:
    """Return ω and θ to the right, then to the left, of one free joint, (4, persons)."""
    del problem
    found = crossings(OneJoint(*(matrix[0][0] for matrix in numbers)))
    return namespace(*found).stack(found)
