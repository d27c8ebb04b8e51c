"""Polynomials whose coefficients are numbers or arrays: products, determinants, signs on a cell.

Two forms. *Plain*: a list of coefficients in rising powers. *On a cell* [l, r]: the polynomial in
α = (r − x)/(r − l) and β = 1 − α, so that x = l α + r β and 1 = α + β; the list holds the
coefficients of αⁿ, αⁿ⁻¹β, …, βⁿ. Divided by binomials they are Bernstein's: the polynomial lies
between the least and the largest of them, and has as many roots in the cell as they change sign, or
an even number fewer (Descartes; Farouki, Comput. Aided Geom. Des. 29 (2012) 379-419). So no change
proves that there is no root, one that there is exactly one.

Everything works element by element, so that a coefficient may be an array of many problems.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import comb
from typing import TypeAlias

import numpy as np

from standfast.numerics.arrays import ROUNDOFF, Scalar, namespace

Polynomial: TypeAlias = list[Scalar]


def multiplied(p: Sequence[Scalar], q: Sequence[Scalar]) -> Polynomial:
    """Return the product, in either form."""
    product: list[Scalar | None] = [None] * (len(p) + len(q) - 1)
    for i, a in enumerate(p):
        for j, b in enumerate(q):
            before = product[i + j]
            product[i + j] = a * b if before is None else before + a * b
    return product


def squared(p: Sequence[Scalar]) -> Polynomial:
    """Return the square, in either form, with half of the multiplications."""
    square = []
    for k in range(2 * len(p) - 1):
        low = max(0, k - len(p) + 1)
        pairs = [p[i] * p[k - i] for i in range(low, (k + 1) // 2)]
        total: Scalar = 2.0 * sum(pairs[1:], pairs[0]) if pairs else None
        if k % 2 == 0:
            middle = p[k // 2] * p[k // 2]
            total = middle if total is None else total + middle
        square.append(total)
    return square


def added(p: Sequence[Scalar], q: Sequence[Scalar]) -> Polynomial:
    """Return the sum of two plain polynomials."""
    longer, shorter = (p, q) if len(p) >= len(q) else (q, p)
    return [a + b for a, b in zip(longer, shorter, strict=False)] + list(longer[len(shorter) :])


def subtracted(p: Sequence[Scalar], q: Sequence[Scalar]) -> Polynomial:
    """Return p − q, both plain."""
    return added(p, [-b for b in q])


def determinant(rows: Sequence[Sequence[Polynomial]]) -> Polynomial:
    """Return the determinant of a matrix of one to three rows of plain polynomials."""
    if len(rows) == 1:
        return list(rows[0][0])
    first, *others = rows
    if len(rows) == 2:
        (second,) = others
        return subtracted(multiplied(first[0], second[1]), multiplied(first[1], second[0]))
    total: Polynomial = []
    for column in range(3):
        after, last = (column + 1) % 3, (column + 2) % 3
        minor = determinant([[row[after], row[last]] for row in others])
        total = added(total, multiplied(first[column], minor))
    return total


def value_at(p: Sequence[Scalar], x: Scalar) -> Scalar:
    """Return a plain polynomial's value (Horner)."""
    total = p[-1]
    for coefficient in p[-2::-1]:
        total = total * x + coefficient
    return total


def all_roots(coefficients: np.ndarray) -> np.ndarray:
    """Return the complex roots of many plain polynomials, (degree + 1, many), as (many, degree).

    Eigenvalues of companion matrices; the highest coefficients are not 0.
    """
    degree, many = coefficients.shape[0] - 1, coefficients.shape[1]
    companion = np.zeros((many, degree, degree))
    companion[:, np.arange(1, degree), np.arange(degree - 1)] = 1.0
    companion[:, :, -1] = -(coefficients[:-1] / coefficients[-1]).T
    found: np.ndarray = np.linalg.eigvals(companion)
    return found


def elevated(p: Sequence[Scalar], degree: int) -> Polynomial:
    """Return a polynomial on a cell as one of a higher degree: times α + β = 1."""
    raised = list(p)
    while len(raised) <= degree:
        inner = [a + b for a, b in zip(raised[1:], raised[:-1], strict=True)]
        raised = [raised[0], *inner, raised[-1]]
    return raised


@dataclass(frozen=True, slots=True)
class OnCell:
    """A polynomial on a cell, with a bound of its Bernstein coefficients and of their errors.

    ``size`` bounds their absolute values, ``error`` what rounding did to them. A product's
    coefficients are weighted means of products, so both bounds multiply.
    """

    coefficients: Polynomial
    size: Scalar
    error: Scalar

    @classmethod
    def of(cls, plain: Sequence[Scalar], low: Scalar, high: Scalar) -> "OnCell":
        """Turn a plain polynomial to the cell [low, high], 0 ≤ low < high, by Horner's scheme."""
        cell, size = [plain[-1]], abs(plain[-1])
        for degree, coefficient in enumerate(plain[-2::-1], start=1):
            inner = [low * b + high * a for a, b in pairwise(cell)]
            by_x = [low * cell[0], *inner, high * cell[-1]]
            cell = [v + comb(degree, i) * coefficient for i, v in enumerate(by_x)]
            size = size * high + abs(coefficient)
        return cls(cell, size, 3.0 * len(plain) * ROUNDOFF * size).measured()

    def measured(self) -> "OnCell":
        """Return it with the size of the coefficients themselves, instead of a bound."""
        degree = len(self.coefficients) - 1
        xp = namespace(*self.coefficients)
        size = abs(self.coefficients[0])
        for i, coefficient in enumerate(self.coefficients[1:], start=1):
            size = xp.maximum(size, abs(coefficient) * (1.0 / comb(degree, i)))
        return OnCell(self.coefficients, size, self.error)

    def __add__(self, other: "OnCell") -> "OnCell":
        degree = max(len(self.coefficients), len(other.coefficients)) - 1
        pairs = zip(
            elevated(self.coefficients, degree), elevated(other.coefficients, degree), strict=True
        )
        size = self.size + other.size
        error = self.error + other.error + (degree + 1) * ROUNDOFF * size
        return OnCell([a + b for a, b in pairs], size, error)

    def __sub__(self, other: "OnCell") -> "OnCell":
        return self + OnCell([-b for b in other.coefficients], other.size, other.error)

    def __mul__(self, other: "OnCell") -> "OnCell":
        mine, theirs = self.coefficients, other.coefficients
        product = squared(mine) if other is self else multiplied(mine, theirs)
        size = self.size * other.size
        terms = min(len(mine), len(theirs)) + 2
        # both errors are far below the sizes, so that their product is below a rounding
        error = self.size * other.error + self.error * other.size + terms * ROUNDOFF * size
        return OnCell(product, size, error)

    def roots(self) -> Scalar:
        """Return how many roots lie inside the cell: 0 or 1 if that is proven, else 2.

        An end of the cell whose value rounding could have made 0 leaves it open.
        """
        degree = len(self.coefficients) - 1
        xp = namespace(*self.coefficients)
        # One that is within rounding of 0 may lie beside a change of sign, and nowhere else: two of
        # them could hide two more changes.
        known: Scalar = None
        sign, changes, open_ended = None, 0, False
        for i, coefficient in enumerate(self.coefficients):
            bound = comb(degree, i) * self.error
            up, down = coefficient > bound, coefficient < -bound
            before, known = known, up | down
            if sign is None:
                sign, open_ended = up, xp.logical_not(known)
                changes = 0 * xp.where(up, 1, 1)
                continue
            turned = known & (up != sign)
            open_ended = open_ended | xp.logical_not(before | turned)
            changes = changes + xp.where(turned, 1, 0)
            sign = xp.where(known, up, sign)
        return xp.where(open_ended | xp.logical_not(known) | (changes > 1), 2, changes)
