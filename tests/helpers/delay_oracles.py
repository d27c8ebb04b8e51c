"""Independent ways to crossings, counts and roots of delayed feedback, for one person at a time.

None of them shares a formula with the package: crossings from a matrix pencil of Kronecker
products, counts from the argument principle, roots from Chebyshev collocation and Newton's method.
"""

import math

import numpy as np
import scipy.linalg


def delta(matrices: np.ndarray, delay: float, s: np.ndarray) -> np.ndarray:
    """Return det(A s² + B s + C + (P + D s) e^(−sτ)) for every s."""
    a, b, c, p, d = matrices
    s = np.asarray(s, complex)[..., None, None]
    return np.linalg.det(a * s**2 + b * s + c + (p + d * s) * np.exp(-s * delay))


def crossings_by_pencil(matrices: np.ndarray) -> list[tuple[float, float]]:
    """Return (ω, θ) of all crossings: det[L(s) ⊗ L(−s) − F(s) ⊗ F(−s)] = 0 on the axis.

    The quartic matrix polynomial of size n² is linearised; roots near the axis are then tried: z
    must be an eigenvalue of L z⁻¹ + F on the unit circle.
    """
    a, b, c, p, d = matrices
    n = len(a)
    # scaled by the Cholesky factor of A
    inverse = np.linalg.inv(np.linalg.cholesky(a))
    a, b, c, p, d = (inverse @ m @ inverse.T for m in (a, b, c, p, d))
    kron = np.kron
    terms = [
        kron(c, c) - kron(p, p),
        kron(b, c) - kron(c, b) - kron(d, p) + kron(p, d),
        kron(a, c) + kron(c, a) - kron(b, b) + kron(d, d),
        kron(b, a) - kron(a, b),
        kron(a, a),
    ]
    # s = i ω and z on the circle
    size = n * n
    companion = np.zeros((4 * size, 4 * size))
    for k in range(3):
        companion[k * size : (k + 1) * size, (k + 1) * size : (k + 2) * size] = np.eye(size)
    for k in range(4):
        companion[3 * size :, k * size : (k + 1) * size] = -np.linalg.solve(terms[4], terms[k])
    found = []
    for s in np.linalg.eigvals(companion):
        if s.imag > 0.0 and abs(s.real) < 1e-5 * abs(s):
            omega = s.imag
            passive = -a * omega**2 + 1j * b * omega + c
            z = scipy.linalg.eigvals(-passive, p + 1j * omega * d)
            on_circle = z[np.abs(np.abs(z) - 1.0) < 1e-4]
            found += [(omega, float(-np.angle(each) % math.tau)) for each in on_circle]
    return sorted(found)


def unstable_by_argument(
    matrices: np.ndarray, delay: float, shift: float = 0.0, steps: int = 4000
) -> int:
    """Return how many roots lie right of Re s = shift: N = n − Δarg det Δ(iω)/π, ω from 0 up.

    Steps are halved wherever the argument turns by more than a third of a half turn between
    neighbours, so that no turn is missed.
    """
    a, b, c, p, d = matrices
    n = len(a)
    inverse = np.linalg.inv(np.linalg.cholesky(a))

    def size(m: np.ndarray) -> float:
        return float(np.linalg.norm(inverse @ m @ inverse.T))

    grown = math.exp(-shift * delay) if shift < 0.0 else 1.0
    rate = size(b) + size(d) * grown + 2.0 * abs(shift)
    static = size(c) + (size(p) + abs(shift) * size(d)) * grown
    static += abs(shift) * size(b) + shift**2
    top = 40.0 * (rate + math.sqrt(rate**2 + 4.0 * static))
    omega = np.concatenate([[0.0], np.geomspace(1e-4, top, steps)])
    omega = np.union1d(omega, np.arange(0.0, min(top, 2000.0), 0.3 / max(delay, 1e-3)))
    values = delta(matrices, delay, shift + 1j * omega)
    for _ in range(40):
        turn = np.abs(np.angle(values[1:] / values[:-1]))
        wide = np.flatnonzero(turn > math.pi / 3.0)
        if not wide.size:
            break
        between = 0.5 * (omega[wide] + omega[wide + 1])
        added = delta(matrices, delay, shift + 1j * between)
        omega = np.insert(omega, wide + 1, between)
        values = np.insert(values, wide + 1, added)
    total = float(np.angle(values[1:] / values[:-1]).sum())
    # from the last ω on det Δ ≈ det A (iω)^(2n), whose argument stays
    total += float(np.angle((1j) ** (2 * n) / (values[-1] / abs(values[-1]))))
    return round(n - total / math.pi)


def roots_by_collocation(matrices: np.ndarray, delay: float, nodes: int = 40) -> np.ndarray:
    """Return the rightmost characteristic roots, by Chebyshev collocation and Newton's method.

    Breda, Maset & Vermiglio, SIAM J. Sci. Comput. 27 (2005) 482-495.
    """
    a, b, c, p, d = matrices
    n = len(a)
    inverse = np.linalg.inv(a)
    now = np.block([[np.zeros((n, n)), np.eye(n)], [-inverse @ c, -inverse @ b]])
    late = np.block([[np.zeros((n, n)), np.zeros((n, n))], [-inverse @ p, -inverse @ d]])
    if delay == 0.0:
        return np.linalg.eigvals(now + late)
    k = np.arange(nodes + 1)
    x = np.cos(np.pi * k / nodes)
    weights = np.where((k == 0) | (k == nodes), 2.0, 1.0) * (-1.0) ** k
    gaps = x[:, None] - x[None, :] + np.eye(nodes + 1)
    derivative = (weights[:, None] / weights[None, :]) / gaps
    derivative -= np.diag(derivative.sum(axis=1))
    derivative *= 2.0 / delay
    whole = np.kron(derivative, np.eye(2 * n))
    whole[: 2 * n] = 0.0
    whole[: 2 * n, : 2 * n] = now
    whole[: 2 * n, -2 * n :] = late
    roots = np.linalg.eigvals(whole)
    roots = roots[np.argsort(-roots.real)][: 6 * n]
    polished = []
    for s in roots:
        root = s
        for _ in range(30):
            e = np.exp(-root * delay)
            m = a * root**2 + b * root + c + (p + d * root) * e
            slope = 2.0 * a * root + b + (d - delay * (p + d * root)) * e
            try:
                step = 1.0 / np.trace(np.linalg.solve(m, slope))
            except np.linalg.LinAlgError:
                break
            root = root - step
            if abs(step) < 1e-15 * abs(root):
                break
        if abs(root - s) < 0.3 * (1.0 + abs(s)):
            polished.append(root)
    return np.array(polished)


def polished_crossing(
    matrices: np.ndarray, omega: float, theta: float, steps: int = 6
) -> tuple[float, float]:
    """Return a crossing after steps of Newton's method on L(iω) + F(iω) e^(−iθ), singular there.

    The pencil's eigenvalues are good to about 1e-8 of the largest. The least singular value is
    u* M v, and changes by u* ∂M v.
    """
    a, b, c, p, d = matrices
    for _ in range(steps):
        s, z = 1j * omega, np.exp(-1j * theta)
        whole = a * s**2 + b * s + c + (p + d * s) * z
        left, sizes, right = np.linalg.svd(whole)
        u, v, at = left[:, -1].conj(), right[-1].conj(), complex(sizes[-1])
        by_omega = u @ (1j * (2.0 * a * s + b + d * z)) @ v
        by_theta = u @ (-1j * z * (p + d * s)) @ v
        rows = [[by_omega.real, by_theta.real], [by_omega.imag, by_theta.imag]]
        change = np.linalg.solve(rows, [-at.real, -at.imag])
        omega, theta = omega + change[0], theta + change[1]
        if max(abs(change[0]) / omega, abs(change[1])) < 1e-14:
            break
    return float(omega), float(theta % math.tau)


def rightmost_by_collocation(matrices: np.ndarray, delay: float) -> complex:
    """Return the rightmost root, its imaginary part ≥ 0, by collocation and Newton's method.

    Where the argument principle finds roots right of the best, more nodes are taken: they resolve
    ωτ up to about as much as they are.
    """
    for nodes in (16, 40, 80, 160):
        roots = roots_by_collocation(matrices, delay, nodes)
        best = roots[np.argmax(roots.real)]
        beside = best.real + 1e-6 * (1.0 + abs(best))
        if unstable_by_argument(matrices, delay, beside) == 0:
            break
    return complex(best.real, abs(best.imag))
