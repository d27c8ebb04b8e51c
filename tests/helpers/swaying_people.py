"""Recordings of made-up people: the delay equation under noise, simulated in time.

    A dv = (−B v − C q − P q(t − τ) − D v(t − τ)) dt + σ dW,  dq = v dt

by Heun's method with steps of 1 ms, of many people at once; the centre of pressure is the ankle's
moment of springs, damping and feedback over m g, through a Butterworth filter of the second order
at 10 Hz, forth and back, of which every tenth sample is kept. Nothing of it is the package's but
the matrices.
"""

import numpy as np
from scipy import signal

import standfast as sf

STEP = 1e-3  # s; the fastest rate is some 10 1/s
EVERY = 10  # steps a sample: 100 Hz
SETTLED = 60.0  # s before the recording begins
ENDS = 2.0  # s before and after, that the filter may ring in


def recordings(people, noise, *, seconds, seed):
    """Recordings of people, each the arguments of ``sf.is_stable``, whose ankles are noisy."""
    rng = np.random.default_rng(seed)
    free = np.flatnonzero(np.isfinite(people[0]["stiffness"].joints))
    block = np.ix_(free, free)
    matrices = np.array([_matrices(person, block) for person in people])
    inverse = np.linalg.inv(matrices[:, 0])
    a, b, c, p, d, springs = np.moveaxis(matrices, 1, 0)
    del a
    lag = np.array([round(person["feedback"].delay / STEP) for person in people])
    weight = np.array([p["gravity"] * np.sum(p["body"].segment_mass) for p in people])
    count = round((SETTLED + seconds + 2.0 * ENDS) / STEP)
    depth = lag.max() + 2
    past = np.zeros((depth, 2, len(people), free.size))
    everyone = np.arange(len(people))
    q, v = past[0]
    pressure = np.zeros((count, len(people)))
    strength = np.asarray(noise) * np.sqrt(STEP)

    def by(matrix, vector):
        return np.einsum("kij,kj->ki", matrix, vector)

    def late(number):
        # before the start everyone stood upright
        found = past[(number - lag) % depth, :, everyone]
        return np.where((number >= lag)[:, None, None], found, 0.0)

    for number in range(count):
        past[number % depth] = q, v
        before = late(number)
        fed_back = by(p, before[:, 0]) + by(d, before[:, 1])
        damped = by(b, v)
        pressure[number] = (by(springs, q) + damped + fed_back)[:, 0] / weight
        kick = np.zeros_like(v)
        kick[:, 0] = strength * rng.standard_normal(len(people))
        kick = by(inverse, kick)
        first = by(inverse, -damped - by(c, q) - fed_back)
        # at the end of the step, of which a delay of 0 knows only the start
        ahead_q, ahead_v = q + STEP * v, v + STEP * first + kick
        after = np.where((lag > 0)[:, None, None], late(number + 1), before)
        after = np.where((lag == 1)[:, None, None], np.stack([ahead_q, ahead_v], 1), after)
        fed_back = by(p, after[:, 0]) + by(d, after[:, 1])
        second = by(inverse, -by(b, ahead_v) - by(c, ahead_q) - fed_back)
        q, v = (
            q + 0.5 * STEP * (v + ahead_v),
            v + 0.5 * STEP * (first + second) + kick,
        )
    return _recorded(pressure, seconds, rng)


def _matrices(person, block):
    """A, B, C, P, D and K of the free joints."""
    body, stiffness, gravity = (person[name] for name in ("body", "stiffness", "gravity"))
    joints = np.array(stiffness.joints)
    springs = np.diag(np.where(np.isfinite(joints), joints, 0.0))
    load = np.asarray(sf.stiffness_matrix(body, sf.Stiffness(0.0, 0.0, 0.0), gravity))
    damping = np.asarray(person["damping"], float) * (
        np.eye(3) if np.ndim(person["damping"]) < 2 else 1.0
    )
    feedback = person["feedback"]
    whole = (
        sf.inertia_matrix(body), damping, springs + load, feedback.proportional,
        feedback.derivative, springs,
    )  # fmt: skip
    return [np.asarray(each, float)[block] for each in whole]


def _recorded(pressure, seconds, rng):
    """What the plate's software makes of the centre of pressure; mediolateral is of no matter."""
    sections = signal.butter(2, 10.0, fs=1.0 / STEP, output="sos")
    seen = signal.sosfiltfilt(sections, pressure, axis=0)
    first = round((SETTLED + ENDS) / STEP)
    kept = seen[first : first + round(seconds / STEP) : EVERY].T
    other = np.cumsum(rng.standard_normal(kept.shape), axis=1) * 1e-4
    other = signal.detrend(other, axis=1)
    return [
        sf.Recording(ap, ml, rate=1.0 / (STEP * EVERY)) for ap, ml in zip(kept, other, strict=True)
    ]
