"""The natural modes of standing: eigenvalues and shapes of C v = λ A v, in closed form.

λ = ω² where the mode sways (ω in rad/s), λ = −σ² where it falls away at the rate σ (1/s). Of each
mode the vector is found first, in closed form and without LAPACK; the eigenvalue is then the
quotient of two energies, λ = vᵀ C v / vᵀ A v. An error δ of the vector enters as δ², and the
numerator, where springs and gravity cancel near the threshold, is summed in pairs of float64.

notation: λ eigenvalue, v shape, A inertia matrix, C stiffness matrix, as in Gait & Posture 25
(2007) 432-439.
"""

import math
from typing import NamedTuple

import numpy as np

from standfast.anthropometry.body import Body
from standfast.mechanics.joints import Stiffness, checked_person
from standfast.mechanics.matrices import (
    coupling_rows,
    joint_gravity,
    joint_inertia,
    second_variation,
)
from standfast.mechanics.motion import kinetic_energy
from standfast.numerics import eigenvectors
from standfast.numerics.arrays import Array, Scalar, Vector, namespace
from standfast.numerics.vectors import dot, matvec
from standfast.parameters import STANDARD_GRAVITY
from standfast.stability.margins import signed_by
from standfast.stability.springs import verdict


class Modes(NamedTuple):
    """Eigenvalues and shapes of the three modes, the least stable first.

    Attributes
    ----------
    eigenvalues : (3,), rad²/s²
        ascending, signed; ``inf`` for each rigid joint.
    shapes : (3, 3), 1
        columns are modes, rows the rotations of ankle, knee and hip; the ankle's is 1, or that of
        the first joint that is not rigid. A mode at infinity has no shape: its column is 0.

    Examples
    --------
    >>> import standfast as sf
    >>> found = sf.modes(sf.Body.edwards2007(), sf.Stiffness(950, 2000, 738), gravity=9.8)
    >>> found.shapes[:, 1].round(3)    # ankle, knee, hip in the second mode
    array([ 1.   , -0.397, -2.46 ])
    """

    eigenvalues: Array
    shapes: Array


@np.errstate(all="ignore")
def modes(body: Body, stiffness: Stiffness, gravity: Scalar = STANDARD_GRAVITY) -> Modes:
    """Return the three modes of C v = λ A v.

    The eigenvalues are good to 1e-12 relative, also close to 0 and to each other, for body,
    stiffness (up to 1e12 N·m/rad, or rigid) and gravity taken as exact. The sign of the first is
    that of the verdict.

    Raises
    ------
    InputError
        if gravity is out of range.

    Examples
    --------
    >>> import standfast as sf
    >>> body = sf.Body.from_height_mass(1.66, 68.0)
    >>> K = sf.Stiffness(ankle=900.0, knee=1500.0, hip=400.0)
    >>> found = sf.modes(body, K)
    >>> print(f"{found.eigenvalues[0]:.3f} rad²/s²")
    0.459 rad²/s²
    >>> found.shapes[:, 0].round(3)    # ankle, knee, hip in the least stable mode
    array([1.   , 0.42 , 0.775])
    """
    xp = checked_person(body, stiffness, gravity)
    load = joint_gravity(body, gravity)
    inertia = joint_inertia(body)
    inverse = eigenvectors.inverse_of_cholesky(inertia)
    # trace(A⁻¹G) bounds the fastest fall of a person without any stiffness
    shift = sum(dot(row, matvec(load, row)) for row in inverse)
    vectors = eigenvectors.spring_eigenvectors(
        stiffness.joints, load, inertia, shift, coupling_rows(stiffness)
    )

    rigid = sum(xp.where(xp.isinf(k), 1, 0) for k in stiffness.joints)
    values, shapes = [], []
    for number, vector in enumerate(vectors):
        finite = rigid + number < 3
        inertial = 2.0 * kinetic_energy(body, (0.0, 0.0, 0.0), vector)
        quotient = second_variation(body, stiffness, gravity, vector) / inertial
        values.append(xp.where(finite, quotient, xp.inf))
        shapes.append([xp.where(finite, turn, 0.0) for turn in _scaled_to_ankle(stiffness, vector)])
    low, middle, high = _ascending(*values)
    low = signed_by(verdict(body, stiffness, gravity), low)
    return Modes(xp.stack([low, middle, high]), xp.stack([xp.stack(s) for s in shapes], axis=-1))


def frequency(body: Body, stiffness: Stiffness, gravity: Scalar = STANDARD_GRAVITY) -> Scalar:
    """Return the frequency of the least stable mode √|λ₁| / 2π (Hz), negative where it falls.

    Raises
    ------
    InputError
        if gravity is out of range.

    Examples
    --------
    >>> import standfast as sf
    >>> body = sf.Body.from_height_mass(1.66, 68.0)
    >>> K = sf.Stiffness(ankle=900.0, knee=1500.0, hip=400.0)
    >>> print(f"{sf.frequency(body, K):.3f} Hz on Earth")
    0.108 Hz on Earth
    >>> print(f"{sf.frequency(body, K, gravity=1.62):.3f} Hz on the Moon")
    0.454 Hz on the Moon
    """
    return frequency_of(modes(body, stiffness, gravity).eigenvalues[0])


def growth_rate(body: Body, stiffness: Stiffness, gravity: Scalar = STANDARD_GRAVITY) -> Scalar:
    """Return the growth rate of the fall √(−λ₁) (1/s), 0 where the person stands.

    Raises
    ------
    InputError
        if gravity is out of range.

    Examples
    --------
    >>> import standfast as sf
    >>> body = sf.Body.from_height_mass(1.66, 68.0)
    >>> K = sf.Stiffness(ankle=900.0, knee=1500.0, hip=400.0)
    >>> float(sf.growth_rate(body, K))
    0.0
    >>> print(f"{sf.growth_rate(body, K._replace(ankle=700.0)):.3f} 1/s")
    1.020 1/s
    """
    return growth_rate_of(modes(body, stiffness, gravity).eigenvalues[0])


def frequency_of(eigenvalue: Scalar) -> Scalar:
    """Return the frequency √|λ| / 2π in Hz, with the sign of λ."""
    xp = namespace(eigenvalue)
    return xp.copysign(xp.sqrt(abs(eigenvalue)), eigenvalue) / math.tau


def growth_rate_of(eigenvalue: Scalar) -> Scalar:
    """Return the growth rate of the fall √(−λ) in 1/s, 0 where λ ≥ 0."""
    xp = namespace(eigenvalue)
    stands = eigenvalue >= 0.0
    # the root of 0 has no slope, so none is drawn where the person stands
    return xp.where(stands, 0.0, xp.sqrt(xp.where(stands, 1.0, -eigenvalue)))[()]


def ratio_to_ankle(joint: str, stiffness: Stiffness, of: Modes) -> Scalar:
    """Return the rotation of ``"knee"`` or ``"hip"`` per rotation of the ankle, least stable mode.

    Infinite with a rigid ankle; NaN with three rigid joints, when nothing turns.
    """
    xp = namespace(*of, *stiffness)
    turn = of.shapes[Stiffness._fields.index(joint), 0]
    with_ankle = xp.where(xp.isinf(stiffness.ankle), xp.inf, turn)
    # of the stiffnesses, not of the infinite eigenvalue: so no one need compute eigenvalues for it
    still = xp.isinf(stiffness.ankle) & xp.isinf(stiffness.knee) & xp.isinf(stiffness.hip)
    return xp.where(still, xp.nan, with_ankle)[()]


@np.errstate(all="ignore")
def _scaled_to_ankle(stiffness: Stiffness, vector: Vector) -> Vector:
    xp = namespace(*stiffness, *vector)
    ankle, knee, hip = vector
    above_ankle = xp.where(xp.isfinite(stiffness.knee), knee, hip)
    free_to_turn = xp.where(xp.isfinite(stiffness.ankle), ankle, above_ankle)
    return ankle / free_to_turn, knee / free_to_turn, hip / free_to_turn


def _ascending(a: Scalar, b: Scalar, c: Scalar) -> Vector:
    """Sort three eigenvalues that can be out of order by rounding where they are equal."""
    xp = namespace(a, b, c)
    a, b = xp.minimum(a, b), xp.maximum(a, b)
    b, c = xp.minimum(b, c), xp.maximum(b, c)
    a, b = xp.minimum(a, b), xp.maximum(a, b)
    return a, b, c
