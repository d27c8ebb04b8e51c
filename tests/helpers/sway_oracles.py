"""Covariances of sway by other ways than an integral over frequencies."""

import numpy as np
from scipy.linalg import expm, solve_continuous_lyapunov

RATE = 10.0  # 1/s, what velocities are counted in: numbers of one size keep their digits


def first_order(matrices):
    """x' = F x + H x(t − τ) + E w of A, B, C, P, D, (5, n, n), x = (Lᵀq, Lᵀq̇/RATE), A = L Lᵀ.

    Returns F, H, E, and L⁻ᵀ, which takes x to rotations.
    """
    a, b, c, p, d = matrices
    count = len(a)
    inverse = np.linalg.inv(np.linalg.cholesky(a))
    b, c, p, d = (inverse @ each @ inverse.T for each in (b, c, p, d))
    zero = np.zeros((count, count))
    now = np.block([[zero, RATE * np.eye(count)], [-c / RATE, -b]])
    late = np.block([[zero, zero], [-p / RATE, -d]])
    return now, late, np.vstack([zero, inverse / RATE]), inverse.T


def fastest(people):
    """The largest modulus of what would be the roots without the feedback (1/s), (persons,)."""
    each = (first_order(people.matrices(number))[0] for number in range(people.kind.size))
    return np.array([np.abs(np.linalg.eigvals(now)).max() for now in each])


def without_delay(matrices, noise):
    """The covariance of rotations that solves Lyapunov's equation, P and D at once."""
    now, late, enters, back = first_order(matrices)
    made = enters @ np.diag(np.square(noise)) @ enters.T
    count = len(matrices[0])
    return back @ solve_continuous_lyapunov(now + late, -made)[:count, :count] @ back.T


def with_delay(matrices, noise, delay):
    """The covariance of rotations from the delay Lyapunov matrix R(θ) = E x(t + θ) x(t)ᵀ.

    On 0 ≤ θ ≤ τ, with Y(θ) = R(θ − τ): R' = F R + H Y, Y' = −Y Fᵀ − R Hᵀ; at the ends
    Y(τ) = R(0) = R(0)ᵀ, Y(0) = R(τ)ᵀ, and F R(0) + H R(τ)ᵀ + (…)ᵀ = −W.
    Its digits are lost as τ times the fastest rate passes 10.
    """
    now, late, enters, back = first_order(matrices)
    made = enters @ np.diag(np.square(noise)) @ enters.T
    n = len(now)
    one, size = np.eye(n), n * n
    # of matrices by rows: vec(A X) = (A ⊗ 1) vec X, vec(X Aᵀ) = (1 ⊗ A) vec X
    ode = np.block([
        [np.kron(now, one), np.kron(late, one)],
        [-np.kron(one, late), -np.kron(one, now)],
    ])  # fmt: skip
    transposed = np.eye(size).reshape(n, n, size).transpose(1, 0, 2).reshape(size, size)
    start = np.eye(2 * size)
    end = expm(ode * delay)
    r0, y0, r1, y1 = start[:size], start[size:], end[:size], end[size:]
    energy = np.kron(now, one) @ r0 + np.kron(late, one) @ (transposed @ r1)
    energy = energy + transposed @ energy
    rows = np.vstack([y1 - r0, r0 - transposed @ r0, y0 - transposed @ r1, energy])
    right = np.concatenate([np.zeros(3 * size), -made.ravel()])
    scale = np.linalg.norm(rows, axis=1)
    scale[scale == 0.0] = 1.0
    found, *_ = np.linalg.lstsq(rows / scale[:, None], right / scale, rcond=None)
    count = len(matrices[0])
    return back @ found[:size].reshape(n, n)[:count, :count] @ back.T
