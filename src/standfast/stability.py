"""Does the person stand, and by what margin: everything that follows from C alone.

Springs in series with gravity. From the top down each joint must be stiffer than the load that it
carries, and hands a larger one to the joint below:

    L3 = γb,  L2 = γt + L3 Kh / (Kh − L3),  L1 = γs + L2 Kk / (Kk − L2)

The person stands if Kh > L3, Kk > L2 and Ka > L1, and det C = (Ka − L1)(Kk − L2)(Kh − L3). With
the load written as L / (1 − L/K) a rigid joint (K = inf) hands on exactly what it carries.

notation: γs, γt, γb gravity loads of shank, thigh, upper body; L1, L2, L3 loads carried by ankle,
knee, hip; Ka, Kk, Kh stiffnesses (Gait & Posture 25 (2007) 432-439 for the model).
"""

import numpy as np

from standfast import eigen
from standfast.arithmetic import (
    Matrix,
    Scalar,
    Vector,
    add,
    dot,
    minus,
    multiply,
    namespace,
    product_less,
    reciprocal,
)
from standfast.body import Body, Stiffness, checked_person, checked_scalar
from standfast.cubic import largest_root
from standfast.dynamics import (
    gravity_load_pairs,
    gravity_loads,
    joint_gravity,
    second_variation,
)
from standfast.quantities import STANDARD_GRAVITY

# Unit roundoff of float64.
ROUNDOFF = 2.0**-53


def is_stable(body: Body, stiffness: Stiffness, gravity: Scalar = STANDARD_GRAVITY) -> bool:
    """Return whether the person stands: C is positive definite.

    The boundary itself counts as unstable. Right unless the ankle's stiffness lies within
    rounding of the threshold (see :func:`verdict_is_certain`).

    Raises
    ------
    InputError
        if gravity is out of range.
    """
    checked_person(body, stiffness, gravity)
    return bool(verdict(body, stiffness, gravity))


def verdict(body: Body, stiffness: Stiffness, gravity: Scalar) -> Scalar:
    """Return the verdict as a truth value that may be traced: Ka > L1.

    L1 is infinite if knee or hip already fail, so this one comparison is the whole verdict.
    """
    namespace(*body, *stiffness, gravity)  # refuses single precision
    return stiffness.ankle > carried_loads(body, stiffness, gravity)[0]


def carried_loads(body: Body, stiffness: Stiffness, gravity: Scalar) -> Vector:
    """Return L1, L2, L3: the loads that ankle, knee and hip carry (N·m/rad).

    Infinite below a joint that fails.
    """
    shank, thigh, upper = gravity_loads(body, gravity)
    at_knee = thigh + handed_on(upper, stiffness.hip)
    at_ankle = shank + handed_on(at_knee, stiffness.knee)
    return at_ankle, at_knee, upper


@np.errstate(all="ignore")
def handed_on(load: Scalar, stiffness: Scalar) -> Scalar:
    """Return L / (1 − L/K), what a joint hands on of the load it carries; inf if K ≤ L."""
    xp = namespace(load, stiffness)
    return xp.where(stiffness > load, load / (1.0 - load / stiffness), xp.inf)


@np.errstate(all="ignore")
def bearable(stiffness: Scalar, limit: Scalar) -> Scalar:
    """Return 1 / (1/K + 1/S), the largest load of which a joint hands on no more than S > 0."""
    xp = namespace(stiffness, limit)
    return 1.0 / (1.0 / xp.asarray(stiffness) + 1.0 / limit)


def critical_stiffness(
    body: Body, stiffness: Stiffness, gravity: Scalar = STANDARD_GRAVITY
) -> Stiffness:
    """Return each joint's threshold, the other two as given: the person stands above it.

    ankle: L1.  knee: L2 / (1 − L2/S1), S1 = Ka − γs.  hip: γb / (1 − γb/S2),
    S2 = 1 / (1/S1 + 1/Kk) − γt.  The same recursion, read upwards for knee and hip.

    Returns
    -------
    Stiffness, N·m/rad; ``inf`` where no stiffness of that joint suffices.

    Raises
    ------
    InputError
        if gravity is out of range.
    """
    checked_person(body, stiffness, gravity)
    return Stiffness(
        ankle=critical_ankle_stiffness(body, stiffness.knee, stiffness.hip, gravity),
        knee=critical_knee_stiffness(body, stiffness.ankle, stiffness.hip, gravity),
        hip=critical_hip_stiffness(body, stiffness.ankle, stiffness.knee, gravity),
    )


def critical_ankle_stiffness(body: Body, knee: Scalar, hip: Scalar, gravity: Scalar) -> Scalar:
    """Return the ankle's threshold (N·m/rad): the load that knee and hip hand down to it."""
    shank, thigh, upper = gravity_loads(body, gravity)
    return shank + handed_on(thigh + handed_on(upper, hip), knee)


def critical_knee_stiffness(body: Body, ankle: Scalar, hip: Scalar, gravity: Scalar) -> Scalar:
    """Return the knee's threshold (N·m/rad) with ankle and hip as given."""
    shank, thigh, upper = gravity_loads(body, gravity)
    return handed_on(thigh + handed_on(upper, hip), ankle - shank)


def critical_hip_stiffness(body: Body, ankle: Scalar, knee: Scalar, gravity: Scalar) -> Scalar:
    """Return the hip's threshold (N·m/rad) with ankle and knee as given."""
    shank, thigh, upper = gravity_loads(body, gravity)
    xp = namespace(shank, thigh, upper, ankle, knee)
    spare = ankle - shank
    spare_above = xp.where(spare > 0.0, bearable(knee, spare), 0.0) - thigh
    return handed_on(upper, spare_above)


def equal_rotation(
    body: Body, knee: Scalar, gravity: Scalar = STANDARD_GRAVITY
) -> tuple[Scalar, Scalar]:
    """Return the neutral point at which ankle and hip turn equally, for a given knee stiffness.

    On the neutral contour C v = 0; with v = (1, x, 1) its rows give x = (G2 + G3)/(Kk − G2),
    Ka = G1 + G3 + G2 x and Kh = G3 (2 + x). Over all Kk this is a straight line; on the side of
    softer hips the hip turns more than the ankle (the hip strategy).

    Returns
    -------
    ankle and hip stiffness, N·m/rad; ``inf`` where Kk ≤ G2 (no neutral point).

    Raises
    ------
    InputError
        if gravity or the knee's stiffness is out of range.
    """
    xp = namespace(*body, gravity, knee)
    (g1, g2, g3), _, _ = joint_gravity(body, gravity)
    spare = checked_scalar("knee_stiffness", knee) - g2
    knee_rotation = xp.where(spare > 0.0, (g2 + g3) / xp.where(spare > 0.0, spare, 1.0), xp.inf)
    return g1 + g3 + g2 * knee_rotation, g3 * (2.0 + knee_rotation)


def flexible_matrix(body: Body, stiffness: Stiffness, gravity: Scalar) -> Matrix:
    """Return C as rows, with a rigid joint taken out: its row and column are those of 1."""
    xp = namespace(*body, *stiffness, gravity)
    (g1, g2, g3), _, _ = joint_gravity(body, gravity)
    ankle, knee, hip = stiffness
    no_ankle, no_knee, no_hip = xp.isinf(ankle), xp.isinf(knee), xp.isinf(hip)
    c11 = xp.where(no_ankle, 1.0, ankle - g1)
    c22 = xp.where(no_knee, 1.0, knee - g2)
    c33 = xp.where(no_hip, 1.0, hip - g3)
    c12 = xp.where(no_ankle | no_knee, 0.0, -g2)
    c13 = xp.where(no_ankle | no_hip, 0.0, -g3)
    c23 = xp.where(no_knee | no_hip, 0.0, -g3)
    return ((c11, c12, c13), (c12, c22, c23), (c13, c23, c33))


def verdict_by_minors(body: Body, stiffness: Stiffness, gravity: Scalar) -> Scalar:
    """Return the verdict by Sylvester's criterion: the leading minors of C are all positive."""
    (c11, c12, _), (_, c22, _), _ = rows = flexible_matrix(body, stiffness, gravity)
    return (c11 > 0.0) & (c11 * c22 - c12**2 > 0.0) & (_determinant(rows) > 0.0)


def stability_determinant(
    body: Body, stiffness: Stiffness, gravity: Scalar = STANDARD_GRAVITY
) -> Scalar:
    """Return det C in (N·m/rad)³.

    With a rigid joint it is infinite, with the sign of the determinant without that joint.

    Raises
    ------
    InputError
        if gravity is out of range.
    """
    xp = checked_person(body, stiffness, gravity)
    determinant = _determinant(flexible_matrix(body, stiffness, gravity))
    any_rigid = xp.isinf(stiffness.ankle) | xp.isinf(stiffness.knee) | xp.isinf(stiffness.hip)
    return xp.where(any_rigid, xp.copysign(xp.inf, determinant), determinant)[()]


def determinant_in_pairs(body: Body, stiffness: Stiffness, gravity: Scalar) -> Scalar:
    """Return det C, right to the last digits also where it is nearly 0; NaN with a rigid joint.

    det C = c33 (c11 c22 − G2²) − G3² (c11 + c22 + 2 G2), summed in pairs of float64.
    """
    xp = namespace(*body, *stiffness, gravity)
    shank, thigh, g3 = gravity_load_pairs(body, gravity)
    g2 = add(thigh, g3)
    g1 = add(shank, g2)
    c11, c22, c33 = (
        add((xp.asarray(k), 0.0), minus(g)) for k, g in zip(stiffness, (g1, g2, g3), strict=True)
    )
    of_hip = add(multiply(c11, c22), minus(multiply(g2, g2)))
    rest = multiply(multiply(g3, g3), add(add(c11, c22), add(g2, g2)))
    return product_less(c33, of_hip, rest)


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
    """
    checked_person(body, stiffness, gravity)
    load = joint_gravity(body, gravity)
    shift = load[0][0] + load[1][1] + load[2][2]
    softest = eigen.spring_eigenvectors(stiffness, load, eigen.IDENTITY, shift)[0]
    quotient = second_variation(body, stiffness, gravity, softest) / dot(softest, softest)
    return signed_by(verdict(body, stiffness, gravity), _unless_rigid(stiffness, quotient))


ALMOST_FREE = 1e-60  # N·m/rad


@np.errstate(all="ignore")
def safety_factor(body: Body, stiffness: Stiffness, gravity: Scalar = STANDARD_GRAVITY) -> Scalar:
    """Return the factor by which all stiffnesses could be divided and the person just stand.

    The smallest s of diag(K) v = s G v, with G the gravity part of C. So x = 1/s is the largest
    root of x³ − t x² + m x − d, with t, m, d the trace, the sum of the principal minors and the
    determinant of K⁻¹ G: sums and products of positive numbers. All entries of K⁻¹ G are positive,
    so the root is simple; it is found as a multiple of the trace. Above 1 exactly where the verdict
    is stable; 0 with a free joint; infinite with three rigid joints.

    Raises
    ------
    InputError
        if gravity is out of range.
    """
    xp = checked_person(body, stiffness, gravity)
    shank, thigh, upper = gravity_loads(body, gravity)
    below = thigh + upper
    # a joint as good as free would overflow the determinant
    ankle, knee, hip = (1.0 / xp.maximum(xp.asarray(k), ALMOST_FREE) for k in stiffness)
    trace = (shank + below) * ankle + below * knee + upper * hip
    minors = ankle * (shank * below * knee + (shank + thigh) * upper * hip)
    minors = minors + thigh * upper * knee * hip
    determinant = shank * thigh * upper * ankle * knee * hip
    per_trace = reciprocal(trace)
    share = largest_root(1.0, minors * per_trace**2, determinant * per_trace**3, steps=2)
    factor = _unless_rigid(stiffness, 1.0 / (trace * share))
    free = (stiffness.ankle == 0.0) | (stiffness.knee == 0.0) | (stiffness.hip == 0.0)
    factor = xp.where(free, 0.0, factor)
    # within rounding of 1 the verdict decides
    just_above = 1.0 + 2.0 * ROUNDOFF
    return xp.where(
        verdict(body, stiffness, gravity),
        xp.maximum(factor, just_above),
        xp.minimum(factor, 1.0),
    )[()]


def signed_by(stable: Scalar, value: Scalar) -> Scalar:
    """Return the margin with the sign of the verdict: positive exactly where stable.

    The two are computed by different routes and can disagree within rounding of 0 alone.
    """
    xp = namespace(stable, value)
    size = abs(value)
    return xp.where(stable, xp.maximum(size, xp.finfo(xp.float64).tiny), -size)[()]


def load_rounding(
    body: Body, stiffness: Stiffness, gravity: Scalar, *, scaling: float = 0.0
) -> Vector:
    """Return bounds on the rounding errors of :func:`carried_loads` (N·m/rad).

    A running error analysis with the unit roundoff u = 2⁻⁵³, body, stiffness and gravity taken as
    exact: γs, γt, γb have the relative errors 4u, 3u, 2u. A load L with relative error ε gives
    the ratio r = L/K the error ε + u, the rest 1 − r the relative error δ = r (ε + u)/(1 − r) + u,
    and the load handed on ε + δ + u. The bound is infinite where δ is not small against 1, and
    holds with fused multiplications too, which only round less often. ``scaling`` is a relative
    error that the gravity loads have beside, where the body was scaled in floating point.
    """
    xp = namespace(*body, *stiffness, gravity)
    loads = carried_loads(body, stiffness, gravity)
    at_ankle, at_knee, at_hip = loads
    hip_error = 2.0 * ROUNDOFF + scaling
    knee_error = _error_after(at_hip, hip_error, stiffness.hip, own=3.0 * ROUNDOFF + scaling)
    ankle_error = _error_after(at_knee, knee_error, stiffness.knee, own=4.0 * ROUNDOFF + scaling)
    return (
        xp.where(xp.isinf(at_ankle), xp.inf, at_ankle * ankle_error),
        xp.where(xp.isinf(at_knee), xp.inf, at_knee * knee_error),
        at_hip * hip_error,
    )


# Covers the products of two errors, which the first-order bound leaves out, and the rounding of
# the bound itself; both are below one part in a hundred while δ < 1/256.
SECOND_ORDER = 1.01
LARGEST_RELATIVE_ERROR = 1.0 / 256.0


@np.errstate(all="ignore")
def _error_after(load: Scalar, error: Scalar, stiffness: Scalar, *, own: float) -> Scalar:
    """Return the relative error of the next load down, γ + L / (1 − L/K)."""
    xp = namespace(load, stiffness)
    ratio = load / stiffness
    rest = ratio * (error + ROUNDOFF) / (1.0 - ratio) + ROUNDOFF
    handed = error + rest + ROUNDOFF
    # the sum is a weighted mean of its terms' errors, and one more rounding
    total = SECOND_ORDER * (xp.maximum(handed, own) + ROUNDOFF)
    return xp.where((stiffness > load) & (total < LARGEST_RELATIVE_ERROR), total, xp.inf)


OUTWARD = 1.25


@np.errstate(all="ignore")
def threshold_interval(
    body: Body, knee: Scalar, hip: Scalar, gravity: Scalar, *, scaling: float = 0.0
) -> Vector:
    """Return the ankle's threshold, and the ends between which the exact one lies (N·m/rad).

    The ends are both infinite where knee or hip fail beyond doubt, and 0 and infinity where that
    is in doubt. The bounds are those of :func:`load_rounding`.
    """
    stiffness = Stiffness._make((0.0, knee, hip))
    xp = namespace(*body, knee, hip, gravity)
    at_ankle, at_knee, at_hip = carried_loads(body, stiffness, gravity)
    ankle_error, knee_error, hip_error = load_rounding(body, stiffness, gravity, scaling=scaling)
    # outward by more than these sums are rounded themselves
    ankle_error, knee_error, hip_error = (
        OUTWARD * error for error in (ankle_error, knee_error, hip_error)
    )
    hip_fails = hip < at_hip - hip_error
    hip_holds = hip > at_hip + hip_error
    known = hip_holds & xp.isfinite(knee_error)
    knee_fails = known & (knee < at_knee - knee_error)
    holds = known & (knee > at_knee + knee_error) & xp.isfinite(ankle_error)
    falls = hip_fails | knee_fails
    low, high = at_ankle - ankle_error, at_ankle + ankle_error
    return (
        at_ankle,
        xp.where(falls, xp.inf, xp.where(holds, low, 0.0)),
        xp.where(falls, xp.inf, xp.where(holds, high, xp.inf)),
    )


def verdict_is_certain(
    body: Body, stiffness: Stiffness, gravity: Scalar = STANDARD_GRAVITY
) -> bool:
    """Return whether the verdict is proven to be that of exact arithmetic.

    From the hip down each joint must differ from its load by more than :func:`load_rounding`;
    the first one that falls short by more than that settles the matter.
    """
    checked_person(body, stiffness, gravity)
    loads = carried_loads(body, stiffness, gravity)
    bounds = load_rounding(body, stiffness, gravity)
    for joint, load, bound in zip(stiffness[::-1], loads[::-1], bounds[::-1], strict=True):
        if np.isfinite(joint) and not abs(joint - load) > bound:
            return False
        if joint < load:
            return True
    return True


def _determinant(rows: Matrix) -> Scalar:
    (c11, c12, c13), (_, c22, c23), (_, _, c33) = rows
    return (
        c11 * (c22 * c33 - c23**2) - c12 * (c12 * c33 - c23 * c13) + c13 * (c12 * c23 - c22 * c13)
    )


def _unless_rigid(stiffness: Stiffness, value: Scalar) -> Scalar:
    """Return the value, or infinity if all three joints are rigid."""
    xp = namespace(*stiffness, value)
    ankle, knee, hip = stiffness
    return xp.where(xp.isinf(ankle) & xp.isinf(knee) & xp.isinf(hip), xp.inf, value)
