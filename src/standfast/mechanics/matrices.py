"""The matrices A and C of the linearised equations A q̈ + C q = 0 of the standing person.

The feet are fixed; shank, thigh and upper body turn in the sagittal plane about ankle, knee and
hip. The paper's appendix with A and C is not in its printed text; they are derived here.

notation: m mass, I inertia, h length, e height of the centre of mass in its segment, K stiffness,
G gravity part of C, γ gravity load of a segment, g gravity; s, t, b shank, thigh, upper body;
a, k, h ankle, knee, hip (Gait & Posture 25 (2007) 432-439).
"""

from standfast.anthropometry.body import Body
from standfast.mechanics.joints import NO_COUPLING, Stiffness, checked_body, checked_person
from standfast.numerics.arrays import Array, Matrix, Scalar, Vector, namespace, stacked
from standfast.numerics.pairs import Pair, add, multiply, negate, product
from standfast.parameters import STANDARD_GRAVITY


def inertia_matrix(body: Body) -> Array:
    """Return the inertia matrix A of the linearised equations A q̈ + C q = 0.

    A = Tᵀ M T, T = [[1, 0, 0], [1, 1, 0], [1, 1, 1]], and in segment angles
    M = [[Is + ms es² + (mt + mb) hs², (mt et + mb ht) hs, mb hs eb],
    [·, It + mt et² + mb ht², mb ht eb], [·, ·, Ib + mb eb²]].

    Returns
    -------
    (3, 3), kg·m², symmetric and positive definite; rows ankle, knee, hip.

    Raises
    ------
    InputError
        if it is not the body of one person.

    Examples
    --------
    >>> import standfast as sf
    >>> sf.inertia_matrix(sf.Body.edwards2007()).round(2)
    array([[87.17, 55.19, 25.39],
           [55.19, 36.11, 17.46],
           [25.39, 17.46,  9.56]])
    """
    checked_body(body)
    return stacked(joint_inertia(body))


def stiffness_matrix(body: Body, stiffness: Stiffness, gravity: Scalar = STANDARD_GRAVITY) -> Array:
    """Return the stiffness matrix C of the linearised equations, springs less gravity.

    C = K − [[G1, G2, G3], [G2, G2, G3], [G3, G3, G3]]
    with K = [[Ka, Kak, Kah], [Kak, Kk, Kkh], [Kah, Kkh, Kh]] and
    G1 = γs + γt + γb, G2 = γt + γb, G3 = γb, where
    γs = g (ms es + (mt + mb) hs), γt = g (mt et + mb ht), γb = g mb eb.

    Returns
    -------
    (3, 3), N·m/rad, symmetric; a rigid joint has ``inf`` on the diagonal, and no coupling.

    Raises
    ------
    InputError
        if gravity is out of range.

    Examples
    --------
    >>> import standfast as sf
    >>> body = sf.Body.from_height_mass(1.66, 68.0)
    >>> K = sf.Stiffness(ankle=900, knee=1500, hip=400)
    >>> sf.stiffness_matrix(body, K).round(1)
    array([[ 296.6, -349.9, -135.3],
           [-349.9, 1150.1, -135.3],
           [-135.3, -135.3,  264.7]])
    """
    checked_person(body, stiffness, gravity)
    return stacked(stiffness_rows(body, stiffness, gravity))


def stiffness_rows(body: Body, stiffness: Stiffness, gravity: Scalar) -> Matrix:
    """Return C as rows."""
    (g1, g2, g3), _, _ = joint_gravity(body, gravity)
    ankle, knee, hip = stiffness.joints
    c12, c23, c13 = -g2, -g3, -g3
    if stiffness.is_coupled:
        ankle_knee, knee_hip, ankle_hip = couplings_of_free(stiffness)
        c12, c23, c13 = ankle_knee - g2, knee_hip - g3, ankle_hip - g3
    return ((ankle - g1, c12, c13), (c12, knee - g2, c23), (c13, c23, hip - g3))


def couplings_of_free(stiffness: Stiffness) -> Vector:
    """Return the couplings of :class:`.Stiffness`, those of a rigid joint as 0."""
    if not stiffness.is_coupled:
        return NO_COUPLING
    xp = namespace(*stiffness)
    ankle, knee, hip = (xp.isinf(k) for k in stiffness.joints)
    ankle_knee, knee_hip, ankle_hip = stiffness.couplings
    return (
        xp.where(ankle | knee, 0.0, ankle_knee),
        xp.where(knee | hip, 0.0, knee_hip),
        xp.where(ankle | hip, 0.0, ankle_hip),
    )


def coupling_rows(stiffness: Stiffness) -> Matrix | None:
    """Return what stands beside the diagonal of K, as rows; None without any coupling."""
    if not stiffness.is_coupled:
        return None
    ankle_knee, knee_hip, ankle_hip = couplings_of_free(stiffness)
    return ((0.0, ankle_knee, ankle_hip), (ankle_knee, 0.0, knee_hip), (ankle_hip, knee_hip, 0.0))


def gravity_loads(body: Body, gravity: Scalar) -> Vector:
    """Return each segment's gravity load: its toppling moment per radian of its angle (N·m/rad).

    γs = g (ms es + (mt + mb) hs),  γt = g (mt et + mb ht),  γb = g mb eb, all positive.
    """
    namespace(*body, gravity)  # refuses single precision
    g = gravity
    ms, mt, mb = body.segment_mass
    hs, ht = body.segment_length
    es, et, eb = body.segment_com
    return g * (ms * es + (mt + mb) * hs), g * (mt * et + mb * ht), g * (mb * eb)


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
    a23 = m23 + m33
    a13 = m13 + a23
    a22 = m22 + m23 + a23
    a12 = m12 + m13 + a22
    a11 = m11 + m12 + m13 + a12
    return ((a11, a12, a13), (a12, a22, a23), (a13, a23, m33))


def second_variation(body: Body, stiffness: Stiffness, gravity: Scalar, rotation: Vector) -> Scalar:
    """Return qᵀ C q, twice the potential energy of a small rotation, to the last digits.

    qᵀ C q = Ka θa² + Kk θk² + Kh θh² + 2 Kak θa θk + 2 Kkh θk θh + 2 Kah θa θh − γs φs² − γt φt²
    − γb φb²: near the threshold of stability springs and gravity cancel, so the whole sum is
    carried in pairs of float64. A rigid joint stores nothing: its rotation is 0.
    """
    xp = namespace(*body, *stiffness, gravity, *rotation)
    total = angle = (xp.asarray(0.0), xp.asarray(0.0))
    for k, turn in zip(stiffness.joints, rotation, strict=True):
        flexible = xp.where(xp.isinf(k), 0.0, k)
        total = add(total, multiply(product(turn, turn), (flexible, 0.0)))
    if stiffness.is_coupled:
        ankle, knee, hip = rotation
        turned = ((ankle, knee), (knee, hip), (ankle, hip))
        for k, both in zip(couplings_of_free(stiffness), turned, strict=True):
            total = add(total, multiply(product(*both), (2.0 * k, 0.0)))
    for load, turn in zip(gravity_load_pairs(body, gravity), rotation, strict=True):
        angle = add(angle, (turn, 0.0))
        total = add(total, negate(multiply(load, multiply(angle, angle))))
    return total[0] + total[1]


def gravity_load_pairs(body: Body, gravity: Scalar) -> tuple[Pair, Pair, Pair]:
    """Return :func:`gravity_loads` in pairs."""
    ms, mt, mb = body.segment_mass
    hs, ht = body.segment_length
    es, et, eb = body.segment_com
    shank = add(add(product(ms, es), product(mt, hs)), product(mb, hs))
    thigh = add(product(mt, et), product(mb, ht))
    upper = product(mb, eb)
    g = (gravity, 0.0)
    return multiply(shank, g), multiply(thigh, g), multiply(upper, g)
