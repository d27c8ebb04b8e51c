"""What rounding may do to a threshold: proven bounds of its error in float64.

notation: γ gravity load of a segment, L load carried by a joint, K stiffness, u unit roundoff.
"""

import numpy as np

from standfast.anthropometry.body import Body
from standfast.mechanics.joints import Stiffness, checked_person
from standfast.numerics.arrays import ROUNDOFF, Scalar, Vector, namespace
from standfast.parameters import STANDARD_GRAVITY
from standfast.stability.springs import carried_loads


def load_rounding(
    body: Body, stiffness: Stiffness, gravity: Scalar, *, scaling: float = 0.0
) -> Vector:
    """Return bounds on the rounding errors of :func:`carried_loads` (N·m/rad).

    A running error analysis with the unit roundoff u = 2⁻⁵³, body, stiffness and gravity taken as
    exact: γs, γt, γb have the relative errors 4u, 3u, 2u. A load L with relative error ε gives
    the ratio r = L/K the error ε + u, the rest 1 − r the relative error δ = r (ε + u)/(1 − r) + u,
    and the load transmitted ε + δ + u. The bound is infinite where δ is not small against 1, and
    holds with fused multiplications too, which only round less often. ``scaling`` is a relative
    error that the gravity loads have beside, where the body was scaled in floating point.
    """
    xp = namespace(*body, *stiffness, gravity)
    at_ankle, at_knee, at_hip = carried_loads(body, stiffness, gravity)
    hip_error = 2.0 * ROUNDOFF + scaling
    knee_error = _error_after(at_hip, hip_error, stiffness.hip, own=3.0 * ROUNDOFF + scaling)
    ankle_error = _error_after(at_knee, knee_error, stiffness.knee, own=4.0 * ROUNDOFF + scaling)
    of_ankle = xp.where(xp.isinf(at_ankle), xp.inf, at_ankle * ankle_error)
    of_knee = xp.where(xp.isinf(at_knee), xp.inf, at_knee * knee_error)
    return of_ankle, of_knee, at_hip * hip_error


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
    transmitted = error + rest + ROUNDOFF
    # the sum is a weighted mean of its terms' errors, and one more rounding
    total = SECOND_ORDER * (xp.maximum(transmitted, own) + ROUNDOFF)
    return xp.where((stiffness > load) & (total < LARGEST_RELATIVE_ERROR), total, xp.inf)


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
    bounds = load_rounding(body, stiffness, gravity, scaling=scaling)
    # outward by more than these sums are rounded themselves
    ankle_error, knee_error, hip_error = (1.25 * bound for bound in bounds)
    hip_fails = hip < at_hip - hip_error
    hip_holds = hip > at_hip + hip_error
    known = hip_holds & xp.isfinite(knee_error)
    knee_fails = known & (knee < at_knee - knee_error)
    holds = known & (knee > at_knee + knee_error) & xp.isfinite(ankle_error)
    falls = hip_fails | knee_fails
    low = xp.where(holds, at_ankle - ankle_error, 0.0)
    high = xp.where(holds, at_ankle + ankle_error, xp.inf)
    return at_ankle, xp.where(falls, xp.inf, low), xp.where(falls, xp.inf, high)


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
    for joint, load, bound in zip(stiffness.joints[::-1], loads[::-1], bounds[::-1], strict=True):
        if np.isfinite(joint) and not abs(joint - load) > bound:
            return False
        if joint < load:
            return True
    return True
