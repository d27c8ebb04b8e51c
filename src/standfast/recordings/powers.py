"""What a recording of some seconds makes of a spectrum: the powers that measures are made of.

A *power* is quadratic in the n samples, at a rate r, of a stationary process, so its expectation is
∫ S(f) Φ(f) df exactly, over both signs of f, with a weight Φ that the definition of the measure
fixes:

    s²          (1 − F(f)) n/(n − 1),   F = (sin(πfn/r)/(n sin(πf/r)))²
    steps²      (2 r sin(πf/r))²
    ∫P, ∫fP     what Welch's method makes of a sine wave: nearly 1, and f, above some 1/T

s² is the variance about the mean, P Welch's spectrum. A mean that is removed takes what is slower
than the recording; that is why Φ falls to 0 there. P itself, in windows of L samples, follows from
the autocovariance R_m = ∫ S(f) cos(2π f m/r) df:

    E P_k = (2 or 1)/(r Σ w²) · u* R u,  u_a = w_a e^(−2πi k a/L) less its mean

This is the only place that says what is expected of a measure: :mod:`.expected` sums over the
frequencies that one person needs, a fit over those that all of its persons share.

notation: S two-sided spectral density a hertz, R autocovariance, r rate (Hz), n samples, T duration
(s), w Hann's window, E expectation.
"""

import numpy as np
from scipy import fft, signal

from standfast.numerics.arrays import TURN, Array
from standfast.recordings.recording import window_of

POWERS = ("variance", "steps", "welch", "welch_times_f")
VARIANCE, STEPS, WELCH, WELCH_TIMES_F = range(len(POWERS))
# (E |x|)² of a Gaussian x is so much of E x²: a mean velocity is a mean of sizes of steps.
OF_SIZES = 2.0 / np.pi
# From so many of Welch's bins on, Φ is 1 and f to 1e-6.
BINS = 20
SAMPLES = 3000  # of a window of slow waves: more of them look the same


def integral(density: Array, step: float) -> Array:
    """Return ∫ over both signs of f of densities, whose last axis is even from 0 (Hz)."""
    total = 2.0 * density.sum(axis=-1) - density[..., 0] - density[..., -1]
    found: Array = total * step
    return found


def variance_weight(hertz: Array, count: int, rate: float) -> Array:
    """Return Φ of s²: all of a power but what is in the mean of the samples, Fejér's kernel F."""
    turn = np.pi * hertz / rate
    sine = count * np.sin(turn)
    small = abs(sine) < 1e-12 * count
    of_mean = np.where(small, 1.0, np.sin(count * turn) / np.where(small, 1.0, sine)) ** 2
    found: Array = (1.0 - of_mean) * count / (count - 1)
    return found


def steps_weight(hertz: Array, rate: float) -> Array:
    """Return Φ of the mean square of the steps between samples, a second."""
    found: Array = (2.0 * rate * np.sin(np.pi * hertz / rate)) ** 2
    return found


def welch_weights(hertz: Array, count: int, rate: float) -> tuple[Array, Array]:
    """Return Φ of ∫ P df and ∫ f P df, by trapezoids: of slow waves as Welch's method finds it."""
    size = window_of(count, rate)
    seconds = size / rate
    slow = np.flatnonzero(hertz * seconds < BINS)
    fewer = min(size, SAMPLES)
    waves = np.cos(TURN * seconds / fewer * np.outer(hertz[slow], np.arange(fewer)))
    bins, found = welch_spectrum(waves, fewer / seconds)
    plain, times_f = np.ones_like(hertz), abs(hertz - rate * np.round(hertz / rate))
    # a constant has no power, but for rounding, of either sign
    plain[slow] = np.maximum(np.trapezoid(found, bins), 0.0)
    times_f[slow] = np.maximum(np.trapezoid(bins * found, bins), 0.0)
    return plain, times_f


def welch_spectrum(covariance: Array, rate: float) -> tuple[Array, Array]:
    """Return the frequencies (Hz) and the mean of the spectrum that :func:`cop_spectrum` estimates.

    ``covariance`` has R at the lags of 0, 1, … samples of a window along its last axis.
    """
    size = covariance.shape[-1]
    window = signal.get_window("hann", size)
    # u* R u of all frequencies at once, with the window's own correlation
    lagged = _correlation(window) * covariance
    found = 2.0 * fft.rfft(lagged).real - lagged[..., :1]
    # the mean is taken off the samples, not the window: it is felt where the window's own spectrum
    # is not 0, at the first two
    for place in range(2):
        turned = window * np.exp(-1j * TURN * place / size * np.arange(size))
        both = 2.0 * _correlation(turned - turned.mean())
        both[0] *= 0.5
        found[..., place] = covariance @ both
    density = 2.0 * found / (rate * np.sum(window**2))
    density[..., 0] *= 0.5
    if size % 2 == 0:
        density[..., -1] *= 0.5
    return np.arange(density.shape[-1]) * (rate / size), density


def _correlation(values: Array) -> Array:
    """Return the real part of Σ_a v_a* v_(a + m) at the lags m from 0 on."""
    size = values.size
    found: Array = fft.ifft(abs(fft.fft(values, 2 * size)) ** 2)[:size].real
    return found
