"""By how much the person stands or falls: det C, stiffness reserve, safety factor.

notation: C stiffness matrix, G its gravity part, K stiffness (Gait & Posture 25 (2007) 432-439).
"""

import numpy as np

from standfast.anthropometry.body import Body
from standfast.mechanics import matrices
from standfast.mechanics.joints import Stiffness, checked_person
from standfast.numerics import eigenvectors
from standfast.numerics.arrays import ROUNDOFF, Matrix, Scalar, Vector, namespace
from standfast.numerics.cubic import largest_root
from standfast.numerics.pairs import add, difference_of_products, multiply, negate
from standfast.numerics.vectors import dot
from standfast.parameters import STANDARD_GRAVITY
from standfast.stability.springs import loads_of_springs, verdict

NOTHING: Vector = (0.0, 0.0, 0.0)


def stability_determinant(
    body: Body, stiffness: Stiffness, gravity: Scalar = STANDARD_GRAVITY
) -> Scalar:
    """Return det C in (N·m/rad)³.

    With a rigid joint it is infinite, with the sign of the determinant without that joint.

    Raises
    ------
    InputError
        if gravity is out of range.

    Examples
    --------
    >>> import standfast as sf
    >>> body = sf.Body.from_height_mass(1.66, 68.0)
    >>> K = sf.Stiffness(ankle=900.0, knee=1500.0, hip=400.0)
    >>> print(f"{sf.stability_determinant(body, K):.3e} (N·m/rad)³")
    1.857e+07 (N·m/rad)³
    """
    xp = checked_person(body, stiffness, gravity)
    (c11, c12, c13), (_, c22, c23), (_, _, c33) = matrices.stiffness_rows(body, stiffness, gravity)
    # a rigid joint is taken out: its row and column are those of 1
    no_ankle, no_knee, no_hip = (xp.isinf(k) for k in stiffness.joints)
    c11 = xp.where(no_ankle, 1.0, c11)
    c22 = xp.where(no_knee, 1.0, c22)
    c33 = xp.where(no_hip, 1.0, c33)
    c12 = xp.where(no_ankle | no_knee, 0.0, c12)
    c13 = xp.where(no_ankle | no_hip, 0.0, c13)
    c23 = xp.where(no_knee | no_hip, 0.0, c23)
    determinant = (
        c11 * (c22 * c33 - c23**2) - c12 * (c12 * c33 - c23 * c13) + c13 * (c12 * c23 - c22 * c13)
    )
    any_rigid = no_ankle | no_knee | no_hip
    return xp.where(any_rigid, xp.copysign(xp.inf, determinant), determinant)[()]


def determinant_in_pairs(body: Body, stiffness: Stiffness, gravity: Scalar) -> Scalar:
    """Return det C, right to the last digits also where it is nearly 0; NaN with a rigid joint.

    det C = c33 (c11 c22 − G2²) − G3² (c11 + c22 + 2 G2), summed in pairs of float64.
    """
    xp = namespace(*body, *stiffness, gravity)
    shank, thigh, g3 = matrices.gravity_load_pairs(body, gravity)
    g2 = add(thigh, g3)
    g1 = add(shank, g2)
    joints = zip(stiffness.joints, (g1, g2, g3), strict=True)
    c11, c22, c33 = (add((xp.asarray(k), 0.0), negate(g)) for k, g in joints)
    of_hip = add(multiply(c11, c22), negate(multiply(g2, g2)))
    rest = multiply(multiply(g3, g3), add(add(c11, c22), add(g2, g2)))
    return difference_of_products(c33, of_hip, rest)


@np.errstate(all="ignore")
def stiffness_reserve(
    body: Body, stiffness: Stiffness, gravity: Scalar = STANDARD_GRAVITY
) -> Scalar:
    """Return the smallest eigenvalue of C: what every joint could lose at once (N·m/rad).

    Negative where every joint must gain that much. A rigid joint loses nothing and is left out;
    with three rigid joints the reserve is infinite. Its sign is that of :func:`is_stable`.

    Raises
    ------
    InputError
        if gravity is out of range.

    Examples
    --------
    >>> import standfast as sf
    >>> body = sf.Body.from_height_mass(1.66, 68.0)
    >>> K = sf.Stiffness(ankle=900.0, knee=1500.0, hip=400.0)
    >>> print(f"{sf.stiffness_reserve(body, K):.2f} N·m/rad")
    36.91 N·m/rad
    """
    checked_person(body, stiffness, gravity)
    load = matrices.joint_gravity(body, gravity)
    shift = load[0][0] + load[1][1] + load[2][2]
    across = matrices.coupling_rows(stiffness)
    softest = eigenvectors.spring_eigenvectors(
        stiffness.joints, load, eigenvectors.IDENTITY, shift, across
    )[0]
    lost = matrices.second_variation(body, stiffness, gravity, softest)
    quotient = lost / dot(softest, softest)
    return signed_by(verdict(body, stiffness, gravity), unless_all_rigid(stiffness, quotient))


@np.errstate(all="ignore")
def safety_factor(body: Body, stiffness: Stiffness, gravity: Scalar = STANDARD_GRAVITY) -> Scalar:
    """Return the factor by which all stiffnesses could be divided and the person just stand.

    The smallest s of K v = s G v, with G the gravity part of C. Of joints that nothing couples
    x = 1/s is the largest root of x³ − t x² + m x − d, with t, m, d the trace, the sum of the
    principal minors and the determinant of K⁻¹ G: sums and products of positive numbers. All
    entries of K⁻¹ G are positive, so the root is simple; it is found as a multiple of the trace.
    Above 1 exactly where the verdict is stable; 0 with a free joint, or where K of coupled joints
    is not positive definite; infinite with three rigid joints.

    Raises
    ------
    InputError
        if gravity is out of range.

    Examples
    --------
    >>> import standfast as sf
    >>> body = sf.Body.from_height_mass(1.66, 68.0)
    >>> K = sf.Stiffness(ankle=900.0, knee=1500.0, hip=400.0)
    >>> print(f"{sf.safety_factor(body, K):.3f}")
    1.050
    """
    xp = checked_person(body, stiffness, gravity)
    if stiffness.is_coupled:
        factor = _coupled_factor(body, stiffness, gravity)
    else:
        factor = _uncoupled_factor(body, stiffness, gravity)
    # within rounding of 1 the verdict decides
    above, below = xp.maximum(factor, 1.0 + 2.0 * ROUNDOFF), xp.minimum(factor, 1.0)
    return xp.where(verdict(body, stiffness, gravity), above, below)[()]


def _uncoupled_factor(body: Body, stiffness: Stiffness, gravity: Scalar) -> Scalar:
    xp = namespace(*body, *stiffness, gravity)
    shank, thigh, upper = matrices.gravity_loads(body, gravity)
    below = thigh + upper
    # a joint as good as free, below 1e-60 N·m/rad, would overflow the determinant
    ankle, knee, hip = (1.0 / xp.maximum(xp.asarray(k), 1e-60) for k in stiffness.joints)
    trace = (shank + below) * ankle + below * knee + upper * hip
    trace = xp.where(trace > 0.0, trace, 1.0)  # three rigid joints, whose slopes would be NaN
    minors = ankle * (shank * below * knee + (shank + thigh) * upper * hip)
    minors = minors + thigh * upper * knee * hip
    determinant = shank * thigh * upper * ankle * knee * hip
    share = largest_root(1.0, minors / trace**2, determinant / trace**3, steps=2)
    factor = unless_all_rigid(stiffness, 1.0 / (trace * share))
    free = [k == 0.0 for k in stiffness.joints]
    # beside one free joint the factor grows as its stiffness over its load, beside more not at all
    one = (1 * free[0] + 1 * free[1] + 1 * free[2]) == 1
    loads = (shank + below, below, upper)
    of_free = sum(
        xp.where(is_free, k, 0.0) / load
        for is_free, k, load in zip(free, stiffness.joints, loads, strict=True)
    )
    return xp.where(free[0] | free[1] | free[2], xp.where(one, of_free, 0.0), factor)


def _coupled_factor(body: Body, stiffness: Stiffness, gravity: Scalar) -> Scalar:
    """Return the smallest s of K v = s G v as the quotient of the energies of springs and gravity.

    It is 0 where K is not positive definite, since then no multiple of it holds.
    """
    xp = namespace(*body, *stiffness, gravity)
    load = matrices.joint_gravity(body, gravity)
    across = matrices.coupling_rows(stiffness)
    nothing: Matrix = (NOTHING, NOTHING, NOTHING)
    ankle, knee, hip = eigenvectors.spring_eigenvectors(
        stiffness.joints, nothing, load, 1.0, across
    )[0]
    angles = (ankle, ankle + knee, ankle + knee + hip)
    loads = matrices.gravity_loads(body, gravity)
    drop = sum(load * angle**2 for load, angle in zip(loads, angles, strict=True))
    stored = matrices.second_variation(body, stiffness, 0.0, (ankle, knee, hip))
    holds = stiffness.ankle > loads_of_springs(stiffness)[0]
    return xp.where(holds, unless_all_rigid(stiffness, stored / drop), 0.0)


def signed_by(stable: Scalar, value: Scalar) -> Scalar:
    """Return the margin with the sign of the verdict: positive exactly where stable.

    The two are computed by different routes and can disagree within rounding of 0 alone.
    """
    xp = namespace(stable, value)
    size = abs(value)
    return xp.where(stable, xp.maximum(size, xp.finfo(xp.float64).tiny), -size)[()]


def unless_all_rigid(stiffness: Stiffness, value: Scalar) -> Scalar:
    """Return the value, or infinity if all three joints are rigid."""
    xp = namespace(*stiffness, value)
    ankle, knee, hip = (xp.isinf(k) for k in stiffness.joints)
    return xp.where(ankle & knee & hip, xp.inf, value)
