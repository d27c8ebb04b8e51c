"""How one person sways: covariance of the rotations, and spectra.

notation: Σ covariance, S spectral density, τ delay, B damping, G gravity part of C, m g weight.
"""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from standfast.anthropometry.body import Body
from standfast.errors import InputError, says_its_arguments, shortened
from standfast.mechanics.feedback import Feedback
from standfast.mechanics.joints import Stiffness
from standfast.mechanics.matrices import joint_gravity
from standfast.numerics.arrays import TURN, Array, Scalar
from standfast.parameters import JOINTS, PARAMETERS, STANDARD_GRAVITY, checked_number
from standfast.stability.delay.persons import all_crossings
from standfast.stability.feedback import WRITE, checked_numbers, is_stable
from standfast.stability.sway.density import COM, COP, PAIRS, Swaying, densities
from standfast.stability.sway.integral import integrals
from standfast.stability.sway.persons import damped, swaying_of, variances

EXACT = 1e-10  # relative, of what is asked of one person
# Hz, of a spectrum: at the longest delay, 10 s, the phase ωτ is then below the 10⁶ rad up to which
# cosine and sine are exact.
HIGHEST_FREQUENCY = 1e4


class Spectrum(NamedTuple):
    """One-sided power spectral densities of a person's sway, over the frequencies.

    Attributes
    ----------
    frequency : (n,), Hz
    ankle, knee, hip : (n,), rad²/Hz
        of the rotations; 0 of a rigid joint.
    com, cop : (n,), m²/Hz
        of the centre of mass over the ankle, and of the centre of pressure.

    Examples
    --------
    >>> import standfast as sf
    >>> body = sf.Body.from_height_mass(1.66, 68.0)
    >>> K = sf.Stiffness(ankle=400.0, knee=1500.0, hip=400.0)
    >>> F = sf.Feedback(proportional=(600, 0, 0), derivative=(150, 0, 0), delay=0.05)
    >>> B = (30, 20, 20)
    >>> spectrum = sf.sway_spectrum(body, K, damping=B, feedback=F, frequency=[0.1, 1.0])
    >>> type(spectrum).__name__, spectrum.cop.shape
    ('Spectrum', (2,))
    """

    frequency: Array
    ankle: Array
    knee: Array
    hip: Array
    com: Array
    cop: Array


@says_its_arguments(WRITE)
def sway_covariance(
    body: Body,
    stiffness: Stiffness,
    gravity: Scalar = STANDARD_GRAVITY,
    *,
    damping: Any = None,
    feedback: Feedback | None = None,
    noise: Any = (1.0, 1.0, 1.0),
) -> Array:
    """Return the covariance of the rotations of a person whose joints' torques are noisy.

    Σ = (1/2π) ∫ H(iω) S H(iω)* dω,  H(s) = (A s² + B s + C + (P + D s) e^(−sτ))⁻¹,
    S = diag(σa², σk², σh²), to 1e-9 relative. With one free joint and without delay it is
    σ²/(2 B C). It grows without bounds as stability is lost.

    Parameters
    ----------
    body, stiffness, gravity, damping, feedback
        as of :func:`is_stable`.
    noise
        σ of the white torque noise at ankle, knee and hip (N·m·√s); of a rigid joint it means
        nothing.

    Returns
    -------
    (3, 3), rad², rows ankle, knee, hip; 0 of a rigid joint, ``inf`` where the person falls, or
    nothing damps it.

    Raises
    ------
    InputError
        if anything is out of range or of another shape.
    ArithmeticError
        if rounding leaves open whether the person stands, or how much.

    Examples
    --------
    >>> import standfast as sf
    >>> body, K = sf.Body.from_height_mass(1.66, 68.0), sf.Stiffness(400, 1500, 400)
    >>> F = sf.Feedback(proportional=(600, 0, 0), derivative=(150, 0, 0), delay=0.05)
    >>> found = sf.sway_covariance(body, K, damping=(30, 20, 20), feedback=F, noise=(1, 0, 0.3))
    >>> print(f"{1e3 * found[0, 0] ** 0.5:.2f} mrad at the ankle")
    4.47 mrad at the ankle
    """
    given = (body, stiffness, gravity, damping, feedback, noise)
    swaying, stands, ends = checked_swaying("sway_covariance", *given)
    if not (stands and ends):
        free = np.isfinite(np.array(stiffness.joints, float))
        return np.where(free[:, None] & free, np.inf, 0.0)
    return _covariance(swaying, stiffness)


def _covariance(swaying: Swaying, stiffness: Stiffness) -> Array:
    """Return the covariance of one person who stands."""
    found = np.zeros((3, 3))
    # variances first: what of a covariance is small is so beside them
    for across in (False, True):
        deviations = np.sqrt(found.diagonal())
        places = [
            (row, i, j)
            for row, (i, j) in enumerate(PAIRS)
            if (i != j) == across and (not across or deviations[i] * deviations[j] > 0.0)
            and not np.isinf([stiffness.joints[i], stiffness.joints[j]]).any()
        ]  # fmt: skip
        if not places or not swaying.noise.any():
            continue
        rows, first, second = map(np.array, zip(*places, strict=True))
        sizes = (deviations[first] * deviations[second])[:, None] if across else None
        values, sure = integrals(tuple(rows), swaying, accuracy=EXACT, sizes=sizes)
        if not sure.all():
            raise ArithmeticError("the person is too near to falling to say how much it sways")
        found[first, second] = found[second, first] = values[:, 0]
    return found


def sway_integrals(
    body: Body,
    stiffness: Stiffness,
    gravity: Scalar,
    *,
    damping: Any,
    feedback: Feedback,
    noise: Any,
    rows: Sequence[int],
) -> list[float | None]:
    """Return (1/2π) ∫ of rows of densities; arguments and errors as of :func:`sway_covariance`.

    What the person sways too near to falling to say is None.
    """
    given = (body, stiffness, gravity, damping, feedback, noise)
    swaying, stands, ends = checked_swaying("sway_integrals", *given)
    settles = np.array([stands and ends])
    found, sure = variances(tuple(rows), swaying, settles, accuracy=EXACT)
    return [
        float(value) if known else None
        for value, known in zip(found[:, 0], sure[:, 0], strict=True)
    ]


@says_its_arguments(WRITE)
def sway_spectrum(
    body: Body,
    stiffness: Stiffness,
    gravity: Scalar = STANDARD_GRAVITY,
    *,
    damping: Any = None,
    feedback: Feedback | None = None,
    noise: Any = (1.0, 1.0, 1.0),
    frequency: Any,
) -> Spectrum:
    """Return the power spectral densities of a person's sway at some frequencies.

    2 S(2πf) a hertz, S = H(iω) S_w H(iω)*, of :func:`sway_covariance`; over all frequencies the
    density of a rotation adds up to its variance. The centre of pressure is that of the moment of
    springs, damping and feedback at the ankle, through a low-pass at 10 Hz, forth and back, of the
    second order (Santos & Duarte, PeerJ 4 (2016) e2648).

    Parameters
    ----------
    frequency
        Hz, from 0 to 10 kHz; one or more.

    Others are those of :func:`sway_covariance`.

    Raises
    ------
    InputError
        if anything is out of range or of another shape, or the person falls, or nothing damps it.
    ArithmeticError
        if rounding leaves open whether the person stands.

    Examples
    --------
    >>> import standfast as sf
    >>> body = sf.Body.from_height_mass(1.66, 68.0)
    >>> K = sf.Stiffness(ankle=400.0, knee=1500.0, hip=400.0)
    >>> F = sf.Feedback(proportional=(600, 0, 0), derivative=(150, 0, 0), delay=0.05)
    >>> B = (30, 20, 20)
    >>> spectrum = sf.sway_spectrum(body, K, damping=B, feedback=F, frequency=[0.1, 1.0])
    >>> (1e6 * spectrum.cop).round(2)    # mm²/Hz
    array([363.28,   9.12])
    """
    hertz = _checked_frequencies(frequency)
    given = (body, stiffness, gravity, damping, feedback, noise)
    swaying, stands, ends = checked_swaying("sway_spectrum", *given)
    if not stands:
        raise InputError("the person falls, and so has no spectrum of sway")
    if not ends and np.isfinite(np.array(stiffness.joints, float)).any():
        raise InputError(
            "nothing damps the person, whom noise moves ever more, and so there is no spectrum of "
            "sway; give damping, or a derivative gain"
        )
    omega = TURN * hertz
    rows = densities(swaying, omega, omega * swaying.delay)
    ankle, knee, hip = (rows[PAIRS.index((joint, joint))] for joint in range(3))
    return Spectrum(hertz, *(2.0 * row for row in (ankle, knee, hip, rows[COM], rows[COP])))


def checked_swaying(
    function: str,
    body: Body,
    stiffness: Stiffness,
    gravity: Scalar,
    damping: Any,
    feedback: Feedback | None,
    noise: Any,
) -> tuple[Swaying, bool, bool]:
    """Check what a public function is given; return the person, if it stands, and if damped.

    Of whom rounding leaves that open, at the very delay of a crossing or with a root at 0, it is
    open too whether there is any sway: an ArithmeticError.
    """
    numbers, rigid, delay = checked_numbers(function, body, stiffness, gravity, damping, feedback)
    stands = is_stable(body, stiffness, gravity, damping=damping, feedback=feedback)
    if not stands and all_crossings(numbers, rigid).open_each(np.array([delay]))[0]:
        raise ArithmeticError("rounding leaves open whether the person stands, and so sways")
    swaying = swaying_alone(body, gravity, numbers, rigid, delay, _checked_noise(noise))
    return swaying, stands, bool(damped(numbers, rigid, swaying.delay)[0])


def swaying_alone(
    body: Body,
    gravity: Scalar,
    numbers: np.ndarray,
    rigid: np.ndarray,
    delay: float,
    noise: Sequence[float],
) -> Swaying:
    """Return one person as densities need it; ``numbers``, ``rigid``: :func:`.numbers_of`."""
    return swaying_of(
        numbers,
        rigid,
        np.array([delay]),
        np.array(noise, float)[:, None],
        np.array(joint_gravity(body, gravity)[0], float)[:, None],
        np.array([float(np.sum(body.segment_mass)) * float(gravity)]),
    )


def _checked_noise(noise: Any) -> list[float]:
    if np.ndim(noise) != 1 or len(noise) != len(JOINTS):
        raise InputError(f"noise = {shortened(noise)} is not three numbers: ankle, knee, hip")
    return [
        checked_number(f"{joint}_noise", value, row=PARAMETERS[f"{joint}_noise"])
        for joint, value in zip(JOINTS, noise, strict=True)
    ]


def _checked_frequencies(frequency: Any) -> Array:
    try:
        hertz = np.atleast_1d(np.asarray(frequency, float))
    except (TypeError, ValueError):  # text, or rows of different lengths
        hertz = np.empty(0)
    if hertz.ndim != 1 or not hertz.size or not ((hertz >= 0) & (hertz <= HIGHEST_FREQUENCY)).all():
        raise InputError(
            f"frequency = {shortened(frequency)} is not one or more numbers of Hz, from 0 to "
            f"{HIGHEST_FREQUENCY:,.0f}"
        )
    return hertz
