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

from standfast import eigen
from standfast.arithmetic import (
    Array,
    Matrix,
    Scalar,
    Vector,
    applied,
    dot,
    namespace,
    reciprocal,
)
from standfast.body import Body, Stiffness, checked_person
from standfast.cubic import largest_root
from standfast.dynamics import joint_gravity, joint_inertia, kinetic_energy, second_variation
from standfast.quantities import STANDARD_GRAVITY
from standfast.stability import ROUNDOFF, determinant_in_pairs, signed_by, verdict


class Modes(NamedTuple):
    """Eigenvalues and shapes of the three modes, the least stable first.

    Attributes
    ----------
    eigenvalues : (3,), rad²/s²
        ascending, signed; ``inf`` for each rigid joint.
    shapes : (3, 3), 1
        columns are modes, rows the rotations of ankle, knee and hip; the ankle's is 1, or that of
        the first joint that is not rigid. A mode at infinity has no shape: its column is 0.
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
    """
    xp = checked_person(body, stiffness, gravity)
    load = joint_gravity(body, gravity)
    inertia = joint_inertia(body)
    inverse = eigen.inverse_of_cholesky(inertia)
    # trace(A⁻¹G) bounds the fastest fall of a person without any stiffness
    shift = sum(dot(row, applied(load, row)) for row in inverse)
    vectors = eigen.spring_eigenvectors(stiffness, load, inertia, shift)

    rigid = sum(xp.where(xp.isinf(k), 1, 0) for k in stiffness)
    values = []
    shapes = []
    for number, vector in enumerate(vectors):
        finite = rigid + number < 3
        shape = _scaled_to_ankle(stiffness, vector)
        quotient = second_variation(body, stiffness, gravity, vector) / (
            2.0 * kinetic_energy(body, UPRIGHT, vector)
        )
        values.append(xp.where(finite, quotient, xp.inf))
        shapes.append([xp.where(finite, turn, 0.0) for turn in shape])
    low, middle, high = _ascending(*values)
    low = signed_by(verdict(body, stiffness, gravity), low)
    return Modes(xp.stack([low, middle, high]), xp.stack([xp.stack(s) for s in shapes], axis=-1))


UPRIGHT = (0.0, 0.0, 0.0)

# What the estimate of :func:`quick_eigenvalues` allows relative to the eigenvalue; how many
# roundings of the largest term it expects in trace and minors, how many of the determinant itself,
# and what pairs leave of the determinant's largest term. The inverse of A, whose rounding the
# estimate leaves out, costs up to 2e-13 with the proportions of the body models.
DOUBT = 5e-13
ROUNDINGS = 24.0 * ROUNDOFF
DETERMINANT_ROUNDINGS = 16.0 * ROUNDOFF
PAIR_ROUNDING = 2.0**-72


@np.errstate(all="ignore")
def quick_eigenvalues(
    body: Body, stiffness: Stiffness, gravity: Scalar
) -> tuple[Scalar, Scalar, Scalar, Scalar]:
    """Return the eigenvalues of C v = λ A v, ascending, and whether they are in doubt.

    The roots of λ³ − e1 λ² + e2 λ − e3 with e1 = tr A⁻¹C, e2 = tr adj(C) A / det A, e3 = det C /
    det A: the largest first, the others from the quadratic that is left. det C, on which the
    eigenvalue nearest 0 hangs, is summed in pairs. All three are straight lines in the hip's
    stiffness, whose coefficients a grid needs on the other axes alone.

    An error δp of the polynomial moves a root by δp/p'(λ); in doubt is what this may move by more
    than :data:`DOUBT`, that is eigenvalues near each other, and persons with a rigid joint. Many
    times faster than :func:`modes`, which is for these.
    """
    return _quick_roots(body, stiffness, gravity, joint_inertia(body))


@np.errstate(all="ignore")
def quick_reserve(body: Body, stiffness: Stiffness, gravity: Scalar) -> tuple[Scalar, Scalar]:
    """Return the smallest eigenvalue of C, as :func:`quick_eigenvalues` does, and if in doubt."""
    low, _, _, doubt = _quick_roots(body, stiffness, gravity, eigen.IDENTITY)
    return low, doubt


def _quick_roots(
    body: Body, stiffness: Stiffness, gravity: Scalar, inertia: Matrix
) -> tuple[Scalar, Scalar, Scalar, Scalar]:
    xp = namespace(*body, *stiffness, gravity)
    (g1, g2, g3), _, _ = joint_gravity(body, gravity)
    (a11, a12, a13), (_, a22, a23), (_, _, a33) = inertia
    (n11, n22, n33), _, per_volume = _adjugate(inertia)
    ankle, knee, hip = stiffness
    c11, c22, c33 = ankle - g1, knee - g2, hip - g3
    slope2 = a11 * c22 + a22 * c11 + 2.0 * a12 * g2
    rest2 = a33 * (c11 * c22 - g2**2) - (a11 + a22 - 2.0 * a12) * g3**2
    rest2 = rest2 + 2.0 * g3 * (a13 * (g2 + c22) + a23 * (g2 + c11))
    e1 = _trace(body, stiffness, gravity, inertia)
    e2 = (slope2 * per_volume) * c33 + rest2 * per_volume
    e3 = determinant_in_pairs(body, stiffness, gravity) * per_volume

    high = largest_root(e1, e2, e3, steps=1)
    # the quadratic that is left, times the square of the largest root
    half = e2 * high - e3
    root = xp.sqrt(xp.maximum(half**2 - 4.0 * e3 * high**3, 0.0))
    both = half + xp.copysign(root, half)
    inverse = reciprocal(high**2 * both)
    outer = 0.5 * both**2 * inverse
    inner = 2.0 * e3 * high**3 * inverse
    low, middle = xp.minimum(outer, inner), xp.maximum(outer, inner)

    # K − G is known to a few roundings of G and one of itself
    s1, s2, s3 = abs(c11) + g1, abs(c22) + g2, abs(c33) + g3
    scale = ROUNDINGS / DOUBT * per_volume
    size1 = (scale * n33) * s3 + scale * (n11 * s1 + n22 * s2)
    size2 = (scale * (a11 * s2 + a22 * s1)) * s3 + scale * (a33 * s1 * s2)
    size3 = (PAIR_ROUNDING / DOUBT * per_volume * s1 * s2) * s3
    size3 = size3 + DETERMINANT_ROUNDINGS / DOUBT * abs(e3)

    def moves_by(root: Scalar) -> Scalar:
        left = abs(((root - e1) * root + e2) * root - e3)  # where the root is not quite one
        return (size1 * abs(root) + size2) * abs(root) + (size3 + 3.0 / DOUBT * left)

    apart, above, across = middle - low, high - middle, high - low
    certain = (
        (moves_by(low) < abs(low) * apart * across)
        & (moves_by(middle) < abs(middle) * apart * above)
        & (moves_by(high) < abs(high) * above * across)
    )
    return low, middle, high, ~certain


def sum_of_eigenvalues(body: Body, stiffness: Stiffness, gravity: Scalar) -> Scalar:
    """Return tr A⁻¹C (rad²/s²)."""
    return _trace(body, stiffness, gravity, joint_inertia(body))


def _trace(body: Body, stiffness: Stiffness, gravity: Scalar, inertia: Matrix) -> Scalar:
    (g1, g2, g3), _, _ = joint_gravity(body, gravity)
    (n11, n22, n33), (n12, n13, n23), per_volume = _adjugate(inertia)
    ankle, knee, hip = stiffness
    of_others = n11 * (ankle - g1) + n22 * (knee - g2) - 2.0 * (n12 * g2 + (n13 + n23) * g3)
    return (n33 * per_volume) * (hip - g3) + of_others * per_volume


def _adjugate(inertia: Matrix) -> tuple[Vector, Vector, Scalar]:
    """Return adj A, its diagonal and n12, n13, n23, and 1/det A."""
    (a11, a12, a13), (_, a22, a23), (_, _, a33) = inertia
    n11, n22, n33 = a22 * a33 - a23**2, a11 * a33 - a13**2, a11 * a22 - a12**2
    n12, n13, n23 = a13 * a23 - a12 * a33, a12 * a23 - a13 * a22, a12 * a13 - a11 * a23
    return (n11, n22, n33), (n12, n13, n23), 1.0 / (a11 * n11 + a12 * n12 + a13 * n13)


def frequency(eigenvalue: Scalar) -> Scalar:
    """Return the frequency √|λ| / 2π in Hz, with the sign of λ."""
    xp = namespace(eigenvalue)
    return xp.copysign(xp.sqrt(abs(eigenvalue)), eigenvalue) / math.tau


def growth_rate(eigenvalue: Scalar) -> Scalar:
    """Return the growth rate of the fall √(−λ) in 1/s, 0 where λ ≥ 0."""
    xp = namespace(eigenvalue)
    return xp.sqrt(xp.maximum(-eigenvalue, 0.0))


def ratio_to_ankle(joint: str, stiffness: Stiffness, of: Modes) -> Scalar:
    """Return the rotation of ``"knee"`` or ``"hip"`` per rotation of the ankle, least stable mode.

    Infinite with a rigid ankle; NaN with three rigid joints, when nothing turns.
    """
    xp = namespace(*of, *stiffness)
    turn = of.shapes[Stiffness._fields.index(joint), 0]
    with_ankle = xp.where(xp.isinf(stiffness.ankle), xp.inf, turn)
    return xp.where(xp.isinf(of.eigenvalues[0]), xp.nan, with_ankle)[()]


@np.errstate(all="ignore")
def _scaled_to_ankle(stiffness: Stiffness, vector: Vector) -> Vector:
    xp = namespace(*stiffness, *vector)
    ankle, knee, hip = vector
    free_to_turn = xp.where(
        xp.isfinite(stiffness.ankle), ankle, xp.where(xp.isfinite(stiffness.knee), knee, hip)
    )
    return ankle / free_to_turn, knee / free_to_turn, hip / free_to_turn


def _ascending(a: Scalar, b: Scalar, c: Scalar) -> Vector:
    """Sort three eigenvalues that can be out of order by rounding where they are equal."""
    xp = namespace(a, b, c)
    a, b = xp.minimum(a, b), xp.maximum(a, b)
    b, c = xp.minimum(b, c), xp.maximum(b, c)
    a, b = xp.minimum(a, b), xp.maximum(a, b)
    return a, b, c
