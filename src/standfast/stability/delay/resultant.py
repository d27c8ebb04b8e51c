"""Where a root z of Δ(iω, z) lies on the unit circle: the Schur-Cohn resultant R(ω²).

R changes sign at ω where a root z passes the unit circle, that is at the crossings of all delays.
With x = ω² every polynomial on the imaginary axis is a(x) + iω b(x), and R a real polynomial in x
of degree 4n (m = 2) or 6n (m = 3); for m = 1 see :mod:`.one_channel`. Its coefficients would lose
all digits, so it is put together from the qk on each cell of x, where signs of Bernstein's
coefficients prove what roots there are.

    m = 2: R = h² − |u|²                        z = −h/u,   h = |q0|² − |q2|², u = q̄0 q1 − q2 q̄1
    m = 3: R = h² g − 2 h |u|² + 2 Re(ū² w) − g |w|²        h + u z + w z² = 0
           h = |q0|² − |q3|², g = h + |q1|² − |q2|², u = q̄0 q1 − q3 q̄2, w = q̄0 q2 − q3 q̄1

The same lines make R of numbers, at a point, and of polynomials on a cell: both add and multiply.

notation: n free joints, m rank of the feedback (:mod:`.characteristic`).
"""

from collections.abc import Sequence
from typing import Any, NamedTuple, TypeAlias

from standfast.numerics.arrays import TURN, Scalar, namespace
from standfast.numerics.complex_pairs import Complex, times
from standfast.numerics.polynomials import OnCell, Polynomial, value_at

Real: TypeAlias = Any  # a number, or a polynomial on a cell

# Newton's method from ω good to rounding of R: the angle's digits double twice.
POLISHING_STEPS = 4


class OnAxis(NamedTuple):
    """A polynomial in s on the imaginary axis: a + iω b, both of x = ω²."""

    even: Real
    odd: Real


def resultant(quasi: Sequence[OnAxis], x: Real) -> Real:
    """Return R of q0 … qm on the imaginary axis."""
    h, u, *w = _reduced(quasi, x)
    if not w:
        return h * h - _square(u, x)
    g = h + _square(quasi[1], x) - _square(quasi[2], x)
    real, imaginary = w[0]
    squares = u.even * u.even, x * (u.odd * u.odd)
    sizes, crossed = squares[0] + squares[1], x * (u.even * u.odd) * imaginary
    turned = (squares[0] - squares[1]) * real + (crossed + crossed)
    return h * (h * g - (sizes + sizes)) + (turned + turned) - g * _square(w[0], x)


def roots_on_cell(quasi: Sequence[Polynomial], low: Scalar, high: Scalar) -> Scalar:
    """Return how many crossings have low < ω² < high: 0 or 1 where proven, else 2."""
    on_cell = []
    for q in quasi:
        even, odd = parts(q)
        on_cell.append(OnAxis(OnCell.of(even, low, high), OnCell.of(odd, low, high)))
    x = OnCell([low, high], high, 0.0)
    return resultant(on_cell, x).roots()


def resultant_at(quasi: Sequence[Polynomial], x: Scalar) -> Scalar:
    """Return R at x = ω², divided by the largest |qk|² to the power m, so that none overflows."""
    values = _at(quasi, x)
    xp = namespace(x, *(part for q in values for part in q))
    root = xp.sqrt(x)
    size = abs(values[0].even)
    for q in values:
        size = xp.maximum(size, xp.maximum(abs(q.even), abs(root * q.odd)))
    scaled = [OnAxis(q.even / size, q.odd / size) for q in values]
    return resultant(scaled, x)


def crossing_at(quasi: Sequence[Polynomial], x: Scalar) -> tuple[Scalar, Scalar, Scalar, Scalar]:
    """Return ω, θ, the direction and the last correction of the crossing at ω² ≈ x.

    The root iω lies on the axis for the delays τ = (θ + 2πk)/ω, 0 ≤ θ < 2π, and passes to the right
    (+1) or left (−1) as τ grows: sgn Re(Δs · conj(iω z Δz)), for all k.
    """
    xp = namespace(x, *(c for q in quasi for c in q))
    omega = xp.sqrt(x)
    start = _root_on_circle([value_at(q, 1j * omega) for q in quasi])
    return refined(quasi, omega, -xp.angle(start))


def refined(
    quasi: Sequence[Polynomial], omega: Scalar, theta: Scalar
) -> tuple[Scalar, Scalar, Scalar, Scalar]:
    """Return ω, θ, the direction and the last correction of the crossing near ω and θ."""
    xp = namespace(omega, theta, *(c for q in quasi for c in q))
    z = Complex(xp.cos(theta), -xp.sin(theta))
    correction: Scalar = 0.0
    for _ in range(POLISHING_STEPS):
        at, by_s, by_z = _slopes_on_axis(quasi, omega, z)
        # Δ + i Δs dω − i z Δz dθ = 0 in two real unknowns
        first, turned = Complex(-by_s.im, by_s.re), times(z, by_z)
        second = Complex(turned.im, -turned.re)
        area = first.re * second.im - first.im * second.re
        change = (at.im * second.re - at.re * second.im) / area
        turn = (at.re * first.im - at.im * first.re) / area
        omega = omega + change
        z = times(z, Complex(xp.cos(turn), -xp.sin(turn)))
        correction = xp.maximum(abs(change) / omega, abs(turn))
    _, by_s, by_z = _slopes_on_axis(quasi, omega, z)
    turned = times(z, by_z)
    # i z Δz is (−Im, Re) of z Δz
    direction = xp.sign(by_s.im * turned.re - by_s.re * turned.im)
    theta = xp.arctan2(-z.im, z.re)
    return omega, xp.where(theta < 0.0, theta + TURN, theta), direction, correction


def parts(q: Polynomial) -> tuple[Polynomial, Polynomial]:
    """Return a and b of q(iω) = a(ω²) + iω b(ω²)."""
    even = [c if place % 2 == 0 else -c for place, c in enumerate(q[0::2])]
    odd = [c if place % 2 == 0 else -c for place, c in enumerate(q[1::2])]
    return even, odd


def _at(quasi: Sequence[Polynomial], x: Scalar) -> list[OnAxis]:
    return [OnAxis(*(value_at(part, x) for part in parts(q))) for q in quasi]


def _reduced(quasi: Sequence[OnAxis], x: Real) -> list[Any]:
    """Return h, u and, for m = 3, w: the polynomial that q and its reversed conjugate leave."""
    first, last = quasi[0], quasi[-1]
    h = _square(first, x) - _square(last, x)
    others = quasi[1:-1]
    reduced = []
    for q, opposite in zip(others, reversed(others), strict=True):
        ahead, behind = _conjugate_times(first, q, x), _conjugate_times(opposite, last, x)
        reduced.append(OnAxis(ahead.even - behind.even, ahead.odd - behind.odd))
    return [h, *reduced]


def _square(p: OnAxis, x: Real) -> Real:
    """Return |p|²."""
    return p.even * p.even + x * (p.odd * p.odd)


def _conjugate_times(p: OnAxis, q: OnAxis, x: Real) -> OnAxis:
    """Return p̄ q."""
    return OnAxis(p.even * q.even + x * (p.odd * q.odd), p.even * q.odd - p.odd * q.even)


def _root_on_circle(q: Sequence[Scalar]) -> Scalar:
    """Return the root z of q0 + … + qm zᵐ that lies on the unit circle where R is 0.

    Of the two roots of the quadratic that is left for m = 3 it is the one, scaled to the circle, at
    which Δ is smaller: the other may lie near the circle too.
    """
    h = abs(q[0]) ** 2 - abs(q[-1]) ** 2
    u = q[0].conj() * q[1] - q[-1] * q[-2].conj()
    if len(q) == 3:
        return -h / u
    w = q[0].conj() * q[2] - q[3] * q[1].conj()
    xp = namespace(*q)
    root = xp.sqrt(u**2 - 4.0 * h * w)
    root = xp.where((u.conj() * root).real < 0.0, -root, root)
    first, second = -2.0 * h / (u + root), -(u + root) / (2.0 * w)
    first, second = first / abs(first), second / abs(second)
    nearer = abs(value_at(q, second)) < abs(value_at(q, first))
    return xp.where(nearer, second, first)


def _plus(p: Complex, re: Scalar, im: Scalar) -> Complex:
    return Complex(p.re + re, p.im + im)


def _slopes_on_axis(
    quasi: Sequence[Polynomial], omega: Scalar, z: Complex
) -> tuple[Complex, Complex, Complex]:
    """Return Δ, ∂Δ/∂s and ∂Δ/∂z at s = iω."""
    x = omega**2
    nothing = Complex(0.0 * omega, 0.0 * omega)
    at, by_s, by_z = nothing, nothing, nothing
    for q in reversed(quasi):  # Horner's scheme in z
        (even, odd), (slope, odd_slope) = parts(q), parts([k * c for k, c in enumerate(q)][1:])
        by_z = _plus(times(by_z, z), at.re, at.im)
        at = _plus(times(at, z), value_at(even, x), omega * value_at(odd, x))
        imaginary = omega * value_at(odd_slope, x) if odd_slope else 0.0
        by_s = _plus(times(by_s, z), value_at(slope, x), imaginary)
    return at, by_s, by_z


def slopes(quasi: Sequence[Polynomial], s: Scalar, z: Scalar) -> tuple[Scalar, Scalar, Scalar]:
    """Return Δ, ∂Δ/∂s and ∂Δ/∂z."""
    values = [value_at(q, s) for q in quasi]
    slopes = [value_at([k * c for k, c in enumerate(q)][1:], s) for q in quasi]
    # without feedback there is q0 alone
    by_z = value_at([k * v for k, v in enumerate(values)][1:] or [0.0 * z], z)
    return value_at(values, z), value_at(slopes, z), by_z
