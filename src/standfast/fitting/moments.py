"""Expectation and covariance of the measures of a recording whose process is known.

Of a stationary Gaussian process of spectral densities S a power has the expectation μ = ∫ S Φ df
(:mod:`standfast.recordings.powers`). Two powers a, b of readings x, y have the covariance

    2 Σ_u G_ab(u) ρ_ab(u)²,   ρ_ab(u) = ∫ S_xy(f) √(Φ_a Φ_b) e^(2πifu) df

with the overlap G of their times: exact for weights that do not change within 1/T, and near
otherwise. Mean velocity is a mean of |steps|, whose correlation ρ gives it the relative variance
Σ_u G(u) (√(1 − ρ²) + ρ asin ρ − 1), exactly. Logarithms of measures are nearly Gaussian; their
expectation is below the logarithm of the expectation by half of the relative variance (delta
method). All derivatives are exact.

notation: S two-sided spectral densities a hertz, u lag, dx derivative of x along each change.
"""

from typing import NamedTuple

import numpy as np
from scipy import fft

from standfast.fitting.window import Window
from standfast.recordings.powers import (
    OF_SIZES,
    STEPS,
    VARIANCE,
    WELCH,
    WELCH_TIMES_F,
    integral,
)

VELOCITY, FREQUENCY = "mean_velocity_ap", "mean_frequency_ap"
# The reading, and which powers with which exponents, a measure is made of.
MADE_OF = {
    "sd_ap": ("cop", {VARIANCE: 0.5}),
    VELOCITY: ("cop", {STEPS: 0.5}),
    FREQUENCY: ("cop", {WELCH_TIMES_F: 1.0, WELCH: -1.0}),
    "sd_com": ("com", {VARIANCE: 0.5}),
    "sd_ankle": ("ankle", {VARIANCE: 0.5}),
    "sd_knee": ("knee", {VARIANCE: 0.5}),
    "sd_hip": ("hip", {VARIANCE: 0.5}),
}


class Moments(NamedTuple):
    """Of the logarithms of measures: expectation, covariance, and their derivatives.

    Attributes
    ----------
    mean : (measures,)
    covariance : (measures, measures)
    mean_slope : (changes, measures)
    covariance_slope : (changes, measures, measures)
    """

    mean: np.ndarray
    covariance: np.ndarray
    mean_slope: np.ndarray
    covariance_slope: np.ndarray


def moments(
    measures: tuple[str, ...],
    window: Window,
    response: np.ndarray,
    slope: np.ndarray,
    noise: np.ndarray,
) -> Moments:
    """Return the moments of measures.

    Parameters
    ----------
    response : (readings, joints, m), slope : (changes, readings, joints, m)
        as :func:`.responses.responses` gives them, of :func:`readings_of` the measures.
    noise : (joints,), N²·m²·s
        the density of each joint's torque, σ².
    """
    readings = readings_of(measures)
    powers = [
        (readings.index(MADE_OF[name][0]), power) for name in measures for power in MADE_OF[name][1]
    ]
    exponents = np.zeros((len(measures), len(powers)))
    column = 0
    for row, name in enumerate(measures):
        for exponent in MADE_OF[name][1].values():
            exponents[row, column] = exponent
            column += 1
    steps = np.array([power == STEPS for _, power in powers])
    mean, mean_slope, relative, relative_slope = _relative(powers, window, response, slope, noise)
    # the expectation of mean |steps| is itself the root of a power, that of an SD is not
    share = np.where(steps, 0.5, 1.0)
    below = share * np.diagonal(relative)
    below_slope = share * np.diagonal(relative_slope, axis1=1, axis2=2)
    constant = np.array([0.5 * np.log(OF_SIZES) if n == VELOCITY else 0.0 for n in measures])
    return Moments(
        exponents @ (np.log(mean) - 0.5 * below) + constant,
        exponents @ relative @ exponents.T,
        (mean_slope / mean - 0.5 * below_slope) @ exponents.T,
        exponents @ relative_slope @ exponents.T,
    )


def readings_of(measures: tuple[str, ...]) -> tuple[str, ...]:
    """Return the readings that measures are of, each once."""
    return tuple(dict.fromkeys(MADE_OF[name][0] for name in measures))


def _relative(
    powers: list[tuple[int, int]],
    window: Window,
    response: np.ndarray,
    slope: np.ndarray,
    noise: np.ndarray,
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Return expectations of powers and covariances relative to them, each with derivatives."""
    count, last = len(powers), len(window.hertz) - 1
    mean, mean_slope = np.zeros(count), np.zeros((len(slope), count))
    sequences: dict[tuple[int, int], np.ndarray] = {}
    of_readings: dict[tuple[int, int], np.ndarray] = {}
    for i, (x, a) in enumerate(powers):
        for j, (y, b) in enumerate(powers[: i + 1]):
            if (x, y) not in of_readings:
                of_readings[x, y] = _densities(x, y, response, slope, noise)
            both = of_readings[x, y] * window.mixed[a, b]
            if i == j:
                mean[i], *mean_slope[:, i] = integral(both.real, window.hertz[1])
            every = 1 if a == b == STEPS else window.every
            kept = both[:, : last // every + 1]
            sequences[i, j] = fft.irfft(kept, 2 * last // every) / (every * window.step)
    found, found_slope = np.zeros((count, count)), np.zeros((len(slope), count, count))
    for (i, j), sequence in sequences.items():
        a, b = powers[i][1], powers[j][1]
        rho = sequence / np.sqrt(mean[i] * mean[j])
        every = 2 * last // rho.shape[1]
        overlap = every * window.overlap[a, b, ::every]
        logarithmic = mean_slope[:, i] / mean[i] + mean_slope[:, j] / mean[j]
        if i == j and a == STEPS:  # four times that of mean |steps|, as of a power
            share = np.clip(rho[0], -1.0, 1.0)
            angle = np.arcsin(share)
            value = share * angle + np.sqrt(1.0 - share**2) - 1.0
            turned, spent = share * angle, 4.0 * overlap
            gradient = _sum(rho[1:], spent * angle) - 0.5 * logarithmic * _sum(turned, spent)
        else:
            value, spent = rho[0] ** 2, 2.0 * overlap
            gradient = 2.0 * _sum(rho[1:], spent * rho[0]) - logarithmic * _sum(value, spent)
        found[i, j] = found[j, i] = _sum(value, spent)
        found_slope[:, i, j] = found_slope[:, j, i] = gradient
    return mean, mean_slope, found, found_slope


def _densities(
    x: int, y: int, response: np.ndarray, slope: np.ndarray, noise: np.ndarray
) -> np.ndarray:
    """Return the spectral density of two readings, and its derivatives, (1 + changes, m)."""
    weighed = noise[:, None] * response[y].conj()
    joint = (response[x] * weighed).sum(axis=0)
    moved = (slope[:, x] * weighed).sum(axis=1)
    if x == y:
        return np.concatenate([joint[None], moved + moved.conj()]).real
    other = (noise[:, None] * response[x] * slope[:, y].conj()).sum(axis=1)
    return np.concatenate([joint[None], moved + other])


def _sum(values: np.ndarray, weights: np.ndarray) -> np.ndarray:
    """Return weighted sums over the last axis.

    ``@`` would wake the threads of BLAS for each: on two busy cores 70 ms instead of 2 in all.
    """
    found: np.ndarray = np.einsum("...u,u->...", values, weights)
    return found
