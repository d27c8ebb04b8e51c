"""Energies and the nonlinear equations of motion of the standing person, at any posture.

``rotation`` q = (θa, θk, θh) holds the rotations between adjacent segments, all counted in the
same sense (rad), so a segment's angle from the vertical is the sum of the rotations below it:
φ = T q with T = [[1, 0, 0], [1, 1, 0], [1, 1, 1]].

notation: m mass, I inertia, h length, e height of the centre of mass in its segment, K stiffness,
g gravity; s, t, b shank, thigh, upper body; a, k, h ankle, knee, hip (Gait & Posture 25 (2007)
432-439).
"""

from typing import Any

import numpy as np

from standfast.anthropometry.body import Body
from standfast.errors import InputError, shortened
from standfast.mechanics.joints import Stiffness, checked_body, checked_person
from standfast.mechanics.matrices import coupling_rows, gravity_loads, segment_inertia
from standfast.numerics.arrays import Array, Scalar, Vector, in_numpy, is_traced, namespace
from standfast.numerics.vectors import dot
from standfast.parameters import JOINTS, STANDARD_GRAVITY


def segment_angles(rotation: Vector) -> Vector:
    """Return φ = T q, the angles of shank, thigh and upper body from the vertical (rad)."""
    ankle, knee, hip = rotation
    return (ankle, ankle + knee, ankle + knee + hip)


def potential_energy(
    body: Body, stiffness: Stiffness, rotation: Vector, gravity: Scalar = STANDARD_GRAVITY
) -> Scalar:
    """Return the energy of springs and gravity at any posture, 0 when upright (J).

    V = ½ qᵀ K q − γs (1 − cos φs) − γt (1 − cos φt) − γb (1 − cos φb).
    A rigid joint stores nothing while its rotation is 0, and would store infinitely much.

    Raises
    ------
    InputError
        if gravity is out of range, or a motion is not of three joints.

    Examples
    --------
    >>> import standfast as sf
    >>> body = sf.Body.edwards2007()
    >>> K = sf.Stiffness(950, 2000, 738)
    >>> print(f"{sf.potential_energy(body, K, (0.1, 0, 0)):.2f} J")
    1.09 J
    """
    checked_person(body, stiffness, gravity)
    _check_turns(rotation=rotation)
    xp = namespace(*body, *stiffness, gravity, *rotation)
    moments = zip(_spring_moments(xp, stiffness, rotation), rotation, strict=True)
    springs = sum(0.5 * moment * angle for moment, angle in moments)
    # 1 − cos φ as 2 sin²(φ/2), which keeps its digits at small angles
    segments = zip(gravity_loads(body, gravity), segment_angles(rotation), strict=True)
    drop = sum(load * 2.0 * xp.sin(0.5 * angle) ** 2 for load, angle in segments)
    return springs - drop


def kinetic_energy(body: Body, rotation: Vector, velocity: Vector) -> Scalar:
    """Return the kinetic energy at any posture and joint velocity (rad/s), in J.

    T = ½ Σ m (ẋ² + ż²) + ½ Σ I φ̇², with the velocity of each centre of mass written out.

    Examples
    --------
    >>> import standfast as sf
    >>> body = sf.Body.edwards2007()
    >>> print(f"{sf.kinetic_energy(body, (0.1, 0, 0), (0.5, 0, 0)):.2f} J")
    10.90 J
    """
    checked_body(body)
    _check_turns(rotation=rotation, velocity=velocity)
    xp = namespace(*body, *rotation, *velocity)
    hs, ht = body.segment_length
    es, et, eb = body.segment_com
    angles = segment_angles(rotation)
    rates = segment_angles(velocity)
    lever_arms = ((es, 0.0, 0.0), (hs, et, 0.0), (hs, ht, eb))
    segments = zip(body.segment_mass, body.segment_inertia, lever_arms, rates, strict=True)
    energy = 0.0
    for mass, inertia, arms, rate in segments:
        parts = list(zip(arms, angles, rates, strict=True))
        forward = sum(arm * xp.cos(angle) * turn for arm, angle, turn in parts)
        downward = sum(arm * xp.sin(angle) * turn for arm, angle, turn in parts)
        energy = energy + 0.5 * mass * (forward**2 + downward**2) + 0.5 * inertia * rate**2
    return energy


def joint_moments(
    body: Body,
    stiffness: Stiffness,
    rotation: Vector,
    velocity: Vector,
    acceleration: Vector,
    gravity: Scalar = STANDARD_GRAVITY,
) -> Array:
    """Return the outer moments that a motion needs: the full nonlinear equations of motion.

    In segment angles, with M as of :func:`.inertia_matrix` and moments taken back by Tᵀ:
    Tᵀ [ Σj Mij cos(φi − φj) φ̈j + Σj Mij sin(φi − φj) φ̇j² − γi sin φi ] + K q = moments.
    Linearised about upright this is A q̈ + C q.

    Returns
    -------
    (3,), N·m, at ankle, knee and hip; 0 for free motion. At a rigid joint that does not turn it is
    the moment that the joint bears.

    Raises
    ------
    InputError
        if gravity is out of range, or a motion is not of three joints.

    Examples
    --------
    >>> import standfast as sf
    >>> body, K = sf.Body.edwards2007(), sf.Stiffness(950, 2000, 738)
    >>> leaning, still = (0.1, 0, 0), (0, 0, 0)
    >>> sf.joint_moments(body, K, leaning, still, still).round(1)
    array([ 22. , -43.3, -18. ])
    """
    checked_person(body, stiffness, gravity)
    _check_turns(rotation=rotation, velocity=velocity, acceleration=acceleration)
    xp = namespace(*body, *stiffness, gravity, *rotation, *velocity, *acceleration)
    inertia = segment_inertia(body)
    angles = segment_angles(rotation)
    rates = segment_angles(velocity)
    turning = segment_angles(acceleration)
    on_segments = []
    for row, angle, load in zip(inertia, angles, gravity_loads(body, gravity), strict=True):
        moment = sum(
            entry * (xp.cos(angle - other) * turn + xp.sin(angle - other) * rate**2)
            for entry, other, rate, turn in zip(row, angles, rates, turning, strict=True)
        )
        on_segments.append(moment - load * xp.sin(angle))
    springs = _spring_moments(xp, stiffness, rotation)
    return xp.stack([springs[i] + sum(on_segments[i:]) for i in range(3)])


def _check_turns(**turns: Vector) -> None:
    """Refuse a motion that is not of three joints, or not of finite numbers where it has them."""
    for name, values in turns.items():
        three = hasattr(values, "__len__") and len(values) == len(JOINTS)
        if not three or not all(map(_is_finite, in_numpy(values))):
            raise InputError(f"{name} = {shortened(values)} is not three numbers: ankle, knee, hip")


def _is_finite(value: Any) -> bool:
    if is_traced(value):
        return True
    number = np.asarray(value)
    if number.dtype == object:  # a symbol, which can be calculated with
        return hasattr(value, "__mul__")
    return number.dtype.kind in "iuf" and bool(np.isfinite(number).all())


def _spring_moments(xp: Any, stiffness: Stiffness, rotation: Vector) -> list[Scalar]:
    """Return K q, the moments of the springs."""
    turned = zip(stiffness.joints, rotation, strict=True)
    moments = [_spring_moment(xp, k, angle) for k, angle in turned]
    across = coupling_rows(stiffness)
    if across is None:
        return moments
    return [moment + dot(row, rotation) for moment, row in zip(moments, across, strict=True)]


@np.errstate(invalid="ignore")
def _spring_moment(xp: Any, stiffness: Scalar, angle: Scalar) -> Scalar:
    """Return K θ; 0 for a rigid joint that does not turn."""
    return xp.where(xp.isinf(stiffness) & (angle == 0.0), 0.0, stiffness * xp.asarray(angle))
