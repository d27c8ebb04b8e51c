"""Characteristic roots from the right: against the proof, an oracle's count, and eigenvalues."""

from functools import cache

import numpy as np
import pytest

import standfast as sf
from delay_oracles import delta, unstable_by_argument
from delay_people import one_link, random_persons
from standfast.stability.delay.persons import all_rightmost
from standfast.stability.delay.spectrum import roots_from_the_right, shape_at

# Newton's method ends within rounding of a simple root; what is left is the root's condition.
SAME_ROOT = 1e-8
ROUNDED = 1e-8  # of a root, relative to the terms of the equation
DELAYS = (0.0, 0.02, 0.1, 0.2, 0.4)


@pytest.fixture(scope="module")
def people():
    rng = np.random.default_rng(14)
    persons = random_persons(rng, 60)
    return persons, rng.choice(DELAYS, 60)


@pytest.fixture(scope="module")
def roots_of(people):
    """The roots of one of the people by number, found once for all tests."""
    persons, delay = people
    return cache(lambda person: roots_from_the_right(persons.matrices(person), delay[person]))


def test_the_first_is_the_rightmost_that_is_proven():
    rng = np.random.default_rng(15)
    persons, delay = random_persons(rng, 10, ("diagonal", "one channel")), rng.choice(DELAYS, 10)
    root, proven = all_rightmost(persons.numbers, persons.rigid, delay)
    assert proven.all()
    for person in range(delay.size):
        first = roots_from_the_right(persons.matrices(person), delay[person])[0]
        assert abs(first - root[person]) <= SAME_ROOT * (1.0 + abs(first)), person


def test_none_lies_right_of_the_first(people, roots_of):
    persons, delay = people
    for person in range(0, delay.size, 5):
        matrices = persons.matrices(person)
        first = roots_of(person)[0]
        near = 1e-6 * (1.0 + abs(first))
        assert unstable_by_argument(matrices, delay[person], first.real + near) == 0, person
        assert unstable_by_argument(matrices, delay[person], first.real - near) > 0, person


def test_none_is_missing_between_the_first_and_the_last(people, roots_of):
    persons, delay = people
    late = np.flatnonzero(delay > 0.0)[:5]
    for person in late.tolist():
        matrices = persons.matrices(person)
        roots = roots_of(person)
        count = np.where(roots.imag > 0.0, 2, 1).sum()
        line = roots[-1].real - 1e-6 * (1.0 + abs(roots[-1]))
        assert unstable_by_argument(matrices, delay[person], line) == count, person


def test_without_delay_they_are_all_eigenvalues(people):
    persons, delay = people
    for person in np.flatnonzero(delay == 0.0):
        a, b, c, p, d = persons.matrices(person)
        n = len(a)
        first_order = np.block(
            [
                [np.zeros((n, n)), np.eye(n)],
                [-np.linalg.solve(a, c + p), -np.linalg.solve(a, b + d)],
            ]
        )
        expected = np.linalg.eigvals(first_order)
        found = roots_from_the_right(persons.matrices(person), 0.0)
        every = np.concatenate([found, found[found.imag > 0.0].conj()])
        assert every.size == 2 * n
        for root in expected:
            assert np.abs(every - root).min() <= 1e-6 * (1.0 + abs(root)), person


def test_they_are_sorted_and_none_is_twice(people):
    persons, delay = people
    for person in range(0, delay.size, 7):
        roots = roots_from_the_right(persons.matrices(person), delay[person], most=9)
        assert 1 <= roots.size <= 9
        assert (np.diff(roots.real) <= 0.0).all()
        assert (roots.imag >= 0.0).all()
        assert np.unique(np.round(roots, 6)).size == roots.size


def test_a_shape_solves_the_equation_and_its_largest_rotation_is_1(people, roots_of):
    persons, delay = people
    for person in range(0, delay.size, 5):
        a, b, c, p, d = matrices = persons.matrices(person)
        s = complex(roots_of(person)[0])
        shape = shape_at(matrices, delay[person], s)
        whole = a * s**2 + b * s + c + (p + d * s) * np.exp(-s * delay[person])
        terms = (a * s**2, b * s, c, (abs(p) + abs(d * s)) * abs(np.exp(-s * delay[person])))
        scale = sum(np.abs(term).max() for term in terms)
        assert np.abs(whole @ shape).max() <= ROUNDED * scale, person
        assert np.abs(shape).max() == pytest.approx(1.0, abs=1e-15)
        assert shape[np.argmax(np.abs(shape))] == pytest.approx(1.0, abs=1e-15)


def test_a_rightmost_root_beyond_the_points_is_among_them():
    # a stiff joint that rings on a long delay: 191 rad/s and 4 s are 120 turns
    person = one_link(70.0, 700.0, stiffness=2.6e6, proportional=2e4)
    root, proven = all_rightmost(person.numbers, person.rigid, np.array([4.0]))
    assert proven[0]
    assert root[0].imag > 180.0
    found = roots_from_the_right(person.matrices(0), 4.0, rightmost=complex(root[0]))
    assert found[0] == root[0]


def test_a_pendulum_of_known_roots():
    # s² + 2 s + 2 = 0
    matrices = one_link(1.0, 0.0, stiffness=2.0, damping=2.0).matrices(0)
    assert roots_from_the_right(matrices, 0.0) == pytest.approx([-1.0 + 1.0j])
    # nothing moves
    assert roots_from_the_right(np.zeros((5, 0, 0)), 0.1).size == 0


def test_another_delay_would_be_noticed():
    matrices = one_link(70.0, 700.0, proportional=900.0, derivative=300.0).matrices(0)
    (root, *_) = roots_from_the_right(matrices, 0.1)
    size = abs(delta(matrices, 0.1, 2.0 * root))
    assert abs(delta(matrices, 0.1, root)) < 1e-12 * size
    assert abs(delta(matrices, 0.1001, root)) > 1e-6 * size


def test_the_public_rightmost_root_is_among_them():
    body = sf.Body.from_height_mass(1.7, 70.0)
    stiffness = sf.Stiffness(500.0, 1500.0, 400.0)
    late = sf.Feedback([600.0, 100.0, 100.0], [200.0, 20.0, 20.0], 0.12)
    root = sf.rightmost_root(body, stiffness, damping=[10.0, 5.0, 5.0], feedback=late)
    numbers = np.array([
        sf.inertia_matrix(body),
        np.diag([10.0, 5.0, 5.0]),
        sf.stiffness_matrix(body, stiffness),
        late.proportional,
        late.derivative,
    ])  # fmt: skip
    assert roots_from_the_right(numbers, 0.12)[0] == pytest.approx(root, rel=SAME_ROOT)
