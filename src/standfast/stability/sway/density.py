"""Spectral densities of sway: what noise in the joints' torques makes of angles and of the CoP.

    A q̈ + B q̇ + C q + P q(t − τ) + D q̇(t − τ) = w,   S_q(ω) = H(iω) S H(iω)*,
    H(s) = (A s² + B s + C + (P + D s) e^(−sτ))⁻¹

w is white, of the two-sided density S = diag(σa², σk², σh²). The centre of mass over the ankle is
x = (G1, G2, G3) q / (m g). The centre of pressure is that of the moment that the ankle bears,
springs, damping and feedback, without the noise of the instant, which as white noise would have no
finite variance: with a free ankle u = (K q + B q̇ + P q(t − τ) + D q̇(t − τ))₁ / (m g). It is
seen through the low-pass of a force plate's software, because its velocity would have none either.

notation: A inertia, B damping, C stiffness less gravity, P and D gains, τ delay, S noise, G gravity
part, ω angular frequency (rad/s), q rotations of ankle, knee and hip (rad), F moments of springs,
damping and feedback per rotation.
"""

from typing import NamedTuple

from standfast.numerics.arrays import TURN, Array, Scalar
from standfast.numerics.complex_pairs import Complex, along, less, plus, square_of, times
from standfast.numerics.trigonometry import cosine_and_sine

# A Butterworth filter of the second order, forth and back, at 10 Hz: what Santos & Duarte (PeerJ 4
# (2016) e2648) put recordings of force plates through. Its gain is 1/(1 + (f/10 Hz)⁴).
LOW_PASS = 10.0 * TURN

# The rows of densities: of Σ above its diagonal, of CoM, CoP and the CoP's velocity, and ω times
# the CoP's.
PAIRS = ((0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2))
COM, COP, COP_VELOCITY, COP_TIMES_OMEGA = 6, 7, 8, 9


class Swaying(NamedTuple):
    """Persons as densities need them; of a rigid joint nothing is left but a 1 that nothing moves.

    Attributes
    ----------
    numbers : (5, 3, 3, persons)
        A, B, C, P, D.
    delay : (persons,), s
    noise : (3, persons), N²·m²·s
        the density of each joint's torque, σ².
    loads : (3, persons), m/rad
        G1, G2, G3 over m g: where the CoM goes with each rotation.
    lever : (3, persons), m/(N·m)
        what the rows of the equation add to the moment at the ankle, over m g: (1, 0, 0)/(m g) with
        a free ankle; A₁f Aff⁻¹/(m g) of the free joints f where it is rigid.
    """

    numbers: Array
    delay: Array
    noise: Array
    loads: Array
    lever: Array


def densities(swaying: Swaying, omega: Scalar, phase: Scalar) -> list[Scalar]:
    """Return all rows of densities at an angular frequency ω, with the phase ωτ of the feedback."""
    forces = _forces(swaying.numbers, omega, phase)
    adjugate, scale = _inverse(_matrix(swaying, omega, forces))
    found = [
        scale * sum(swaying.noise[k] * along(adjugate[i][k], adjugate[j][k]) for k in range(3))
        for i, j in PAIRS
    ]
    mass, pressure = (
        sum(
            swaying.noise[k] * square_of(_product(reading, [row[k] for row in adjugate]))
            for k in range(3)
        )
        for reading in (
            [Complex(load, 0.0) for load in swaying.loads],
            [_reading(swaying, forces, j) for j in range(3)],
        )
    )
    gain = 1.0 / (1.0 + (omega / LOW_PASS) ** 4)
    pressure = scale * gain * gain * pressure
    return [*found, scale * mass, pressure, omega**2 * pressure, omega * pressure]


def characteristic(swaying: Swaying, omega: Scalar) -> Scalar:
    """Return det H⁻¹ at iω, a complex number: near a pole of H its angle turns by π."""
    forces = _forces(swaying.numbers, omega, omega * swaying.delay)
    matrix = _matrix(swaying, omega, forces)
    determinant = _product(matrix[0], [_minor(matrix, 0, j) for j in range(3)])
    return determinant.re + 1j * determinant.im


def _matrix(swaying: Swaying, omega: Scalar, forces: list[list[Complex]]) -> list[list[Complex]]:
    """Return H⁻¹ at iω."""
    inertia, square = swaying.numbers[0], omega * omega
    return [
        [Complex(forces[i][j].re - square * inertia[i][j], forces[i][j].im) for j in range(3)]
        for i in range(3)
    ]


def _forces(numbers: Array, omega: Scalar, phase: Scalar) -> list[list[Complex]]:
    """Return F entry by entry."""
    _, b, c, p, d = numbers
    turned = cosine_and_sine(phase)
    return [
        [moment(b[i][j], c[i][j], p[i][j], d[i][j], omega, turned) for j in range(3)]
        for i in range(3)
    ]


def moment(
    b: Scalar, c: Scalar, p: Scalar, d: Scalar, omega: Scalar, turned: tuple[Scalar, Scalar]
) -> Complex:
    """Return F = C + iωB + (P + iωD) e^(−iωτ).

    Of one entry, or of arrays of them that broadcast; ``turned`` holds cos ωτ and sin ωτ.
    """
    cosine, sine = turned
    return Complex(
        c + p * cosine + omega * d * sine,
        omega * (b + d * cosine) - p * sine,
    )


def _inverse(m: list[list[Complex]]) -> tuple[list[list[Complex]], Scalar]:
    """Return the adjugate of a matrix and 1/|det|²."""
    adjugate = [[_minor(m, j, i) for j in range(3)] for i in range(3)]
    determinant = _product(m[0], [adjugate[j][0] for j in range(3)])
    return adjugate, 1.0 / square_of(determinant)


def _minor(m: list[list[Complex]], row: int, column: int) -> Complex:
    """Return the cofactor of an entry."""
    (i, j), (k, n) = ((row + 1) % 3, (row + 2) % 3), ((column + 1) % 3, (column + 2) % 3)
    return less(times(m[i][k], m[j][n]), times(m[i][n], m[j][k]))


def _reading(swaying: Swaying, forces: list[list[Complex]], joint: int) -> Complex:
    """Return what a joint's rotation adds to the CoP (m/rad)."""
    terms = [
        Complex(swaying.lever[i] * forces[i][joint].re, swaying.lever[i] * forces[i][joint].im)
        for i in range(3)
    ]
    total = plus(plus(terms[0], terms[1]), terms[2])
    return Complex(total.re + swaying.loads[joint], total.im)


def _product(row: list[Complex], column: list[Complex]) -> Complex:
    first, second, third = (times(p, q) for p, q in zip(row, column, strict=True))
    return plus(plus(first, second), third)
