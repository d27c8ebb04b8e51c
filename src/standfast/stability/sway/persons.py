"""Persons of every kind as densities need them, and their variances.

notation: A inertia, B damping, C stiffness less gravity, P and D gains, m g weight, q rotations.
"""

import numpy as np

from standfast.numerics.arrays import Array
from standfast.stability.delay.problem import Apply, directly
from standfast.stability.sway.density import Swaying
from standfast.stability.sway.integral import ACCURACY, integrals
from standfast.stability.sway.nodes import Rows

JOINTS = range(3)
# What stands for a rigid joint in A, B, C, P and D: (1 + s)², never 0 on the axis.
IN_PLACE = (1.0, 2.0, 1.0, 0.0, 0.0)


def swaying_of(
    numbers: np.ndarray,
    rigid: np.ndarray,
    delay: np.ndarray,
    noise: np.ndarray,
    loads: np.ndarray,
    weight: np.ndarray,
) -> Swaying:
    """Return persons without their rigid joints.

    ``numbers`` holds A, B, C, P, D, (5, 3, 3, persons), of a rigid joint anything; ``rigid`` and
    the standard deviations ``noise`` (N·m·√s) are (3, persons), as G1, G2, G3 in ``loads``
    (N·m/rad); ``weight`` m g is in N.
    """
    taken = rigid[:, None] | rigid[None, :]
    inside = np.where(taken, 0.0, numbers)
    for joint in JOINTS:
        for matrix, alone in zip(inside, IN_PLACE, strict=True):
            matrix[joint, joint][rigid[joint]] = alone
    return Swaying(
        inside,
        delay,
        np.where(rigid, 0.0, noise) ** 2,
        np.where(rigid, 0.0, loads) / weight,
        _lever(numbers[0], rigid) / weight,
    )


def _lever(inertia: np.ndarray, rigid: np.ndarray) -> Array:
    """Return which moments at the joints make up the one at the ankle, (3, persons).

    A free ankle bears its own. A rigid one bears G₁q − A₁q̈, in which q̈ is what the moments at
    the free joints f make of them: A₁f Aff⁻¹.
    """
    _, knee, hip = rigid
    a22, a23, a33 = (
        np.where(knee, 1.0, inertia[1, 1]),
        np.where(knee | hip, 0.0, inertia[1, 2]),
        np.where(hip, 1.0, inertia[2, 2]),
    )
    a12, a13 = np.where(knee, 0.0, inertia[0, 1]), np.where(hip, 0.0, inertia[0, 2])
    determinant = a22 * a33 - a23 * a23
    held = np.stack([
        np.zeros_like(a22),
        (a33 * a12 - a23 * a13) / determinant,
        (a22 * a13 - a23 * a12) / determinant,
    ])  # fmt: skip
    own = np.zeros_like(held)
    own[0] = 1.0
    return np.where(rigid[0], held, own)


def damped(numbers: np.ndarray, rigid: np.ndarray, delay: np.ndarray) -> np.ndarray:
    """Return who has any damping, or gains that are late or sense the rate, (persons,).

    Motion of others never dies out, and noise moves them ever more. Arguments are those of
    :func:`swaying_of`.
    """
    free = ~(rigid[:, None] | rigid[None, :])
    _, b, _, p, d = np.where(free, numbers, 0.0) != 0.0
    found: np.ndarray = (b | d | (p & (delay > 0.0))).any(axis=(0, 1))
    return found


def variances(
    rows: Rows,
    swaying: Swaying,
    settles: np.ndarray,
    *,
    undecided: np.ndarray | None = None,
    accuracy: float = ACCURACY,
    apply: Apply = directly,
) -> tuple[np.ndarray, np.ndarray]:
    """Return the integrals of rows of densities, and whether each is that accurate.

    Both are (rows, persons); rows that are asked together cost little more than one. Integrals are
    infinite of whom motion does not settle, because they fall or are not :func:`damped`, if noise
    moves anything of them; NaN of whom it is ``undecided`` whether it does, and where they are not
    that accurate, too near to falling.
    """
    moved = (swaying.noise > 0.0).any(axis=0)
    found = np.tile(np.where(moved, np.inf, 0.0), (len(rows), 1))
    sure = np.ones(found.shape, bool)
    if undecided is not None:
        sure[:, moved & undecided] = False
    who = np.flatnonzero(moved & settles & sure[0])
    if who.size:
        some = Swaying(*(each.take(who, axis=-1) for each in swaying))
        found[:, who], sure[:, who] = integrals(rows, some, accuracy=accuracy, apply=apply)
    return np.where(sure, found, np.nan), sure
