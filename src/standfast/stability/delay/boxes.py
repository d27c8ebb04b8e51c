"""Crossings of the persons whom the resultant leaves open, isolated in boxes of ω and θ.

The resultant also touches 0 where two roots z are each other's mirror image in the unit circle,
away from it. Where nothing damps and D is a multiple of P that happens for nearly everybody: all z
then have the same or opposite angles. So f(ω, θ) = Δ(iω, e^(−iθ)) = 0 is solved itself.

On a box of half-widths h, t around (ω0, θ0), with qk(i(ω0 + δ)) = Σj Tkj δʲ, f is its linear part
within ρ = Σk ( Σj≥2 |Tkj| hʲ + |Tk1| h · kt + ½ |Tk0| (kt)² ). So

1. |f| above what the linear part and ρ can change, or |q0| above all others: no crossing;
2. the Newton step from the middle, give or take what ρ makes of it, leaves the box: no crossing;
   it stays inside, and the slopes change too little for Newton's map to expand: exactly one
   (Brouwer's and Banach's fixed points);
3. else the box is split.

notation: Δ, qk, z of :mod:`.characteristic`; ω and θ of :mod:`.table`.
"""

import math
from itertools import pairwise, product

import numpy as np

from standfast.numerics.arrays import ROUNDOFF, Array, Scalar, namespace
from standfast.numerics.polynomials import Polynomial
from standfast.stability.delay.problem import Apply, Problem
from standfast.stability.delay.resultant import refined

NONE, ONE, SPLIT_FREQUENCY, SPLIT_ANGLE = 0, 1, 2, 3

# Edges of the first boxes, parts of the bound of ω; and sectors of θ.
FIRST_EDGES = (0.0, 1 / 32, 1 / 8, 1 / 3, 1.0)
SECTORS = 8
# Crossings are isolated in boxes so much larger, so that none is lost between two.
LARGER = 1.25
ROUNDINGS = 128.0 * ROUNDOFF  # of f, relative to the sum of sizes of all its terms
NARROWEST = 1e-8  # relative width at which a box is given up
LOWEST = 1e-6  # of ω, part of the bound below which no crossing is looked for
POLISHINGS = 3  # calls of some steps of Newton's method
ROUNDED_UP = 1.0 + 1e-9
MOST_OPEN = 3000  # boxes of one person at once
SAME, BESIDE = 1e-8, 1e-6  # distance of crossings that are one; of those that may be


def boxed(problem: Problem, coefficients: Array, boxes: Array) -> Array:
    """Return the rows verdict, ω, θ of boxes, whose rows are low and high ω, low and high θ."""
    low, high, first, last = (boxes[row] for row in range(4))
    xp = namespace(low)
    omega, theta = 0.5 * (low + high), 0.5 * (first + last)
    h, t = 0.5 * (high - low), 0.5 * (last - first)
    quasi = problem.quasi(coefficients)
    shifted = [_shifted(q, omega) for q in quasi]
    turns = [xp.exp(-1j * k * theta) for k in range(len(quasi))]
    at = sum(taylor[0] * z for taylor, z in zip(shifted, turns, strict=True))
    by_omega = sum(taylor[1] * z for taylor, z in zip(shifted, turns, strict=True))
    by_theta = sum(
        -1j * k * taylor[0] * z for k, (taylor, z) in enumerate(zip(shifted, turns, strict=True))
    )
    sizes = [[abs(c) for c in taylor] for taylor in shifted]
    rounding = ROUNDINGS * sum(_at_most([abs(c) for c in q], high) for q in quasi)
    nothing = _far_from_zero(sizes, (at, by_omega, by_theta), (h, t), rounding)
    # Newton's step and what the rest, of f and of its slopes, makes of it in a larger box
    larger, wider = LARGER * h, LARGER * t
    rest, of_slopes = remainders(sizes, larger, wider)
    area = (by_omega.conj() * by_theta).imag
    step = -(at.conj() * by_theta).imag / area
    turn = (at.conj() * by_omega).imag / area
    beside, astray = abs(by_theta / area), abs(by_omega / area)
    off, off_turn = beside * (rest + rounding), astray * (rest + rounding)
    nothing = nothing | (abs(step) - off > h) | (abs(turn) - off_turn > t)
    one = (abs(step) + off <= larger) & (abs(turn) + off_turn <= wider)
    one = one & (xp.maximum(beside / larger, astray / wider) * of_slopes < 1.0)
    by_frequency = abs(by_omega) * h + sum(_at_most([0.0, 0.0, *s[2:]], h) for s in sizes)
    by_angle = abs(by_theta) * t + sum(0.5 * s[0] * (k * t) ** 2 for k, s in enumerate(sizes))
    split = xp.where(by_frequency > by_angle, SPLIT_FREQUENCY, SPLIT_ANGLE)
    verdict = xp.where(nothing, NONE, xp.where(one, ONE, split))
    return xp.stack([1.0 * verdict, omega + step, theta + turn])


def _shifted(q: Polynomial, omega: Scalar) -> Polynomial:
    """Return the coefficients of q(i(ω + δ)) in rising powers of δ."""
    coefficients = [c * 1j**power for power, c in enumerate(q)]
    for stage in range(len(q) - 1):
        for place in range(len(q) - 2, stage - 1, -1):
            coefficients[place] = coefficients[place] + omega * coefficients[place + 1]
    return coefficients


def _at_most(sizes: list[Scalar], x: Scalar) -> Scalar:
    total: Scalar = 0.0
    for size in reversed(sizes):
        total = total * x + size
    return total


def _far_from_zero(
    sizes: list[list[Scalar]],
    linear: tuple[Scalar, Scalar, Scalar],
    halves: tuple[Scalar, Scalar],
    rounding: Scalar,
) -> Scalar:
    """Return whether |f|, or |q0| beside the other terms, is too large to vanish on the box."""
    (at, by_omega, by_theta), (h, t) = linear, halves
    rest, _ = remainders(sizes, h, t)
    far = abs(at) > abs(by_omega) * h + abs(by_theta) * t + rest + rounding
    first, *others = sizes
    off_first = _at_most([0.0, *first[1:]], h)
    return far | (first[0] - off_first - rounding > sum(_at_most(s, h) for s in others))


def remainders(sizes: list[list[Scalar]], h: Scalar, t: Scalar) -> tuple[Scalar, Scalar]:
    """Return ρ, and a bound of h |Δ of ∂f/∂ω| + t |Δ of ∂f/∂θ| on the box."""
    rest: Scalar = 0.0
    of_slopes: Scalar = 0.0
    for k, s in enumerate(sizes):
        higher = _at_most([0.0, 0.0, *s[2:]], h)
        mixed, angular = s[1] * h * (k * t), s[0] * (k * t) ** 2
        rest = rest + higher + mixed + 0.5 * angular
        steeper = _at_most([0.0, 0.0, *(j * c for j, c in enumerate(s) if j > 1)], h)
        of_slopes = of_slopes + steeper + mixed + k * t * (higher + s[1] * h) + angular
    return rest, of_slopes


def polished_in_box(problem: Problem, coefficients: Array, at: Array) -> Array:
    """Return ω, θ, direction and last correction of crossings near the rows ω, θ of ``at``."""
    return namespace(at).stack(refined(problem.quasi(coefficients), at[0], at[1]))


def isolated_in_boxes(
    problem: Problem, coefficients: np.ndarray, highest: np.ndarray, apply: Apply
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return persons and their crossings, rows ω, θ, direction, correction; and who stays open.

    ``highest`` is each person's bound of ω.
    """
    person, boxes = _first_boxes(highest)
    open_ = np.zeros(highest.size, bool)
    found: list[tuple[np.ndarray, np.ndarray]] = []
    while person.size:
        verdict, omega, theta = np.asarray(apply(boxed, problem, coefficients[:, person], boxes))
        one = verdict == ONE
        found.append((person[one], np.stack([omega[one], theta[one], *boxes[:, one]])))
        split = ~(one | (verdict == NONE))
        person, boxes, way = person[split], boxes[:, split], verdict[split]
        low, high, first, last = boxes
        given_up = ~((high - low > NARROWEST * high) | (last - first > NARROWEST))
        given_up |= high < LOWEST * highest[person]
        given_up |= np.bincount(person, minlength=highest.size)[person] > MOST_OPEN
        open_[person[given_up]] = True
        kept = ~open_[person]
        person, boxes = _split(person[kept], boxes[:, kept], way[kept] == SPLIT_FREQUENCY)
    person = np.concatenate([who for who, _ in found])
    at, boxes = np.split(np.concatenate([where for _, where in found], axis=1), [2])
    for _ in range(POLISHINGS):
        # θ counts from 0 to a turn; near its ends it is kept where the box is
        turns = math.tau * np.rint((0.5 * (boxes[2] + boxes[3]) - at[1]) / math.tau)
        at[1] += turns
        crossings = np.asarray(apply(polished_in_box, problem, coefficients[:, person], at))
        at = crossings[:2].copy()
    low, high, first, last = boxes
    turn = crossings[1] - 0.5 * (first + last)
    turn = abs(turn - math.tau * np.rint(turn / math.tau))
    outside = abs(crossings[0] - 0.5 * (low + high)) > 0.5 * LARGER * (high - low) * ROUNDED_UP
    outside |= turn > 0.5 * LARGER * (last - first) * ROUNDED_UP
    outside |= ~(crossings[0] > 0.0)
    open_[person[outside]] = True
    return *_each_once(person, crossings, open_), open_


def _first_boxes(highest: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    sector = math.tau / SECTORS
    parts_ = product(pairwise(FIRST_EDGES), range(SECTORS))
    boxes = [
        (
            low * highest,
            high * highest,
            0.0 * highest + k * sector,
            0.0 * highest + (k + 1) * sector,
        )
        for (low, high), k in parts_
    ]
    person = np.tile(np.arange(highest.size), len(boxes))
    return person, np.concatenate(np.array(boxes), axis=1)


def _split(
    person: np.ndarray, boxes: np.ndarray, by_frequency: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    low, high, first, last = boxes
    middle = np.where(low > 0.0, np.sqrt(low * high), high / 4.0)
    lower, upper = boxes.copy(), boxes.copy()
    lower[1], upper[0] = (np.where(by_frequency, middle, edge) for edge in (high, low))
    half = 0.5 * (first + last)
    lower[3], upper[2] = (np.where(by_frequency, edge, half) for edge in (last, first))
    return np.concatenate([person, person]), np.concatenate([lower, upper], axis=1)


def _each_once(
    person: np.ndarray, crossings: np.ndarray, open_: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Take crossings that boxes beside each other found as one; note who has doubtful pairs."""
    order = np.lexsort((crossings[1], crossings[0], person))
    person, crossings = person[order], crossings[:, order]
    kept = np.ones(person.size, bool)
    # at most the four boxes that meet in a corner find one and the same
    for apart in range(1, min(8, person.size)):
        omega, theta = crossings[0], crossings[1]
        distance = abs(omega[apart:] / omega[:-apart] - 1.0)
        turn = theta[apart:] - theta[:-apart]
        distance = np.maximum(distance, abs(turn - math.tau * np.rint(turn / math.tau)))
        mine = person[apart:] == person[:-apart]
        kept[apart:] &= ~(mine & (distance < SAME))
        doubtful = mine & (distance >= SAME) & (distance < BESIDE)
        open_[person[apart:][doubtful]] = True
    return person[kept], crossings[:, kept]
