"""Recordings drawn at random from the spectrum of a person, by H(iω) written out here.

A long periodic Gaussian process of which a piece is kept: exact but for how it forgets its past.
"""

import numpy as np

import standfast as sf

RATE = 100.0  # Hz
PERIOD = 240.0  # s
LOW_PASS = 10.0  # Hz


def centres_of_pressure(person, noise, *, seconds, count, seed):
    """CoP (count, samples), m, of a person, the arguments of ``sf.is_stable``; σ of the joints."""
    free = np.flatnonzero(np.isfinite(person["stiffness"].joints))
    block = np.ix_(free, free)
    body, gravity, feedback = person["body"], person["gravity"], person["feedback"]
    springs = np.diag(
        np.where(np.isfinite(person["stiffness"].joints), person["stiffness"].joints, 0)
    )
    load = np.asarray(sf.stiffness_matrix(body, sf.Stiffness(0.0, 0.0, 0.0), gravity))
    a, b, c, p, d, k = (
        np.asarray(each, float)[block]
        for each in (
            sf.inertia_matrix(body), person["damping"], springs + load,
            feedback.proportional, feedback.derivative, springs,
        )
    )  # fmt: skip
    samples = round(PERIOD * RATE)
    s = 2j * np.pi * np.fft.rfftfreq(samples, 1.0 / RATE)[:, None, None]
    late = (p + d * s) * np.exp(-s * feedback.delay)
    h = np.linalg.inv(a * s**2 + b * s + c + late)
    reading = ((k + b * s + late) @ h)[:, 0] / (gravity * np.sum(body.segment_mass))
    reading /= 1.0 + (abs(s[:, 0]) / (2.0 * np.pi * LOW_PASS)) ** 4
    rng = np.random.default_rng(seed)
    drawn = rng.standard_normal((2, count, len(s), free.size)) @ np.diag(np.asarray(noise)[free])
    white = (drawn[0] + 1j * drawn[1]) * np.sqrt(0.5 * samples * RATE)
    white[:, 0] = np.sqrt(2.0) * white[:, 0].real
    found = np.fft.irfft((white * reading).sum(axis=-1), samples)
    return found[:, : round(seconds * RATE)]


def recording(cop, seed=0):
    """A recording with this anterior-posterior CoP; mediolateral is of no matter."""
    other = np.random.default_rng(seed).standard_normal(cop.size)
    return sf.Recording(cop, 2e-3 * other, RATE)
