"""Eigenvectors of a 3×3 problem in closed form, for joints that may be free, springy or rigid.

The problem is (diag(K) − P) v = λ B v with springs K ≥ 0 (``inf`` = rigid), P symmetric and
B symmetric positive definite. All quantities that need an eigenvector are one of three cases:
the modes (P gravity, B inertia), the stiffness reserve (P gravity, B = 1) and the safety factor of
coupled joints (P = 0, B gravity). What couples the joints is taken off P. Only vectors are made
here: the caller takes the eigenvalue from the quotient of two energies, whose error is the square
of the vector's.
"""

from standfast.numerics.arrays import Matrix, Scalar, Vector, namespace
from standfast.numerics.vectors import cross, dot, matvec

IDENTITY: Matrix = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


def spring_eigenvectors(
    springs: Vector, load: Matrix, metric: Matrix, shift: Scalar, coupling: Matrix | None = None
) -> tuple[Vector, Vector, Vector]:
    """Return the eigenvectors of (diag(K) − P) v = λ B v, ascending in λ.

    K are the springs, P the load, B the metric, σ the shift, large enough that W = σB − P is
    positive definite. (diag(K) + W)⁻¹ has the eigenvalues 1/(λ + σ). Scaled to a unit diagonal it
    exists for a free joint (K = 0) and a rigid one alike: diag(K) + W = S⁻¹ U S⁻¹ with
    S = diag(K + W)^(−1/2), where a rigid joint has S = 0 exactly. With B = L Lᵀ and U = R Rᵀ the
    symmetric matrix XᵀX, X = R⁻¹ S L, has these eigenvalues, and v = L⁻ᵀ u. In the finite modes a
    rigid joint has rotation 0 exactly; the vectors that belong to λ = ∞, one for each rigid joint,
    come last and mean nothing.

    ``coupling`` is what the springs have beside the diagonal, 0 at a rigid joint: it is taken off
    P, and σ, large enough for P alone, grows by a bound of its eigenvalues in the metric B.
    """
    xp = namespace(*springs, *(entry for row in (*load, *metric) for entry in row), shift)
    inverse = inverse_of_cholesky(metric)
    if coupling is not None:
        load = _entrywise(load, coupling)
        shift = shift + _largest_row(coupling, inverse)
    w = [[shift * metric[i][j] - load[i][j] for j in range(3)] for i in range(3)]
    s = [1.0 / xp.sqrt(springs[i] + w[i][i]) for i in range(3)]
    unit = (
        (1.0, 0.0, 0.0),
        (s[0] * s[1] * w[1][0], 1.0, 0.0),
        (s[0] * s[2] * w[2][0], s[1] * s[2] * w[2][1], 1.0),
    )
    r = inverse_of_cholesky(unit)
    (i11, _, _), (i21, i22, _), (i31, i32, i33) = inverse
    # L from its inverse, lower triangular: the diagonal is reciprocal, the rest by substitution
    l11, l22, l33 = 1.0 / i11, 1.0 / i22, 1.0 / i33
    l21 = -l22 * i21 * l11
    l32 = -l33 * i32 * l22
    l31 = -l33 * (i31 * l11 + i32 * l21)
    x = (
        matvec(r, (s[0] * l11, s[1] * l21, s[2] * l31)),
        matvec(r, (0.0, s[1] * l22, s[2] * l32)),
        matvec(r, (0.0, 0.0, s[2] * l33)),
    )
    back = ((i11, i21, i31), (0.0, i22, i32), (0.0, 0.0, i33))
    rigid1, rigid2, rigid3 = (xp.isinf(k) for k in springs)

    def shape(u: Vector) -> Vector:
        v1, v2, v3 = matvec(back, u)
        return xp.where(rigid1, 0.0, v1), xp.where(rigid2, 0.0, v2), xp.where(rigid3, 0.0, v3)

    squared = (matvec(x, x[0]), matvec(x, x[1]), matvec(x, x[2]))
    first, second, third = symmetric_eigenvectors(squared)
    return shape(first), shape(second), shape(third)


def _entrywise(a: Matrix, b: Matrix) -> Matrix:
    """Return a − b."""
    first, second, third = (
        (x[0] - y[0], x[1] - y[1], x[2] - y[2]) for x, y in zip(a, b, strict=True)
    )
    return first, second, third


def _largest_row(matrix: Matrix, inverse: Matrix) -> Scalar:
    """Return the largest sum of sizes of a row of L⁻¹ M L⁻ᵀ, which bounds its eigenvalues."""
    xp = namespace(*(entry for row in (*matrix, *inverse) for entry in row))
    turned = [matvec(matrix, row) for row in inverse]
    sums = [sum(abs(dot(row, column)) for column in turned) for row in inverse]
    return xp.maximum(xp.maximum(sums[0], sums[1]), sums[2])


def inverse_of_cholesky(matrix: Matrix) -> Matrix:
    """Return L⁻¹, lower triangular, for a symmetric positive definite matrix L Lᵀ."""
    (m11, _, _), (m21, m22, _), (m31, m32, m33) = matrix
    xp = namespace(m11, m21, m22, m31, m32, m33)
    d1 = 1.0 / xp.sqrt(m11)
    l21 = m21 * d1
    l31 = m31 * d1
    d2 = 1.0 / xp.sqrt(m22 - l21**2)
    l32 = (m32 - l31 * l21) * d2
    d3 = 1.0 / xp.sqrt(m33 - l31**2 - l32**2)
    return (
        (d1, 0.0, 0.0),
        (-d2 * l21 * d1, d2, 0.0),
        (-d3 * (l31 * d1 - l32 * d2 * l21 * d1), -d3 * l32 * d2, d3),
    )


def symmetric_eigenvectors(matrix: Matrix) -> tuple[Vector, Vector, Vector]:
    """Return orthonormal eigenvectors of a symmetric matrix, descending in the eigenvalue.

    1. The eigenvalue farthest from the two others is well conditioned however close those are: it
       is η of the deviator D = matrix − mean, scaled to J2 = 3: η = ±2y with 4y³ − 3y = |J3/2|,
       and has the sign of J3 = det D; J2 is half the squared norm of D.
    2. Its vector is the longest product of two rows of D − η.
    3. The other two are a rotation in the plane across it.
    After Scherzinger & Dohrmann, Comput. Methods Appl. Mech. Engrg. 197 (2008) 4007-4015, with
    the cubic solved by Newton's method in place of trigonometric functions.
    """
    (m11, m12, m13), (_, m22, m23), (_, _, m33) = matrix
    xp = namespace(m11, m12, m13, m22, m23, m33)
    mean = (m11 + m22 + m33) / 3.0
    d11, d22, d33 = m11 - mean, m22 - mean, m33 - mean
    j2 = 0.5 * (d11**2 + d22**2 + d33**2) + m12**2 + m13**2 + m23**2
    # the deviator is scaled to J2 = 3; a matrix without one stays 0
    size = 1.0 / xp.sqrt(xp.maximum(j2, xp.finfo(xp.float64).tiny) / 3.0)
    d11, d22, d33 = size * d11, size * d22, size * d33
    d12, d13, d23 = size * m12, size * m13, size * m23
    deviator = ((d11, d12, d13), (d12, d22, d23), (d13, d23, d33))
    half_j3 = 0.5 * dot(deviator[0], cross(deviator[1], deviator[2]))
    upward = half_j3 >= 0.0

    eta = xp.where(upward, 2.0, -2.0) * _cosine_of_third(xp.minimum(abs(half_j3), 1.0))
    rows = ((d11 - eta, d12, d13), (d12, d22 - eta, d23), (d13, d23, d33 - eta))
    products = cross(rows[0], rows[1]), cross(rows[0], rows[2]), cross(rows[1], rows[2])
    isolated = _unit(_longest(*products))

    first, second = _plane_across(isolated)
    turned = matvec(deviator, second)
    half = 0.5 * (dot(first, matvec(deviator, first)) - dot(second, turned))
    mixed = dot(first, turned)
    long_side = xp.hypot(half, mixed) + abs(half)
    # the two sides of the rotation's triangle; equal eigenvalues leave it open: no rotation
    c = xp.where(long_side > 0.0, xp.where(half >= 0.0, long_side, mixed), 1.0)
    s = xp.where(half >= 0.0, mixed, long_side)
    norm = xp.sqrt(c**2 + s**2)
    c, s = c / norm, s / norm
    larger = _combined(c, first, s, second)
    smaller = _combined(c, second, -s, first)
    return (
        _choose(upward, isolated, larger),
        _choose(upward, larger, smaller),
        _choose(upward, smaller, isolated),
    )


def _cosine_of_third(x: Scalar) -> Scalar:
    """Return y = cos(arccos(x) / 3) for 0 ≤ x ≤ 1, the root of 4y³ − 3y = x in [√3/2, 1].

    The chord between the ends is off by less than 0.01 and the slope stays between 6 and 9, so
    three steps of Newton's method reach float64.
    """
    y = 0.8660254037844386 + 0.1339745962155614 * x
    for _ in range(3):
        y = (8.0 * y**3 + x) / (12.0 * y**2 - 3.0)
    return y


def _plane_across(normal: Vector) -> tuple[Vector, Vector]:
    """Return two unit vectors that make a right-handed frame with a unit normal.

    Duff et al., Building an Orthonormal Basis, Revisited, J. Comput. Graph. Tech. 6 (2017) 1-8.
    """
    n1, n2, n3 = normal
    xp = namespace(*normal)
    sign = xp.where(n3 >= 0.0, 1.0, -1.0)
    a = -1.0 / (sign + n3)
    b = n1 * n2 * a
    return (1.0 + sign * n1**2 * a, sign * b, -sign * n1), (b, sign + n2**2 * a, -n2)


def _combined(p: Scalar, a: Vector, q: Scalar, b: Vector) -> Vector:
    return (p * a[0] + q * b[0], p * a[1] + q * b[1], p * a[2] + q * b[2])


def _choose(condition: Scalar, a: Vector, b: Vector) -> Vector:
    xp = namespace(condition, *a, *b)
    first, second, third = (xp.where(condition, x, y) for x, y in zip(a, b, strict=True))
    return first, second, third


def _longest(a: Vector, b: Vector, c: Vector) -> Vector:
    longer = _choose(dot(a, a) >= dot(b, b), a, b)
    return _choose(dot(longer, longer) >= dot(c, c), longer, c)


def _unit(a: Vector) -> Vector:
    """Return a / |a|, or the first axis for a null vector (every direction is an eigenvector)."""
    xp = namespace(*a)
    square = dot(a, a)
    factor = 1.0 / xp.sqrt(xp.where(square > 0.0, square, 1.0))
    return xp.where(square > 0.0, factor * a[0], 1.0), factor * a[1], factor * a[2]
