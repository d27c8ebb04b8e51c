"""The characteristic quasi-polynomial, its roots without delay, the bound and the resultant."""

import numpy as np
import pytest

from delay_oracles import crossings_by_pencil, delta
from delay_people import random_persons
from standfast.stability.delay import resultant as resultants
from standfast.stability.delay.characteristic import (
    Matrices,
    highest_crossing,
    quasi_polynomial,
    right_of_axis,
    undelayed,
    value,
)

SEED = 20072
# det of LAPACK and the sum over minors: some roundings of terms larger than what is left
DETERMINANT = 1e-10
# the product over roots z loses digits where one is near the circle, or far away
PRODUCT = 1e-7
POLYNOMIALS = 4000
NEAR_AXIS = 1e-9  # relative, where numpy.roots does not tell sides


def people(size=60):
    return random_persons(np.random.default_rng(SEED), size, bodies=8)


def of_person(persons, number):
    matrices = persons.matrices(number)
    return matrices, Matrices(*matrices.tolist())


@pytest.mark.parametrize("place", [None, (0, 0, 0), (1, 0, 0), (2, 0, 0), (3, 0, 0), (4, 0, 0)])
def test_the_quasi_polynomial_is_the_determinant(place):
    rng = np.random.default_rng(SEED)
    persons = people(21)
    for number in range(21):
        matrices, rows = of_person(persons, number)
        quasi = quasi_polynomial(rows, len(matrices[0]))
        if place is not None:
            # an entry that is off by a millionth of the largest breaks it
            matrices = matrices.copy()
            matrices[place] += 1e-6 * abs(matrices[place[0]]).max() + 1e-6
        s = rng.normal(size=4) + 1j * rng.normal(0.0, 5.0, 4)
        delay = rng.uniform(0.0, 0.5)
        known = delta(matrices, delay, s)
        found = np.array([value(quasi, each, np.exp(-each * delay)) for each in s])
        equal = np.allclose(found, known, rtol=DETERMINANT, atol=0.0)
        assert equal == (place is None)


def test_of_lower_rank_higher_powers_of_z_are_absent():
    rng = np.random.default_rng(SEED)
    persons = random_persons(rng, 20, ("one channel",), rigid_share=0.0)
    for number in range(20):
        matrices, rows = of_person(persons, number)
        quasi = quasi_polynomial(rows, 1)
        assert [len(q) for q in quasi] == [7, 6]
        s = 0.3 + 2.0j
        known = delta(matrices, 0.2, s)
        assert value(quasi, s, np.exp(-0.2 * s)) == pytest.approx(known, rel=1e-8)


def routh_cases(rng):
    for _ in range(POLYNOMIALS):
        degree = 2 * rng.integers(1, 4)
        roots = []
        while len(roots) < degree:
            size = 10.0 ** rng.uniform(-1.0, 2.0)
            if rng.random() < 0.5 or len(roots) == degree - 1:
                roots.append(size * rng.choice([-1.0, -1.0, 1.0]))
            else:
                beside = rng.choice([-1.0, -1.0, 1.0]) * 10.0 ** rng.uniform(-12.0, 0.0)
                roots += [size * complex(beside, 1.0), size * complex(beside, -1.0)]
        plain = np.poly(roots).real[::-1]
        yield plain * 10.0 ** rng.uniform(-2.0, 2.0), np.array(roots)


def test_roots_right_of_the_axis_are_those_of_numpy():
    certain = near = 0
    for plain, _ in routh_cases(np.random.default_rng(SEED)):
        count, uncertain = right_of_axis(list(plain))
        found = np.roots(plain[::-1])
        clear = (abs(found.real) > NEAR_AXIS * abs(found).max()).all()
        near += not clear
        if not uncertain:
            certain += 1
            assert count == (found.real > 0.0).sum() or not clear
        # far from the axis nothing is left open
        assert not uncertain or (abs(found.real) < 1e-6 * abs(found).max()).any()
    assert certain > 0.7 * POLYNOMIALS
    assert near > 0.05 * POLYNOMIALS


def test_roots_right_of_the_axis_change_with_one_sign():
    assert right_of_axis([2.0, 3.0, 1.0]) == (0, False)
    assert right_of_axis([-2.0, 3.0, 1.0]) == (1, False)
    assert right_of_axis([2.0, -3.0, 1.0]) == (2, False)
    _, uncertain = right_of_axis([2.0, 0.0, 1.0])
    assert uncertain


def test_no_crossing_lies_above_the_bound():
    persons = people(80)
    parts = []
    for number in range(80):
        matrices, rows = of_person(persons, number)
        crossings = crossings_by_pencil(matrices)
        if crossings:
            parts.append(crossings[-1][0] / float(highest_crossing(rows)))
    assert max(parts) < 1.0
    # and it is no idle one: a tenth of it would not do
    assert max(parts) > 0.1


def product_formula(q):
    """∏(1 − |zi|²) ∏|1 − zi z̄j|² |qm|^2m of the roots zi of q0 + … + qm zᵐ, up to a sign."""
    z = np.roots(q[::-1])
    m = len(z)
    pairs = [abs(1.0 - z[i] * z[j].conj()) ** 2 for i in range(m) for j in range(i)]
    return np.prod(1.0 - abs(z) ** 2) * np.prod(pairs) * abs(q[-1]) ** (2 * m)


@pytest.mark.parametrize("rank", [2, 3])
def test_the_resultant_is_the_product_over_roots(rank):
    rng = np.random.default_rng(SEED)
    signs, broken = set(), []
    for _ in range(300):
        q = rng.normal(size=rank + 1) + 1j * rng.normal(size=rank + 1)
        x = rng.uniform(0.1, 4.0)
        on_axis = [resultants.OnAxis(c.real, c.imag / np.sqrt(x)) for c in q]
        found = resultants.resultant(on_axis, x)
        known = product_formula(q) * (-1.0) ** rank
        scale = abs(q).max() ** (2 * rank)
        assert abs(abs(found) - abs(known)) < PRODUCT * scale
        # the sign, which tells sides, is one and the same
        if abs(known) > PRODUCT * scale:
            signs.add(np.sign(found / known))
            conjugated = [on_axis[0], *(c._replace(odd=-c.odd) for c in on_axis[1:])]
            broken.append(abs(resultants.resultant(conjugated, x) - found) > PRODUCT * scale)
    assert len(signs) == 1
    assert np.mean(broken) > 0.9


def test_without_delay_z_is_one():
    matrices, rows = of_person(people(7), 1)
    quasi = quasi_polynomial(rows, len(matrices[0]))
    s = 0.4 + 1.5j
    whole = undelayed(quasi)
    assert np.polyval(whole[::-1], s) == pytest.approx(delta(matrices, 0.0, s), rel=1e-9)
