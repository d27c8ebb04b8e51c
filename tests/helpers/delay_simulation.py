"""Persons with delayed feedback simulated in time, by their full nonlinear equations.

Runge-Kutta of fourth order with a fixed step that the delay is a multiple of. Rotations and rates
of the last τ are kept; between two steps they are interpolated by cubic Hermite polynomials. The
feedback is −P q(t − τ) − D q̇(t − τ), the dampers −B q̇; all else is ``standfast.joint_moments``.
Before t = 0 the person stood upright.
"""

from functools import partial

import jax
import jax.numpy as jnp
import numpy as np

import standfast as sf
from people import random_body

STEP = 1e-3  # s, at most; fast modes of knee and hip are some hundred 1/s
KEPT = 512  # steps of history at most
START = 1e-5  # rad
FALLEN = 1.0  # rad: the person lies, and the simulation is stopped
PARTS = 20  # of a simulation, of each of which the largest rotation is kept
LONGEST = 60.0  # s
RATES = 7.0  # time constants of the slowest root that a simulation lasts
GRAVITY = 9.81
SLACK = sf.Stiffness(0.0, 0.0, 0.0)


def random_case(rng):
    """A person, springs, dampers and feedback; some joints rigid."""
    body = random_body(rng)
    load = -np.asarray(sf.stiffness_matrix(body, sf.Stiffness(0.0, 0.0, 0.0), GRAVITY))
    joints = np.array([rng.uniform(0.2, 1.1) * load[0, 0], *10.0 ** rng.uniform(2.7, 3.7, 2)])
    joints[rng.random(3) < np.array([0.0, 0.3, 0.3])] = np.inf
    p, d = rng.uniform(-0.05, 0.05, (2, 3, 3)) * load[2, 2]
    p[range(3), range(3)] = rng.uniform(0.0, [1.5, 0.2, 0.4]) * np.diag(load)
    d[range(3), range(3)] = rng.uniform(0.0, [0.4, 0.03, 0.05]) * np.diag(load)
    coupling = rng.uniform(0.0, 40.0) if np.isfinite(joints).all() else 0.0
    stiffness = sf.Stiffness(*joints, knee_hip=coupling)
    damping = 10.0 ** rng.uniform(0.5, 1.5, 3)
    return body, stiffness, damping, sf.Feedback(p, d, rng.uniform(0.02, 0.35))


def random_cases(rng, count, away):
    """Persons away from the boundary, half of them standing; their decay rates (1/s)."""
    cases, decay = [], []
    while len(cases) < count:
        body, stiffness, damping, feedback = case = random_case(rng)
        root = sf.rightmost_root(body, stiffness, GRAVITY, damping=damping, feedback=feedback)
        standing = sum(rate > 0.0 for rate in decay)
        wanted = (
            standing < (count + 1) // 2 if root.real < 0.0 else len(cases) - standing < count // 2
        )
        if abs(root.real) > away and wanted:
            cases.append(case)
            decay.append(-root.real)
    return cases, np.array(decay)


def amplitudes(cases, decay):
    """Largest rotations (rad) of every person in the equal parts of its time; inf once fallen.

    A simulation lasts some time constants of the rightmost root, whose ``decay`` rates are given.
    """
    delay = np.array([feedback.delay for *_, feedback in cases])
    lag = np.ceil(delay / STEP).astype(int)
    step = delay / lag
    lasts = np.clip(RATES / abs(np.asarray(decay)), 6.0 * delay, LONGEST)
    count = np.ceil(lasts / step / PARTS).astype(int) * PARTS
    leaves = [
        (tuple(body), _finite(stiffness), np.isfinite(stiffness.joints), np.diag(damping),
         np.asarray(feedback.proportional), np.asarray(feedback.derivative))
        for body, stiffness, damping, feedback in cases
    ]  # fmt: skip
    person = jax.tree.map(lambda *parts: np.stack(parts), *leaves)
    with jax.enable_x64(True):
        return np.asarray(_simulated(person, lag, step, count, int(count.max())))


def falls(found):
    """Whether amplitudes grow from the second quarter to the last; NaN where they do neither."""
    early, late = found[5:10].max(axis=0), found[15:].max(axis=0)
    growth = np.where(np.isinf(late), np.inf, late / np.where(np.isinf(early), 1.0, early))
    return np.where(growth > 1.5, 1.0, np.where(growth < 1.0 / 1.5, 0.0, np.nan))


def _finite(stiffness):
    """K as a matrix, 0 at a rigid joint, whose row is taken out of the equations."""
    springs = np.array(stiffness.joints)
    whole = np.diag(np.where(np.isinf(springs), 0.0, springs))
    whole[0, 1] = whole[1, 0] = stiffness.ankle_knee
    whole[1, 2] = whole[2, 1] = stiffness.knee_hip
    whole[0, 2] = whole[2, 0] = stiffness.ankle_hip
    return whole


@partial(jax.jit, static_argnums=4)
def _simulated(person, lag, step, count, most):
    def one(person, lag, step, count):
        leaves, springs, free, *matrices = person
        body = sf.Body._make(leaves)
        # rotation, rate, acceleration of the last steps, in a ring
        ring = jnp.zeros((KEPT, 3, 3)).at[0, 0].set(jnp.where(free, START, 0.0))

        def pushed(number, carried):
            ring, largest, fallen = carried
            late = (ring[(number - lag) % KEPT], ring[(number - lag + 1) % KEPT])
            after = _stepped(body, springs, free, matrices, ring[number % KEPT], late, step)
            size = jnp.abs(after[0]).max()
            fallen = fallen | ~(size < FALLEN)
            after = jnp.where(fallen, 0.0, after)
            part = jnp.minimum(number * PARTS // count, PARTS)  # what comes later is not kept
            largest = largest.at[part].max(jnp.where(fallen, jnp.inf, size))
            return ring.at[(number + 1) % KEPT].set(after), largest, fallen

        start = (ring, jnp.zeros(PARTS + 1), jnp.array(False))
        return jax.lax.fori_loop(0, most, pushed, start)[1][:PARTS]

    return jax.vmap(one)(person, lag, step, count).T


def _stepped(body, springs, free, matrices, now, late, step):
    """Rotation, rate and acceleration one step on."""
    damping, proportional, derivative = matrices
    # delayed values at the beginning, the middle and the end of the step
    before, after = late
    middle = [
        0.5 * (before[k] + after[k]) + step / 8.0 * (before[k + 1] - after[k + 1]) for k in (0, 1)
    ]

    def acceleration(q, v, late_q, late_v):
        outer = -damping @ v - springs @ q - proportional @ late_q - derivative @ late_v

        def moments(turning):
            return sf.joint_moments(body, SLACK, tuple(q), tuple(v), tuple(turning), GRAVITY)

        bias = moments(jnp.zeros(3))
        mass = jnp.stack([moments(column) - bias for column in jnp.eye(3)], axis=1)
        both = free[:, None] & free[None, :]
        mass = jnp.where(both, mass, jnp.eye(3))
        return jnp.linalg.solve(mass, jnp.where(free, outer - bias, 0.0))

    q, v, _ = now
    first = acceleration(q, v, before[0], before[1])
    v2 = v + 0.5 * step * first
    second = acceleration(q + 0.5 * step * v, v2, *middle)
    v3 = v + 0.5 * step * second
    third = acceleration(q + 0.5 * step * v2, v3, *middle)
    v4 = v + step * third
    fourth = acceleration(q + step * v3, v4, after[0], after[1])
    q = q + step / 6.0 * (v + 2.0 * v2 + 2.0 * v3 + v4)
    v = v + step / 6.0 * (first + 2.0 * second + 2.0 * third + fourth)
    return jnp.stack([q, v, acceleration(q, v, after[0], after[1])])
