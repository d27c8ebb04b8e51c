"""What is published of sway on a force plate, each by its definition.

Definitions were found on the 99 recordings of Santos & Duarte (PeerJ 4 (2016) e2648) that have
published numbers: area within 1e-4 of them, mean velocity 2e-4, mean frequency 0.8 %.
notation: x, y anterior-posterior and mediolateral about their means, n samples, T duration, f rate,
S their covariance (divided by n − 1), P(f) one-sided power spectral density.
"""

import math
from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from scipy import signal

from standfast.errors import InputError, says_its_arguments, shortened
from standfast.numerics.arrays import Array
from standfast.recordings.recording import Recording, checked_recording, window_of

COVERED = 0.95  # by the prediction ellipse
ORDER = 2  # of the low-pass, which runs forth and back


class Measure(NamedTuple):
    """A row of the table of measures: unit, and how it is printed, as the field does."""

    meaning: str
    unit: str
    printed: str
    factor: float


MEASURES: Mapping[str, Measure] = {
    "area": Measure("area of the 95 % prediction ellipse", "m²", "mm²", 1e6),
    "sd_ap": Measure("SD, anterior-posterior", "m", "mm", 1e3),
    "sd_ml": Measure("SD, mediolateral", "m", "mm", 1e3),
    "range_ap": Measure("range, anterior-posterior", "m", "mm", 1e3),
    "range_ml": Measure("range, mediolateral", "m", "mm", 1e3),
    "path": Measure("path", "m", "mm", 1e3),
    "mean_velocity": Measure("mean velocity", "m/s", "mm/s", 1e3),
    "mean_velocity_ap": Measure("mean velocity, anterior-posterior", "m/s", "mm/s", 1e3),
    "mean_velocity_ml": Measure("mean velocity, mediolateral", "m/s", "mm/s", 1e3),
    "mean_frequency": Measure("mean frequency", "Hz", "Hz", 1.0),
    "median_frequency": Measure("median frequency", "Hz", "Hz", 1.0),
}


class SwayMeasures(NamedTuple):
    """The measures of one recording, in SI.

    Attributes
    ----------
    area : m²
        of the ellipse in which a further sample lies with 95 %:
        π √det S · 2 (n − 1)(n + 1)/(n (n − 2)) · F(0.95; 2, n − 2), the last a quantile of
        Fisher's distribution (Schubert & Kirchner, Gait Posture 39 (2014) 518).
    sd_ap, sd_ml : m
        √S of each direction (Duarte & Freitas, Rev Bras Fisioter 14 (2010) 183; Prieto et al.,
        IEEE Trans Biomed Eng 43 (1996) 956, RDIST, divide by n).
    range_ap, range_ml : m
        largest less smallest.
    path : m
        Σ √(Δx² + Δy²) (Prieto: TOTEX).
    mean_velocity : m/s
        path / T (Prieto: MVELO).
    mean_velocity_ap, mean_velocity_ml : m/s
        Σ abs(Δx) / T of each direction.
    mean_frequency : Hz
        ∫ f (P_x + P_y) df / ∫ (P_x + P_y) df by trapezoids over all frequencies up to half the
        rate, of Welch's spectrum. That of Prieto (MFREQ) is another: velocity / (2π distance).
    median_frequency : Hz
        below it lies half of ∫ (P_x + P_y) df (Prieto, from 0.15 to 5 Hz: 50 % power frequency).
    """

    area: float
    sd_ap: float
    sd_ml: float
    range_ap: float
    range_ml: float
    path: float
    mean_velocity: float
    mean_velocity_ap: float
    mean_velocity_ml: float
    mean_frequency: float
    median_frequency: float


class CopSpectrum(NamedTuple):
    """One-sided power spectral densities (n,) of a recording, m²/Hz, at some frequencies (Hz)."""

    frequency: Array
    ap: Array
    ml: Array


@says_its_arguments()
def sway_measures(recording: Recording, *, low_pass: float | None = None) -> SwayMeasures:
    """Return what is published of a recording of quiet standing (:class:`SwayMeasures`).

    Parameters
    ----------
    low_pass
        Hz: a Butterworth filter of the second order forth and back before all else, as 10 Hz;
        without it the samples as they are, as the published numbers have it.

    Raises
    ------
    InputError
        if it is no recording, or the filter's frequency not between 0 and half of its rate.

    Examples
    --------
    >>> import numpy as np
    >>> import standfast as sf
    >>> t = np.arange(6000) / 100                       # s
    >>> ap = 0.004 * np.sin(2 * np.pi * 0.25 * t)       # m
    >>> ml = 0.002 * np.cos(2 * np.pi * 0.25 * t)
    >>> measures = sf.sway_measures(sf.Recording(ap, ml, rate=100.0))
    >>> print(f"{1e3 * measures.sd_ap:.2f} mm, {measures.mean_frequency:.2f} Hz")
    2.83 mm, 0.25 Hz
    """
    ap, ml = filtered(recording, low_pass)
    steps = np.diff(ap), np.diff(ml)
    time = recording.duration
    path = float(np.hypot(*steps).sum())
    spectrum = cop_spectrum(recording, low_pass=low_pass)
    mean, median = mean_and_median(spectrum.frequency, spectrum.ap + spectrum.ml)
    covariance = np.cov(ap, ml)
    return SwayMeasures(
        area=math.pi * math.sqrt(np.linalg.det(covariance)) * ellipse_factor(ap.size),
        sd_ap=math.sqrt(covariance[0, 0]),
        sd_ml=math.sqrt(covariance[1, 1]),
        range_ap=float(np.ptp(ap)),
        range_ml=float(np.ptp(ml)),
        path=path,
        mean_velocity=path / time,
        mean_velocity_ap=float(np.abs(steps[0]).sum()) / time,
        mean_velocity_ml=float(np.abs(steps[1]).sum()) / time,
        mean_frequency=mean,
        median_frequency=median,
    )


def cop_spectrum(recording: Recording, *, low_pass: float | None = None) -> CopSpectrum:
    """Return the spectra of a recording by Welch's method.

    Hann's windows of 30 s (half of the recording if it is shorter than 60 s), half overlapping, the
    mean removed from each.
    """
    columns = filtered(recording, low_pass)
    window = window_of(recording.ap.size, recording.rate)
    hertz, density = signal.welch(
        np.stack(columns),
        recording.rate,
        window="hann",
        nperseg=window,
        noverlap=window // 2,
        detrend="constant",
    )
    return CopSpectrum(hertz, *density)


def filtered(recording: Recording, low_pass: float | None) -> tuple[Array, Array]:
    """Return both directions (m) through the low-pass of :func:`sway_measures`, if any."""
    checked_recording(recording)
    if low_pass is None:
        return recording.ap, recording.ml
    cut = checked_low_pass(low_pass, recording.rate)
    sections = signal.butter(ORDER, cut, fs=recording.rate, output="sos")
    ap, ml = signal.sosfiltfilt(sections, np.stack([recording.ap, recording.ml]))
    return ap, ml


def checked_low_pass(given: Any, rate: float) -> float:
    """Return the frequency (Hz) of the low-pass.

    Raises
    ------
    InputError
        if it is none, or not below half of the rate.
    """
    try:
        cut = float(given)
    except (TypeError, ValueError):
        cut = math.nan
    if not 0.0 < cut < 0.5 * rate:
        raise InputError(
            f"low_pass = {shortened(given)} is not between 0 and half of the rate ({rate:g} Hz)"
        )
    return cut


def ellipse_factor(count: int) -> float:
    """Return the square of the ellipse's half axes, in standard deviations.

    2 (n − 1)(n + 1)/(n (n − 2)) · F(0.95; 2, n − 2);
    with two degrees of freedom the quantile is m/2 · ((1 − p)^(−2/m) − 1), m = n − 2.
    """
    m = count - 2
    quantile = 0.5 * m * math.expm1(-2.0 / m * math.log(1.0 - COVERED))
    return 2.0 * (count - 1) * (count + 1) / (count * m) * quantile


def mean_and_median(hertz: Array, density: Array) -> tuple[float, float]:
    """Return mean and median frequency (Hz) of a density."""
    mean = np.trapezoid(hertz * density, hertz) / np.trapezoid(density, hertz)
    slices = 0.5 * (density[1:] + density[:-1]) * np.diff(hertz)
    below = np.concatenate([[0.0], np.cumsum(slices)])
    return float(mean), float(np.interp(0.5 * below[-1], below, hertz))
