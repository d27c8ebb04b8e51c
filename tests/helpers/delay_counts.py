"""Unstable roots of many persons at once, by the argument principle with certified steps.

It shares no formula with the package: Δ is expanded by Leibniz' rule, and nothing of resultants,
Bernstein's coefficients or Routh's array is used. On a cell [l, r] of ω with middle m the turn of
Δ(iω) is known for certain where Δ stays within a disc around Δ(im) that 0 is not in:

    |Δ(iω) − Δ(im)| ≤ |Δ'| h + Σk ( Σj≥2 |Tkj| hʲ + |Tk1| h · kτh + ½ |Tk0| (kτh)² ) < 0.7 |Δ(im)|

with h = (r − l)/2 and qk(i(m + δ)) = Σj Tkj δʲ. Where q0 outweighs the others on a whole cell, Δ
turns as q0 does but for the angles between them at both ends. Other cells are halved.
N = n − Δarg Δ(iω)/π for ω from 0 up to where the leading term outweighs twice the others.

notation: q0 … q3 coefficients of Δ = Σ qk(s) zᵏ with z = e^(−sτ), n free joints, τ delay.
"""

import itertools
import math
from functools import partial

import jax
import jax.numpy as jnp
import numpy as np

CHUNK = 2**14
DISC = 0.7
WIDE = {"xla_cpu_prefer_vector_width": 512}
FIRST = 28  # cells
NARROWEST = 1e-13  # of ω: a root lies on the axis, within rounding
SIGNS = {order: float(np.linalg.det(np.eye(3)[list(order)]))
         for order in itertools.permutations(range(3))}  # fmt: skip


def expanded(numbers: np.ndarray, rigid: np.ndarray) -> np.ndarray:
    """q0 … q3 in rising powers of s, (4, 7, persons); a rigid joint is a row of the identity."""
    a, b, c, p, d = np.where(rigid[:, None] | rigid[None, :], 0.0, numbers)
    c = c + np.eye(3)[..., None] * rigid
    passive, active = (c, b, a), (p, d)
    found = np.zeros((4, 7, numbers.shape[-1]))
    for order in itertools.permutations(range(3)):
        entries = [
            [[m[i, j] for m in kind] for kind in (passive, active)] for i, j in enumerate(order)
        ]
        for chosen in itertools.product(range(2), repeat=3):
            for powers in itertools.product(*(range(3 - which) for which in chosen)):
                term = SIGNS[order]
                for row, which, power in zip(entries, chosen, powers, strict=True):
                    term = term * row[which][power]
                found[sum(chosen), sum(powers)] += term
    return found


def tops(q: np.ndarray, joints: np.ndarray) -> np.ndarray:
    """ω from which |lead| ω^2n exceeds twice the sum of all other terms."""
    sizes = abs(q).sum(axis=0)
    lead = np.take_along_axis(sizes, 2 * joints[None], axis=0)[0]
    top = np.full(joints.shape, 1.0)
    for power in range(6):
        rest = np.where(power < 2 * joints, sizes[power], 0.0)
        # each of at most 9 terms is to be below a nineteenth of the lead
        top = np.maximum(top, (19.0 * rest / lead) ** (1.0 / np.maximum(2.0 * joints - power, 1.0)))
    return top


@partial(jax.jit, compiler_options=WIDE)
def turned(q, delay, low, high):
    """Turn of Δ(iω) over cells, and whether it is certain."""
    middle, half = 0.5 * (low + high), 0.5 * (high - low)
    real = imaginary = slope_real = slope_imaginary = rest = 0.0
    first, others, off_first = 0.0, 0.0, 0.0
    for k, (c, s) in enumerate(rotations(delay, middle)):
        taylor, late = shifted(q[k], 6 - k, middle), k * delay
        (a, b), (da, db) = taylor[:2]
        real, imaginary = real + a * c - b * s, imaginary + a * s + b * c
        # d/dω of (a + ib) exp(−ikωτ)
        da_late, db_late = da + late * b, db - late * a
        slope_real = slope_real + da_late * c - db_late * s
        slope_imaginary = slope_imaginary + da_late * s + db_late * c
        higher = 0.0
        for term in taylor[:1:-1]:
            higher = (higher + jnp.hypot(*term)) * half
        size, steep = jnp.hypot(a, b), jnp.hypot(da, db)
        rest = rest + (higher + steep * late * half) * half
        rest = rest + 0.5 * size * (late * half) ** 2
        off = (higher + steep) * half
        if k == 0:
            first, off_first = size, off
        else:
            others = others + size + off
    steepest = jnp.hypot(slope_real, slope_imaginary)
    within = steepest * half + rest < DISC * jnp.hypot(real, imaginary)
    outweighed = off_first + others < DISC * first
    at_low, at_high = value(q, delay, low), value(q, delay, high)
    q0_low, q0_high = ((at[2], at[3]) for at in (at_low, at_high))
    of_first = angle(q0_low, q0_high) + angle(q0_high, at_high) - angle(q0_low, at_low)
    return jnp.where(within, angle(at_low, at_high), of_first), within | outweighed


def angle(before, after):
    """Angle from one complex number to another, between −π and π."""
    (a, b), (c, d) = before[:2], after[:2]
    return jnp.arctan2(a * d - b * c, a * c + b * d)


def rotations(delay, omega):
    """Cosine and sine of −kωτ for k = 0 … 3."""
    c, s = jnp.cos(omega * delay), -jnp.sin(omega * delay)
    turns = [(1.0, 0.0), (c, s)]
    for _ in range(2):
        a, b = turns[-1]
        turns.append((a * c - b * s, a * s + b * c))
    return turns


def shifted(q, degree, middle):
    """Real and imaginary parts of q(i(m + δ)) in rising powers of δ."""
    parts = []
    for first in range(2):
        taylor = [
            (-1.0) ** (power // 2) * q[power] if power % 2 == first else 0.0 * middle
            for power in range(degree + 1)
        ]
        for stage in range(degree):
            for place in range(degree - 1, stage - 1, -1):
                taylor[place] = taylor[place] + middle * taylor[place + 1]
        parts.append(taylor)
    return list(zip(*parts, strict=True))


def value(q, delay, omega):
    """Real and imaginary part of Δ(iω), and those of q0(iω)."""
    real = imaginary = 0.0
    first = ()
    for k, (c, s) in enumerate(rotations(delay, omega)):
        x, degree = omega**2, 6 - k
        a = b = 0.0
        for power in range(degree - degree % 2, -1, -2):
            a = q[k, power] - x * a
        for power in range(degree - 1 + degree % 2, 0, -2):
            b = q[k, power] - x * b
        b = omega * b
        first = first or (a, b)
        real, imaginary = real + a * c - b * s, imaginary + a * s + b * c
    return real, imaginary, *first


def counted(q: np.ndarray, joints: np.ndarray, delay: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Unstable roots of each person at its delay, and whether every step was certified."""
    with jax.enable_x64(True):
        return _counted(q, joints, delay)


def _counted(q, joints, delay):
    persons = delay.size
    top = tops(q, joints)
    edges = np.concatenate([[0.0], np.geomspace(1e-4, 1.0, FIRST)])
    whose = np.tile(np.arange(persons), FIRST)
    low, high = ((part[:, None] * top).ravel() for part in (edges[:-1], edges[1:]))
    total, certified = np.zeros(persons), np.ones(persons, bool)
    while whose.size:
        wide = []
        for start in range(0, whose.size, CHUNK):
            part = slice(start, start + CHUNK)
            who, left, right = whose[part], low[part], high[part]
            filled = np.resize(np.arange(who.size), CHUNK)
            turn, certain = turned(
                q[..., who[filled]], delay[who[filled]], left[filled], right[filled]
            )
            turn, certain = np.asarray(turn)[: who.size], np.asarray(certain)[: who.size]
            total += np.bincount(who[certain], turn[certain], persons)
            given_up = ~certain & (right - left <= NARROWEST * right)
            certified[who[given_up]] = False
            wide.append(np.flatnonzero(~certain & ~given_up) + start)
        chosen = np.concatenate(wide)
        middle = 0.5 * (low[chosen] + high[chosen])
        whose = np.concatenate([whose[chosen], whose[chosen]])
        low, high = (
            np.concatenate([low[chosen], middle]), np.concatenate([middle, high[chosen]]),
        )  # fmt: skip
        open_ = certified[whose]
        whose, low, high = whose[open_], low[open_], high[open_]
    real, imaginary = (np.asarray(part) for part in value(q, delay, top)[:2])
    lead = np.take_along_axis(q[0], 2 * joints[None], axis=0)[0] * (-1.0) ** joints
    total += np.angle(lead / (real + 1j * imaginary))
    found = joints - total / math.pi
    count = np.rint(found)
    certified &= abs(found - count) < 1e-6
    return count.astype(np.int64), certified
