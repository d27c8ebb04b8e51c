"""The rightmost root against Chebyshev collocation, its proof against the argument principle."""

import numpy as np
import pytest

from delay_oracles import (
    delta,
    rightmost_by_collocation,
    roots_by_collocation,
    unstable_by_argument,
)
from delay_people import one_link, random_persons
from standfast.stability.delay.persons import all_rightmost
from standfast.stability.delay.rightmost import shifted

SEED = 20074
PERSONS = 210
LONGEST = 0.3  # s
EQUAL = 1e-9  # relative to 1 + |s|; the worst seen in 1,000 is 3e-14
BESIDE = 1e-6  # of the root: on which side of it the roots are counted


@pytest.fixture(scope="module")
def cases():
    rng = np.random.default_rng(SEED)
    people = random_persons(rng, PERSONS, rigid_share=0.9, bodies=16)
    delay = rng.uniform(0.0, LONGEST, PERSONS)
    delay[::10] = 0.0
    root, proven = all_rightmost(people.numbers, people.rigid, delay)
    return people, delay, root, proven


def test_every_root_is_proven(cases):
    _, _, root, proven = cases
    assert proven.all()
    assert (root.imag >= 0.0).all()
    # falling and standing are both there
    assert (root.real > 0.0).sum() > PERSONS / 10
    assert (root.real < 0.0).sum() > PERSONS / 10


def test_roots_are_those_of_collocation(cases):
    people, delay, root, _ = cases
    known = np.array([
        rightmost_by_collocation(people.matrices(number), delay[number])
        for number in range(PERSONS)
    ])  # fmt: skip
    assert (abs(root - known) <= EQUAL * (1.0 + abs(known))).all()
    # a gain that is off by a millionth would show
    number = int(np.argmax(abs(people.numbers[3, 0, 0]) * people.free[0]))
    matrices = people.matrices(number).copy()
    matrices[3, 0, 0] *= 1.0 + 1e-6
    moved = rightmost_by_collocation(matrices, delay[number])
    assert abs(moved - known[number]) > EQUAL * (1.0 + abs(known[number]))


def test_no_root_lies_right_of_it(cases):
    people, delay, root, _ = cases
    for number in range(0, PERSONS, 7):
        beside = BESIDE * (1.0 + abs(root[number]))
        matrices, at = people.matrices(number), root[number].real
        assert unstable_by_argument(matrices, delay[number], at + beside) == 0
        assert unstable_by_argument(matrices, delay[number], at - beside) > 0


def test_where_few_nodes_of_collocation_miss_it():
    """ωτ is 70: 12 nodes find other roots, the proof finds this one."""
    people = random_persons(np.random.default_rng(SEED), 12, ("undamped",), rigid_share=0.0)
    delay = np.full(12, 0.45)
    root, proven = all_rightmost(people.numbers, people.rigid, delay)
    assert proven.all()
    missed = 0
    for number in range(12):
        few = roots_by_collocation(people.matrices(number), delay[number], 12).real.max()
        missed += few < root[number].real - BESIDE
        right_of = root[number].real + BESIDE * (1.0 + abs(root[number]))
        assert unstable_by_argument(people.matrices(number), delay[number], right_of) == 0
    assert missed > 0


def test_the_matrices_of_a_shifted_line_have_the_same_roots_less_the_shift():
    people = random_persons(np.random.default_rng(SEED), 5, rigid_share=0.0)
    shift, delay = np.full(5, -0.7), np.full(5, 0.2)
    moved = shifted(people.numbers, delay, shift)
    for number in range(5):
        s = np.array([0.3 + 2.0j, -1.0 + 7.0j])
        known = delta(people.matrices(number), 0.2, s)
        found = delta(moved[..., number], 0.2, s + 0.7)
        assert found == pytest.approx(known, rel=1e-9)
        assert delta(moved[..., number], 0.2, s + 0.7001) != pytest.approx(known, rel=1e-9)


def test_without_delay_or_feedback():
    person = one_link(60.0, 600.0, stiffness=700.0, damping=30.0)
    root, proven = all_rightmost(person.numbers, person.rigid, np.array([0.1]))
    assert proven.all()
    assert root[0] == pytest.approx(complex(-0.25, np.sqrt(100.0 / 60.0 - 0.25**2)), rel=1e-12)
    rigid = np.ones((3, 1), bool)
    root, proven = all_rightmost(person.numbers, rigid, np.array([0.1]))
    assert proven.all()
    assert root[0].real == -np.inf
