"""Covariances of sway from responses in time: neither frequencies nor an equation of Lyapunov.

Σ = ∫₀^∞ h(t) S h(t)ᵀ dt, h the response to an impulse at each joint. It is followed by steps of at
most τ, on each of which it is a polynomial that fulfils x' = F x + H x(t − τ) at Chebyshev's
points, what is late being that of the steps before.
"""

import numpy as np

from sway_oracles import first_order

POINTS = 16  # of a step
PER_STEP = 2.0  # longest step, in time constants of the fastest root
SMALL = 1e-16  # what the last steps add, relative to all: they add up, where decay is slow
TOGETHER = 64  # steps that are looked at for that
MOST = 400_000  # steps


def by_responses(matrices, noise, delay):
    """The covariance of rotations; NaN where the response takes too many steps to die out."""
    now, late, enters, back = first_order(matrices)
    lag, step = _steps(now, late, delay)
    if not lag:
        now, late = now + late, np.zeros_like(late)
    ahead, of_late, weights = _propagators(now, late, step)
    size, count = len(now), len(matrices[0])
    x = np.zeros((POINTS * size, count))
    x[-size:] = enters * np.asarray(noise)  # at the end of the step before
    ring = [np.zeros_like(x) for _ in range(max(lag, 1))]
    total = np.zeros((count, count))
    recent = total.copy()
    for number in range(MOST):
        x = ahead @ x[-size:] + of_late @ ring[number % len(ring)]
        ring[number % len(ring)] = x
        angles = x.reshape(POINTS, size, count)[:, :count]
        recent += np.einsum("p,pik,pjk->ij", weights, angles, angles)
        if number % TOGETHER == TOGETHER - 1:
            total += recent
            if np.trace(recent) < SMALL * np.trace(total) and number > 4 * lag:
                return back @ total @ back.T
            recent = np.zeros_like(total)
    return np.full_like(total, np.nan)


def _steps(now, late, delay):
    """Steps in a delay, and the length of one (s)."""
    fastest = np.abs(np.linalg.eigvals(now)).max() + np.linalg.norm(late, 2)
    longest = PER_STEP / fastest
    if delay == 0.0:
        return 0, longest
    lag = int(np.ceil(delay / longest))
    return lag, delay / lag


def _propagators(now, late, step):
    """What takes the end of the last step, and the late step, to a step; weights of its integral.

    At points cⱼ of a step: x(cⱼ) = x₀ + step Σ aⱼᵢ x'(cᵢ), exact for polynomials.
    """
    # roots of a Chebyshev polynomial, and the end of the step, which the next one starts from
    c = np.append(0.5 - 0.5 * np.cos(np.pi * (np.arange(POINTS - 1) + 0.5) / (POINTS - 1)), 1.0)
    powers = np.polynomial.legendre.legvander(2.0 * c - 1.0, POINTS - 1)
    integrated = np.stack([
        np.polynomial.legendre.legval(
            2.0 * c - 1.0, np.polynomial.legendre.legint(row, lbnd=-1.0)
        ) / 2.0
        for row in np.eye(POINTS)
    ], axis=1)  # fmt: skip
    a = step * integrated @ np.linalg.inv(powers)
    size = len(now)
    left = np.eye(POINTS * size) - np.kron(a, now)
    start = np.kron(np.ones((POINTS, 1)), np.eye(size))
    return (
        np.linalg.solve(left, start),
        np.linalg.solve(left, np.kron(a, late)),
        a[-1],
    )
