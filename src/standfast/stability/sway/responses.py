"""What noise makes of readings of a swaying person, and how that changes with gains and delay.

    y = (a F + b) H w,  H = (F − ω² A)⁻¹,  F = :func:`.density.moment`

of a reading that weighs the joints' moments by a and their rotations by b: a rotation has a = 0 and
b of one joint, the centre of mass b = (G1, G2, G3)/(m g), the centre of pressure both
(:mod:`.density`). From dH = −H dF H follows dy = (a dF − y dF) H w, exactly.

notation: those of :mod:`.density`; y response to unit noise at each joint.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from standfast.numerics.complex_pairs import Complex
from standfast.stability.sway.density import LOW_PASS, Swaying, moment

READINGS = ("ankle", "knee", "hip", "com", "cop")


class Change(NamedTuple):
    """A direction in which gains (3, 3) and delay change, a unit of the parameter."""

    proportional: np.ndarray
    derivative: np.ndarray
    delay: float


class Matrices(NamedTuple):
    """What a person's joints answer at each frequency, of the free joints.

    Attributes
    ----------
    free : which joints are; omega : (n,), rad/s
    moments : F, whole : H⁻¹ = F − ω² A, both (free, free, n)
    gains : P and D, (free, free, 1)
    turned : cos ωτ and sin ωτ, (n,)
    """

    free: np.ndarray
    omega: np.ndarray
    moments: np.ndarray
    whole: np.ndarray
    gains: tuple[np.ndarray, np.ndarray]
    turned: tuple[np.ndarray, np.ndarray]


def responses(
    swaying: Swaying,
    rigid: np.ndarray,
    omega: np.ndarray,
    readings: Sequence[str],
    changes: Sequence[Change] = (),
    low_pass: float = LOW_PASS,
) -> tuple[np.ndarray, np.ndarray]:
    """Return what unit noise makes of readings of one person, and its derivatives.

    Parameters
    ----------
    swaying
        one person; which joints are ``rigid``, (3,).
    omega : (n,), rad/s
    readings
        among :data:`READINGS`.
    low_pass : rad/s
        that the centre of pressure is seen through, 1/(1 + (ω/``low_pass``)⁴).

    Returns
    -------
    (readings, joints, n), complex, in rad or m per N·m·√s; 0 of a rigid joint.
    (changes, readings, joints, n), the derivatives.
    """
    return followed(matrices(swaying, rigid, omega), swaying, readings, changes, low_pass)


def followed(
    known: Matrices,
    swaying: Swaying,
    readings: Sequence[str],
    changes: Sequence[Change] = (),
    low_pass: float = LOW_PASS,
) -> tuple[np.ndarray, np.ndarray]:
    """Return the same of matrices that are known."""
    free, omega, moments, whole, gains, turned = known
    h = _inverse(whole)
    by_moment, by_rotation = _weights(swaying, free, readings)
    gain = np.ones((len(readings), 1, omega.size))
    square = (omega / low_pass) ** 2
    gain[[name == "cop" for name in readings]] = 1.0 / (1.0 + square**2)
    found = np.zeros((1 + len(changes), len(readings), 3, omega.size), complex)
    rows = _product(_product(by_moment, moments) + by_rotation, h)
    found[0][:, free] = gain * rows
    for row, change in zip(found[1:], changes, strict=True):
        moved = _moved(change, np.ix_(free, free), gains, omega, turned)
        row[:, free] = gain * _product(_product(by_moment - rows, moved), h)
    return found[0], found[1:]


def determinant(known: Matrices) -> np.ndarray:
    """Return det H⁻¹ of the free joints of one person, (n,): near a pole its angle turns by π."""
    whole = known.whole
    found: np.ndarray = whole[0, 0] if len(whole) == 1 else np.linalg.det(np.moveaxis(whole, -1, 0))
    return found


def matrices(swaying: Swaying, rigid: np.ndarray, omega: np.ndarray) -> Matrices:
    """Return the matrices of one person's free joints at ω, (n,), rad/s."""
    free = np.flatnonzero(~rigid)
    block = np.ix_(free, free)
    a, b, c, p, d = (matrix[block][..., None] for matrix in swaying.numbers[..., 0])
    # NumPy's own: as quick here as those of the densities, and right at any phase
    phase = omega * swaying.delay[0]
    turned = np.cos(phase), np.sin(phase)
    moments = _complex(moment(b, c, p, d, omega, turned))
    return Matrices(free, omega, moments, moments - omega**2 * a, (p, d), turned)


def _moved(
    change: Change,
    block: tuple[np.ndarray, ...],
    gains: tuple[np.ndarray, np.ndarray],
    omega: np.ndarray,
    turned: tuple[np.ndarray, np.ndarray],
) -> np.ndarray:
    """Return dF: F of the gains that change, and −iω dτ times F of all gains alone."""
    p, d = (matrix[block][..., None] for matrix in (change.proportional, change.derivative))
    found = _complex(moment(0.0, 0.0, p, d, omega, turned))
    if change.delay:
        found -= 1j * omega * change.delay * _complex(moment(0.0, 0.0, *gains, omega, turned))
    return found


def _complex(pair: Complex) -> np.ndarray:
    """Return a pair of real arrays as a complex one."""
    found = np.empty(pair.re.shape, complex)
    found.real, found.imag = pair
    return found


def _weights(
    swaying: Swaying, free: np.ndarray, readings: Sequence[str]
) -> tuple[np.ndarray, np.ndarray]:
    """Return a and b of each reading over the free joints, (readings, free, 1)."""
    moment, rotation = np.zeros((2, len(readings), 3))
    for place, name in enumerate(readings):
        if name in ("com", "cop"):
            rotation[place] = swaying.loads[:, 0]
        else:
            rotation[place, READINGS.index(name)] = 1.0
        if name == "cop":
            moment[place] = swaying.lever[:, 0]
    return moment[:, free, None], rotation[:, free, None]


def _product(left: np.ndarray, right: np.ndarray) -> np.ndarray:
    """Return the product of matrices whose last axis is that of the frequencies."""
    found: np.ndarray = (left[:, :, None] * right[None]).sum(axis=1)
    return found


def _inverse(matrix: np.ndarray) -> np.ndarray:
    """Return the inverse of matrices whose last axis is that of the frequencies."""
    if len(matrix) == 1:
        return 1.0 / matrix
    return np.ascontiguousarray(np.moveaxis(np.linalg.inv(np.moveaxis(matrix, -1, 0)), 0, -1))
