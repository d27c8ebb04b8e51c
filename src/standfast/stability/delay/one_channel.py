"""Crossings where all feedback goes through one channel: R = |q0|² − |q1|² with coefficients.

Of rank 1, R(x) of x = ω² has the degree 2n, and each of its coefficients is a short sum of products
of those of q0 and q1: it need not be put together anew on each cell, as of higher ranks, and the
root z = −q0/q1 is there at once. With it goes the polynomial S of the same products, all positive:
no rounding of R at x is larger than a few roundings of S(x).

    Search = R0 … R2n, S0 … S2n

notation: n free joints, a and b parts of q(iω) = a(ω²) + iω b(ω²), θ = ωτ the crossing's phase.
"""

from collections.abc import Sequence
from itertools import combinations
from typing import Any

from standfast.numerics.arrays import ROUNDOFF, TURN, Array, Scalar, namespace
from standfast.numerics.polynomials import (
    OnCell,
    Polynomial,
    added,
    squared,
    subtracted,
    value_at,
)
from standfast.stability.delay.resultant import parts

# Roundings that went into a coefficient of R, at most: 2(n + 1) of its products and four sums.
ROUNDINGS = 16
# Roundings of a minor of two by two whose terms cancel, in units of the larger term.
CANCELS = 8.0 * ROUNDOFF
# Newton's method from a narrowed bracket: the digits double each time.
POLISHING_STEPS = 4


def is_one_channel(problem: Any, gains: Array) -> Scalar:
    """Return whether P + D s is b (p + d s)ᵀ or (b + d s) pᵀ: minors of [P D] or [P; D] vanish.

    ``gains`` are P and D, (2, n, n, persons), whatever ``problem`` they belong to.
    """
    del problem
    rows = [[gains[k][i] for i in range(len(gains[k]))] for k in range(2)]
    joints = range(len(rows[0]))
    one = []
    for wide in (
        [[rows[k][i][j] for k in range(2) for j in joints] for i in joints],
        [[rows[k][j][i] for k in range(2) for j in joints] for i in joints],
    ):
        vanish: Scalar = True
        for a, b in combinations(joints, 2):
            for i, j in combinations(range(2 * len(joints)), 2):
                first, second = wide[a][i] * wide[b][j], wide[a][j] * wide[b][i]
                larger = namespace(first, second).maximum(abs(first), abs(second))
                vanish = vanish & (abs(first - second) <= CANCELS * larger)
        one.append(vanish)
    return one[0] | one[1]


def search_of(quasi: Sequence[Polynomial]) -> Polynomial:
    """Return the coefficients of R and then of S, both in rising powers of ω²."""
    (even, odd), (late, late_odd) = (parts(q) for q in quasi)
    positive = added(squared(even), [0.0, *squared(odd)])
    negative = added(squared(late), [0.0, *squared(late_odd)])
    sizes: Polynomial = []
    for part, shift in ((even, []), (odd, [0.0]), (late, []), (late_odd, [0.0])):
        sizes = added(sizes, [*shift, *squared([abs(c) for c in part])])
    return [*subtracted(positive, negative), *sizes]


def roots_on_cell(search: Sequence[Scalar], low: Scalar, high: Scalar) -> Scalar:
    """Return how many crossings have low < ω² < high: 0 or 1 where proven, else 2."""
    resultant, sizes = _halves(search)
    cell = OnCell.of(resultant, low, high)
    error = cell.error + ROUNDINGS * ROUNDOFF * value_at(sizes, high)
    return OnCell(cell.coefficients, cell.size, error).roots()


def resultant_at(search: Sequence[Scalar], x: Scalar) -> Scalar:
    """Return R/S at x = ω², between −1 and 1."""
    resultant, sizes = _halves(search)
    return value_at(resultant, x) / value_at(sizes, x)


def crossing_at(quasi: Sequence[Polynomial], x: Scalar) -> tuple[Scalar, Scalar, Scalar, Scalar]:
    """Return ω, θ, the direction and the last correction of the crossing at ω² ≈ x.

    Newton's method on R, from q0 and q1. The direction is the sign of dR/dx (Cooke & van den
    Driessche, Funkcial. Ekvac. 29 (1986) 77-90): where |q0| outgrows |q1| as ω rises, the root
    passes to the right as τ grows.
    """
    first, last = (parts(q) for q in quasi)
    change: Scalar = 0.0
    for _ in range(POLISHING_STEPS):
        square, slope = _square_at(first, x)
        late, late_slope = _square_at(last, x)
        change = (square - late) / (slope - late_slope)
        x = x - change
    xp = namespace(x)
    omega = xp.sqrt(x)
    direction = xp.sign(_square_at(first, x)[1] - _square_at(last, x)[1])
    (re, im), (late_re, late_im) = (
        (value_at(even, x), omega * value_at(odd, x)) for even, odd in (first, last)
    )
    # θ = −arg(−q0/q1)
    theta = xp.arctan2(im * late_re - re * late_im, -(re * late_re + im * late_im))
    return omega, xp.where(theta < 0.0, theta + TURN, theta), direction, abs(change) / x


def _square_at(q: tuple[Polynomial, Polynomial], x: Scalar) -> tuple[Scalar, Scalar]:
    """Return |q|² = a² + x b² and its slope along x."""
    (a, a_slope), (b, b_slope) = (_with_slope(part, x) for part in q)
    return a * a + x * (b * b), 2.0 * (a * a_slope + x * (b * b_slope)) + b * b


def _with_slope(p: Polynomial, x: Scalar) -> tuple[Scalar, Scalar]:
    return value_at(p, x), value_at([k * c for k, c in enumerate(p)][1:] or [0.0], x)


def _halves(search: Sequence[Scalar]) -> tuple[Sequence[Scalar], Sequence[Scalar]]:
    half = len(search) // 2
    return search[:half], search[half:]
