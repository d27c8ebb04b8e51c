"""Sway of a law's person, straight from H: spectra, and recordings drawn at random from them.

    H(s) = (A s² + B s + C + (P + D s) e^(−sτ))⁻¹,  q = H w,  x = (G1, G2, G3) q / (m g)

of the joints that are not rigid, w white torque noise. Two centres of pressure:

- control: the moment of springs, damping and feedback, u = (K q + B q̇ + P q(t − τ) + …)₁ / (m g);
- total: all that the ankle bears, the noise too, u − w₁/(m g) = x − (A q̈)₁ / (m g), which is what
  acts on the ground if the feet have no mass.

Both go through the low-pass 1/(1 + (f/10 Hz)⁴) of Santos & Duarte's recordings. Nothing here uses
the package's own densities: it checks them. ``sway_study.py`` is the script.

notation: A inertia, B damping, C stiffness less gravity, G gravity part, P and D gains, τ delay.
"""

from typing import NamedTuple

import numpy as np
from scipy import signal

import standfast as sf

JOINTS = ("ankle", "knee", "hip")
LOW_PASS = 10.0  # Hz
WINDOW = 30.0  # s: Welch's windows of the published spectra
SECONDS = 60  # a recording
RECORDINGS = 68  # drawn of a law


class Person(NamedTuple):
    """Matrices of the free joints, (m, m); delay (s); weight m g (N)."""

    inertia: np.ndarray
    damping: np.ndarray
    stiffness: np.ndarray
    gravity: np.ndarray
    proportional: np.ndarray
    derivative: np.ndarray
    delay: float
    weight: float
    joints: tuple[str, ...]


def person_of(
    body: sf.Body,
    stiffness: sf.Stiffness,
    gravity: float,
    damping: object,
    feedback: sf.Feedback,
) -> Person:
    """Return a person without the rigid joints; the arguments are those of ``sf.is_stable``."""
    free = np.flatnonzero(np.isfinite(np.array(stiffness.joints, float)))
    block = np.ix_(free, free)
    mass, length, com = (np.asarray(body[i], float) for i in (0, 2, 3))
    loads = gravity * np.array([
        mass[0] * com[0] + (mass[1] + mass[2]) * length[0],
        mass[1] * com[1] + mass[2] * length[1],
        mass[2] * com[2],
    ])  # fmt: skip
    above = np.cumsum(loads[::-1])[::-1]
    held = above[np.maximum.outer(np.arange(3), np.arange(3))]
    springs = np.diag(np.where(np.isfinite(stiffness.joints), stiffness.joints, 0.0))
    matrices = (
        sf.inertia_matrix(body),
        np.asarray(damping, float) * (np.eye(3) if np.ndim(damping) < 2 else 1.0),
        springs - held,
        held,
        feedback.proportional,
        feedback.derivative,
    )
    return Person(
        *(np.asarray(each, float)[block] for each in matrices),
        delay=float(feedback.delay),
        weight=float(gravity * mass.sum()),
        joints=tuple(JOINTS[j] for j in free),
    )


def transfer(person: Person, hertz: np.ndarray) -> dict[str, np.ndarray]:
    """Return what each noise makes of each reading at some frequencies: (n, joints)."""
    s = 2j * np.pi * hertz[:, None, None]
    late = np.exp(-s * person.delay)
    h = np.linalg.inv(
        person.inertia * s**2
        + person.damping * s
        + person.stiffness
        + (person.proportional + person.derivative * s) * late
    )
    com = person.gravity[0] / person.weight @ h
    total = com - (s**2 * person.inertia[0] / person.weight @ h)[:, 0]
    own = np.eye(len(person.joints))[0] / person.weight
    gain = 1.0 / (1.0 + (hertz[:, None] / LOW_PASS) ** 4)
    rotations = {joint: h[:, i] for i, joint in enumerate(person.joints)}
    return {**rotations, "com": com, "control": (total + own) * gain, "total": total * gain}


def spectrum(person: Person, hertz: np.ndarray, noise: np.ndarray) -> dict[str, np.ndarray]:
    """Return one-sided densities a hertz; ``noise`` is σ of each free joint (N·m·√s)."""
    return {
        name: 2.0 * (abs(rows) ** 2 @ noise**2) for name, rows in transfer(person, hertz).items()
    }


def recordings(
    person: Person, noise: np.ndarray, *, rate: float, seed: int
) -> dict[str, np.ndarray]:
    """Return recordings of 60 s drawn from the spectra, (recordings, samples), of each reading.

    They are cut from one long periodic Gaussian process: the discrete transform of white noise of
    density σ² has the variance N σ² rate.
    """
    count = int(RECORDINGS * SECONDS * rate)
    hertz = np.fft.rfftfreq(count, 1.0 / rate)
    rng = np.random.default_rng(seed)
    drawn = rng.standard_normal((2, len(person.joints), hertz.size))
    white = (drawn[0] + 1j * drawn[1]) * np.sqrt(0.5 * count * rate) * noise[:, None]
    white[:, 0] = 0.0
    return {
        name: np.fft.irfft(np.einsum("nj,jn->n", rows, white), count).reshape(RECORDINGS, -1)
        for name, rows in transfer(person, hertz).items()
    }


def deviation(samples: np.ndarray) -> np.ndarray:
    """Return the standard deviation of each recording about its mean."""
    return np.std(samples, axis=-1, ddof=1)


def velocity(samples: np.ndarray, rate: float) -> np.ndarray:
    """Return the mean of |velocity| of each recording."""
    return np.abs(np.diff(samples)).mean(axis=-1) * rate


def welch(samples: np.ndarray, rate: float) -> tuple[np.ndarray, np.ndarray]:
    """Return frequencies and one-sided densities as ``sf.sway_measures`` takes them."""
    window = int(WINDOW * rate)
    return signal.welch(
        samples, rate, window="hann", nperseg=window, noverlap=window // 2, detrend="constant"
    )


def mean_frequency(samples: np.ndarray, rate: float) -> np.ndarray:
    """Return ∫ f P df / ∫ P df of each recording, one direction."""
    hertz, density = welch(samples, rate)
    return np.trapezoid(hertz * density, hertz) / np.trapezoid(density, hertz)


def com_of(cop: np.ndarray, square: float, rate: float) -> np.ndarray:
    """Return the centre of mass from that of pressure by the low-pass ω₀²/(ω₀² + ω²).

    ``square`` is ω₀² = m g h/J (1/s²). Recordings are mirrored, so that their ends meet.
    """
    moved = cop - cop.mean(axis=-1, keepdims=True)
    turned = np.fft.rfft(np.concatenate([moved, moved[..., ::-1]], axis=-1))
    omega = 2.0 * np.pi * np.fft.rfftfreq(2 * cop.shape[-1], 1.0 / rate)
    return np.fft.irfft(turned * square / (square + omega**2))[..., : cop.shape[-1]]


def slope(hertz: np.ndarray, density: np.ndarray, low: float, high: float) -> float:
    """Return the exponent of f of a density between two frequencies, in equal steps of log f."""
    some = hertz > 0.0
    at = np.geomspace(low, high, 100)
    values = np.interp(np.log(at), np.log(hertz[some]), np.log(density[some]))
    return float(np.polyfit(np.log(at), values, 1)[0])
