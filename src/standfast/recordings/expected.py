"""What a recording of a model would show: measures by the definitions of recordings.

The model's sway is a stationary Gaussian process, so the expectations of :mod:`.powers` are all
that is needed: the SD is the root of that of s², the mean velocity √(2/π) times the root of that of
steps², and frequencies are those of the mean spectrum. So a short recording is compared with a
short one of the model. Integrals are sums of equal steps Δf = 1/period: what they leave out is the
autocovariance a period later, which has died out.

A fit (:mod:`standfast.fitting`) takes the expectations of logarithms, which are lower by half of
the relative variance, of hundreds of persons at frequencies that they share; here one person is
asked, at as many as that person needs.
"""

import math
from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from scipy import fft

from standfast.anthropometry.body import Body
from standfast.errors import InputError, says_its_arguments
from standfast.mechanics.feedback import Feedback, checked_feedback
from standfast.mechanics.joints import Stiffness
from standfast.numerics.arrays import TURN, Array, Scalar
from standfast.parameters import JOINTS, STANDARD_GRAVITY
from standfast.recordings.measures import (
    MEASURES,
    Measure,
    checked_low_pass,
    filtered,
    mean_and_median,
)
from standfast.recordings.powers import (
    OF_SIZES,
    integral,
    steps_weight,
    variance_weight,
    welch_spectrum,
)
from standfast.recordings.recording import Recording, checked_recording, window_of
from standfast.stability.feedback import rightmost_root
from standfast.stability.sway.density import LOW_PASS, Swaying
from standfast.stability.sway.person import checked_swaying
from standfast.stability.sway.responses import READINGS, responses

# Nothing is left of a motion after so many time constants, nor beyond so many times the low-pass.
DIED_OUT, BEYOND = 20.0, 10.0
SLOWEST, NEVER = 1.0 / 300.0, 1e-9  # 1/s: of decay; slower, minutes say nothing
TOGETHER = 2**16  # frequencies, so that memory stays small

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
        with which the SD of the centre of pressure behind ``low_pass`` is the recording's: every SD
        grows in proportion to it. Velocity over SD and frequencies do not depend on the strength.
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
    rate, own = checked_recording(recording).rate, LOW_PASS / TURN
    cut = own if low_pass is None else checked_low_pass(low_pass, rate)
    person = (body, stiffness, gravity, damping, feedback, (1.0,) * 3 if noise is None else noise)
    swaying, stands, _ = checked_swaying("expected_sway", *person)
    if not stands:
        raise InputError("the person falls, and so has no sway to compare")
    late = checked_feedback(feedback)
    root = rightmost_root(body, stiffness, gravity, damping=damping, feedback=late)
    hertz = _frequencies(-root.real, recording, max(cut, own))
    density = _densities(swaying, np.isinf(np.array(stiffness.joints, float)), hertz, cut)
    if not density["cop"].any():
        raise InputError("no joint that turns has noise, so nothing sways")
    strengths = np.sqrt(swaying.noise[:, 0]) if noise is None else noise
    return _shown(hertz, density, recording, strengths, low_pass=low_pass, given=noise is not None)


def _shown(
    hertz: Array,
    density: dict[str, Array],
    recording: Recording,
    strengths: Any,
    *,
    low_pass: float | None,
    given: bool,
) -> ExpectedSway:
    """Return the measures by densities at even frequencies.

    Unless noise is given, it is as much stronger as makes the SD that of the recording, which goes
    through the low-pass too, as the model has.
    """
    count, rate, step = recording.ap.size, recording.rate, float(hertz[1])
    about_mean, of_steps = variance_weight(hertz, count, rate), steps_weight(hertz, rate)
    size = {n: math.sqrt(integral(each * about_mean, step)) for n, each in density.items()}
    speed = math.sqrt(OF_SIZES * integral(density["cop"] * of_steps, step))
    covariance = _autocovariance(density["cop"], step, rate)[: window_of(count, rate)]
    bins, spectrum = welch_spectrum(covariance, rate)
    mean, median = mean_and_median(bins, spectrum)
    factor = 1.0 if given else float(filtered(recording, low_pass)[0].std(ddof=1)) / size["cop"]
    ankle, knee, hip = (factor * float(each) for each in strengths)
    return ExpectedSway(
        noise=(ankle, knee, hip),
        sd_ap=factor * size["cop"],
        mean_velocity_ap=factor * speed,
        mean_frequency_ap=mean,
        median_frequency_ap=median,
        com_sway=factor * size["com"],
        ankle_sway=factor * size["ankle"],
        knee_sway=factor * size["knee"],
        hip_sway=factor * size["hip"],
        frequency=bins,
        density=factor**2 * spectrum,
    )


def _frequencies(decay: float, recording: Recording, low_pass: float) -> Array:
    """Return even frequencies (Hz) from 0 for sway that dies out with ``decay`` (1/s).

    Their period is of whole samples. The low-pass is the model's own or a higher one: rotations do
    not pass any.
    """
    count, rate = recording.ap.size, recording.rate
    if decay < SLOWEST:
        slowly = "does not die out" if decay < NEVER else f"dies out over {1.0 / decay:,.0f} s"
        raise InputError(
            f"the model's sway {slowly}: it is undamped or about to fall, and no recording of "
            f"{count / rate:.4g} s is like it; give damping, gains or a shorter delay"
        )
    period = fft.next_fast_len(count + math.ceil(DIED_OUT / decay * rate)) / rate
    hertz: Array = np.arange(math.ceil(BEYOND * low_pass * period) + 1) / period
    return hertz


def _densities(
    swaying: Swaying, rigid: np.ndarray, hertz: Array, low_pass: float
) -> dict[str, Array]:
    """Return the two-sided densities of all readings at some frequencies."""
    found = np.zeros((len(READINGS), hertz.size))
    for first in range(0, hertz.size, TOGETHER):
        some = slice(first, first + TOGETHER)
        response, _ = responses(
            swaying, rigid, TURN * hertz[some], READINGS, low_pass=TURN * low_pass
        )
        found[:, some] = (swaying.noise * abs(response) ** 2).sum(axis=1)
    return dict(zip(READINGS, found, strict=True))


def _autocovariance(density: Array, step: float, rate: float) -> Array:
    """Return R at lags of 0, 1, … samples, of a two-sided density in steps (Hz) from 0 on."""
    power = 2.0 * density * step
    power[0] *= 0.5  # of both signs there is one 0
    samples = round(rate / step)
    covariance: Array = fft.fft(np.bincount(np.arange(power.size) % samples, power, samples)).real
    return covariance
