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
    count, changes = len(powers), len(slope)
    pairs: dict[tuple[int, int], list[tuple[int, int]]] = {}
    for i, (x, _) in enumerate(powers):
        for j, (y, _) in enumerate(powers[: i + 1]):
            pairs.setdefault((x, y), []).append((i, j))
    density = {both: _densities(*both, response, slope, noise) for both in pairs}
    integrals = np.zeros((1 + changes, count))
    for i, (x, a) in enumerate(powers):
        integrals[:, i] = integral(density[x, x] * window.weight[a], window.hertz[1])
    mean, logarithmic = integrals[0], integrals[1:] / integrals[0]
    found, found_slope = np.zeros((count, count)), np.zeros((changes, count, count))
    power = np.array([a for _, a in powers])
    for both, whose in pairs.items():
        fast = [(i, j) for i, j in whose if i == j and power[i] == STEPS]
        slow = [pair for pair in whose if pair not in fast]
        for some, vary in ((fast, _vary_of_steps), (slow, _vary_together)):
            if not some:
                continue
            i, j = np.array(some).T
            value, gradient = vary(
                density[both],
                power[i],
                power[j],
                window,
                np.sqrt(mean[i] * mean[j]),
                logarithmic[:, i] + logarithmic[:, j],
            )
            found[i, j] = found[j, i] = value
            found_slope[:, i, j] = found_slope[:, j, i] = gradient
    return mean, integrals[1:], found, found_slope


def _vary_together(
    density: np.ndarray,
    a: np.ndarray,
    b: np.ndarray,
    window: Window,
    root: np.ndarray,
    logarithmic: np.ndarray,
) -> tuple[np.ndarray, np.ndarray]:
    """Return 2 Σ G ρ² of pairs of powers, (pairs,), and its derivatives, (changes, pairs).

    ``root`` is that of the product of their expectations, ``logarithmic`` the derivatives of its
    square's logarithm.
    """
    last = (len(window.hertz) - 1) // window.every
    spectra = density[:, None, : last + 1] * window.mixed[a, b, : last + 1]
    rho = fft.irfft(spectra, 2 * last) / (window.every * window.step * root[:, None])
    spent = 2.0 * window.every * window.overlap[a, b, :: window.every] * rho[0]
    value = np.einsum("pu,pu->p", spent, rho[0])
    return value, 2.0 * np.einsum("pu,cpu->cp", spent, rho[1:]) - logarithmic * value


def _vary_of_steps(
    density: np.ndarray,
    a: np.ndarray,
    b: np.ndarray,
    window: Window,
    root: np.ndarray,
    logarithmic: np.ndarray,
) -> tuple[np.ndarray, np.ndarray]:
    """Return four times the relative variance of mean |steps|, as of a power, likewise.

    ρ is even here, so that half of the lags are enough, and of these those of the recording.
    """
    last, lags = len(window.hertz) - 1, window.lags
    sequence = fft.dct(density * window.mixed[a[0], b[0]], 1)[:, :lags]
    rho = sequence / (2 * last * window.step * root[0])
    spent = 8.0 * window.overlap[a[0], b[0], :lags]
    spent[0] *= 0.5
    share = np.clip(rho[0], -1.0, 1.0)
    angle = np.arcsin(share)
    turned = share * angle
    value = _sum(turned + np.sqrt(1.0 - share**2) - 1.0, spent)
    gradient = _sum(rho[1:], spent * angle) - 0.5 * logarithmic[:, 0] * _sum(turned, spent)
    return value[None], gradient[:, None]


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
