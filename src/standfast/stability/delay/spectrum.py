"""Characteristic roots of one person from the right, and how the body moves at a root.

Without delay they are eigenvalues. With one there is no end of them: a start of each is an
eigenvalue of the motion's generator on Chebyshev points (Breda, Maset & Vermiglio, SIAM J. Sci.
Comput. 27 (2005) 482-495); Newton's method on Δ(s, e^(−sτ)) itself takes it to a root, and what
does not converge is no root.

notation: A inertia, B damping, C stiffness less gravity, P and D gains, τ delay, s root (1/s).
"""

import numpy as np

from standfast.stability.delay.problem import Problem, directly, prepared
from standfast.stability.delay.rightmost import CONVERGED, newton

# Points resolve e^(sθ) on a delay up to |s| τ of about as much as they are; those of three joints
# take a twentieth of a second.
POINTS = {1: 96, 2: 64, 3: 48}
# A start that moves by more than so much, relative, was none: what lies left of it is not shown.
RESOLVED = 1e-2
NEWTON_CALLS = 4
# Two that lie so near, relative, are one that was found twice; and an imaginary part below it is
# that of a real root.
SAME = 1e-7


def roots_from_the_right(
    numbers: np.ndarray, delay: float, *, most: int = 12, rightmost: complex | None = None
) -> np.ndarray:
    """Return the characteristic roots with the largest real parts (1/s), imaginary part ≥ 0.

    Parameters
    ----------
    numbers
        A, B, C, P, D of the free joints, (5, n, n).
    delay
        τ, s.
    most
        how many are wanted; without delay there are at most 2 n.
    rightmost
        the first if it is proven (:func:`.rightmost.rightmost_roots`), which is then among them
        also where the points do not resolve it.

    Returns
    -------
    complex array, by falling real part, as far to the left as the points resolve all of them.
    """
    joints = numbers.shape[-1]
    if joints == 0:
        return np.zeros(0, complex)
    now, late = _first_order(numbers)
    at_once, alone = np.linalg.eigvals(now + late), np.linalg.eigvals(now)
    starts, line = at_once, -np.inf
    if delay > 0.0:
        starts = np.linalg.eigvals(_generator(now, late, delay, POINTS[joints]))
        starts = starts[np.argsort(-starts.real)][: 8 * most]
    starts = starts[starts.imag >= 0.0]
    roots, moved = _polished(numbers, delay, starts)
    if delay > 0.0:
        lost = np.flatnonzero(~(moved < RESOLVED * (1.0 + np.abs(starts))))
        line = starts.real[lost[0]] if lost.size else starts.real.min()
        # what is over before the feedback arrives is near a root without it
        more = np.concatenate([each[each.imag >= 0.0] for each in (at_once, alone)])
        roots = np.concatenate([roots, _polished(numbers, delay, more)[0]])
    if rightmost is not None:
        roots = np.append(roots, rightmost)
    roots = roots[np.isfinite(roots)]
    roots = roots[np.argsort(-roots.real, kind="stable")]
    kept: list[complex] = []
    for root in roots:
        beyond = root.real < line and kept  # the first is shown whatever is behind it
        if not beyond and all(abs(root - other) > SAME * (1.0 + abs(root)) for other in kept):
            kept.append(complex(root))
    return np.array(kept[:most], complex)


def shape_at(numbers: np.ndarray, delay: float, s: complex) -> np.ndarray:
    """Return the rotations v of the free joints at a root, (n,), the largest 1.

    (A s² + B s + C + (P + D s) e^(−sτ)) v = 0
    """
    a, b, c, p, d = numbers
    _, _, right = np.linalg.svd(a * s**2 + b * s + c + (p + d * s) * np.exp(-s * delay))
    least: np.ndarray = right[-1].conj()
    shape: np.ndarray = least / least[np.argmax(np.abs(least))]
    return shape


def _first_order(numbers: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the matrices of ẋ(t) = now x(t) + late x(t − τ), x = (q, q̇)."""
    a, b, c, p, d = numbers
    zero, one = np.zeros_like(a), np.eye(len(a))
    now = np.block([[zero, one], [-np.linalg.solve(a, c), -np.linalg.solve(a, b)]])
    late = np.block([[zero, zero], [-np.linalg.solve(a, p), -np.linalg.solve(a, d)]])
    return now, late


def _generator(now: np.ndarray, late: np.ndarray, delay: float, points: int) -> np.ndarray:
    """Return ẋ = d x/dθ on Chebyshev points of [−τ, 0], where ẋ(0) = now x(0) + late x(−τ)."""
    k = np.arange(points + 1)
    x = np.cos(np.pi * k / points)
    weights = np.where((k == 0) | (k == points), 2.0, 1.0) * (-1.0) ** k
    gaps = x[:, None] - x[None, :] + np.eye(points + 1)
    slope = (weights[:, None] / weights[None, :]) / gaps
    slope -= np.diag(slope.sum(axis=1))
    size = len(now)
    whole: np.ndarray = np.kron(slope * (2.0 / delay), np.eye(size))
    whole[:size] = 0.0
    whole[:size, :size] = now
    whole[:size, -size:] += late
    return whole


def _polished(
    numbers: np.ndarray, delay: float, starts: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Take starts to roots above the real axis, NaN where none is reached; and how far they moved.

    A start has arrived when Newton's next step is rounding.
    """
    problem = Problem(numbers.shape[-1], numbers.shape[-1])
    coefficients = np.asarray(directly(prepared, problem, numbers[..., None]))
    re, im, step = starts.real, starts.imag, np.full(starts.size, np.inf)
    each = np.broadcast_to(coefficients, (len(coefficients), starts.size))
    for _ in range(NEWTON_CALLS):
        moved = directly(newton, problem, each, np.full(starts.size, delay), re, im)
        going = ~(step < CONVERGED * (1.0 + np.hypot(re, im)))
        re, im, step = np.where(going, np.asarray(moved), np.stack([re, im, step]))
    size = np.hypot(re, im)
    good = np.isfinite(size) & (step < CONVERGED * (1.0 + size))
    im = np.where(np.abs(im) > SAME * size, np.abs(im), 0.0)
    roots: np.ndarray = np.where(good, re + 1j * im, np.nan)
    return roots, np.abs(roots - starts)
