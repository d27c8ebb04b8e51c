"""Fast ways to margins and eigenvalues on grids, each with the points where it is uncertain.

Each returns ``(found, uncertain)``: where uncertain, the reference function of the same quantity
is to be asked. They solve the characteristic polynomial, which makes three eigenvalues 15 times as
fast as :func:`standfast.modes`, by vectors and energies in 79 bits (``results/benchmarks``).

notation: λ eigenvalue, A inertia matrix, C stiffness matrix, G its gravity part, K stiffness.
"""

from typing import NamedTuple

import numpy as np

from standfast.anthropometry.body import Body
from standfast.mechanics.joints import Stiffness
from standfast.mechanics.matrices import joint_gravity, joint_inertia, stiffness_rows
from standfast.numerics import eigenvectors
from standfast.numerics.arrays import ROUNDOFF, Matrix, Scalar, Vector, namespace
from standfast.numerics.cubic import largest_root
from standfast.stability.margins import determinant_in_pairs

# What the estimate of :func:`_roots` allows relative to the eigenvalue; how many roundings of the
# largest term it expects in trace and minors, how many of the determinant itself, and what pairs
# leave of the determinant's largest term. The inverse of A, whose rounding the estimate leaves out,
# costs up to 2e-13 with the proportions of the body models.
ALLOWED = 5e-13
ROUNDINGS = 24.0 * ROUNDOFF
DETERMINANT_ROUNDINGS = 16.0 * ROUNDOFF
PAIR_ROUNDING = 2.0**-72


class Spectrum(NamedTuple):
    """Eigenvalues without shapes, ascending (rad²/s²)."""

    eigenvalues: tuple[Scalar, Scalar, Scalar]


@np.errstate(all="ignore")
def fast_eigenvalues(body: Body, stiffness: Stiffness, gravity: Scalar) -> tuple[Spectrum, Scalar]:
    """Return the eigenvalues of C v = λ A v, and whether they are uncertain.

    The roots of λ³ − e1 λ² + e2 λ − e3 with e1 = tr A⁻¹C, e2 = tr adj(C) A / det A, e3 = det C /
    det A: the largest first, the others from the quadratic that is left. det C, on which the
    eigenvalue nearest 0 hangs, is summed in pairs. All three are straight lines in the hip's
    stiffness, whose coefficients a grid needs on the other axes alone.

    An error δp of the polynomial moves a root by δp/p'(λ); uncertain is what this may move by more
    than :data:`ALLOWED`, that is eigenvalues near each other, and persons with a rigid joint.
    """
    low, middle, high, uncertain = _roots(body, stiffness, gravity, joint_inertia(body))
    return Spectrum((low, middle, high)), uncertain


@np.errstate(all="ignore")
def fast_reserve(body: Body, stiffness: Stiffness, gravity: Scalar) -> tuple[Scalar, Scalar]:
    """Return the smallest eigenvalue of C, found as those of A⁻¹C, and whether it is uncertain."""
    low, _, _, uncertain = _roots(body, stiffness, gravity, eigenvectors.IDENTITY)
    return low, uncertain


def _roots(
    body: Body, stiffness: Stiffness, gravity: Scalar, inertia: Matrix
) -> tuple[Scalar, Scalar, Scalar, Scalar]:
    """Return the roots of det(C − λ B), ascending, and whether they are uncertain; B = inertia."""
    xp = namespace(*body, *stiffness, gravity)
    (g1, g2, g3), _, _ = joint_gravity(body, gravity)
    (a11, a12, a13), (_, a22, a23), (_, _, a33) = inertia
    (n11, n22, n33), (n12, n13, n23), per_volume = _adjugate(inertia)
    (c11, _, _), (_, c22, _), (_, _, c33) = stiffness_rows(body, stiffness, gravity)
    slope2 = a11 * c22 + a22 * c11 + 2.0 * a12 * g2
    rest2 = a33 * (c11 * c22 - g2**2) - (a11 + a22 - 2.0 * a12) * g3**2
    rest2 = rest2 + 2.0 * g3 * (a13 * (g2 + c22) + a23 * (g2 + c11))
    rest1 = n11 * c11 + n22 * c22 - 2.0 * (n12 * g2 + (n13 + n23) * g3)
    e1 = (n33 * per_volume) * c33 + rest1 * per_volume
    e2 = (slope2 * per_volume) * c33 + rest2 * per_volume
    e3 = determinant_in_pairs(body, stiffness, gravity) * per_volume

    high = largest_root(e1, e2, e3, steps=1)
    # the quadratic that is left, times the square of the largest root
    half = e2 * high - e3
    root = xp.sqrt(xp.maximum(half**2 - 4.0 * e3 * high**3, 0.0))
    both = half + xp.copysign(root, half)
    outer = 0.5 * both / high**2
    inner = 2.0 * e3 * high / both
    low, middle = xp.minimum(outer, inner), xp.maximum(outer, inner)

    # K − G is known to a few roundings of G and one of itself
    s1, s2, s3 = abs(c11) + g1, abs(c22) + g2, abs(c33) + g3
    scale = ROUNDINGS / ALLOWED * per_volume
    size1 = (scale * n33) * s3 + scale * (n11 * s1 + n22 * s2)
    size2 = (scale * (a11 * s2 + a22 * s1)) * s3 + scale * (a33 * s1 * s2)
    size3 = (PAIR_ROUNDING / ALLOWED * per_volume * s1 * s2) * s3
    size3 = size3 + DETERMINANT_ROUNDINGS / ALLOWED * abs(e3)

    def moves_by(root: Scalar) -> Scalar:
        left = abs(((root - e1) * root + e2) * root - e3)  # where the root is not quite one
        return (size1 * abs(root) + size2) * abs(root) + (size3 + 3.0 / ALLOWED * left)

    apart, above, across = middle - low, high - middle, high - low
    certain = (
        (moves_by(low) < abs(low) * apart * across)
        & (moves_by(middle) < abs(middle) * apart * above)
        & (moves_by(high) < abs(high) * above * across)
    )
    return low, middle, high, ~certain


def _adjugate(inertia: Matrix) -> tuple[Vector, Vector, Scalar]:
    """Return adj A, its diagonal and n12, n13, n23, and 1/det A."""
    (a11, a12, a13), (_, a22, a23), (_, _, a33) = inertia
    n11, n22, n33 = a22 * a33 - a23**2, a11 * a33 - a13**2, a11 * a22 - a12**2
    n12, n13, n23 = a13 * a23 - a12 * a33, a12 * a23 - a13 * a22, a12 * a13 - a11 * a23
    return (n11, n22, n33), (n12, n13, n23), 1.0 / (a11 * n11 + a12 * n12 + a13 * n13)
