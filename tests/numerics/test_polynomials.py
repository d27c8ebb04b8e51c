"""Polynomials on cells against exact fractions: values, honest errors, what is proven of roots."""

from fractions import Fraction
from math import comb

import numpy as np
import pytest

from standfast.numerics import polynomials
from standfast.numerics.polynomials import OnCell, determinant, value_at

SEED = 20071
VALUE = 1e-13  # relative to the sum of sizes: a few roundings of degree 6
POLYNOMIALS = 2000
NEAREST = 1e-9  # relative distance of the closest pairs of roots
# Errors seen are below 0.2 of the bound; if they never came near it, it would prove nothing.
REACHED = 0.02


def exact_on_cell(plain, low, high):
    """Coefficients of αⁿ⁻ⁱβⁱ by expanding Σ ak (lα + rβ)ᵏ (α + β)ⁿ⁻ᵏ in fractions."""
    low, high, degree = Fraction(low), Fraction(high), len(plain) - 1
    total = [Fraction(0)] * (degree + 1)
    for power, coefficient in enumerate(plain):
        term = [Fraction(coefficient)]
        for factor in [(low, high)] * power + [(1, 1)] * (degree - power):
            term = exact_product(term, factor)
        total = [a + b for a, b in zip(total, term, strict=True)]
    return total


def exact_product(p, q):
    product = [Fraction(0)] * (len(p) + len(q) - 1)
    for i, a in enumerate(p):
        for j, b in enumerate(q):
            product[i + j] += a * b
    return product


def exact_sum(p, q):
    while len(p) < len(q):
        p = exact_product(p, (1, 1))
    while len(q) < len(p):
        q = exact_product(q, (1, 1))
    return [a + b for a, b in zip(p, q, strict=True)]


def off(polynomial, exact):
    """Largest error of Bernstein's coefficients, relative to the bound that is claimed."""
    degree = len(exact) - 1
    errors = [
        abs(Fraction(float(c)) - e) / comb(degree, i)
        for i, (c, e) in enumerate(zip(polynomial.coefficients, exact, strict=True))
    ]
    sizes = [abs(e) / comb(degree, i) for i, e in enumerate(exact)]
    assert max(sizes) <= Fraction(float(polynomial.size)) * (1 + Fraction(VALUE))
    return float(max(errors) / Fraction(float(polynomial.error)))


def random_plain(rng, degree):
    # sizes of many orders, as those of characteristic polynomials are
    return rng.uniform(-1.0, 1.0, degree + 1) * 10.0 ** rng.uniform(-4.0, 6.0, degree + 1)


def cases(rng, count):
    for _ in range(count):
        low, high = np.sort(10.0 ** rng.uniform(-3.0, 3.0, 2))
        yield (0.0 if rng.random() < 0.3 else low), high


def test_a_value_on_a_cell_is_the_plain_polynomials():
    rng = np.random.default_rng(SEED)
    for low, high in cases(rng, 200):
        plain = random_plain(rng, rng.integers(0, 7))
        cell = OnCell.of(list(plain), low, high)
        x = rng.uniform(low, high)
        a = (high - x) / (high - low)
        degree = len(plain) - 1
        value = sum(c * a ** (degree - i) * (1 - a) ** i for i, c in enumerate(cell.coefficients))
        size = np.polyval(abs(plain)[::-1], high)
        assert abs(value - np.polyval(plain[::-1], x)) <= VALUE * size
        assert value_at(list(plain), x) == pytest.approx(
            np.polyval(plain[::-1], x), abs=VALUE * size
        )


def test_errors_on_a_cell_are_bounded_as_claimed():
    rng = np.random.default_rng(SEED)
    seen = [
        off(OnCell.of(list(plain), low, high), exact_on_cell(plain, low, high))
        for low, high in cases(rng, 300)
        for plain in [random_plain(rng, rng.integers(1, 5))]
    ]
    assert REACHED < max(seen) <= 1.0


def test_errors_of_sums_and_products_are_bounded_as_claimed():
    """The operations of the resultant in their order: squares, differences, products of those."""
    rng = np.random.default_rng(SEED + 1)
    seen = []
    for low, high in cases(rng, 60):
        plains = [random_plain(rng, degree) for degree in (3, 2, 2, 1)]
        p, q, r, s = (OnCell.of(list(plain), low, high) for plain in plains)
        ep, eq, er, es = (exact_on_cell(plain, low, high) for plain in plains)
        minus = lambda e: [-v for v in e]  # noqa: E731
        h, eh = p * p - r * r, exact_sum(exact_product(ep, ep), minus(exact_product(er, er)))
        u, eu = p * q - r * s, exact_sum(exact_product(ep, eq), minus(exact_product(er, es)))
        whole, exact = h * h + u * u, exact_sum(exact_product(eh, eh), exact_product(eu, eu))
        seen += [off(h, eh), off(u, eu), off(whole * h, exact_product(exact, eh))]
    assert 1e-3 * REACHED < max(seen) <= 1.0


def test_a_wrong_coefficient_exceeds_the_claimed_error():
    plain = [1.0, -3.0, 2.0]
    cell = OnCell.of(plain, 0.5, 3.0)
    wrong = OnCell(
        [*cell.coefficients[:2], cell.coefficients[2] * (1 + 1e-13)], cell.size, cell.error
    )
    assert off(cell, exact_on_cell(plain, 0.5, 3.0)) <= 1.0
    assert off(wrong, exact_on_cell(plain, 0.5, 3.0)) > 1.0


def sturm(plain, low, high):
    """How many distinct roots lie in (low, high], exactly."""
    first = [Fraction(c) for c in plain]
    chain = [first, [k * c for k, c in enumerate(first)][1:]]
    while any(chain[-1]):
        rest = list(chain[-2])
        divisor = trimmed(chain[-1])
        while len(trimmed(rest)) >= len(divisor) and any(rest):
            rest = trimmed(rest)
            ratio, shift = rest[-1] / divisor[-1], len(rest) - len(divisor)
            for place, c in enumerate(divisor):
                rest[place + shift] -= ratio * c
        chain.append([-c for c in trimmed(rest)])

    def changes(x):
        signs = [v > 0 for p in chain if any(p) and (v := value_at(p, Fraction(x))) != 0]
        return sum(a != b for a, b in zip(signs[1:], signs, strict=False))

    return changes(low) - changes(high)


def trimmed(p):
    p = list(p)
    while len(p) > 1 and p[-1] == 0:
        p.pop()
    return p


def with_close_roots(rng):
    """Coefficients with some roots on a cell, two of them often close; a cell around them."""
    roots = rng.uniform(0.5, 2.0, rng.integers(0, 4))
    if rng.random() < 0.6:
        first = rng.uniform(0.6, 1.9)
        roots = np.append(
            roots, [first, first * (1.0 + 10.0 ** rng.uniform(np.log10(NEAREST), -1.0))]
        )
    plain = np.array([rng.choice([-1.0, 1.0])])
    for root in roots:
        plain = np.convolve(plain, [-root, 1.0])
    if rng.random() < 0.7:
        # a pair of complex roots beside the axis
        middle, beside = rng.uniform(0.5, 2.0), 10.0 ** rng.uniform(-8.0, 0.0)
        plain = np.convolve(plain, [middle**2 + beside**2, -2.0 * middle, 1.0])
    low, high = np.sort(rng.uniform(0.4, 2.1, 2))
    return plain, low, high


def test_roots_are_never_claimed_wrongly():
    rng = np.random.default_rng(SEED)
    made = {0: 0, 1: 0, 2: 0}
    for _ in range(POLYNOMIALS):
        plain, low, high = with_close_roots(rng)
        found = int(OnCell.of(list(plain), low, high).roots())
        made[found] += 1
        if found < 2:
            assert found == sturm(plain, low, high), (plain, low, high)
    # the claims would be worth nothing if few were made
    assert made[0] > POLYNOMIALS / 10
    assert made[1] > POLYNOMIALS / 10


def close_pair(rng):
    """(x² + r²) − 2 r x − e on a cell with ends near r, where digits cancel; its roots there."""
    r = rng.integers(512, 2048) / 1024.0  # its square is exact
    e = rng.choice([-1.0, 1.0]) * 10.0 ** rng.uniform(-18.0, -4.0)
    low, high = r + 10.0 ** rng.uniform(-9.0, -1.0, 2) * rng.choice([(-1, 1), (1, 2), (-2, -1)])
    low, high = sorted((low, high))
    whole = OnCell.of([r * r, 0.0, 1.0], low, high) - OnCell.of([0.0, 2.0 * r], low, high)
    whole -= OnCell.of([e], low, high)
    known = 0
    for side in (-1, 1) if e > 0.0 else ():
        # r ± √e lies beyond a place where (place − r)² tells it
        beyond = [
            side * (Fraction(place) - Fraction(r)) < 0
            or (Fraction(place) - Fraction(r)) ** 2 < Fraction(e)
            for place in (low, high)
        ]
        known += beyond[0] != beyond[1]
    return whole, known


def claims(rng, error=1.0):
    """Wrong claims and claims at all, of close pairs, with a part of the errors."""
    wrong = made = 0
    for _ in range(POLYNOMIALS):
        cell, known = close_pair(rng)
        found = int(OnCell(cell.coefficients, cell.size, cell.error * error).roots())
        made += found < 2
        wrong += found < 2 and found != known
    return wrong, made


def test_close_pairs_are_never_claimed_wrongly():
    wrong, made = claims(np.random.default_rng(SEED))
    assert wrong == 0
    assert made > POLYNOMIALS / 4


def test_close_pairs_are_claimed_wrongly_without_errors():
    wrong, _ = claims(np.random.default_rng(SEED), error=0.0)
    assert wrong > 0


def test_two_coefficients_within_rounding_may_hide_two_roots():
    error, degree = 1e-10, 36
    scaled = [1.0, *[-0.99 * error] * (degree - 3), 0.99 * error, 0.99 * error, -1.0001 * error]
    coefficients = [comb(degree, i) * b for i, b in enumerate(scaled)]
    x = np.linspace(0.0, 1.0, 20001)
    value = sum(c * (1 - x) ** (degree - i) * x**i for i, c in enumerate(coefficients))
    assert np.count_nonzero(np.diff(np.sign(value))) == 3
    for kind in (float, np.atleast_1d):
        assert OnCell([kind(c) for c in coefficients], kind(1.0), kind(error)).roots() == 2


def test_one_coefficient_within_rounding_beside_a_change_hides_none():
    arrays = [np.array([c]) for c in (1.0, 1e-12, -1.0)]
    assert OnCell(arrays, np.ones(1), np.full(1, 1e-11)).roots() == 1
    same = [np.array([c]) for c in (1.0, 1e-12, 1.0)]
    assert OnCell(same, np.ones(1), np.full(1, 1e-11)).roots() == 2


@pytest.mark.parametrize("size", [1, 2, 3])
def test_determinants_of_polynomials(size):
    rng = np.random.default_rng(SEED)
    rows = rng.normal(size=(size, size, 3))
    plain = determinant([[list(entry) for entry in row] for row in rows])
    for x in rng.normal(size=5):
        known = np.linalg.det(np.polyval(rows.transpose(2, 0, 1)[::-1], x))
        assert value_at(plain, x) == pytest.approx(known, rel=1e-10)


def test_a_square_is_a_product_with_itself():
    rng = np.random.default_rng(SEED)
    for length in (1, 2, 3, 6):
        p = list(rng.normal(size=length))
        assert polynomials.squared(p) == pytest.approx(polynomials.multiplied(p, p), rel=1e-14)
