"""One free joint with delayed feedback, in closed form: pure functions of one person.

    J q̈ + B q̇ + C q = −P q(t − τ) − D q̇(t − τ)

A root iω with z = e^(−iωτ) needs |C − Jω² + iBω| = |P + iDω|, a quadratic in ω²,

    J² ω⁴ + (B² − D² − 2JC) ω² + C² − P² = 0,

of whose roots the larger passes to the right as the delay grows and the smaller to the left.

notation: J inertia, B damping, C stiffness less gravity, P and D gains, τ delay (s).
"""

from typing import NamedTuple

import numpy as np

from standfast.numerics.arrays import TURN, Scalar, namespace


class OneJoint(NamedTuple):
    """The five numbers of one free joint."""

    inertia: Scalar  # kg·m²
    damping: Scalar  # N·m·s/rad
    stiffness: Scalar  # N·m/rad, springs less gravity
    proportional: Scalar  # N·m/rad
    derivative: Scalar  # N·m·s/rad


def undelayed_roots(joint: OneJoint) -> tuple[Scalar, Scalar]:
    """Return how many roots have a positive real part without delay, and whether it stands.

    Of J s² + b s + c: two if c > 0 > b, one if c < 0. Without gains it stands as springs do, also
    where nothing damps.
    """
    _, b, c, p, d = joint
    xp = namespace(*joint)
    rate, static = b + d, c + p
    right = xp.where(static < 0.0, 1, xp.where((static > 0.0) & (rate < 0.0), 2, 0))
    right = xp.where((static == 0.0) & (rate < 0.0), 1, right)
    no_gains = (p == 0.0) & (d == 0.0)
    stands = (static > 0.0) & ((rate > 0.0) | no_gains)
    return right, stands


@np.errstate(all="ignore")
def crossings(joint: OneJoint) -> tuple[Scalar, Scalar, Scalar, Scalar]:
    """Return ω and θ of the crossing to the right, then of that to the left; NaN without one.

    They happen at the delays (θ + 2πk)/ω, 0 ≤ θ < 2π.
    """
    j, b, c, p, d = joint
    xp = namespace(*joint)
    middle = d * d - b * b + 2.0 * j * c
    last = (c - p) * (c + p)
    spread = middle * middle - 4.0 * (j * j) * last
    root = xp.sqrt(spread)
    both = xp.where(middle >= 0.0, middle + root, middle - root)
    one, other = both / (2.0 * j * j), 2.0 * last / both
    larger, smaller = xp.maximum(one, other), xp.minimum(one, other)

    def of(square: Scalar) -> tuple[Scalar, Scalar]:
        omega = xp.sqrt(xp.where(square > 0.0, square, xp.nan))
        # e^(iθ) = −(P + iDω)/(C − Jω² + iBω)
        even, odd = c - j * square, b * omega
        back = d * omega
        theta = xp.arctan2(-(back * even - p * odd), -(p * even + back * odd))
        return omega, xp.where(theta < 0.0, theta + TURN, theta)

    return *of(larger), *of(smaller)


def critical_delay(joint: OneJoint) -> Scalar:
    """Return the smallest delay at which it ceases to stand (s); 0 or inf as everywhere."""
    xp = namespace(*joint)
    omega, theta, _, _ = crossings(joint)
    _, stands = undelayed_roots(joint)
    delay = xp.where(omega > 0.0, theta / omega, xp.inf)
    return xp.where(stands, delay, 0.0)[()]


def unstable_roots(joint: OneJoint, delay: Scalar) -> Scalar:
    """Return the number of roots with a positive real part at a delay."""
    xp = namespace(*joint, delay)
    right, _ = undelayed_roots(joint)
    to_right, start, to_left, start_left = crossings(joint)

    def passed(omega: Scalar, theta: Scalar) -> Scalar:
        turns = xp.ceil((delay * omega - theta) / TURN)
        return xp.where(turns > 0.0, turns, 0.0)

    return right + 2.0 * (passed(to_right, start) - passed(to_left, start_left))


def stands(joint: OneJoint, delay: Scalar) -> Scalar:
    """Return whether it stands at a delay: no root has a real part ≥ 0."""
    xp = namespace(*joint, delay)
    _, at_once = undelayed_roots(joint)
    no_gains = (joint.proportional == 0.0) & (joint.derivative == 0.0)
    found = (unstable_roots(joint, delay) == 0) & (joint.stiffness + joint.proportional > 0.0)
    return xp.where((delay == 0.0) | no_gains, at_once, found)
