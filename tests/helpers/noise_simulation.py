"""Persons who are disturbed by noise, simulated in time: second moments of what is recorded.

x' = F x + H x(t − τ) + E w in steps that the delay is a multiple of. Over a step everything is
exact but the late state between two steps. There the rates are a polynomial that has the rates at
both ends and turns the rotation of the one into that of the other: straight lines would leave out
what noise does within a step, some per cent of what is fed back. All paths of all persons go
together; each starts upright, and nothing is counted until that is forgotten.
"""

from typing import NamedTuple

import numpy as np
from scipy.linalg import expm

from noisy_people import LOADS, WEIGHT, Standing
from sway_oracles import RATE, first_order

STEP = 1e-3  # s, at most
FORGOTTEN = 6.0  # time constants of the slowest root until anything is counted
LOW_PASS = 10.0  # Hz, of the centre of pressure, forth and back
EDGE = 1.0  # s at both ends of a record that the filter spoils
POINTS, WEIGHTS = np.polynomial.legendre.leggauss(12)  # of integrals over a step, from −1 to 1


class Recorded(NamedTuple):
    """Of each path: means of q qᵀ, (persons, paths, 3, 3), and of the squares of CoP and velocity.

    ``pressure`` and ``velocity`` are (persons, recorded paths), m² and m²/s².
    """

    rotations: np.ndarray
    pressure: np.ndarray
    velocity: np.ndarray


class _Step(NamedTuple):
    """What a step of one person does to x of now, late x at its two ends, and noise.

    Beside x, (6,), it gives the integrals over the step of what now and what is late adds to the
    CoP: averages of a step, unlike samples, hold nothing of what is faster than steps.
    """

    now: np.ndarray
    late: np.ndarray
    next_late: np.ndarray
    noise: np.ndarray
    rotation: np.ndarray


def recorded(rng, standing: Standing, decay, seconds: float, paths: int, kept: int) -> Recorded:
    """Simulate persons with three free joints; ``kept`` of the paths record the CoP."""
    lag = np.maximum(np.ceil(standing.delay / STEP).astype(int), 1)
    step = np.where(standing.delay > 0.0, standing.delay / lag, STEP)
    steps = _Step(*map(np.stack, zip(*(
        _step_of(standing, person, step[person]) for person in range(lag.size)
    ), strict=True)))  # fmt: skip
    persons = np.arange(lag.size)
    before = np.ceil(FORGOTTEN / decay.min() / step.min()).astype(int)
    count = int(seconds / step.min())
    length = lag.max() + 1
    ring = np.zeros((length, lag.size, 8, paths))
    total = np.zeros((lag.size, paths, 3, 3))
    record = np.zeros((count, lag.size, kept), np.float32)
    for number in range(before + count):
        x = ring[number % length, persons, :6]
        late = ring[(number - lag) % length, persons, :6]
        next_late = ring[(number - lag + 1) % length, persons]
        after = steps.now @ x + steps.late @ late + steps.next_late @ next_late[:, :6]
        after += steps.noise @ rng.standard_normal(after.shape)
        ring[(number + 1) % length, persons] = after
        if number >= before:
            q = steps.rotation @ x
            total += np.einsum("aip,ajp->apij", q, q)
            record[number - before] = after[:, 6, :kept] + next_late[:, 7, :kept]
    pressure, velocity = np.stack([
        _filtered(record[:, person], step[person]) for person in persons
    ], axis=1)  # fmt: skip
    return Recorded(total / count, pressure, velocity)


def _step_of(standing: Standing, person: int, step: float) -> _Step:
    matrices, noise = standing.people.matrices(person), standing.noise[:, person]
    now, late, enters, back = first_order(matrices)
    _, b, c, p, d = matrices
    none = np.zeros((3, 3))
    # of x: rotations and rates
    to_q, to_rate = np.hstack([back, none]), np.hstack([none, RATE * back])
    of_now = ((c[0] + LOADS) @ to_q + b[0] @ to_rate) / WEIGHT
    of_late = (p[0] @ to_q + d[0] @ to_rate) / WEIGHT
    if standing.delay[person] == 0.0:
        now, late = now + late, np.zeros_like(late)
        of_now, of_late = of_now + of_late, np.zeros_like(of_late)
    whole = np.zeros((8, 8))
    whole[:6, :6], whole[6, :6], whole[7, :6] = now, of_now, of_late
    late, pushed = np.pad(late, ((0, 2), (0, 0))), np.pad(enters * noise, ((0, 2), (0, 0)))
    at = 0.5 * step * (1.0 + POINTS)
    after = [expm(whole * (step - s)) for s in at]
    weights = 0.5 * step * WEIGHTS
    made = sum(w * e @ pushed @ pushed.T @ e.T for w, e in zip(weights, after, strict=True))
    size, directions = np.linalg.eigh(made)
    return _Step(
        expm(whole * step)[:, :6],
        *_pushes(late, weights, after, at / step, step),
        directions * np.sqrt(np.maximum(size, 0.0)),
        to_q,
    )


def _pushes(late, weights, after, u, step):
    """What the late x at both ends of a step adds to the state at its end."""
    one, none = np.eye(3), np.zeros((3, 3))
    first, second = np.zeros((2, len(late), 6))
    for w, e, part in zip(weights, after, u, strict=True):
        swing = 6.0 * part * (1.0 - part)
        turned = swing / (step * RATE) * one
        at_first = np.block([
            [(1.0 - part) * one, none], [-turned, (1.0 - part - 0.5 * swing) * one]
        ])  # fmt: skip
        at_second = np.block([[part * one, none], [turned, (part - 0.5 * swing) * one]])
        first += w * e @ late @ at_first
        second += w * e @ late @ at_second
    return first, second


def _filtered(record: np.ndarray, step: float) -> tuple[np.ndarray, np.ndarray]:
    """Mean squares of the filtered CoP of each path, and of its velocity, of integrals over steps.

    Filter and derivative are those of continuous time, and what averages lack is given back.
    """
    hertz = np.fft.rfftfreq(len(record), step)[:, None]
    gain = 1.0 / (step * np.sinc(hertz * step) * (1.0 + (hertz / LOW_PASS) ** 4))
    seen = np.fft.rfft(record.astype(float), axis=0) * gain
    edge = int(EDGE / step)
    parts = (np.fft.irfft(each, len(record), axis=0) for each in (seen, 2j * np.pi * hertz * seen))
    pressure, velocity = (np.mean(part[edge:-edge] ** 2, axis=0) for part in parts)
    return pressure, velocity
