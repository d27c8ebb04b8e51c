"""All crossings of the imaginary axis, of many persons at once.

1. Coefficients of the characteristic quasi-polynomial, unstable roots without delay, and a bound
   above which nothing crosses.
2. Cells of x = ω² from 0 to the bound are classified (:func:`.resultant.roots_on_cell`): proven
   empty, proven to hold one crossing, or split. Some 15 cells a person settle all.
3. Each crossing is narrowed down and polished to ω, θ and its direction.
4. Whom that leaves open has them isolated in boxes of ω and θ (:mod:`.boxes`).

The functions of each step are those of :mod:`.problem`. Arrays have the persons last.
"""

from itertools import pairwise

import numpy as np

from standfast.numerics.arrays import TURN
from standfast.numerics.polynomials import all_roots
from standfast.stability.delay.boxes import isolated_in_boxes
from standfast.stability.delay.characteristic import undelayed
from standfast.stability.delay.problem import (
    NOISE,
    Apply,
    Problem,
    Whom,
    bracketed,
    classified,
    directly,
    examined,
    highest,
    narrowed,
    of_one_joint,
    polished,
    prepared,
    sought,
)
from standfast.stability.delay.table import Crossings

# The first cells end at these parts of the bound; each is eight times as wide as the one below.
FIRST_CELLS = (0.0, 8.0**-3, 8.0**-2, 8.0**-1, 1.0)
WIDE = 1.5  # a cell whose ends have a larger ratio is split at their geometric mean
# Cells are split off the middle, so that no crossing that a study makes likely lies on an end.
OFF_MIDDLE = 0.5003
NARROWEST = 1e-10  # relative width at which a cell is given up
# Open cells of one person at once; where R is lost in rounding they double with every split.
MOST_OPEN = 32
LOWEST = 1e-12  # of x, part of the bound below which no crossing is looked for
NARROWINGS = 15  # calls at most, before Newton's method starts again
NARROW = 1e-8  # relative width from which polishing goes on
ROUNDED_UP = 1.0 + 1e-12
AT_ONCE = 1e-9  # rad of a turn, of roots that lie on the axis without delay
CANCELLED = 1e-9  # part of the largest entry of C that a pivot may be and be told from 0
BESIDE = 1e-7  # part of a root that its real part may be where it lies on the axis
SETTLED = 1e-9  # largest last correction of a crossing that counts as found


def crossings_of(
    problem: Problem,
    numbers: np.ndarray,
    *,
    of: Whom = "everybody",
    boxes: bool = True,
    apply: Apply = directly,
) -> Crossings:
    """Find all crossings of persons whose matrices are ``numbers``, (5, n, n, persons).

    A critical delay needs crossings ``of`` who stands at once, without delay, a verdict of who may
    stand at any, a rightmost root of nobody; those of others may be missing. Without ``boxes`` more
    persons stay uncertain.
    """
    if problem.rank == 0:
        return _without_feedback(numbers[2])
    coefficients = np.asarray(apply(prepared, problem, numbers))
    unstable, left = apply(examined, problem, coefficients)
    unstable, uncertain = np.array(unstable, np.int32), np.array(left, bool)
    on_axis, neutral, nobody = (np.zeros_like(uncertain) for _ in range(3))
    open_ = np.flatnonzero(uncertain)
    if open_.size:
        whole = np.array(undelayed(problem.quasi(coefficients[:, open_])))
        unstable[open_], on_axis[open_], neutral[open_], uncertain[open_] = _settled(whole)
    known = (unstable, on_axis, neutral, uncertain, nobody)
    if problem.joints == 1:
        person, frequency, angle, direction = _in_closed_form(problem, numbers, apply)
        return Crossings(*known, person, frequency, angle, direction)
    persons = np.flatnonzero(_asked(of, unstable, neutral) | uncertain)
    bound = np.asarray(apply(highest, problem, numbers))
    person, (frequency, angle, direction, _), left = _found(
        problem, coefficients, bound, persons, apply, boxes=boxes
    )
    uncertain |= left
    # roots on the axis without delay leave it at once, to the right or to the left
    at_once = on_axis[person] & ((angle < AT_ONCE) | (angle > TURN - AT_ONCE))
    angle = np.where(at_once, np.where(direction > 0.0, 0.0, TURN), angle)
    return Crossings(*known, person, frequency, angle, direction)


def _asked(of: Whom, unstable: np.ndarray, neutral: np.ndarray) -> np.ndarray:
    """Return of whom crossings are looked for."""
    everybody = np.ones(unstable.shape, bool)
    asked: np.ndarray = {
        "nobody": ~everybody,
        "who stands at once": (unstable == 0) & ~neutral,
        "who may stand": (unstable % 2 == 0) & ~neutral,
        "everybody": everybody,
    }[of]
    return asked


def _found(
    problem: Problem,
    coefficients: np.ndarray,
    bound: np.ndarray,
    persons: np.ndarray,
    apply: Apply,
    *,
    boxes: bool,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return whose and the rows ω, θ, direction, correction of crossings; and who stays open."""
    left = np.zeros(bound.size, bool)
    search = np.asarray(apply(sought, problem, coefficients)) if problem.rank == 1 else coefficients
    person, low, high = _isolated(problem, search, bound, persons, left, apply)
    found, lost = _located(
        problem, search.take(person, axis=1), coefficients.take(person, axis=1), low, high, apply
    )
    left[person[lost]] = True
    if not (boxes and left.any()):
        return person, found, left
    who = np.flatnonzero(left)
    again, others, open_ = isolated_in_boxes(
        problem, coefficients[:, who], np.sqrt(bound[who]), apply
    )
    open_[again[~(others[3] < SETTLED) | (others[2] == 0.0)]] = True
    sure = ~left[person]
    left[who] = open_
    person = np.concatenate([person[sure], who[again]])
    return person, np.concatenate([found[:, sure], others], axis=1), left


def _without_feedback(stiffness: np.ndarray) -> Crossings:
    """Return the table of persons without feedback, by their springs: C, (n, n, persons).

    With any damping, or none, as many roots lie to the right as C has negative eigenvalues. The
    signs of its pivots tell; one that nearly cancels is uncertain.
    """
    size = np.abs(stiffness).max(axis=(0, 1))
    rest = stiffness.copy()
    negative = np.zeros(size.shape, np.int32)
    uncertain = np.zeros(size.shape, bool)
    for step in range(len(rest)):
        pivot = rest[step, step]
        uncertain |= ~(np.abs(pivot) > CANCELLED * size)
        negative += pivot < 0.0
        safe = np.where(pivot == 0.0, 1.0, pivot)
        rest = rest - rest[:, step][:, None] * rest[step][None] / safe
    none = np.zeros(0)
    nobody = np.zeros(size.shape, bool)
    return Crossings(
        negative,
        nobody,
        uncertain.copy(),
        uncertain,
        ~nobody,
        none.astype(np.intp),
        none,
        none,
        none,
    )


def _in_closed_form(
    problem: Problem, numbers: np.ndarray, apply: Apply
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    both = np.asarray(apply(of_one_joint, problem, numbers)).reshape(2, 2, -1)
    way, person = np.nonzero(np.isfinite(both[:, 0]))
    frequency, angle = both[way, :, person].T
    return person, frequency, angle, np.where(way == 0, 1.0, -1.0)


def _settled(whole: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Count the roots right of the axis where Routh's array leaves it open; (powers, persons).

    Returns also whether some lie on it, whether 0 is one, and whether that is uncertain: it is not
    where all powers are even, because nothing damps.
    """
    roots = all_roots(whole)
    distance = np.abs(roots)
    size = distance.max(axis=1, keepdims=True)
    beside = np.abs(roots.real) <= BESIDE * np.maximum(distance, BESIDE * size)
    right = np.count_nonzero((roots.real > 0.0) & ~beside, axis=1)
    neutral = (whole[0] == 0.0) | (distance <= BESIDE * size).any(axis=1)
    return right, beside.any(axis=1), neutral, neutral | whole[1::2].any(axis=0)


def _isolated(
    problem: Problem,
    search: np.ndarray,
    bound: np.ndarray,
    persons: np.ndarray,
    uncertain: np.ndarray,
    apply: Apply,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return persons and ends of cells that hold one crossing each; note who stays uncertain."""
    # the first cells are of the same persons, so that their numbers are gathered once
    own = search if persons.size == bound.size else search.take(persons, axis=1)
    ends = np.array(FIRST_CELLS)[:, None] * bound[persons]
    low, high = ends[:-1].ravel(), ends[1:].ravel()
    person = np.tile(persons, len(ends) - 1)
    count = np.concatenate([apply(classified, problem, own, *cell) for cell in pairwise(ends)])
    found: list[list[np.ndarray]] = []
    while True:
        cells = (person, low, high)
        one, split = np.flatnonzero(count == 1), np.flatnonzero(count == 2)
        found.append([each.take(one) for each in cells])
        person, low, high = (each.take(split) for each in cells)
        given_up = ~(high - low > NARROWEST * high)  # or not a number
        given_up |= high < LOWEST * bound.take(person)
        given_up |= np.bincount(person, minlength=bound.size).take(person) > MOST_OPEN
        if given_up.any():
            uncertain[person[given_up]] = True
            person, low, high = person[~given_up], low[~given_up], high[~given_up]
        if not person.size:
            break
        middle = np.where(low > 0.0, np.sqrt(low * high), high / 8.0)
        middle = np.where(high < WIDE * low, low + OFF_MIDDLE * (high - low), middle)
        person = np.concatenate([person, person])
        low, high = np.concatenate([low, middle]), np.concatenate([middle, high])
        count = apply(classified, problem, search.take(person, axis=1), low, high)
    person, low, high = (np.concatenate(each) for each in zip(*found, strict=True))
    return person, low, high


def _located(
    problem: Problem,
    search: np.ndarray,
    coefficients: np.ndarray,
    low: np.ndarray,
    high: np.ndarray,
    apply: Apply,
) -> tuple[np.ndarray, np.ndarray]:
    """Return ω, θ, direction and last correction in each cell, and whether it was not found.

    A cell holds one, so what Newton's method comes to within it is that one: it starts once the
    resultant is small, and again from a narrow bracket where that was too early.
    """
    state = np.asarray(apply(bracketed, problem, search, low, high))
    found = np.array(apply(polished, problem, coefficients, _nearer(state)))
    lost = _is_lost(found, low, high)
    again = np.flatnonzero(lost)
    if again.size:
        state = _narrowed(problem, search[:, again], state[:, again], apply)
        found[:, again] = apply(polished, problem, coefficients[:, again], _nearer(state))
        lost[again] = _is_lost(found[:, again], low[again], high[again])
    return found, lost


def _nearer(state: np.ndarray) -> np.ndarray:
    """Return the end of each bracket where the resultant is smaller."""
    nearer: np.ndarray = np.where(abs(state[1]) < abs(state[3]), state[0], state[2])
    return nearer


def _is_lost(found: np.ndarray, low: np.ndarray, high: np.ndarray) -> np.ndarray:
    """Return which crossings Newton's method did not come to, or which lie in another cell."""
    frequency, _, direction, correction = found
    inside = (low <= frequency**2 * ROUNDED_UP) & (frequency**2 <= high * ROUNDED_UP)
    # each has a mirror image below 0, to which a long first step may lead
    inside &= frequency > 0.0
    lost: np.ndarray = ~(correction < SETTLED) | ~inside | (direction == 0.0)
    return lost


def _narrowed(problem: Problem, search: np.ndarray, state: np.ndarray, apply: Apply) -> np.ndarray:
    """Return brackets after some calls of :func:`narrowed`; what is narrow stays as it is."""
    active = np.arange(state.shape[1])
    for _ in range(NARROWINGS):
        if not active.size:
            break
        state[:, active] = apply(narrowed, problem, search[:, active], state[:, active])
        size = np.abs(state[0, active] - state[2, active])
        wide = (size > NARROW * state[0, active]) & (np.abs(state[1, active]) > NOISE)
        active = active[wide]
    return state
