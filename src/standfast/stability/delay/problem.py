"""What is computed of a person with delayed feedback, step by step: pure, element by element.

Each function takes the :class:`Problem` that is the same for all persons of a batch, and arrays
with the persons last. Whoever has them compiled hands them in as ``apply``.
"""

from collections.abc import Callable
from typing import Any, Literal, NamedTuple, TypeAlias

import numpy as np

from standfast.numerics.arrays import Array, Scalar, namespace
from standfast.numerics.polynomials import Polynomial
from standfast.stability.delay.characteristic import (
    Matrices,
    highest_crossing,
    quasi_polynomial,
    right_of_axis,
    undelayed,
)
from standfast.stability.delay.one_joint import OneJoint, crossings
from standfast.stability.delay.resultant import crossing_at, resultant_at, roots_on_cell

NARROWING_STEPS = 2  # of Chandrupatla's method in one call
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
Whom: TypeAlias = Literal["who stands at once", "who may stand", "everybody"]

Apply: TypeAlias = Callable[..., Any]


def directly(function: Callable[..., Any], problem: Problem, *arrays: np.ndarray) -> Any:
    """Apply a function to arrays as it is, without compiling."""
    with np.errstate(all="ignore"):
        return function(problem, *arrays)


def prepared(problem: Problem, numbers: Array) -> tuple[Array, Array, Array, Array]:
    """Return coefficients, unstable roots without delay, whether they are uncertain, and ω²max.

    ``numbers`` are the matrices of :class:`Matrices`, (5, n, n, persons).
    """
    n = problem.joints
    rows = [[[numbers[k][i][j] for j in range(n)] for i in range(n)] for k in range(5)]
    matrices = Matrices(*rows)
    quasi = quasi_polynomial(matrices, problem.rank)
    unstable, uncertain = right_of_axis(undelayed(quasi))
    bound = highest_crossing(matrices)
    xp = namespace(bound)
    return xp.stack([c for q in quasi for c in q]), unstable, uncertain, bound**2


def classified(problem: Problem, coefficients: Array, low: Scalar, high: Scalar) -> Scalar:
    """Return how many crossings lie in a cell of ω²: 0, 1, or 2 where it must be split."""
    return roots_on_cell(problem.quasi(coefficients), low, high)


def evaluated(problem: Problem, coefficients: Array, x: Scalar) -> Scalar:
    """Return the scaled resultant at x = ω²."""
    return resultant_at(problem.quasi(coefficients), x)


def narrowed(problem: Problem, coefficients: Array, state: Array) -> Array:
    """Return a bracket of a root after some steps of Chandrupatla's method.

    ``state`` has the rows x1, f1 (the newest), x2, f2 (of the other sign), x3, f3 (the one before).
    Chandrupatla, Adv. Eng. Softw. 28 (1997) 145-149: inverse quadratic interpolation where that is
    safe, else bisection.
    """
    quasi = problem.quasi(coefficients)
    x1, f1, x2, f2, x3, f3 = (state[row] for row in range(6))
    xp = namespace(x1)
    for _ in range(NARROWING_STEPS):
        xi, phi = (x1 - x2) / (x3 - x2), (f1 - f2) / (f3 - f2)
        safe = (phi**2 < xi) & ((1.0 - phi) ** 2 < 1.0 - xi)
        t = f1 / (f2 - f1) * f3 / (f2 - f3)
        t = t + (x3 - x1) / (x2 - x1) * f1 / (f3 - f1) * f2 / (f3 - f2)
        t = xp.where(safe & xp.isfinite(t), t, 0.5)
        least = 2.0**-53 * xp.maximum(abs(x1), abs(x2)) / abs(x2 - x1)
        t = xp.clip(t, least, 1.0 - least)
        x = x1 + t * (x2 - x1)
        f = resultant_at(quasi, x)
        # in rounding's reach a compiler may find two signs of one number
        done = abs(f1) < NOISE
        same = (f > 0.0) == (f1 > 0.0)
        older, other = xp.where(same, x1, x2), xp.where(same, x2, x1)
        f_older, f_other = xp.where(same, f1, f2), xp.where(same, f2, f1)
        x3, f3 = xp.where(done, x3, older), xp.where(done, f3, f_older)
        x2, f2 = xp.where(done, x2, other), xp.where(done, f2, f_other)
        x1, f1 = xp.where(done, x1, x), xp.where(done, f1, f)
    return xp.stack([x1, f1, x2, f2, x3, f3])


def polished(problem: Problem, coefficients: Array, x: Scalar) -> Array:
    """Return ω, θ, direction and last correction of crossings, (4, …)."""
    found = crossing_at(problem.quasi(coefficients), x)
    return namespace(x).stack(found)


def of_one_joint(problem: Problem, numbers: Array) -> Array:
    """Return ω and θ to the right, then to the left, of one free joint, (4, persons)."""
    del problem
    found = crossings(OneJoint(*(matrix[0][0] for matrix in numbers)))
    return namespace(*found).stack(found)
