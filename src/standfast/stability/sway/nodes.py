"""Densities of sway at the nodes of intervals of ω: element by element, what ``apply`` compiles.

Each function takes the rows of densities that are asked, the same of all persons of a batch, and
arrays with the intervals last: the parts of :class:`.Swaying` and Ω of their persons, and their
ends in t, ω = Ω t/(1 − t). H(iω) is found once for all rows.
"""

from typing import Any

import numpy as np
from numpy.polynomial import Legendre

from standfast.numerics.arrays import TURN, Array, Scalar, namespace
from standfast.stability.sway.density import Swaying, characteristic, densities

Rows = tuple[int, ...]

PHASES = np.arange(8) / 8.0 * TURN

# Nodes and weights of Kronrod's 15 points and Gauss's 7 on (−1, 1), to the last digit of float64.
_NODES = (
    0.9914553711208126, 0.9491079123427585, 0.8648644233597691, 0.7415311855993945,
    0.5860872354676911, 0.4058451513773972, 0.2077849550078985, 0.0,
)  # fmt: skip
_KRONROD = (
    0.02293532201052922, 0.06309209262997855, 0.1047900103222502, 0.1406532597159259,
    0.1690047266392679, 0.1903505780647854, 0.2044329400752989, 0.2094821410847278,
)  # fmt: skip
_GAUSS = (
    0.0, 0.1294849661688697, 0.0, 0.2797053914892767,
    0.0, 0.3818300505051189, 0.0, 0.4179591836734694,
)  # fmt: skip
NODES = np.array([-x for x in _NODES] + list(_NODES[-2::-1]))
KRONROD = np.array(_KRONROD + _KRONROD[-2::-1])
GAUSS = np.array(_GAUSS + _GAUSS[-2::-1])
# Combinations of values that are 0 of polynomials up to degrees 13, 12 and 11: one of them may be
# small by chance.
UNSEEN = np.stack([KRONROD - GAUSS, *(KRONROD * Legendre.basis(k)(NODES) for k in (13, 12))])


def over_intervals(rows: Rows, *own_and_ends: Array) -> Array:
    """Return the integrals over intervals and their errors, (2, rows, intervals)."""
    swaying, omega, slope = _mapped(*own_and_ends)
    found = densities(swaying, omega, omega * swaying.delay)
    xp = namespace(omega)
    value, error = zip(*(_estimated(xp, found[row] * slope) for row in rows), strict=True)
    return xp.stack([xp.stack(value), xp.stack(error)])


def _estimated(xp: Any, at_nodes: Array) -> tuple[Array, Array]:
    """Return the integral of which values at nodes, (15, intervals), are given, and its error."""
    value = KRONROD @ at_nodes
    error = abs(UNSEEN @ at_nodes).max(axis=0)
    around = KRONROD @ abs(at_nodes - 0.5 * value)
    # as QUADPACK takes it (Piessens et al. 1983)
    ratio = 200.0 * error / xp.where(around > 0.0, around, 1.0)
    return value, xp.minimum(error, around * xp.minimum(1.0, ratio * xp.sqrt(ratio)))


def mean_over_intervals(rows: Rows, *own_and_ends: Array) -> Array:
    """Return :func:`over_intervals` of the densities' means over the phase."""
    swaying, omega, slope = _mapped(*own_and_ends)
    turning = swaying.delay > 0.0
    total: list[Scalar] = [0.0] * len(rows)
    for phase in PHASES:
        found = densities(swaying, omega, phase * turning)
        total = [so_far + found[row] for so_far, row in zip(total, rows, strict=True)]
    xp = namespace(omega)
    weights = np.stack([KRONROD, (KRONROD - GAUSS) * 1e-3]) / PHASES.size
    return xp.stack([weights @ (each * slope) for each in total], axis=1)


def turning(rows: Rows, *own_and_ends: Array) -> Array:
    """Return det H⁻¹ at ends and nodes of intervals, whatever ``rows``, (17, intervals)."""
    del rows
    *parts, scale, low, high = own_and_ends
    points = np.concatenate([[-1.0], NODES, [1.0]])[:, None]
    t = 0.5 * (low + high) + 0.5 * (high - low) * points
    return characteristic(Swaying(*parts), scale * t / (1.0 - t))


def at_phases(rows: Rows, *own_and_omega: Array) -> Array:
    """Return densities at a frequency over the phases, (rows, phases, persons)."""
    *parts, omega = own_and_omega
    swaying = Swaying(*parts)
    turning = swaying.delay > 0.0
    found = densities(swaying, omega, PHASES[:, None] * turning)
    return namespace(omega).stack([found[row] for row in rows])


def _mapped(*own_and_ends: Array) -> tuple[Swaying, Scalar, Scalar]:
    """Return persons, the frequencies at the nodes of an interval of t, and dω of a node."""
    *parts, scale, low, high = own_and_ends
    half = 0.5 * (high - low)
    t = 0.5 * (low + high) + half * NODES[:, None]
    over = 1.0 / (1.0 - t)
    return Swaying(*parts), scale * t * over, half * scale * over * over
