"""What a recording of a model would show: measures by the definitions of recordings.

The model's centre of pressure is a stationary Gaussian process with the one-sided density S(f). Of
n samples at a rate r, about their mean, over windows of L samples, its autocovariance
R_m = ∫ S(f) cos(2π f m/r) df is all that is needed (E is the expectation):

    SD        E s² = n/(n − 1) · (R_0 − Var x̄),  Var x̄ = (R_0 + 2 Σ (1 − m/n) R_m)/n
    velocity  E|Δx| r = √(2/π) √(2 (R_0 − R_1)) r
    spectrum  E P_k = (2 or 1)/(r Σ w²) · u* R u,  u_a = w_a e^(−2πi k a/L) less its mean

so a short recording is compared with a short one of the model. The integral is a sum of equal steps
Δf = 1/period: what it leaves out is R a period later, which has died out.

notation: S one-sided density (m²/Hz), R autocovariance (m²), w Hann's window, P Welch's spectrum.
"""

import math
from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from scipy import fft, linalg, signal

from standfast.anthropometry.body import Body
from standfast.errors import InputError, says_its_arguments
from standfast.mechanics.feedback import Feedback
from standfast.mechanics.joints import Stiffness
from standfast.numerics.arrays import TURN, Array, Scalar
from standfast.parameters import JOINTS, STANDARD_GRAVITY
from standfast.recordings.measures import MEASURES, Measure, checked_low_pass, mean_and_median
from standfast.recordings.recording import Recording, window_of
from standfast.stability.feedback import is_stable, rightmost_root
from standfast.stability.sway.density import LOW_PASS
from standfast.stability.sway.person import Spectrum, sway_spectrum

# Nothing is left of R after so many time constants, nor of S beyond so many times the low-pass.
DIED_OUT, BEYOND = 20.0, 10.0
SLOWEST, NEVER = 1.0 / 300.0, 1e-9  # 1/s: of decay; slower, minutes say nothing
TOGETHER = 2**16  # frequencies, so that memory stays small
READ = ("cop", "com", *JOINTS)

# What a model has a value of, anterior-posterior.
MODELLED: Mapping[str, Measure] = {
    **{name: MEASURES[name] for name in ("sd_ap", "mean_velocity_ap")},
    **{
        f"{kind}_frequency_ap": Measure(f"{kind} frequency, anterior-posterior", "Hz", "Hz", 1.0)
        for kind in ("mean", "median")
    },
    "com_sway": Measure("SD of the centre of mass", "m", "mm", 1e3),
    **{
        f"{joint}_sway": Measure(f"SD of the {joint}'s rotation", "rad", "°", math.degrees(1.0))
        for joint in JOINTS
    },
}


class ExpectedSway(NamedTuple):
    """What a recording of a model would show, in SI, by the definitions of ``SwayMeasures``.

    Attributes
    ----------
    noise : (3,), N·m·√s
        of ankle, knee and hip: as given, or of one strength at all joints that turn, with which the
        model's ``sd_ap`` is the recording's.
    sd_ap : m
        root of the mean square, of recordings of this length.
    mean_velocity_ap : m/s
    mean_frequency_ap, median_frequency_ap : Hz
        of the mean spectrum, anterior-posterior alone.
    com_sway : m, ankle_sway, knee_sway, hip_sway : rad
        SD of the centre of mass and of the rotations, over this length too.
    frequency, density : (n,), Hz, m²/Hz
        the mean spectrum of the centre of pressure by Welch's method.
    """

    noise: tuple[float, float, float]
    sd_ap: float
    mean_velocity_ap: float
    mean_frequency_ap: float
    median_frequency_ap: float
    com_sway: float
    ankle_sway: float
    knee_sway: float
    hip_sway: float
    frequency: Array
    density: Array


@says_its_arguments()
def expected_sway(
    recording: Recording,
    body: Body,
    stiffness: Stiffness,
    gravity: Scalar = STANDARD_GRAVITY,
    *,
    damping: Any = None,
    feedback: Feedback | None = None,
    noise: Any = None,
    low_pass: float | None = None,
) -> ExpectedSway:
    """Return what a recording of a person in the model would show, beside a recording.

    It has the length, the rate and the low-pass of the recording. The model is sagittal, so only
    what is anterior-posterior has a value.

    Parameters
    ----------
    recording
        which it stands beside.
    body, stiffness, gravity, damping, feedback
        as of :func:`standfast.sway_covariance`.
    noise
        σ at ankle, knee and hip (N·m·√s). Left out, it is of one strength at all joints that turn,
        with which the SD of the centre of pressure is the recording's: every SD grows in proportion
        to it. Velocity over SD and frequencies do not depend on the strength.
    low_pass
        Hz, as of :func:`standfast.sway_measures`; left out, the model's own of 10 Hz, with which
        recordings of force plates are published.

    Raises
    ------
    InputError
        if anything is out of range, the person falls, nothing damps them, they sway too slowly for
        a recording, or no joint that turns is noisy.
    ArithmeticError
        if rounding leaves open whether the person stands.

    Examples
    --------
    >>> import standfast as sf
    >>> recording = sf.read_recording("recording.csv", unit="mm", rate=100)
    >>> found = sf.expected_sway(recording, **sf.LAWS["dec-2015"].person)
    >>> bool(abs(found.sd_ap / sf.sway_measures(recording, low_pass=10).sd_ap - 1) < 0.05)
    True
    """
    person: dict[str, Any] = {
        "body": body,
        "stiffness": stiffness,
        "gravity": gravity,
        "damping": damping,
        "feedback": feedback,
    }
    turns = [math.isfinite(float(each)) for each in stiffness.joints]
    strengths = tuple(map(float, turns)) if noise is None else noise
    lags = _autocovariances(person, strengths, recording, low_pass)
    if not lags["cop"][0] > 0.0:
        raise InputError("no joint that turns has noise, so nothing sways")
    wanted = float(recording.ap.std(ddof=1)) if noise is None else None
    return _shown(lags, recording.rate, strengths, wanted)


def _shown(
    lags: dict[str, Array], rate: float, strengths: Any, wanted: float | None
) -> ExpectedSway:
    """Return the measures by autocovariances, with noise so much stronger that the SD is wanted."""
    sizes = {name: _deviation(each) for name, each in lags.items()}
    pressure = lags["cop"]
    hertz, density = _welch(pressure, rate)
    mean, median = mean_and_median(hertz, density)
    factor = 1.0 if wanted is None else wanted / sizes["cop"]
    ankle, knee, hip = (factor * float(each) for each in strengths)
    return ExpectedSway(
        noise=(ankle, knee, hip),
        sd_ap=factor * sizes["cop"],
        mean_velocity_ap=factor * rate * math.sqrt(4.0 / math.pi * (pressure[0] - pressure[1])),
        mean_frequency_ap=mean,
        median_frequency_ap=median,
        com_sway=factor * sizes["com"],
        ankle_sway=factor * sizes["ankle"],
        knee_sway=factor * sizes["knee"],
        hip_sway=factor * sizes["hip"],
        frequency=hertz,
        density=factor**2 * density,
    )


def _autocovariances(
    person: dict[str, Any], noise: Any, recording: Recording, low_pass: float | None
) -> dict[str, Array]:
    """Return R of all readings at the lags of a recording's samples."""
    count, rate = recording.ap.size, recording.rate
    own = LOW_PASS / TURN
    cut = own if low_pass is None else checked_low_pass(low_pass, rate)
    steps = _steps_of_a_period(person, count, rate)
    spectrum = _spectrum(person, noise, steps / rate, BEYOND * cut)
    gain = ((1.0 + (spectrum.frequency / own) ** 4) / (1.0 + (spectrum.frequency / cut) ** 4)) ** 2
    seen = spectrum._replace(cop=gain * spectrum.cop)
    return {name: _autocovariance(getattr(seen, name), steps, rate)[:count] for name in READ}


def _steps_of_a_period(person: dict[str, Any], count: int, rate: float) -> int:
    """Return how many samples a period has, after which nothing is left of the sway."""
    if not is_stable(**person):
        raise InputError("the person falls, and so has no sway to compare")
    decay = -rightmost_root(**person).real
    if decay < SLOWEST:
        slowly = "does not die out" if decay < NEVER else f"dies out over {1.0 / decay:,.0f} s"
        raise InputError(
            f"the model's sway {slowly}: it is undamped or about to fall, and no recording of "
            f"{count / rate:.4g} s is like it; give damping, gains or a shorter delay"
        )
    return int(fft.next_fast_len(count + math.ceil(DIED_OUT / decay * rate)))


def _spectrum(person: dict[str, Any], noise: Any, period: float, highest: float) -> Spectrum:
    """Return the model's spectrum in steps of 1/period (Hz) from 0 on."""
    hertz = np.arange(math.ceil(highest * period) + 1) / period
    pieces = [
        sway_spectrum(**person, noise=noise, frequency=hertz[first : first + TOGETHER])
        for first in range(0, hertz.size, TOGETHER)
    ]
    return Spectrum._make(map(np.concatenate, zip(*pieces, strict=True)))


def _autocovariance(density: Array, steps: int, rate: float) -> Array:
    """Return R at lags of 0, 1, … samples, of a density in steps of rate/steps from 0 on."""
    power = density * (rate / steps)
    power[0] *= 0.5  # of one step the half beside 0
    folded = np.bincount(np.arange(power.size) % steps, power, steps)
    covariance: Array = fft.fft(folded).real
    return covariance


def _deviation(covariance: Array) -> float:
    """Return the root of the mean square SD of as many samples about their mean."""
    count = covariance.size
    weights = 2.0 * (1.0 - np.arange(count) / count)
    weights[0] = 1.0
    of_mean = float(weights @ covariance) / count
    return math.sqrt(max(count / (count - 1) * (float(covariance[0]) - of_mean), 0.0))


def _welch(covariance: Array, rate: float) -> tuple[Array, Array]:
    """Return the mean of the spectrum that :func:`cop_spectrum` estimates."""
    size = window_of(covariance.size, rate)
    window = signal.get_window("hann", size)
    # u* R u of all frequencies at once, with the window's own correlation
    overlap = fft.irfft(np.abs(fft.rfft(window, 2 * size)) ** 2, 2 * size)[:size]
    lagged = overlap * covariance[:size]
    found = 2.0 * fft.rfft(lagged).real - lagged[0]
    # the mean is taken off the samples, not the window: it is felt where the window's own spectrum
    # is not 0, at the first two
    for place in range(2):
        turned = window * np.exp(-1j * TURN * place / size * np.arange(size))
        turned -= turned.mean()
        found[place] = np.vdot(turned, linalg.matmul_toeplitz(covariance[:size], turned)).real
    density = 2.0 * found / (rate * np.sum(window**2))
    density[0] *= 0.5
    if size % 2 == 0:
        density[-1] *= 0.5
    return np.arange(density.size) * (rate / size), density
