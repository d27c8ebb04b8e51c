"""Energies, the matrices A and C, and the nonlinear equations of motion of the standing person.

The feet are fixed; shank, thigh and upper body turn in the sagittal plane about ankle, knee and
hip. ``rotation`` q = (θa, θk, θh) holds the rotations between adjacent segments, all counted in
the same sense (rad), so a segment's angle from the vertical is the sum of the rotations below it:
φ = T q with T = [[1, 0, 0], [1, 1, 0], [1, 1, 1]].

notation: m mass, I inertia, h length, e height of the centre of mass in its segment, K stiffness,
g gravity; s, t, b shank, thigh, upper body; a, k, h ankle, knee, hip (Gait & Posture 25 (2007)
432-439). The paper's appendix with A and C is not in its printed text; they are derived here.
"""

from typing import Any

import numpy as np

from standfast.arithmetic import (
    Array,
    Matrix,
    Pair,
    Scalar,
    Vector,
    add,
    minus,
    multiply,
    namespace,
    product,
)
from standfast.body import Body, Stiffness, checked_person, checked_scalar
from standfast.quantities import STANDARD_GRAVITY


def inertia_matrix(body: Body) -> Array:
    """Return the inertia matrix A of the linearised equations A q̈ + C q = 0.

    A = Tᵀ M T, with M of :func:`segment_inertia`.

    Returns
    -------
    (3, 3), kg·m², symmetric and positive definite; rows ankle, knee, hip.
    """
    return _stacked(joint_inertia(body))


def stiffness_matrix(body: Body, stiffness: Stiffness, gravity: Scalar = STANDARD_GRAVITY) -> Array:
    """Return the stiffness matrix C of the linearised equations, springs less gravity.

    C = diag(Ka, Kk, Kh) − [[G1, G2, G3], [G2, G2, G3], [G3, G3, G3]]
    with G1 = γs + γt + γb, G2 = γt + γb, G3 = γb of :func:`gravity_loads`.

    Returns
    -------
    (3, 3), N·m/rad, symmetric; a rigid joint has ``inf`` on the diagonal.

    Raises
    ------
    InputError
        if gravity is out of range.
    """
    checked_person(body, stiffness, gravity)
    (g1, g2, g3), _, _ = joint_gravity(body, gravity)
    ankle, knee, hip = stiffness
    return _stacked(
        (
            (ankle - g1, -g2, -g3),
            (-g2, knee - g2, -g3),
            (-g3, -g3, hip - g3),
        )
    )


def gravity_loads(body: Body, gravity: Scalar = STANDARD_GRAVITY) -> Vector:
    """Return the gravity load of each segment: its toppling moment per radian of its own angle.

    γs = g (ms es + (mt + mb) hs),  γt = g (mt et + mb ht),  γb = g mb eb

    Returns
    -------
    shank, thigh, upper body; N·m/rad, all positive.

    Raises
    ------
    InputError
        if gravity is out of range.
    """
    g = checked_scalar("gravity", gravity)
    namespace(*body, g)  # refuses single precision
    ms, mt, mb = body.segment_mass
    hs, ht = body.segment_length
    es, et, eb = body.segment_com
    return (
        g * (ms * es + (mt + mb) * hs),
        g * (mt * et + mb * ht),
        g * (mb * eb),
    )


def joint_gravity(body: Body, gravity: Scalar) -> Matrix:
    """Return the gravity part of C, as rows, with a positive sign: C = diag(K) − this."""
    shank, thigh, upper = gravity_loads(body, gravity)
    g1, g2, g3 = shank + (thigh + upper), thigh + upper, upper
    return ((g1, g2, g3), (g2, g2, g3), (g3, g3, g3))


def segment_inertia(body: Body) -> Matrix:
    """Return M, the inertia matrix in segment angles at the upright posture, as rows.

    M = [[Is + ms es² + (mt + mb) hs², (mt et + mb ht) hs, mb hs eb],
         [·,                           It + mt et² + mb ht², mb ht eb],
         [·,                           ·,                    Ib + mb eb²]]
    """
    ms, mt, mb = body.segment_mass
    i_s, i_t, i_b = body.segment_inertia
    hs, ht = body.segment_length
    es, et, eb = body.segment_com
    m12 = (mt * et + mb * ht) * hs
    m13 = mb * hs * eb
    m23 = mb * ht * eb
    return (
        (i_s + ms * es**2 + (mt + mb) * hs**2, m12, m13),
        (m12, i_t + mt * et**2 + mb * ht**2, m23),
        (m13, m23, i_b + mb * eb**2),
    )


def joint_inertia(body: Body) -> Matrix:
    """Return A = Tᵀ M T as rows: each entry sums the part of M below and right of it."""
    (m11, m12, m13), (_, m22, m23), (_, _, m33) = segment_inertia(body)
    a33 = m33
    a23 = m23 + m33
    a13 = m13 + a23
    a22 = m22 + m23 + a23
    a12 = m12 + m13 + a22
    a11 = m11 + m12 + m13 + a12
    return ((a11, a12, a13), (a12, a22, a23), (a13, a23, a33))


def segment_angles(rotation: Vector) -> Vector:
    """Return φ = T q, the angles of shank, thigh and upper body from the vertical (rad)."""
    ankle, knee, hip = rotation
    return (ankle, ankle + knee, ankle + knee + hip)


def potential_energy(body: Body, stiffness: Stiffness, gravity: Scalar, rotation: Vector) -> Scalar:
    """Return the energy of springs and gravity at any posture, 0 when upright (J).

    V = ½ (Ka θa² + Kk θk² + Kh θh²) − γs (1 − cos φs) − γt (1 − cos φt) − γb (1 − cos φb).
    A rigid joint stores nothing while its rotation is 0, and would store infinitely much.
    """
    xp = namespace(*body, *stiffness, gravity, *rotation)
    springs = sum(
        0.5 * _spring_moment(xp, k, angle) * angle
        for k, angle in zip(stiffness, rotation, strict=True)
    )
    # 1 − cos φ as 2 sin²(φ/2), which keeps its digits at small angles
    drop = sum(
        load * 2.0 * xp.sin(0.5 * angle) ** 2
        for load, angle in zip(gravity_loads(body, gravity), segment_angles(rotation), strict=True)
    )
    return springs - drop


def kinetic_energy(body: Body, rotation: Vector, velocity: Vector) -> Scalar:
    """Return the kinetic energy at any posture and joint velocity (rad/s), in J.

    T = ½ Σ m (ẋ² + ż²) + ½ Σ I φ̇², with the velocity of each centre of mass written out.
    """
    xp = namespace(*body, *rotation, *velocity)
    hs, ht = body.segment_length
    es, et, eb = body.segment_com
    angles = segment_angles(rotation)
    rates = segment_angles(velocity)
    energy = 0.0
    for mass, inertia, arms, rate in zip(
        body.segment_mass,
        body.segment_inertia,
        ((es, 0.0, 0.0), (hs, et, 0.0), (hs, ht, eb)),
        rates,
        strict=True,
    ):
        parts = list(zip(arms, angles, rates, strict=True))
        forward = sum(arm * xp.cos(angle) * turn for arm, angle, turn in parts)
        downward = sum(arm * xp.sin(angle) * turn for arm, angle, turn in parts)
        energy = energy + 0.5 * mass * (forward**2 + downward**2) + 0.5 * inertia * rate**2
    return energy


def joint_moments(
    body: Body,
    stiffness: Stiffness,
    gravity: Scalar,
    rotation: Vector,
    velocity: Vector,
    acceleration: Vector,
) -> Array:
    """Return the outer moments that a motion needs: the full nonlinear equations of motion.

    In segment angles, with M of :func:`segment_inertia` and moments taken back by Tᵀ:
    Tᵀ [ Σj Mij cos(φi − φj) φ̈j + Σj Mij sin(φi − φj) φ̇j² − γi sin φi ] + K q = moments.
    Linearised about upright this is A q̈ + C q.

    Returns
    -------
    (3,), N·m, at ankle, knee and hip; 0 for free motion. At a rigid joint that does not turn it is
    the moment that the joint bears.
    """
    xp = namespace(*body, *stiffness, gravity, *rotation, *velocity, *acceleration)
    inertia = segment_inertia(body)
    angles = segment_angles(rotation)
    rates = segment_angles(velocity)
    turning = segment_angles(acceleration)
    on_segments = [
        sum(
            inertia[i][j]
            * (
                xp.cos(angles[i] - angles[j]) * turning[j]
                + xp.sin(angles[i] - angles[j]) * rates[j] ** 2
            )
            for j in range(3)
        )
        - load * xp.sin(angles[i])
        for i, load in enumerate(gravity_loads(body, gravity))
    ]
    springs = [_spring_moment(xp, k, angle) for k, angle in zip(stiffness, rotation, strict=True)]
    return xp.stack([springs[i] + sum(on_segments[i:]) for i in range(3)])


@np.errstate(invalid="ignore")
def _spring_moment(xp: Any, stiffness: Scalar, angle: Scalar) -> Scalar:
    """Return K θ; 0 for a rigid joint that does not turn."""
    return xp.where(xp.isinf(stiffness) & (angle == 0.0), 0.0, stiffness * xp.asarray(angle))


def second_variation(body: Body, stiffness: Stiffness, gravity: Scalar, rotation: Vector) -> Scalar:
    """Return qᵀ C q, twice the potential energy of a small rotation, to the last digits.

    qᵀ C q = Ka θa² + Kk θk² + Kh θh² − γs φs² − γt φt² − γb φb²: near the threshold of stability
    springs and gravity cancel, so the whole sum is carried in pairs of float64. A rigid joint
    stores nothing: its rotation is 0.
    """
    xp = namespace(*body, *stiffness, gravity, *rotation)
    total: Pair = (xp.asarray(0.0), xp.asarray(0.0))
    for k, turn in zip(stiffness, rotation, strict=True):
        flexible = xp.where(xp.isinf(k), 0.0, k)
        total = add(total, multiply(product(turn, turn), (flexible, 0.0)))
    angle: Pair = (xp.asarray(0.0), xp.asarray(0.0))
    for load, turn in zip(gravity_load_pairs(body, gravity), rotation, strict=True):
        angle = add(angle, (turn, 0.0))
        total = add(total, minus(multiply(load, multiply(angle, angle))))
    return total[0] + total[1]


def gravity_load_pairs(body: Body, gravity: Scalar) -> tuple[Pair, Pair, Pair]:
    """Return :func:`gravity_loads` in pairs."""
    ms, mt, mb = body.segment_mass
    hs, ht = body.segment_length
    es, et, eb = body.segment_com
    shank = add(add(product(ms, es), product(mt, hs)), product(mb, hs))
    thigh = add(product(mt, et), product(mb, ht))
    upper = product(mb, eb)
    g = (checked_scalar("gravity", gravity), 0.0)
    return multiply(shank, g), multiply(thigh, g), multiply(upper, g)


def _stacked(rows: Matrix) -> Array:
    xp = namespace(*(entry for row in rows for entry in row))
    return xp.stack([xp.stack([xp.asarray(entry) for entry in row]) for row in rows])
