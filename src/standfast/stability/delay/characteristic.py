"""The characteristic quasi-polynomial of standing with delayed feedback.

    A q̈ + B q̇ + C q = −P q(t − τ) − D q̇(t − τ),   Δ(s, z) = det(A s² + B s + C + (P + D s) z)

with z = e^(−sτ), s in 1/s. Δ = q0(s) + q1(s) z + … + qm(s) zᵐ has no τ in it: what crosses the
imaginary axis, and where, is found once for all delays.

notation: A inertia, B damping, C stiffness less gravity, P and D proportional and derivative gains
(rows: joint of the moment; columns: joint whose rotation is sensed), n free joints, m feedback's
rank. Matrices are nested lists of n × n numbers or arrays; of rigid joints they have no row.
"""

from collections.abc import Sequence
from itertools import product
from typing import NamedTuple, TypeAlias

from standfast.numerics.arrays import ROUNDOFF, Scalar, namespace
from standfast.numerics.polynomials import Polynomial, added, determinant, value_at

Square: TypeAlias = Sequence[Sequence[Scalar]]


class Matrices(NamedTuple):
    """The five matrices of the free joints, n × n each."""

    inertia: Square  # kg·m²
    damping: Square  # N·m·s/rad
    stiffness: Square  # N·m/rad, springs less gravity
    proportional: Square  # N·m/rad
    derivative: Square  # N·m·s/rad


def quasi_polynomial(matrices: Matrices, rank: int) -> list[Polynomial]:
    """Return q0 … qm in rising powers of s: the sum over which rows are those of the feedback.

    Of an n × n problem qk has the degree 2n − k. ``rank`` is m: qk of k > m are 0 and not made.
    """
    count = len(matrices.inertia)
    passive = [
        [
            [matrices.stiffness[i][j], matrices.damping[i][j], matrices.inertia[i][j]]
            for j in range(count)
        ]
        for i in range(count)
    ]
    active = [
        [[matrices.proportional[i][j], matrices.derivative[i][j]] for j in range(count)]
        for i in range(count)
    ]
    found: list[Polynomial] = [[] for _ in range(rank + 1)]
    for fed_back in product((False, True), repeat=count):
        order = sum(fed_back)
        if order <= rank:
            rows = [active[i] if fed_back[i] else passive[i] for i in range(count)]
            found[order] = added(found[order], determinant(rows))
    return found


def value(quasi: Sequence[Polynomial], s: Scalar, z: Scalar) -> Scalar:
    """Return Δ(s, z)."""
    return value_at([value_at(q, s) for q in quasi], z)


def undelayed(quasi: Sequence[Polynomial]) -> Polynomial:
    """Return Δ(s, 1), the polynomial of degree 2n without delay."""
    total: Polynomial = []
    for q in quasi:
        total = added(total, q)
    return total


def right_of_axis(polynomial: Polynomial) -> tuple[Scalar, Scalar]:
    """Return how many roots have a positive real part, and whether rounding leaves it open.

    Routh's array, its pivots with running bounds of their errors. A root on the axis makes a pivot
    0, and is left open.
    """
    xp = namespace(*polynomial)
    descending = polynomial[::-1]
    upper = [(c, 8.0 * ROUNDOFF * abs(c)) for c in descending[0::2]]
    lower = [(c, 8.0 * ROUNDOFF * abs(c)) for c in descending[1::2]]
    changes, uncertain = 0, abs(upper[0][0]) <= upper[0][1]
    while lower:
        (head, head_error), (pivot, pivot_error) = upper[0], lower[0]
        uncertain = uncertain | xp.logical_not(abs(pivot) > pivot_error)
        changes = changes + xp.where((pivot > 0.0) != (head > 0.0), 1, 0)
        safe = xp.where(pivot == 0.0, 1.0, pivot)
        ratio = head / safe
        ratio_error = (head_error + abs(ratio) * pivot_error) / abs(safe) * 1.5
        ratio_error = ratio_error + ROUNDOFF * abs(ratio)
        following = []
        for place, (above, above_error) in enumerate(upper[1:], start=1):
            if place < len(lower):
                entry, entry_error = lower[place]
                taken = ratio * entry
                error = abs(ratio) * entry_error + ratio_error * (abs(entry) + entry_error)
                error = error + above_error + 2.0 * ROUNDOFF * (abs(taken) + abs(above))
                following.append((above - taken, error))
            else:
                following.append((above, above_error))
        upper, lower = lower, following
    return changes, uncertain


def highest_crossing(matrices: Matrices) -> Scalar:
    """Return a bound of the angular frequencies of all crossings (rad/s).

    With everything scaled by the inverse Cholesky factor of A, a crossing v has
    ω² ≤ (‖C‖ + ‖P‖) + ω (‖B‖ + ‖D‖); here with Frobenius norms.
    """
    inverse = _inverse_cholesky(matrices.inertia)
    static = _scaled_norm(inverse, matrices.stiffness)
    static = static + _scaled_norm(inverse, matrices.proportional)
    rate = _scaled_norm(inverse, matrices.damping) + _scaled_norm(inverse, matrices.derivative)
    xp = namespace(static, rate)
    # by more than the bound itself is rounded, and above 0 also where nothing holds the person
    return (0.5 + 2.0**-20) * (rate + xp.sqrt(rate**2 + 4.0 * static)) + 1e-9


def _inverse_cholesky(matrix: Square) -> list[list[Scalar]]:
    """Return L⁻¹, lower triangular, of a symmetric positive definite matrix L Lᵀ."""
    count = len(matrix)
    xp = namespace(*(entry for row in matrix for entry in row))
    factor: list[list[Scalar]] = []
    for i in range(count):
        row: list[Scalar] = []
        for j in range(i + 1):
            rest = matrix[i][j] - sum(row[k] * (factor[j] if j < i else row)[k] for k in range(j))
            row.append(xp.sqrt(rest) if i == j else rest / factor[j][j])
        factor.append(row)
    inverse: list[list[Scalar]] = [[0.0] * count for _ in range(count)]
    for i in range(count):
        inverse[i][i] = 1.0 / factor[i][i]
        for j in range(i):
            total = sum(factor[i][k] * inverse[k][j] for k in range(j, i))
            inverse[i][j] = -total * inverse[i][i]
    return inverse


def _scaled_norm(inverse: list[list[Scalar]], matrix: Square) -> Scalar:
    """Return the Frobenius norm of L⁻¹ X L⁻ᵀ."""
    count = len(matrix)
    rows = range(count)
    half = [[sum(inverse[i][k] * matrix[k][j] for k in range(i + 1)) for j in rows] for i in rows]
    whole = [sum(half[i][k] * inverse[j][k] for k in range(j + 1)) for i in rows for j in rows]
    xp = namespace(*whole)
    return xp.sqrt(sum(entry**2 for entry in whole))
