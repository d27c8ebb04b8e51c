"""Feedback through one channel: R and S against fractions, cells against roots found apart."""

from fractions import Fraction

import numpy as np
import pytest

from standfast.numerics.arrays import ROUNDOFF
from standfast.stability.delay.one_channel import (
    ROUNDINGS,
    crossing_at,
    is_one_channel,
    resultant_at,
    roots_on_cell,
    search_of,
)
from standfast.stability.delay.problem import Problem

SEED = 1
JOINTS = 3
CASES = 400


@pytest.fixture(scope="module", params=[2, 3])
def quasi(request):
    """Return q0 of degree 2n and q1 of degree 2n − 1, of many cases."""
    rng = np.random.default_rng(SEED + request.param)
    first = rng.normal(size=(2 * request.param + 1, CASES))
    last = rng.normal(size=(2 * request.param, CASES)) * rng.uniform(0.3, 3.0, CASES)
    return [list(first), list(last)]


def exactly(quasi, case, x):
    """Return |q0|² − |q1|² at ω² = x in fractions."""
    values = []
    for q in quasi:
        even = sum(Fraction(c[case]) * (-x) ** k for k, c in enumerate(q[0::2]))
        odd = sum(Fraction(c[case]) * (-x) ** k for k, c in enumerate(q[1::2]))
        values.append(even**2 + x * odd**2)
    return values[0] - values[1]


def test_rounding_of_the_resultant_is_below_its_bound(quasi):
    search = search_of(quasi)
    half = len(search) // 2
    for case in range(0, CASES, 7):
        coefficients = [Fraction(float(c[case])) for c in search]
        for x in (Fraction(1, 64), Fraction(3, 8), Fraction(5, 2)):
            found, size = (
                sum(c * x**k for k, c in enumerate(part))
                for part in (coefficients[:half], coefficients[half:])
            )
            exact = exactly(quasi, case, x)
            assert abs(found - exact) <= ROUNDINGS * Fraction(ROUNDOFF) * size
            assert abs(exact) <= size * (1 + Fraction(ROUNDINGS * ROUNDOFF))
            scaled = float(resultant_at([float(c) for c in coefficients], float(x)))
            # both Horner's schemes round less than that of what they sum
            assert scaled == pytest.approx(float(exact / size), abs=64 * ROUNDOFF)


def test_a_proof_on_a_cell_is_right(quasi):
    search = np.array(search_of(quasi))
    rng = np.random.default_rng(SEED)
    low = rng.uniform(0.0, 3.0, CASES) * (rng.random(CASES) < 0.8)
    high = low + rng.uniform(0.01, 3.0, CASES)
    found = roots_on_cell(search, low, high)
    for case in range(CASES):
        roots = np.roots(search[: len(search) // 2, case][::-1])
        real = roots.real[abs(roots.imag) < 1e-9]
        inside = np.count_nonzero((low[case] < real) & (real < high[case]))
        assert found[case] in (inside, 2)
    # both proofs occur, and neither is all there is
    assert {0, 1, 2} == set(found.tolist())


def test_a_crossing_lies_on_the_circle_and_goes_where_the_root_goes(quasi):
    search = np.array(search_of(quasi))
    checked = 0
    for case in range(CASES):
        roots = np.roots(search[: len(search) // 2, case][::-1])
        for x in roots.real[(abs(roots.imag) < 1e-9) & (roots.real > 1e-3)]:
            own = [[c[case] for c in q] for q in quasi]
            omega, theta, direction, correction = crossing_at(own, x * (1.0 + 1e-5))
            if not correction < 1e-9:  # two crossings so near that Newton's method is slow
                continue
            delay = theta / omega
            q0, q1 = (np.polynomial.Polynomial(q) for q in own)
            assert abs(q0(1j * omega) + q1(1j * omega) * np.exp(-1j * theta)) < 1e-8 * abs(
                q0(1j * omega)
            )
            # the root a little later, by Newton's method on the quasi-polynomial itself
            later, s = delay * (1.0 + 1e-5) + 1e-6, 1j * omega
            for _ in range(30):
                z = np.exp(-s * later)
                slope = q0.deriv()(s) + (q1.deriv()(s) - later * q1(s)) * z
                s = s - (q0(s) + q1(s) * z) / slope
            if abs(s - 1j * omega) < 0.01 * omega:
                assert np.sign(s.real) == direction
                checked += 1
    assert checked > CASES / 2


def test_one_channel_is_told_from_more():
    rng = np.random.default_rng(SEED)
    column, rows = rng.normal(size=(JOINTS, 1)), rng.normal(size=(2, 1, JOINTS))
    sensed = np.stack([column @ rows[0], column @ rows[1]])  # b (p + d s)ᵀ
    acted = sensed.swapaxes(1, 2)  # (b + d s) pᵀ
    changed = sensed.copy()
    changed[1, 0, 2] *= 1.0 + 1e-12
    diagonal = np.stack([np.eye(JOINTS), 2.0 * np.eye(JOINTS)])
    gains = np.stack([sensed, acted, changed, diagonal], axis=-1)
    found = is_one_channel(Problem(JOINTS, JOINTS), gains)
    assert found.tolist() == [True, True, False, False]
