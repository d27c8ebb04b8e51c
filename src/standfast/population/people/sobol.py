"""Scrambled Sobol sequences, block by block.

Points in natural order: x_n is the exclusive or of the direction numbers of n's bits. So a block is
one fixed table, or-ed with one number a block. SciPy's generator goes through all points before a
block, 0.03 s for 2²³ of them, as long as four blocks of persons take; so blocks are made here, and
SciPy is what the tests compare with. Scrambling: a random lower triangular matrix of bits
(Matoušek, J Complexity 14 (1998) 527-556) and a random digital shift, 52 bits.
"""

from functools import lru_cache

import numpy as np

# Independent scramblings of a quasi-Monte Carlo run: the interval is Student's t of their spread.
REPLICATES = 16
LARGEST_BLOCK = 2**17
DIGITS = 52  # (x + ½) / 2⁵² is exact in float64 and neither 0 nor 1
INDEX_BITS = 32
CACHE_LINE = 64  # bytes
STREAM = 1  # of a seed, whose plain random numbers are stream 0

PLACES = np.arange(INDEX_BITS - 1, -1, -1, dtype=np.uint64)  # of an index's bits, first digit first

# S. Joe and F. Y. Kuo, SIAM J Sci Comput 30 (2008) 2635-2654, new-joe-kuo-6, dimensions 2 to 64:
# coefficients of the primitive polynomial : the initial numbers m (as many as its degree).
JOE_KUO = """
0:1  1:1,3  1:1,3,1  2:1,1,1  1:1,1,3,3  4:1,3,5,13  2:1,1,5,5,17  4:1,1,5,5,5  7:1,1,7,11,19
11:1,1,5,1,1  13:1,1,1,3,11  14:1,3,5,5,31  1:1,3,3,9,7,49  13:1,1,1,15,21,21  16:1,3,1,13,27,49
19:1,1,1,15,7,5  22:1,3,1,15,13,25  25:1,1,5,5,19,61  1:1,3,7,11,23,15,103  4:1,3,7,13,13,15,69
7:1,1,3,13,7,35,63  8:1,3,5,9,1,25,53  14:1,3,1,13,9,35,107  19:1,3,1,5,27,61,31
21:1,1,5,11,19,41,61  28:1,3,5,3,3,13,69  31:1,1,7,13,1,19,1  32:1,3,7,5,13,19,59
37:1,1,3,9,25,29,41  41:1,3,5,13,23,1,55  42:1,3,7,3,13,59,17  50:1,3,1,3,5,53,69
55:1,1,5,5,23,33,13  56:1,1,7,7,1,61,123  59:1,1,7,9,13,61,49  62:1,3,3,5,3,55,33
14:1,3,1,15,31,13,49,245  21:1,3,5,15,31,59,63,97  22:1,3,1,11,11,11,77,249
38:1,3,1,11,27,43,71,9  47:1,1,7,15,21,11,81,45  49:1,3,7,3,25,31,65,79  50:1,3,1,1,19,11,3,205
52:1,1,5,9,19,21,29,157  56:1,3,7,11,1,33,89,185  67:1,3,3,3,15,9,79,71  70:1,3,7,11,15,39,119,27
84:1,1,3,1,11,31,97,225  97:1,1,1,3,23,43,57,177  103:1,3,7,7,17,17,37,71
115:1,3,1,5,27,63,123,213  122:1,1,3,5,11,43,53,133  8:1,3,5,5,29,17,47,173,479
13:1,3,3,11,3,1,109,9,69  16:1,1,1,5,17,39,23,5,343  22:1,3,1,5,25,15,31,103,499
25:1,1,1,11,11,17,63,105,183  44:1,1,5,11,9,29,97,231,363  47:1,1,5,15,19,45,41,7,383
52:1,3,7,7,31,19,83,137,221  55:1,1,1,3,23,15,111,223,83  59:1,1,5,13,31,15,55,25,161
62:1,1,3,13,25,47,39,87,257
"""


@lru_cache(maxsize=1)
def direction_numbers() -> np.ndarray:
    """Return the direction numbers (64, 32) of Sobol's sequence: bit 31 is the first digit."""
    entries = JOE_KUO.split()
    table = np.ones((1 + len(entries), INDEX_BITS), np.uint64)
    for row, entry in zip(table[1:], entries, strict=True):
        polynomial, initial = entry.split(":")
        coefficients, m = int(polynomial), [int(number) for number in initial.split(",")]
        degree = len(m)
        for i in range(degree, INDEX_BITS):
            new = m[i - degree] ^ (m[i - degree] << degree)
            for k in range(1, degree):
                if (coefficients >> (degree - 1 - k)) & 1:
                    new ^= m[i - k] << k
            m.append(new)
        row[:] = m
    return table << PLACES


@lru_cache(maxsize=8)
def scrambled_directions(seed: int, replicate: int, dimensions: int) -> tuple[np.ndarray, ...]:
    """Return scrambled direction numbers (d, 32) of 52 bits, and a shift for each dimension."""
    sequence = np.random.SeedSequence([seed, STREAM, replicate])
    random = np.random.Generator(np.random.SFC64(sequence))
    plain = direction_numbers()[:dimensions]
    digits = (plain[:, :, None] >> PLACES) & np.uint64(1)
    lower = np.tril(random.integers(0, 2, (dimensions, DIGITS, INDEX_BITS), np.uint64), -1)
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

    Such arrays XLA reads where they lie; others it copies. With two threads a core
    (:mod:`standfast.population.simulation`) persons are counted 1.2 times as fast.
    """
    count = rows * size
    memory = np.empty(count + CACHE_LINE // 8)
    first = -(memory.ctypes.data // 8) % (CACHE_LINE // 8)
    return memory[first : first + count].reshape(rows, size)
