"""Does the person stand by springs alone: carried loads, thresholds, the verdict.

Springs in series with gravity. From the top down each joint must be stiffer than the load that it
carries, and transmits a larger one to the joint below:

    L3 = γb,  L2 = γt + L3 Kh / (Kh − L3),  L1 = γs + L2 Kk / (Kk − L2)

The person stands if Kh > L3, Kk > L2 and Ka > L1, and det C = (Ka − L1)(Kk − L2)(Kh − L3). With
the load written as L / (1 − L/K) a rigid joint (K = inf) transmits exactly what it carries.

Where muscles across two joints couple them, the loads are those of :func:`eliminated`, and the rest
holds as it stands: the verdict is the same comparison with the ankle's own stiffness.

notation: γs, γt, γb gravity loads of shank, thigh, upper body; L1, L2, L3 loads carried by ankle,
knee, hip; Ka, Kk, Kh stiffnesses (Gait & Posture 25 (2007) 432-439 for the model).
"""

import numpy as np

from standfast.anthropometry.body import Body
from standfast.mechanics.joints import NO_COUPLING, Stiffness, checked_body, checked_person, coupled
from standfast.mechanics.matrices import gravity_loads, joint_gravity
from standfast.numerics.arrays import Scalar, Vector, namespace
from standfast.parameters import STANDARD_GRAVITY, checked_scalar, is_typed_in


def verdict(body: Body, stiffness: Stiffness, gravity: Scalar) -> Scalar:
    """Return the verdict as a truth value that may be traced: Ka > L1.

    L1 is infinite if knee or hip already fail, so this one comparison is the whole verdict.
    """
    namespace(*body, *stiffness, gravity)  # refuses single precision
    return stiffness.ankle > carried_loads(body, stiffness, gravity)[0]


def carried_loads(body: Body, stiffness: Stiffness, gravity: Scalar) -> Vector:
    """Return L1, L2, L3, carried by ankle, knee, hip (N·m/rad); inf below a joint that fails."""
    if stiffness.is_coupled:
        own, _, _ = joint_gravity(body, gravity)
        ankle_knee, knee_hip, ankle_hip = off_diagonal(own, stiffness.couplings)
        across = (ankle_knee, ankle_hip, knee_hip)
        return eliminated(stiffness.knee, stiffness.hip, own, across)
    shank, thigh, upper = gravity_loads(body, gravity)
    at_knee = thigh + transmitted_load(upper, stiffness.hip)
    at_ankle = shank + transmitted_load(at_knee, stiffness.knee)
    return at_ankle, at_knee, upper


@np.errstate(all="ignore")
def eliminated(second: Scalar, third: Scalar, own: Vector, across: Vector) -> Vector:
    """Return the loads of three coupled joints, each with those after it eliminated (N·m/rad).

    L3 = G3,  L2 = G2 + c23²/R3,  L1 = G1 + c13²/R3 + (c12 − c13 c23/R3)²/R2,  Ri = Ki − Li

    K2 and K3 are the joints' stiffnesses, G1, G2, G3 their ``own`` loads and c12, c13, c23 what
    stands ``across`` in C. A joint's load is infinite if one after it fails. Over what a rigid
    joint leaves, quotients are 0, so its couplings mean nothing.
    """
    xp = namespace(second, third, *own, *across)
    own1, own2, own3 = own
    c12, c13, c23 = across
    third_holds = third > own3
    rest3 = xp.where(third_holds, third - own3, 1.0)
    load2 = xp.where(third_holds, own2 + c23**2 / rest3, xp.inf)
    second_holds = second > load2
    rest2 = xp.where(second_holds, second - load2, 1.0)
    load1 = own1 + c13**2 / rest3 + (c12 - c13 * c23 / rest3) ** 2 / rest2
    return xp.where(second_holds, load1, xp.inf), load2, own3


def off_diagonal(own: Vector, couplings: Vector) -> Vector:
    """Return C between ankle and knee, knee and hip, ankle and hip; ``own`` are G1, G2, G3."""
    _, g2, g3 = own
    ankle_knee, knee_hip, ankle_hip = couplings
    return ankle_knee - g2, knee_hip - g3, ankle_hip - g3


def loads_of_springs(stiffness: Stiffness) -> Vector:
    """Return :func:`eliminated` loads without gravity: K is positive definite if Ka > L1."""
    ankle_knee, knee_hip, ankle_hip = stiffness.couplings
    across = (ankle_knee, ankle_hip, knee_hip)
    return eliminated(stiffness.knee, stiffness.hip, (0.0, 0.0, 0.0), across)


@np.errstate(all="ignore")
def transmitted_load(load: Scalar, stiffness: Scalar) -> Scalar:
    """Return L / (1 − L/K), what a joint transmits of the load it carries; inf if K ≤ L."""
    xp = namespace(load, stiffness)
    holds = stiffness > load
    # numbers in place of those that fail: their slopes would be NaN also where they are not taken
    load, stiffness = xp.where(holds, load, 0.0), xp.where(holds, stiffness, 1.0)
    return xp.where(holds, load / (1.0 - load / stiffness), xp.inf)


@np.errstate(all="ignore")
def bearable(stiffness: Scalar, limit: Scalar) -> Scalar:
    """Return 1 / (1/K + 1/S), the largest load of which a joint transmits no more than S > 0."""
    xp = namespace(stiffness, limit)
    free = stiffness == 0.0
    give = 1.0 / xp.where(free, 1.0, stiffness) + 1.0 / limit
    borne = xp.where(give > 0.0, 1.0 / xp.where(give > 0.0, give, 1.0), xp.inf)
    return xp.where(free, stiffness, borne)  # which grows as the stiffness of a free joint does


def critical_stiffness(
    body: Body, stiffness: Stiffness, gravity: Scalar = STANDARD_GRAVITY
) -> Stiffness:
    """Return each joint's threshold, the other two as given: the person stands above it.

    ankle: L1.  knee: L2 / (1 − L2/S1), S1 = Ka − γs.  hip: γb / (1 − γb/S2),
    S2 = 1 / (1/S1 + 1/Kk) − γt.  The same recursion, read upwards for knee and hip.

    Of coupled joints it is L1 of ``eliminated`` with the joint in the first place.

    Returns
    -------
    Stiffness, N·m/rad; ``inf`` where no stiffness of that joint suffices; couplings as given.

    Raises
    ------
    InputError
        if gravity is out of range.

    Examples
    --------
    >>> import standfast as sf
    >>> body = sf.Body.from_height_mass(1.66, 68.0)
    >>> K = sf.Stiffness(ankle=900.0, knee=1500.0, hip=400.0)
    >>> threshold = sf.critical_stiffness(body, K)
    >>> [round(float(one), 1) for one in threshold.joints]
    [835.1, 1191.5, 315.1]
    """
    checked_person(body, stiffness, gravity)
    ankle, knee, hip = stiffness.joints
    couplings = stiffness.couplings
    limits = (
        critical_ankle_stiffness(body, knee, hip, gravity, couplings),
        critical_knee_stiffness(body, ankle, hip, gravity, couplings),
        critical_hip_stiffness(body, ankle, knee, gravity, couplings),
    )
    # as they are: a threshold may lie beyond all that a stiffness may be given
    plain = (float(limit) if is_typed_in(limit) else limit for limit in limits)
    return Stiffness._make((*plain, *couplings))


def critical_ankle_stiffness(
    body: Body, knee: Scalar, hip: Scalar, gravity: Scalar, couplings: Vector = NO_COUPLING
) -> Scalar:
    """Return the ankle's threshold (N·m/rad): the load that knee and hip transmit to it."""
    if coupled(couplings):
        (g1, g2, g3), _, _ = joint_gravity(body, gravity)
        ankle_knee, knee_hip, ankle_hip = off_diagonal((g1, g2, g3), couplings)
        return eliminated(knee, hip, (g1, g2, g3), (ankle_knee, ankle_hip, knee_hip))[0]
    shank, thigh, upper = gravity_loads(body, gravity)
    return shank + transmitted_load(thigh + transmitted_load(upper, hip), knee)


def critical_knee_stiffness(
    body: Body, ankle: Scalar, hip: Scalar, gravity: Scalar, couplings: Vector = NO_COUPLING
) -> Scalar:
    """Return the knee's threshold (N·m/rad) with ankle and hip as given."""
    if coupled(couplings):
        (g1, g2, g3), _, _ = joint_gravity(body, gravity)
        ankle_knee, knee_hip, ankle_hip = off_diagonal((g1, g2, g3), couplings)
        return eliminated(ankle, hip, (g2, g1, g3), (ankle_knee, knee_hip, ankle_hip))[0]
    shank, thigh, upper = gravity_loads(body, gravity)
    return transmitted_load(thigh + transmitted_load(upper, hip), ankle - shank)


def critical_hip_stiffness(
    body: Body, ankle: Scalar, knee: Scalar, gravity: Scalar, couplings: Vector = NO_COUPLING
) -> Scalar:
    """Return the hip's threshold (N·m/rad) with ankle and knee as given."""
    if coupled(couplings):
        (g1, g2, g3), _, _ = joint_gravity(body, gravity)
        ankle_knee, knee_hip, ankle_hip = off_diagonal((g1, g2, g3), couplings)
        return eliminated(ankle, knee, (g3, g1, g2), (ankle_hip, knee_hip, ankle_knee))[0]
    shank, thigh, upper = gravity_loads(body, gravity)
    xp = namespace(shank, thigh, upper, ankle, knee)
    spare = ankle - shank
    some = spare > 0.0
    spare_above = xp.where(some, bearable(knee, xp.where(some, spare, 1.0)), 0.0) - thigh
    return transmitted_load(upper, spare_above)


def equal_rotation(
    body: Body, knee: Scalar, gravity: Scalar = STANDARD_GRAVITY
) -> tuple[Scalar, Scalar]:
    """Return the neutral point at which ankle and hip turn equally, for a given knee stiffness.

    Of joints that nothing couples.

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

    Examples
    --------
    >>> import standfast as sf
    >>> found = sf.equal_rotation(sf.Body.edwards2007(), knee=2000, gravity=9.8)
    >>> [round(float(one), 2) for one in found]
    [1081.44, 431.02]
    """
    checked_body(body)
    checked_scalar("gravity", gravity)
    xp = namespace(*body, gravity, knee)
    (g1, g2, g3), _, _ = joint_gravity(body, gravity)
    spare = checked_scalar("knee_stiffness", knee) - g2
    knee_rotation = xp.where(spare > 0.0, (g2 + g3) / xp.where(spare > 0.0, spare, 1.0), xp.inf)
    return g1 + g3 + g2 * knee_rotation, g3 * (2.0 + knee_rotation)
