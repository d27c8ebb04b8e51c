"""What rounding may do to a threshold: proven bounds of its error in float64.

notation: γ gravity load of a segment, L load carried by a joint, K stiffness, u unit roundoff.
"""

import numpy as np

from standfast.anthropometry.body import Body
from standfast.errors import InputError
from standfast.mechanics.joints import NO_COUPLING, Stiffness, checked_person
from standfast.mechanics.matrices import joint_gravity
from standfast.numerics.arrays import ROUNDOFF, Scalar, Vector, is_traced, namespace
from standfast.numerics.bounded import BESIDE, Bounded, is_above, is_below, minus, over, plus, times
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
    error that the gravity loads have beside, where the body was scaled in floating point. Of
    coupled joints the bounds are those of :mod:`standfast.numerics.bounded`.
    """
    xp = namespace(*body, *stiffness, gravity)
    if stiffness.is_coupled:
        found = _coupled_loads(body, stiffness, gravity, scaling)
        of_ankle, of_knee, of_hip = (SECOND_ORDER * load.error for load in found)
        hip_fails = ~(stiffness.hip > found[2].value)
        knee_fails = hip_fails | ~(stiffness.knee > found[1].value)
        return xp.where(knee_fails, xp.inf, of_ankle), xp.where(hip_fails, xp.inf, of_knee), of_hip
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
    body: Body,
    knee: Scalar,
    hip: Scalar,
    gravity: Scalar,
    couplings: Vector = NO_COUPLING,
    *,
    scaling: float = 0.0,
) -> Vector:
    """Return the ankle's threshold, and the ends between which the exact one lies (N·m/rad).

    The ends are both infinite where knee or hip fail beyond doubt, and 0 and infinity where that
    is in doubt. The bounds are those of :func:`load_rounding`.
    """
    stiffness = Stiffness._make((0.0, knee, hip, *couplings))
    if stiffness.is_coupled:
        return _coupled_interval(body, stiffness, gravity, scaling)
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


@np.errstate(all="ignore")
def _coupled_loads(
    body: Body, stiffness: Stiffness, gravity: Scalar, scaling: float
) -> tuple[Bounded, Bounded, Bounded]:
    """Return the loads of :func:`.eliminated` with bounds; a rigid joint is taken out of C.

    G3, G2, G1 are good to 2, 4 and 5 roundings. The ankle's own stiffness does not enter.
    """
    _, knee, hip = stiffness.joints
    xp = namespace(*body, knee, hip, gravity, *stiffness.couplings)
    own = zip(joint_gravity(body, gravity)[0], (5.0, 4.0, 2.0), strict=True)
    g1, g2, g3 = (Bounded(g, SECOND_ORDER * (count * ROUNDOFF + scaling) * g) for g, count in own)
    no_knee, no_hip = xp.isinf(knee), xp.isinf(hip)

    def across(coupling: Scalar, load: Bounded, taken_out: Scalar) -> Bounded:
        entry = minus(Bounded(coupling, 0.0), load)
        return Bounded(*(xp.where(taken_out, 0.0, part) for part in entry))

    def rest(spring: Scalar, load: Bounded, taken_out: Scalar) -> Bounded:
        entry = minus(Bounded(spring, 0.0), load)
        return Bounded(xp.where(taken_out, 1.0, entry.value), xp.where(taken_out, 0.0, entry.error))

    ankle_knee, knee_hip, ankle_hip = stiffness.couplings
    c12 = across(ankle_knee, g2, no_knee)
    c13 = across(ankle_hip, g3, no_hip)
    c23 = across(knee_hip, g3, no_knee | no_hip)
    c33 = rest(hip, g3, no_hip)
    load2 = plus(g2, over(times(c23, c23), c33))
    rest2 = rest(knee, load2, no_knee)
    c12 = minus(c12, over(times(c13, c23), c33))
    load1 = plus(plus(g1, over(times(c13, c13), c33)), over(times(c12, c12), rest2))
    return load1, load2, g3


@np.errstate(all="ignore")
def _coupled_interval(body: Body, stiffness: Stiffness, gravity: Scalar, scaling: float) -> Vector:
    """Return :func:`threshold_interval` of coupled joints."""
    _, knee, hip = stiffness.joints
    xp = namespace(*body, knee, hip, gravity, *stiffness.couplings)
    at_ankle, at_knee, at_hip = _coupled_loads(body, stiffness, gravity, scaling)
    no_knee, no_hip = xp.isinf(knee), xp.isinf(hip)
    spare_hip = minus(Bounded(xp.where(no_hip, 1.0, hip), 0.0), at_hip)
    spare_knee = minus(Bounded(xp.where(no_knee, 1.0, knee), 0.0), at_knee)
    hip_holds = no_hip | is_above(spare_hip)
    falls = (~no_hip & is_below(spare_hip)) | (hip_holds & ~no_knee & is_below(spare_knee))
    bound = BESIDE * at_ankle.error
    holds = hip_holds & (no_knee | is_above(spare_knee)) & xp.isfinite(bound)
    low = xp.where(holds, at_ankle.value - bound, 0.0)
    high = xp.where(holds, at_ankle.value + bound, xp.inf)
    place = xp.where(holds, at_ankle.value, xp.inf)
    return place, xp.where(falls, xp.inf, low), xp.where(falls, xp.inf, high)


@np.errstate(all="ignore")
def rounding_decides(
    body: Body, stiffness: Stiffness, gravity: Scalar, *, scaling: float = 0.0
) -> Scalar:
    """Return whether the verdict may be another than that of exact arithmetic; may be traced.

    From the hip down each joint must differ from its load by more than :func:`load_rounding`;
    the first one that falls short by more than that settles the matter. ``scaling`` is a relative
    error of the stiffnesses themselves, where they are multiples of loads: in a ratio of load and
    stiffness it is as good as one of the load.
    """
    xp = namespace(*body, *stiffness, gravity)
    loads = carried_loads(body, stiffness, gravity)
    bounds = load_rounding(body, stiffness, gravity, scaling=scaling)
    settled = decides = xp.asarray(False)
    for joint, load, bound in zip(stiffness.joints[::-1], loads[::-1], bounds[::-1], strict=True):
        clear = xp.abs(joint - load) > bound + scaling * joint
        decides = decides | (~settled & ~clear & xp.isfinite(joint))
        settled = settled | (joint < load)
    return decides


# Far above the 40 roundings that the sieve must let through, and far below what anybody notices.
NEAR = 1e-9


def near_threshold(body: Body, stiffness: Stiffness, gravity: Scalar) -> Scalar:
    """Return whether a joint is so near its load that rounding may decide; may be traced.

    |K − L| L3 < NEAR L² at hip, knee or ankle: a cheap sieve for :func:`rounding_decides`, of
    joints that nothing couples. What a joint transmits, T = L / (1 − L/K), has the relative error
    of L/K times T/L. With 10u of the hip's load and stiffness, also where that is a multiple of a
    load, the error of L2 is below 20u L2²/L3, and that of L1 below 40u L1²/L3.
    """
    xp = namespace(*body, *stiffness, gravity)
    found = xp.asarray(False)
    loads = carried_loads(body, stiffness, gravity)
    for joint, load in zip(stiffness.joints, loads, strict=True):
        found = found | (xp.abs(joint - load) * loads[2] < NEAR * load**2)
    return found


def verdict_is_certain(
    body: Body, stiffness: Stiffness, gravity: Scalar = STANDARD_GRAVITY
) -> bool:
    """Return whether the verdict is proven to be that of exact arithmetic.

    From the hip down each joint must differ from its load by more than a bound of the load's
    rounding.

    Examples
    --------
    >>> import standfast as sf
    >>> body = sf.Body.from_height_mass(1.66, 68.0)
    >>> K = sf.Stiffness(ankle=900.0, knee=1500.0, hip=400.0)
    >>> sf.verdict_is_certain(body, K)
    True
    """
    checked_person(body, stiffness, gravity)
    if is_traced(*body, *stiffness, gravity):
        raise InputError(
            "verdict_is_certain is not for jax.vmap, jax.jit or jax.grad; call it person by person"
        )
    return not rounding_decides(body, stiffness, gravity)
