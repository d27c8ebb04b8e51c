"""A recording's length, rate and low-pass, as weights of frequencies and of lags.

What is expected of powers is ∫ S Φ df, with the weights Φ of :mod:`standfast.recordings.powers`, at
frequencies that all persons of a fit share. How much two of them vary together needs besides the
overlap of the times that they are of.
"""

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from scipy import fft

from standfast.recordings.powers import steps_weight, variance_weight, welch_weights
from standfast.recordings.recording import window_of

# Frequencies go up to this multiple of the low-pass's, where its gain is 1/40, of a power 6e-4 …
BAND = 2.5
# … and stand as near as a process needs that forgets its past within so long (s).
MEMORY = 180.0
# What is faster than this matters to steps alone (Hz): all other lags are taken as far apart as it
# allows. That makes covariances 2.5 times as quick at 10 Hz.
SLOW = 6.0


class Window(NamedTuple):
    """A recording's duration, rate and low-pass, as weights of frequencies and times.

    Attributes
    ----------
    hertz : (m,)
        even from 0.
    weight : (powers, m)
        Φ of :data:`.powers.POWERS`.
    mixed : (powers, powers, m)
        √(Φ_a Φ_b).
    step : s
        between times of ``overlap``.
    every : how many times of ``overlap`` are one for what is slow
    overlap : (powers, powers, 2 m − 2)
        Σ_t g_a(t) g_b(t + u) over the lags u, in the order of a discrete Fourier transform, g being
        how much a power has of each time: even, or Hann's windows squared.
    lags : as many of them, from 0 on, as there is an overlap at
    """

    hertz: np.ndarray
    weight: np.ndarray
    mixed: np.ndarray
    step: float
    every: int
    overlap: np.ndarray
    lags: int


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
        variance_weight(hertz, count, rate),
        steps_weight(hertz, rate),
        *welch_weights(hertz, count, rate),
    ])  # fmt: skip
    spent = np.stack([np.full(inside, 1.0 / inside)] * 2 + [_windows(inside, count, rate)] * 2)
    turned = fft.rfft(spent, size)
    overlap = fft.irfft(turned[:, None].conj() * turned[None], size)
    return Window(hertz, weight, np.sqrt(weight[:, None] * weight), step, every, overlap, inside)


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
