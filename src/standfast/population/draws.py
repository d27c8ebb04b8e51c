"""Random scores, block by block: the same for any order of blocks and any number of threads.

A block's numbers depend on seed and block alone. Plain Monte Carlo takes them from one SFC64
generator a block; quasi-Monte Carlo from scrambled Sobol sequences, one independent scrambling a
*replicate*, whose spread gives the interval.

Sobol points in natural order: x_n is the exclusive or of the direction numbers of n's bits. So a
block is one fixed table, or-ed with one number a block. Scrambling: a random lower triangular
matrix of bits (Matoušek, J Complexity 14 (1998) 527-556) and a random digital shift, 52 bits.
"""

from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np
from scipy.special import ndtr, ndtri

from standfast.population.laws import JOINTS, UNCORRELATED, Coordinate, Correlation

# Independent scramblings of a quasi-Monte Carlo run: the interval is Student's t of their spread.
REPLICATES = 16
LARGEST_BLOCK = 2**17

# What a seed is used for; each has streams of its own.
MONTE_CARLO, SCRAMBLING = 0, 1

# Below this score a standard normal number does not come in float64: nothing is cut off.
NEVER = -8.3

DIGITS = 52  # (x + ½) / 2⁵² is exact in float64 and neither 0 nor 1
INDEX_BITS = 32

CACHE_LINE = 64  # bytes

# S. Joe and F. Y. Kuo, SIAM J Sci Comput 30 (2008) 2635-2654, new-joe-kuo-6, dimensions 2 to 24:
# coefficients of the primitive polynomial, and the initial numbers m (as many as its degree).
JOE_KUO = (
    (0, (1,)),
    (1, (1, 3)),
    (1, (1, 3, 1)),
    (2, (1, 1, 1)),
    (1, (1, 1, 3, 3)),
    (4, (1, 3, 5, 13)),
    (2, (1, 1, 5, 5, 17)),
    (4, (1, 1, 5, 5, 5)),
    (7, (1, 1, 7, 11, 19)),
    (11, (1, 1, 5, 1, 1)),
    (13, (1, 1, 1, 3, 11)),
    (14, (1, 3, 5, 5, 31)),
    (1, (1, 3, 3, 9, 7, 49)),
    (13, (1, 1, 1, 15, 21, 21)),
    (16, (1, 3, 1, 13, 27, 49)),
    (19, (1, 1, 1, 15, 7, 5)),
    (22, (1, 3, 1, 15, 13, 25)),
    (25, (1, 1, 5, 5, 19, 61)),
    (1, (1, 3, 7, 11, 23, 15, 103)),
    (4, (1, 3, 7, 13, 13, 15, 69)),
    (7, (1, 1, 3, 13, 7, 35, 63)),
    (8, (1, 3, 5, 9, 1, 25, 53)),
    (14, (1, 3, 1, 13, 9, 35, 107)),
)


@lru_cache(maxsize=1)
def direction_numbers() -> np.ndarray:
    """Return the direction numbers (24, 32) of Sobol's sequence: bit 31 is the first digit."""
    table = np.empty((1 + len(JOE_KUO), INDEX_BITS), np.uint64)
    for dimension in range(len(table)):
        if dimension == 0:
            initial = [1] * INDEX_BITS
        else:
            coefficients, start = JOE_KUO[dimension - 1]
            degree, initial = len(start), list(start)
            for i in range(degree, INDEX_BITS):
                new = initial[i - degree] ^ (initial[i - degree] << degree)
                for k in range(1, degree):
                    if (coefficients >> (degree - 1 - k)) & 1:
                        new ^= initial[i - k] << k
                initial.append(new)
        table[dimension] = [m << (INDEX_BITS - 1 - i) for i, m in enumerate(initial)]
    return table


@lru_cache(maxsize=8)
def scrambled_directions(seed: int, replicate: int, dimensions: int) -> tuple[np.ndarray, ...]:
    """Return scrambled direction numbers (d, 32) of 52 bits, and a shift for each dimension."""
    sequence = np.random.SeedSequence([seed, SCRAMBLING, replicate])
    random = np.random.Generator(np.random.SFC64(sequence))
    plain = direction_numbers()[:dimensions]
    digits = (plain[:, :, None] >> np.arange(INDEX_BITS - 1, -1, -1, dtype=np.uint64)) & np.uint64(
        1
    )
    lower = random.integers(0, 2, (dimensions, DIGITS, INDEX_BITS), np.uint64)
    lower = np.tril(lower, -1)
    lower[:, np.arange(INDEX_BITS), np.arange(INDEX_BITS)] = 1
    mixed = np.einsum("dij,dkj->dki", lower, digits) & np.uint64(1)
    weights = np.uint64(1) << np.arange(DIGITS - 1, -1, -1, dtype=np.uint64)
    shifts = random.integers(0, 2**DIGITS, dimensions, np.uint64)
    return (mixed * weights).sum(axis=2, dtype=np.uint64), shifts


@lru_cache(maxsize=4)
def _table(seed: int, replicate: int, dimensions: int, size: int) -> np.ndarray:
    """Return the first ``size`` scrambled points (d, size), a power of two, before the shift."""
    directions, _ = scrambled_directions(seed, replicate, dimensions)
    points = np.zeros((dimensions, size), np.uint64)
    for bit in range(size.bit_length() - 1):
        points[:, 1 << bit : 2 << bit] = points[:, : 1 << bit] ^ directions[:, bit, None]
    return points


def sobol_block(seed: int, replicate: int, block: int, dimensions: int, size: int) -> np.ndarray:
    """Return one block of a scrambled Sobol sequence: (d, size) uniform numbers inside (0, 1)."""
    directions, shifts = scrambled_directions(seed, replicate, dimensions)
    offset = shifts.copy()
    for bit in range(INDEX_BITS):
        if (block * size >> bit) & 1:
            offset ^= directions[:, bit]
    points = _table(seed, replicate, dimensions, size) ^ offset[:, None]
    uniform = aligned(dimensions, size)
    np.add(points, 0.5, out=uniform)
    uniform *= 2.0**-DIGITS
    return uniform


def aligned(rows: int, size: int) -> np.ndarray:
    """Return an array (rows, size) of any numbers that begins on a cache line.

    Such arrays XLA reads where they lie; others it copies, which takes as long as judging a person.
    """
    count = rows * size
    memory = np.empty(count + CACHE_LINE // 8)
    first = -(memory.ctypes.data // 8) % (CACHE_LINE // 8)
    return memory[first : first + count].reshape(rows, size)


@dataclass(frozen=True)
class Sampler:
    """Where the scores of a population come from.

    Attributes
    ----------
    coordinates
        what each person draws, one row of a block each.
    correlation
        of the normal scores of ankle, knee and hip (Gaussian copula).
    method
        ``monte-carlo`` or ``quasi-monte-carlo``.
    """

    coordinates: tuple[Coordinate, ...]
    correlation: Correlation
    method: str
    seed: int

    def scores(self, replicate: int, block: int, size: int) -> np.ndarray:
        """Return the scores (d, size) of one block."""
        if self.method == "quasi-monte-carlo":
            uniform = sobol_block(self.seed, replicate, block, len(self.coordinates), size)
            return self.from_uniform(uniform)
        sequence = np.random.SeedSequence([self.seed, MONTE_CARLO, block])
        random = np.random.Generator(np.random.SFC64(sequence))
        scores = aligned(len(self.coordinates), size)
        for number, (row, coordinate) in enumerate(zip(scores, self.coordinates, strict=True)):
            if number in self.correlated:
                random.standard_normal(out=row)
            elif coordinate.kind == "uniform":
                random.random(out=row)
            else:
                _draw_normal(random, row, coordinate.lowest)
        self._correlate(scores)
        return scores

    def from_uniform(self, uniform: np.ndarray) -> np.ndarray:
        """Turn uniform numbers (d, n), changed in place, into scores."""
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
        return tuple(
            number
            for number, coordinate in enumerate(self.coordinates)
            if coordinate.name in JOINTS
            and self.correlation[JOINTS.index(coordinate.name)]
            != UNCORRELATED[JOINTS.index(coordinate.name)]
        )

    @cached_property
    def _mixing(self) -> np.ndarray:
        """A matrix L with L Lᵀ the correlation; it may be singular, so by eigenvalues."""
        places = [JOINTS.index(self.coordinates[row].name) for row in self.correlated]
        values, vectors = np.linalg.eigh(np.array(self.correlation)[np.ix_(places, places)])
        mixing: np.ndarray = vectors * np.sqrt(np.maximum(values, 0.0))
        return mixing

    def _correlate(self, scores: np.ndarray) -> None:
        """Correlate independent normal rows in place, then give each its own distribution."""
        rows = list(self.correlated)
        if not rows:
            return
        mixed = self._mixing @ scores[rows]
        for row, normal in zip(rows, mixed, strict=True):
            coordinate = self.coordinates[row]
            if coordinate.kind == "uniform":
                scores[row] = ndtr(normal)
            elif coordinate.lowest > NEVER:
                # 1 − Φ(z) = (1 − Φ(lowest)) (1 − Φ(normal)), written with Φ(−x) for the tail
                scores[row] = -ndtri(ndtr(-coordinate.lowest) * ndtr(-normal))
            else:
                scores[row] = normal


def _draw_normal(random: np.random.Generator, row: np.ndarray, lowest: float) -> None:
    """Fill a row with normal numbers, drawing those below ``lowest`` again."""
    random.standard_normal(out=row)
    if lowest <= NEVER:
        return
    while (below := np.flatnonzero(row < lowest)).size:
        row[below] = random.standard_normal(below.size)
