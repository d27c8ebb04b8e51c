"""What a recording of some seconds makes of a spectrum: the measures as weighings of frequencies.

Every measure is made of *powers*: the variance s² about the mean, the square of the steps, and of
Welch's spectrum P the sums ∫ P df and ∫ f P df. Each is quadratic in the samples, and its
expectation is ∫ S(f) Φ(f) df exactly, with a weight Φ that the definition of the measure fixes:

    s²          (1 − F(f)) n/(n − 1),   F = (sin(πfn/r)/(n sin(πf/r)))²
    steps²      (2 r sin(πf/r))²
    ∫P, ∫fP     what Welch's method makes of a sine wave: nearly 1, and f, above some 1/T

A mean that is removed takes what is slower than the recording; that is why Φ falls to 0 there.

notation: S two-sided spectral density a hertz, r rate (Hz), n samples, T duration (s).
"""

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from scipy import fft, signal

from standfast.recordings.recording import window_of

POWERS = ("variance", "steps", "welch", "welch_times_f")
# Frequencies go up to this multiple of the low-pass's, where its gain is 1/40, of a power 6e-4 …
BAND = 2.5
# … and stand as near as a process needs that forgets its past within so long (s).
MEMORY = 180.0
# What is faster than this matters to steps alone (Hz): all other lags are taken as far apart as it
# allows. That makes covariances 2.5 times as quick at 10 Hz.
SLOW = 6.0
# From so many of Welch's bins on, Φ is 1 and f to 1e-6.
BINS = 20
SAMPLES = 3000  # of a window of slow waves: more of them look the same


class Window(NamedTuple):
    """A recording's duration, rate and low-pass, as weights of frequencies and times.

    Attributes
    ----------
    hertz : (m,)
        even from 0.
    weight : (powers, m)
        Φ of :data:`POWERS`.
    mixed : (powers, powers, m)
        √(Φ_a Φ_b).
    step : s
        between times of ``overlap``.
    every : how many times of ``overlap`` are one for what is slow
    overlap : (powers, powers, 2 m − 2)
        Σ_t g_a(t) g_b(t + u) over the lags u, in the order of a discrete Fourier transform, g being
        how much a power has of each time: even, or Hann's windows squared.
    """

    hertz: np.ndarray
    weight: np.ndarray
    mixed: np.ndarray
    step: float
    every: int
    overlap: np.ndarray

    def integral(self, density: np.ndarray) -> np.ndarray:
        """Return ∫ over both signs of f of a density of the last axis."""
        total = 2.0 * density.sum(axis=-1) - density[..., 0] - density[..., -1]
        found: np.ndarray = total * self.hertz[1]
        return found


@lru_cache(maxsize=8)
def window(count: int, rate: float, low_pass: float) -> Window:
    """Return the window of a recording of some samples at a rate, with a low-pass (all Hz)."""
    step = 0.5 / (BAND * low_pass)
    inside = round(count / rate / step)
    every = max(int(BAND * low_pass / SLOW), 1)
    least = max(2 * inside, inside + round(MEMORY / step))
    size = 2 * every * fft.next_fast_len(-(-least // (2 * every)), real=True)
    hertz = fft.rfftfreq(size, step)
    weight = np.stack([
        (1.0 - _of_mean(hertz, count, rate)) * count / (count - 1),
        (2.0 * rate * np.sin(np.pi * hertz / rate)) ** 2,
        *_welch(hertz, count, rate),
    ])  # fmt: skip
    spent = np.stack([np.full(inside, 1.0 / inside)] * 2 + [_windows(inside, count, rate)] * 2)
    turned = fft.rfft(spent, size)
    overlap = fft.irfft(turned[:, None].conj() * turned[None], size)
    return Window(hertz, weight, np.sqrt(weight[:, None] * weight), step, every, overlap)


def _of_mean(hertz: np.ndarray, count: int, rate: float) -> np.ndarray:
    """Return Fejér's kernel: the share of a power that is in the mean of the samples."""
    turn = np.pi * hertz / rate
    sine = count * np.sin(turn)
    small = abs(sine) < 1e-12 * count
    found: np.ndarray = np.where(small, 1.0, np.sin(count * turn) / np.where(small, 1.0, sine)) ** 2
    return found


def _welch(hertz: np.ndarray, count: int, rate: float) -> tuple[np.ndarray, np.ndarray]:
    """Return Φ of ∫ P df and ∫ f P df, by trapezoids: of slow waves as Welch's method finds it."""
    seconds = window_of(count, rate) / rate
    folded = abs(hertz - rate * np.round(hertz / rate))
    slow = np.flatnonzero(hertz * seconds < BINS)
    length = min(window_of(count, rate), SAMPLES)
    waves = np.exp(2j * np.pi * hertz[slow, None] * seconds / length * np.arange(length))
    shape = signal.get_window("hann", length)
    power = abs(fft.fft(shape * (waves - waves.mean(axis=1, keepdims=True)), axis=1)) ** 2
    bins = abs(fft.fftfreq(length, seconds / length))
    # one-sided densities are twice two-sided ones, but not at the ends, where a trapezoid halves
    power[:, (bins == 0.0) | (bins == bins.max())] *= 0.5
    power /= length * (shape**2).sum()
    plain, times_f = np.ones_like(hertz), folded.copy()
    plain[slow], times_f[slow] = power.sum(axis=1), power @ bins
    return plain, times_f


def _windows(inside: int, count: int, rate: float) -> np.ndarray:
    """Return how much Welch's spectrum has of each of ``inside`` even times."""
    length = window_of(count, rate)
    hop = length - length // 2
    segments = (count - length // 2) // hop
    times = (np.arange(inside) + 0.5) * count / inside
    total = np.zeros(inside)
    for first in hop * np.arange(segments):
        phase = (times - first) / length
        total += np.where((phase > 0.0) & (phase < 1.0), np.sin(np.pi * phase) ** 4, 0.0)
    found: np.ndarray = total / total.sum()
    return found
