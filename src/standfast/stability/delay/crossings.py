"""All crossings of the imaginary axis, of many persons at once, and what follows at any delay.

1. :func:`prepared`: coefficients of the characteristic quasi-polynomial, unstable roots without
   delay, and a bound above which nothing crosses.
2. Cells of x = ω² from 0 to the bound are classified (:func:`.resultant.roots_on_cell`): proven
   empty, proven to hold one crossing, or split. Some 15 cells a person settle all.
3. Each crossing is narrowed down and polished to ω, θ and its direction.
4. Whom that leaves open has the crossings isolated in boxes of ω and θ (:mod:`.boxes`).

The functions of step 1 to 3 are pure and work element by element; whoever has them compiled hands
them in as ``apply``. Arrays have the persons last.
"""

import numpy as np

from standfast.numerics.arrays import Array, Scalar, namespace
from standfast.stability.delay.boxes import isolated_in_boxes
from standfast.stability.delay.characteristic import (
    Matrices,
    highest_crossing,
    quasi_polynomial,
    right_of_axis,
    undelayed,
)
from standfast.stability.delay.problem import Apply, Problem, directly
from standfast.stability.delay.resultant import crossing_at, resultant_at, roots_on_cell
from standfast.stability.delay.table import TURN, Crossings

# The first cells end at these parts of the bound; each is eight times as wide as the one below.
FIRST_CELLS = (0.0, 8.0**-3, 8.0**-2, 8.0**-1, 1.0)
WIDE = 1.5  # a cell whose ends have a larger ratio is split at their geometric mean
# Cells are split off the middle, so that no crossing that a study makes likely lies on an end.
OFF_MIDDLE = 0.5003
NARROWEST = 1e-10  # relative width at which a cell is given up
# Open cells of one person at once; where R is lost in rounding they double with every split.
MOST_OPEN = 32
LOWEST = 1e-12  # of x, part of the bound below which no crossing is looked for
NARROWING_STEPS = 2  # of Chandrupatla's method in one call
MOST_NARROWINGS = 30
NARROW = 1e-8  # relative width from which polishing goes on
NOISE = 1e-13  # of the scaled resultant
ROUNDED_UP = 1.0 + 1e-12
AT_ONCE = 1e-9  # rad of a turn, of roots that lie on the axis without delay
BESIDE = 1e-7  # part of a root that its real part may be where it lies on the axis
SETTLED = 1e-9  # largest last correction of a crossing that counts as found


def prepared(problem: Problem, numbers: Array) -> tuple[Array, Array, Array, Array]:
    """Return coefficients, unstable roots without delay, whether they are uncertain, and ω²max.

    ``numbers`` are the matrices of :class:`Matrices`, (5, n, n, persons).
    """
    n = problem.joints
    rows = [[[numbers[k][i][j] for j in range(n)] for i in range(n)] for k in range(5)]
    matrices = Matrices(*rows)
    quasi = quasi_polynomial(matrices, problem.rank)
    unstable, uncertain = right_of_axis(undelayed(quasi))
    bound = highest_crossing(matrices)
    xp = namespace(bound)
    return xp.stack([c for q in quasi for c in q]), unstable, uncertain, bound**2


def classified(problem: Problem, coefficients: Array, low: Scalar, high: Scalar) -> Scalar:
    """Return how many crossings lie in a cell of ω²: 0, 1, or 2 where it must be split."""
    return roots_on_cell(problem.quasi(coefficients), low, high)


def evaluated(problem: Problem, coefficients: Array, x: Scalar) -> Scalar:
    """Return the scaled resultant at x = ω²."""
    return resultant_at(problem.quasi(coefficients), x)


def narrowed(problem: Problem, coefficients: Array, state: Array) -> Array:
    """Return a bracket of a root after some steps of Chandrupatla's method.

    ``state`` has the rows x1, f1 (the newest), x2, f2 (of the other sign), x3, f3 (the one before).
    Chandrupatla, Adv. Eng. Softw. 28 (1997) 145-149: inverse quadratic interpolation where that is
    safe, else bisection.
    """
    quasi = problem.quasi(coefficients)
    x1, f1, x2, f2, x3, f3 = (state[row] for row in range(6))
    xp = namespace(x1)
    for _ in range(NARROWING_STEPS):
        xi, phi = (x1 - x2) / (x3 - x2), (f1 - f2) / (f3 - f2)
        safe = (phi**2 < xi) & ((1.0 - phi) ** 2 < 1.0 - xi)
        t = f1 / (f2 - f1) * f3 / (f2 - f3)
        t = t + (x3 - x1) / (x2 - x1) * f1 / (f3 - f1) * f2 / (f3 - f2)
        t = xp.where(safe & xp.isfinite(t), t, 0.5)
        least = 2.0**-53 * xp.maximum(abs(x1), abs(x2)) / abs(x2 - x1)
        t = xp.clip(t, least, 1.0 - least)
        x = x1 + t * (x2 - x1)
        f = resultant_at(quasi, x)
        # in rounding's reach a compiler may find two signs of one number
        done = abs(f1) < NOISE
        same = (f > 0.0) == (f1 > 0.0)
        older, other = xp.where(same, x1, x2), xp.where(same, x2, x1)
        f_older, f_other = xp.where(same, f1, f2), xp.where(same, f2, f1)
        x3, f3 = xp.where(done, x3, older), xp.where(done, f3, f_older)
        x2, f2 = xp.where(done, x2, other), xp.where(done, f2, f_other)
        x1, f1 = xp.where(done, x1, x), xp.where(done, f1, f)
    return xp.stack([x1, f1, x2, f2, x3, f3])


def polished(problem: Problem, coefficients: Array, x: Scalar) -> Array:
    """Return ω, θ, direction and last correction of crossings, (4, …)."""
    found = crossing_at(problem.quasi(coefficients), x)
    return namespace(x).stack(found)


def crossings_of(problem: Problem, numbers: np.ndarray, *, apply: Apply = directly) -> Crossings:
    """Find all crossings of persons whose matrices are ``numbers``, (5, n, n, persons)."""
    coefficients, unstable, open_, bound = map(np.asarray, apply(prepared, problem, numbers))
    unstable, uncertain = unstable.astype(np.int32), open_.astype(bool)
    on_axis, neutral = np.zeros_like(uncertain), np.zeros_like(uncertain)
    for who in np.flatnonzero(uncertain):
        whole = undelayed(problem.quasi(coefficients[:, who]))
        unstable[who], on_axis[who], neutral[who], uncertain[who] = _settled(np.array(whole))
    if problem.rank == 0:
        # springs and dampers alone stand where nothing is right of the axis (Kelvin, Tait, Chetaev)
        on_axis = neutral
        none = np.zeros(0)
        return Crossings(
            unstable, on_axis, neutral, uncertain, none.astype(np.intp), none, none, none
        )
    person, (frequency, angle, direction, _), left = _found(problem, coefficients, bound, apply)
    uncertain |= left
    # roots on the axis without delay leave it at once, to the right or to the left
    at_once = on_axis[person] & ((angle < AT_ONCE) | (angle > TURN - AT_ONCE))
    angle = np.where(at_once, np.where(direction > 0.0, 0.0, TURN), angle)
    return Crossings(unstable, on_axis, neutral, uncertain, person, frequency, angle, direction)


def _found(
    problem: Problem, coefficients: np.ndarray, bound: np.ndarray, apply: Apply
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return persons and rows ω, θ, direction, correction of crossings; and who stays open."""
    open_ = np.zeros(bound.size, bool)
    person, low, high = _isolated(problem, coefficients, bound, open_, apply)
    x = _narrowed(problem, coefficients[:, person], low, high, apply)
    found = np.asarray(apply(polished, problem, coefficients[:, person], x))
    inside = (low <= found[0] ** 2 * ROUNDED_UP) & (found[0] ** 2 <= high * ROUNDED_UP)
    open_[person[~inside | _doubtful(found)]] = True
    if not open_.any():
        return person, found, open_
    who = np.flatnonzero(open_)
    again, others, left = isolated_in_boxes(
        problem, coefficients[:, who], np.sqrt(bound[who]), apply
    )
    left[again[_doubtful(others)]] = True
    sure = ~open_[person]
    open_[who] = left
    person = np.concatenate([person[sure], who[again]])
    return person, np.concatenate([found[:, sure], others], axis=1), open_


def _doubtful(found: np.ndarray) -> np.ndarray:
    """Return where rows ω, θ, direction, correction are not settled."""
    doubtful: np.ndarray = ~(found[3] < SETTLED) | (found[2] == 0.0)
    return doubtful


def _settled(polynomial: np.ndarray) -> tuple[int, bool, bool, bool]:
    """Count the roots right of the axis where Routh's array leaves it open.

    Returns also whether some lie on it, whether 0 is one, and whether that is uncertain: it is not
    where all powers are even, because nothing damps.
    """
    roots = np.roots(polynomial[::-1])
    size = np.abs(roots).max(initial=0.0)
    beside = np.abs(roots.real) <= BESIDE * np.maximum(np.abs(roots), BESIDE * size)
    right = int(np.count_nonzero((roots.real > 0.0) & ~beside))
    neutral = bool(polynomial[0] == 0.0 or (np.abs(roots) <= BESIDE * size).any())
    return right, bool(beside.any()), neutral, neutral or bool(np.any(polynomial[1::2]))


def _isolated(
    problem: Problem,
    coefficients: np.ndarray,
    bound: np.ndarray,
    uncertain: np.ndarray,
    apply: Apply,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return persons and ends of cells that hold one crossing each; note who stays uncertain."""
    cells = len(FIRST_CELLS) - 1
    person = np.tile(np.arange(bound.size), cells)
    low = (np.array(FIRST_CELLS[:-1])[:, None] * bound).ravel()
    high = (np.array(FIRST_CELLS[1:])[:, None] * bound).ravel()
    found = []
    while person.size:
        count = np.asarray(apply(classified, problem, coefficients[:, person], low, high))
        one, split = count == 1, count == 2
        found.append((person[one], low[one], high[one]))
        person, low, high = person[split], low[split], high[split]
        narrow = ~(high - low > NARROWEST * high)  # or not a number
        given_up = narrow | (high < LOWEST * bound[person])
        given_up |= np.bincount(person, minlength=bound.size)[person] > MOST_OPEN
        uncertain[person[given_up]] = True
        person, low, high = person[~given_up], low[~given_up], high[~given_up]
        middle = np.where(low > 0.0, np.sqrt(low * high), high / 8.0)
        middle = np.where(high < WIDE * low, low + OFF_MIDDLE * (high - low), middle)
        person = np.concatenate([person, person])
        low, high = np.concatenate([low, middle]), np.concatenate([middle, high])
    person, low, high = (np.concatenate(each) for each in zip(*found, strict=True))
    return person, low, high


def _narrowed(
    problem: Problem,
    coefficients: np.ndarray,
    low: np.ndarray,
    high: np.ndarray,
    apply: Apply,
) -> np.ndarray:
    """Return the root of R in each cell."""
    x: np.ndarray = 0.5 * (low + high)
    f_low = np.asarray(apply(evaluated, problem, coefficients, low))
    f_high = np.asarray(apply(evaluated, problem, coefficients, high))
    state = np.stack([high, f_high, low, f_low, low, f_low])
    active = np.arange(low.size)
    for _ in range(MOST_NARROWINGS):
        if not active.size:
            break
        state = np.asarray(apply(narrowed, problem, coefficients[:, active], state))
        best = np.where(abs(state[1]) < abs(state[3]), state[0], state[2])
        x[active] = best
        going_on = (abs(state[0] - state[2]) > NARROW * best) & (abs(state[1]) > NOISE)
        active, state = active[going_on], state[:, going_on]
    return x
