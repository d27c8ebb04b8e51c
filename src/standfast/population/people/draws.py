"""Draws: what a parameter is in one person, given a random variate.

notation: G the load it is relative to, z a standard normal and u a uniform variate.
"""

import math
from dataclasses import dataclass
from typing import NamedTuple

from standfast.numerics.arrays import Scalar, namespace


@dataclass(frozen=True, slots=True)
class Coordinate:
    """One random number a person: uniform in (0, 1), or normal and not below ``lowest``."""

    name: str
    kind: str  # "uniform" or "normal"
    lowest: float = -math.inf


class Draw(NamedTuple):
    """A distribution as persons are computed by it: x G, with x of two numbers a and b.

    fixed: x = a; uniform: x = a + b u; normal: x = a + b z, not below 0 unless it is ``signed``;
    lognormal: x = exp(a + b z); measured: the person's own. What has no spread is fixed. The
    words say which program is compiled, the numbers are arguments of it
    (:func:`.map_over_batch`), but for ``inf``, a rigid joint.
    """

    kind: str
    relative_to: str
    numbers: tuple[float, ...]
    signed: bool = False

    @property
    def is_random(self) -> bool:
        """Whether it takes a variate at all."""
        return self.kind not in ("fixed", "measured")

    @property
    def is_rigid(self) -> bool:
        """Whether the joint is rigid in everybody."""
        return self.kind == "fixed" and self.numbers == (math.inf,)

    def coordinate(self, name: str) -> Coordinate:
        """Return the variate that it takes."""
        if self.kind == "normal" and not self.signed:
            start, width = self.numbers
            return Coordinate(name, "normal", lowest=-start / width)
        return Coordinate(name, "uniform" if self.kind == "uniform" else "normal")

    def value(self, variate: Scalar, measured: Scalar, load: Scalar) -> Scalar:
        """Return it for one person: from the variate, or measured, times the load G."""
        if self.kind == "measured":
            return measured
        xp = namespace(variate, load, *self.numbers)
        if self.kind == "fixed":
            return xp.asarray(self.numbers[0]) * load
        start, width = self.numbers
        value = start + width * variate
        if self.kind == "lognormal":
            value = xp.exp(value)
        elif self.kind == "normal" and not self.signed:
            # at the cut itself rounding may fall below 0
            value = xp.maximum(value, 0.0)
        return value * load


# Draws by the names of their parameters.
Draws = tuple[tuple[str, Draw], ...]
