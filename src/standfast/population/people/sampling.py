"""Standard variates, block by block: the same for any order of blocks and any number of threads.

A block's numbers depend on seed and block alone. Plain Monte Carlo takes them from one SFC64
generator a block; quasi-Monte Carlo from scrambled Sobol sequences, one independent scrambling a
*replicate*, whose spread gives the interval.
"""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.special import ndtr, ndtri

from standfast.parameters import JOINTS
from standfast.population.people.draws import Coordinate
from standfast.population.people.sections import UNCORRELATED, Correlation
from standfast.population.people.sobol import aligned, sobol_block

STREAM = 0  # of a seed; scrambling is another

# Of a pivot: what a joint has of its own, beside the joints before it.
ROUNDING = 1e-12

# Below this variate a standard normal number does not come in float64: nothing is cut off.
NEVER = -8.3


@dataclass(frozen=True)
class Sampler:
    """Where the standard variates of a population come from."""

    coordinates: tuple[Coordinate, ...]  # what each person draws, one row of a block each
    correlation: Correlation  # of the normal variates of ankle, knee and hip (Gaussian copula)
    method: str  # "monte-carlo" or "quasi-monte-carlo"
    seed: int

    def variates(self, replicate: int, block: int, size: int) -> np.ndarray:
        """Return the variates (d, size) of one block."""
        if self.method == "quasi-monte-carlo":
            uniform = sobol_block(self.seed, replicate, block, len(self.coordinates), size)
            return self.from_uniform(uniform)
        sequence = np.random.SeedSequence([self.seed, STREAM, block])
        random = np.random.Generator(np.random.SFC64(sequence))
        variates = aligned(len(self.coordinates), size)
        for number, (row, coordinate) in enumerate(zip(variates, self.coordinates, strict=True)):
            if number in self.correlated:
                random.standard_normal(out=row)
            elif coordinate.kind == "uniform":
                random.random(out=row)
            else:
                _draw_normal(random, row, coordinate.lowest)
        self._correlate(variates)
        return variates

    def from_uniform(self, uniform: np.ndarray) -> np.ndarray:
        """Turn uniform numbers (d, n), changed in place, into variates."""
        for number, (row, coordinate) in enumerate(zip(uniform, self.coordinates, strict=True)):
            if number in self.correlated:
                ndtri(row, out=row)
            elif coordinate.kind == "normal":
                below = ndtr(coordinate.lowest)
                ndtri(below + (1.0 - below) * row, out=row)
        self._correlate(uniform)
        return uniform

    @cached_property
    def correlated(self) -> tuple[int, ...]:
        """The rows of joints that are correlated with another joint."""
        rows = zip(JOINTS, self.correlation, UNCORRELATED, strict=True)
        joints = [joint for joint, row, alone in rows if row != alone]
        return tuple(i for i, each in enumerate(self.coordinates) if each.name in joints)

    @cached_property
    def _mixing(self) -> list[list[float]]:
        """Rows of the lower triangle L with L Lᵀ the correlation (Cholesky); it may be singular.

        Without pivots and in plain numbers, so that it is the same on every processor.
        """
        places = [JOINTS.index(self.coordinates[row].name) for row in self.correlated]
        mixing: list[list[float]] = []
        for place in places:
            row: list[float] = []
            rest = 1.0
            for other, above in zip(places, mixing, strict=False):
                done = sum(a * b for a, b in zip(row, above, strict=False))
                entry = (self.correlation[place][other] - done) / above[-1] if above[-1] else 0.0
                # of a correlation that is only just possible rounding may ask for more than is left
                row.append(min(max(entry, -math.sqrt(rest)), math.sqrt(rest)))
                rest = max(rest - row[-1] ** 2, 0.0)
            mixing.append([*row, math.sqrt(rest) if rest > ROUNDING else 0.0])
        return mixing

    def _correlate(self, variates: np.ndarray) -> None:
        """Correlate independent normal rows in place, then give each its own distribution."""
        rows = list(self.correlated)
        if not rows:
            return
        # sums in this order, and no library's product of matrices, are the same everywhere
        mixed = [
            sum(part * variates[row] for part, row in zip(parts, rows, strict=False))
            for parts in self._mixing
        ]
        for row, normal in zip(rows, mixed, strict=True):
            coordinate = self.coordinates[row]
            if coordinate.kind == "uniform":
                variates[row] = ndtr(normal)
            elif coordinate.lowest > NEVER:
                # 1 − Φ(z) = (1 − Φ(lowest)) (1 − Φ(normal)), written with Φ(−x) for the tail
                variates[row] = -ndtri(ndtr(-coordinate.lowest) * ndtr(-normal))
            else:
                variates[row] = normal


def _draw_normal(random: np.random.Generator, row: np.ndarray, lowest: float) -> None:
    """Fill a row with normal numbers, drawing those below ``lowest`` again."""
    random.standard_normal(out=row)
    while lowest > NEVER and (below := np.flatnonzero(row < lowest)).size:
        row[below] = random.standard_normal(below.size)
