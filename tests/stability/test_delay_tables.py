"""Tables of crossings of persons of every kind, against pencil, eigenvalues and argument counts."""

import math

import numpy as np
import pytest

from delay_counts import counted, expanded, tops
from delay_oracles import crossings_by_pencil, polished_crossing, unstable_by_argument
from delay_people import KINDS, of_matrices, one_link, random_persons
from delay_scans import expected_inside, gaps, inside, inverse_roots
from standfast.stability.delay.persons import all_crossings
from standfast.stability.delay.table import Crossings

SEED = 20073
PERSONS = 1400  # of all kinds, in one batch with rigid joints
BY_PENCIL = 84
EQUAL = 1e-9  # ω relative, θ in rad; the worst seen in 100,000 crossings is 1e-12
ON_CIRCLE = 1e-8  # distance of an eigenvalue from e^(iθ); the worst seen is 1e-12
BESIDE = 1e-6  # of the critical delay
LATER = 1.2  # s


@pytest.fixture(scope="module")
def people():
    return random_persons(np.random.default_rng(SEED), PERSONS, bodies=24)


@pytest.fixture(scope="module")
def table(people):
    found = all_crossings(people.numbers, people.rigid)
    # random persons leave nothing open
    assert not found.uncertain.any()
    return found


def counts(people, who, delay):
    coefficients, joints = expanded(people.numbers, people.rigid), people.free.sum(axis=0)
    found, certified = counted(coefficients[..., who], joints[who], delay)
    assert certified.all()
    return found


def with_changed(table, **columns):
    kept = {name: getattr(table, name) for name in Crossings.__dataclass_fields__}
    return Crossings(**(kept | columns))


def test_crossings_are_those_of_the_pencil(people, table):
    for person in range(BY_PENCIL):
        matrices = people.matrices(person)
        mine = table.person == person
        ours = sorted(zip(table.frequency[mine], table.angle[mine], strict=True))
        theirs = [polished_crossing(matrices, *each) for each in crossings_by_pencil(matrices)]
        assert len(ours) == len(theirs)
        for (omega, theta), (known, angle) in zip(ours, theirs, strict=True):
            assert omega == pytest.approx(known, rel=EQUAL)
            assert abs(math.remainder(theta - angle, math.tau)) < EQUAL


def test_at_every_crossing_a_root_z_lies_on_the_circle(people, table):
    there = people[table.person]

    def away(omega, theta):
        roots = inverse_roots(there.numbers, there.rigid, omega)
        return abs(roots - np.exp(1j * theta)[:, None]).min(axis=1)

    assert away(table.frequency, table.angle).max() < ON_CIRCLE
    assert np.median(away(table.frequency * (1.0 + 1e-6), table.angle)) > ON_CIRCLE
    assert np.median(away(table.frequency, -table.angle)) > ON_CIRCLE


def test_no_crossing_is_missing(people, table):
    top = tops(expanded(people.numbers, people.rigid), people.free.sum(axis=0))
    person, omega = gaps(table, PERSONS, top)
    there = people[person]
    number, sure = inside(there.numbers, there.rigid, omega)
    # of one ratio, two z of one size cross at one ω; between them both lie on the circle
    assert sure.mean() > 0.999
    person, omega, number = person[sure], omega[sure], number[sure]
    assert np.array_equal(number, expected_inside(table, person, omega))
    # without one of them, or with one turned round, it shows
    rest = np.arange(table.person.size) != 5
    names = ("person", "frequency", "angle", "direction")
    less = with_changed(table, **{name: getattr(table, name)[rest] for name in names})
    assert not np.array_equal(number, expected_inside(less, person, omega))
    turned = with_changed(table, direction=np.where(rest, 1.0, -1.0) * table.direction)
    assert not np.array_equal(number, expected_inside(turned, person, omega))


@pytest.mark.parametrize("longest", [0.0, 0.5, LATER])
def test_counts_at_random_delays(people, table, longest):
    rng = np.random.default_rng(SEED)
    who = np.arange(PERSONS)[:: 1 if longest < 1.0 else 4]
    delay = rng.uniform(0.4 if longest > 0.5 else 0.0, longest, who.size)
    each = np.zeros(PERSONS)
    each[who] = delay
    found = counts(people, who, delay)
    assert np.array_equal(table.unstable_each(each)[who], found)
    if longest:
        turned = with_changed(table, direction=-table.direction)
        assert not np.array_equal(turned.unstable_each(each)[who], found)


def test_stability_is_lost_at_the_critical_delay(people, table):
    critical = table.critical_delay()
    who = np.flatnonzero((critical > 0.0) & (critical < LATER))
    assert who.size > PERSONS / 4
    assert (counts(people, who, critical[who] * (1.0 - BESIDE)) == 0).all()
    assert (counts(people, who, critical[who] * (1.0 + BESIDE)) > 0).all()


def test_stable_windows_lie_beyond_the_critical_delay(people, table):
    delays = np.linspace(0.0, LATER, 241)
    stable, critical = table.stable_at(delays), table.critical_delay()
    later = stable & (delays > critical[:, None] * (1.0 + BESIDE)) & (critical > 0.0)[:, None]
    who, where = np.nonzero(later & (np.cumsum(later, axis=1) == 1))
    assert who.size > PERSONS / 50
    assert (counts(people, who, delays[where]) == 0).all()


def test_verdicts_along_the_axis_are_those_one_by_one(table):
    delays = np.sort(np.random.default_rng(SEED).uniform(0.0, LATER, 50))
    along = table.unstable_at(delays)
    for number, delay in enumerate(delays):
        assert np.array_equal(along[:, number], table.unstable_each(np.full(PERSONS, delay)))
    assert np.array_equal(table.stable_at(delays), along == 0)


def test_batches_do_not_change_a_person(people, table):
    chosen = np.random.default_rng(SEED).permutation(PERSONS)[:100]
    some = people[chosen]
    alone = all_crossings(some.numbers, some.rigid)
    order = np.argsort(chosen)
    back = np.full(PERSONS, -1)
    back[chosen] = np.arange(chosen.size)
    mine = np.isin(table.person, chosen)
    whole = np.lexsort((table.frequency[mine], back[table.person[mine]]))
    part = np.lexsort((alone.frequency, alone.person))
    assert np.array_equal(alone.unstable[order], table.unstable[np.sort(chosen)])
    assert np.array_equal(alone.frequency[part], table.frequency[mine][whole])
    assert np.array_equal(alone.angle[part], table.angle[mine][whole])


@pytest.mark.parametrize("kind", KINDS)
def test_all_kinds_are_there_with_stable_and_falling(people, table, kind):
    critical = table.critical_delay()[people.kind == kind]
    assert (critical > 0.0).mean() > 0.1
    # with P a multiple of G nearly all stand without delay
    assert (critical == 0.0).mean() > 0.02


@pytest.mark.parametrize("damped", [False, True])
def test_without_gains_the_verdict_is_that_of_springs(damped):
    persons = random_persons(np.random.default_rng(SEED), 50)
    persons.numbers[3:] = 0.0
    persons.numbers[1] *= damped
    persons.numbers[1] += 3.0 * damped * np.eye(3)[..., None]
    found = all_crossings(persons.numbers, persons.rigid)
    assert found.person.size == 0
    assert not found.uncertain.any()
    falling = [
        (np.linalg.eigvalsh(persons.matrices(number)[2]) < 0.0).sum() for number in range(50)
    ]
    assert np.array_equal(found.unstable, falling)
    assert np.array_equal(found.critical_delay(), np.where(np.array(falling) > 0, 0.0, np.inf))
    stands = found.stable_at(np.array([0.0, 0.2]))
    assert np.array_equal(stands, (np.array(falling) == 0)[:, None] & np.ones(2, bool))


def test_undamped_proportional_feedback_leaves_the_axis_at_once():
    """J q̈ + c q = −p q(t − τ): on the axis without delay, unstable just after it."""
    person = one_link(60.0, 600.0, proportional=900.0)
    found = all_crossings(person.numbers, person.rigid)
    assert not found.uncertain.any()
    assert found.critical_delay()[0] == 0.0
    assert not found.stable_at(np.array([0.0, 0.01])).any()
    known = unstable_by_argument(person.matrices(0), 0.01)
    assert found.unstable_at(np.array([0.01]))[0, 0] == known == 2


def test_a_root_at_zero_is_neutral_and_said_to_be_doubtful():
    """K + P = mgh exactly, as in published laws: a root at 0 for every delay."""
    person = one_link(60.0, 600.0, stiffness=100.0, proportional=500.0, derivative=200.0)
    found = all_crossings(person.numbers, person.rigid)
    assert found.neutral[0]
    assert found.critical_delay()[0] == 0.0
    assert not found.stable_at(np.array([0.0, 0.1, 0.2])).any()
    beside = one_link(60.0, 600.0, stiffness=100.0, proportional=500.001, derivative=200.0)
    assert all_crossings(beside.numbers, beside.rigid).stable_at(np.array([0.1])).all()


def test_two_equal_joints_that_do_not_touch_are_marked():
    """Both roots cross at once: R does not change its sign, so the person is left open."""
    twice = [np.diag([v, v]) for v in (60.0, 10.0, -500.0, 900.0, 300.0)]
    pair = of_matrices(*twice)
    found = all_crossings(pair.numbers, pair.rigid)
    assert found.uncertain.all()
    apart = [m * np.diag([1.0, 1.1]) for m in twice]
    apart[0] = twice[0]
    pair = of_matrices(*apart)
    found = all_crossings(pair.numbers, pair.rigid)
    assert not found.uncertain.any()
    assert found.person.size == 2
