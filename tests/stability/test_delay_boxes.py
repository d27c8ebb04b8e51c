"""Crossings isolated in boxes of ω and θ: what boxes claim, and whom the resultant leaves open."""

import math

import numpy as np
import pytest

from delay_counts import counted, expanded, tops
from delay_oracles import crossings_by_pencil, polished_crossing
from delay_people import random_persons
from delay_scans import expected_inside, gaps, inside
from standfast.stability.delay import boxes, crossings
from standfast.stability.delay import problem as problems
from standfast.stability.delay.persons import all_crossings
from standfast.stability.delay.problem import Problem, directly

SEED = 20077
KINDS = ("one ratio", "modal")
PERSONS = 160
EQUAL = 1e-9
BOXES = 300  # a person


@pytest.fixture(scope="module")
def people():
    return random_persons(np.random.default_rng(SEED), PERSONS, KINDS, bodies=16)


@pytest.fixture(scope="module")
def table(people):
    return all_crossings(people.numbers, people.rigid)


def test_few_are_left_open(table):
    assert table.uncertain.sum() <= 2


def test_crossings_are_those_of_the_pencil(people, table):
    for person in np.flatnonzero(~table.uncertain)[:60]:
        matrices = people.matrices(person)
        mine = table.person == person
        ours = sorted(zip(table.frequency[mine], table.angle[mine], strict=True))
        theirs = [polished_crossing(matrices, *each) for each in crossings_by_pencil(matrices)]
        # the pencil finds z off the circle too where another lies on it
        assert len(ours) == len(theirs)
        for (omega, theta), (known, angle) in zip(ours, theirs, strict=True):
            assert omega == pytest.approx(known, rel=EQUAL)
            assert abs(math.remainder(theta - angle, math.tau)) < EQUAL


def test_no_crossing_is_missing_and_counts_are_right(people, table):
    coefficients, joints = expanded(people.numbers, people.rigid), people.free.sum(axis=0)
    person, omega = gaps(table, PERSONS, tops(coefficients, joints))
    there = people[person]
    number, sure = inside(there.numbers, there.rigid, omega)
    sure &= ~table.uncertain[person]
    assert np.array_equal(number[sure], expected_inside(table, person, omega)[sure])
    delay = np.random.default_rng(SEED).uniform(0.01, 0.5, PERSONS)
    found, certified = counted(coefficients, joints, delay)
    certified &= ~table.uncertain
    assert certified.sum() > 0.95 * PERSONS
    assert np.array_equal(found[certified], table.unstable_each(delay)[certified])


def prepared(kind, count):
    """Coefficients and bounds of persons of three free joints, and their known crossings."""
    people = random_persons(np.random.default_rng(SEED), count, (kind,), rigid_share=0.0)
    problem = Problem(3, 3)
    coefficients = directly(problems.prepared, problem, people.numbers)
    bound = directly(problems.highest, problem, people.numbers)
    known = []
    for person in range(count):
        matrices = people.matrices(person)
        known.append([polished_crossing(matrices, *c) for c in crossings_by_pencil(matrices)])
    return problem, coefficients, np.sqrt(bound), known


def test_the_resultant_alone_leaves_them_open(people, monkeypatch):
    def nothing(problem, coefficients, highest, apply):
        return np.zeros(0, np.intp), np.zeros((4, 0)), np.ones(highest.size, bool)

    monkeypatch.setattr(crossings, "isolated_in_boxes", nothing)
    found = all_crossings(people.numbers, people.rigid)
    one_ratio = (people.kind == "one ratio") & (people.free.sum(axis=0) > 1)
    assert found.uncertain[one_ratio].all()


@pytest.mark.parametrize("kind", ["one ratio", "full"])
def test_what_a_box_claims_holds(kind):
    rng = np.random.default_rng(SEED)
    problem, coefficients, highest, known = prepared(kind, 12)
    made = {boxes.NONE: 0, boxes.ONE: 0}
    for person, theirs in enumerate(known):
        # around crossings, with one of them near the edge, and anywhere
        sizes = 10.0 ** rng.uniform(-4.0, -0.3, BOXES)
        at = rng.integers(len(theirs), size=BOXES)
        omega, theta = np.array(theirs)[at].T
        anywhere = rng.random(BOXES) < 0.3
        omega = np.where(anywhere, highest[person] * rng.uniform(0.0, 0.5, BOXES), omega)
        low = omega * (1.0 - sizes * rng.uniform(-0.2, 1.0, BOXES))
        first = theta - sizes * rng.uniform(-0.2, 1.0, BOXES)
        rows = np.stack([low, low + sizes * omega, first, first + sizes])
        columns = np.repeat(coefficients[:, [person]], BOXES, axis=1)
        verdict, *_ = directly(boxes.boxed, problem, columns, rows)
        for box, said in zip(rows.T, verdict, strict=True):
            found = within(box, theirs, 1.0)
            if said == boxes.NONE:
                assert found == 0
            if said == boxes.ONE:
                assert within(box, theirs, boxes.LARGER) == 1
            if said in made:
                made[said] += 1
    assert min(made.values()) > BOXES


def within(box, known, larger):
    low, high, first, last = box
    middle, half = 0.5 * (low + high), 0.5 * larger * (high - low)
    return sum(
        abs(omega - middle) <= half
        and abs(math.remainder(theta - 0.5 * (first + last), math.tau))
        <= 0.5 * larger * (last - first)
        for omega, theta in known
    )


def test_without_the_rest_a_box_would_claim_too_much(monkeypatch):
    """The test above can fail: with ρ taken for 0, boxes are said to be empty that are not."""
    monkeypatch.setattr(boxes, "remainders", lambda sizes, h, t: (0.0 * h, 0.0 * h))
    with pytest.raises(AssertionError):
        test_what_a_box_claims_holds("full")
