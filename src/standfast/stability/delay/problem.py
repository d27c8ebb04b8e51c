"""What a batch of persons has in common, and how functions are applied to it."""

from collections.abc import Callable
from typing import Any, NamedTuple, TypeAlias

import numpy as np

from standfast.numerics.arrays import Array
from standfast.numerics.polynomials import Polynomial


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


Apply: TypeAlias = Callable[..., Any]


def directly(function: Callable[..., Any], problem: Problem, *arrays: np.ndarray) -> Any:
    """Apply a function to arrays as it is, without compiling."""
    with np.errstate(all="ignore"):
        return function(problem, *arrays)
