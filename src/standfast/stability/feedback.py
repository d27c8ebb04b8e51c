"""Does one person stand with nerves: springs, damping and feedback that arrives late.

    A q̈ + B q̇ + (K − G) q = −P q(t − τ) − D q̇(t − τ)

stands if no characteristic root has a real part ≥ 0. Without gains that is the verdict of springs,
whatever the damping (Kelvin, Tait, Chetaev). With them stability changes along τ only where a root
crosses the imaginary axis; all crossings are found at once (:mod:`.delay.crossings`).

notation: A inertia, B damping, K stiffness, G gravity part, P and D proportional and derivative
gains, τ delay. A rigid joint takes its row and column out of all of them.
"""

from typing import Any

import numpy as np

from standfast.anthropometry.body import Body
from standfast.errors import InputError, says_its_arguments
from standfast.mechanics.feedback import Feedback, checked_damping, checked_feedback
from standfast.mechanics.joints import Stiffness, checked_person
from standfast.mechanics.matrices import joint_inertia, stiffness_rows
from standfast.numerics.arrays import Scalar, is_traced
from standfast.parameters import PARAMETERS, STANDARD_GRAVITY, checked_number
from standfast.stability.delay.persons import all_crossings, all_rightmost
from standfast.stability.delay.table import Crossings
from standfast.stability.springs import verdict

WRITE = "of feedback write feedback=Feedback(proportional=…, derivative=…, delay=…)"


@says_its_arguments()
def is_stable(
    body: Body,
    stiffness: Stiffness,
    gravity: Scalar = STANDARD_GRAVITY,
    *,
    damping: Any = None,
    feedback: Feedback | None = None,
) -> bool:
    """Return whether the person stands: no characteristic root has a real part ≥ 0.

    The boundary itself counts as unstable. Without feedback: C is positive definite, right unless
    the ankle's stiffness lies within rounding of the threshold (see :func:`verdict_is_certain`).
    Inside ``jax.vmap`` and ``jax.jit`` it is a truth value that is traced; with damping or feedback
    it cannot be traced.

    Parameters
    ----------
    body, stiffness, gravity
        the person, joint stiffness (N·m/rad) and gravity (m/s²).
    damping
        three numbers or a symmetric positive semidefinite 3 × 3 matrix, N·m·s/rad; None: none.
    feedback
        gains and delay; None: none.

    Raises
    ------
    InputError
        if anything is out of range or of another shape.
    ArithmeticError
        if rounding leaves it open, which no person at random has.

    Examples
    --------
    >>> import standfast as sf
    >>> body = sf.Body.from_height_mass(1.66, 68.0)
    >>> K = sf.Stiffness(ankle=900.0, knee=1500.0, hip=400.0)
    >>> sf.is_stable(body, K), sf.is_stable(body, K._replace(ankle=800.0))
    (True, False)
    >>> F = sf.Feedback(proportional=(600, 0, 0), derivative=(150, 0, 0), delay=0.05)
    >>> sf.is_stable(body, K._replace(ankle=400.0), damping=(30, 20, 20), feedback=F)
    True
    """
    checked_person(body, stiffness, gravity)
    if feedback is None and damping is None and is_traced(*body, *stiffness, gravity):
        return verdict(body, stiffness, gravity)  # type: ignore[no-any-return] # traced
    _refuse_traced("is_stable", body, stiffness, gravity, damping, feedback)
    matrix, fed_back = checked_damping(damping), checked_feedback(feedback)
    if not (fed_back.proportional.any() or fed_back.derivative.any()):
        return bool(verdict(body, stiffness, gravity))
    table = _table(*numbers_of(body, stiffness, gravity, matrix, fed_back))
    return bool(table.stable_at(np.array([float(fed_back.delay)]))[0, 0])


@says_its_arguments(WRITE)
def critical_delay(
    body: Body,
    stiffness: Stiffness,
    gravity: Scalar = STANDARD_GRAVITY,
    *,
    damping: Any = None,
    feedback: Feedback,
) -> float:
    """Return the smallest delay at which the person ceases to stand (s).

    0 if they do not stand without delay, inf if they stand at every delay. Windows of standing may
    follow at longer delays (:func:`delay_crossings`). The delay inside ``feedback`` is not used.

    Parameters and errors are those of :func:`is_stable`.

    Examples
    --------
    >>> import standfast as sf
    >>> body = sf.Body.from_height_mass(1.66, 68.0)
    >>> K = sf.Stiffness(ankle=400.0, knee=1500.0, hip=400.0)
    >>> F = sf.Feedback(proportional=(600, 0, 0), derivative=(150, 0, 0), delay=0.05)
    >>> B = (30, 20, 20)
    >>> print(f"{sf.critical_delay(body, K, damping=B, feedback=F):.3f} s")
    0.325 s
    """
    table, _ = _of("critical_delay", body, stiffness, gravity, damping, feedback)
    return float(table.critical_delay()[0])


@says_its_arguments(WRITE)
def delay_crossings(
    body: Body,
    stiffness: Stiffness,
    gravity: Scalar = STANDARD_GRAVITY,
    *,
    damping: Any = None,
    feedback: Feedback,
    longest: float = 1.0,
) -> list[tuple[float, float, int]]:
    """Return where roots cross the imaginary axis, as the delay grows to ``longest`` seconds.

    ``longest`` has the limits of a delay.

    Returns
    -------
    list of (delay in s, angular frequency in rad/s, +1 to the right or −1 to the left), by rising
    delay. Each is a pair of conjugate roots.

    Other parameters and errors are those of :func:`is_stable`.

    Examples
    --------
    >>> import standfast as sf
    >>> body = sf.Body.from_height_mass(1.66, 68.0)
    >>> K = sf.Stiffness(ankle=400.0, knee=1500.0, hip=400.0)
    >>> F = sf.Feedback(proportional=(600, 0, 0), derivative=(150, 0, 0), delay=0.05)
    >>> B = (30, 20, 20)
    >>> for delay, frequency, direction in sf.delay_crossings(
    ...     body, K, damping=B, feedback=F, longest=0.5
    ... ):
    ...     print(f"{delay:.3f} s, {frequency:.2f} rad/s, {direction:+d}")
    0.325 s, 1.12 rad/s, +1
    """
    longest = checked_number("longest", longest, row=PARAMETERS["feedback_delay"])
    table, _ = _of("delay_crossings", body, stiffness, gravity, damping, feedback)
    found = [
        (delay, float(table.frequency[number]), int(table.direction[number]))
        for number in range(table.person.size)
        for delay in np.arange(table.angle[number], longest * table.frequency[number], 2.0 * np.pi)
        / table.frequency[number]
    ]
    return sorted((float(delay), omega, way) for delay, omega, way in found)


@says_its_arguments(WRITE)
def unstable_roots(
    body: Body,
    stiffness: Stiffness,
    gravity: Scalar = STANDARD_GRAVITY,
    *,
    damping: Any = None,
    feedback: Feedback,
) -> int:
    """Return the number of characteristic roots with a positive real part.

    Parameters and errors are those of :func:`is_stable`.

    Examples
    --------
    >>> import standfast as sf
    >>> body = sf.Body.from_height_mass(1.66, 68.0)
    >>> K = sf.Stiffness(ankle=400.0, knee=1500.0, hip=400.0)
    >>> F = sf.Feedback(proportional=(600, 0, 0), derivative=(150, 0, 0), delay=0.05)
    >>> B = (30, 20, 20)
    >>> sf.unstable_roots(body, K, damping=B, feedback=F._replace(delay=0.4))
    2
    """
    table, delay = _of("unstable_roots", body, stiffness, gravity, damping, feedback)
    return int(table.unstable_each(np.array([delay]))[0])


@says_its_arguments(WRITE)
def rightmost_root(
    body: Body,
    stiffness: Stiffness,
    gravity: Scalar = STANDARD_GRAVITY,
    *,
    damping: Any = None,
    feedback: Feedback,
) -> complex:
    """Return the characteristic root with the largest real part (1/s), its imaginary part ≥ 0.

    It is proven that no root lies right of it (by more than 1e-9). With three rigid joints nothing
    moves: −inf.

    Parameters are those of :func:`is_stable`.

    Raises
    ------
    InputError
        if anything is out of range or of another shape.
    ArithmeticError
        if no root could be proven to be the rightmost.

    Examples
    --------
    >>> import standfast as sf
    >>> body = sf.Body.from_height_mass(1.66, 68.0)
    >>> K = sf.Stiffness(ankle=400.0, knee=1500.0, hip=400.0)
    >>> F = sf.Feedback(proportional=(600, 0, 0), derivative=(150, 0, 0), delay=0.05)
    >>> B = (30, 20, 20)
    >>> print(f"{sf.rightmost_root(body, K, damping=B, feedback=F):.3f} 1/s")
    -0.584+0.940j 1/s
    """
    given = (body, stiffness, gravity, damping, feedback)
    numbers, rigid, delay = checked_numbers("rightmost_root", *given)
    root, proven = all_rightmost(numbers, rigid, np.array([delay]))
    if not proven[0]:
        raise ArithmeticError(f"no root was proven to be the rightmost; the best was {root[0]}")
    return complex(root[0])


def checked_numbers(
    function: str, body: Body, stiffness: Stiffness, gravity: Scalar, damping: Any, feedback: Any
) -> tuple[np.ndarray, np.ndarray, float]:
    """Check what a public function is given; return what :func:`numbers_of` does, and the delay."""
    checked_person(body, stiffness, gravity)
    _refuse_traced(function, body, stiffness, gravity, damping, feedback)
    fed_back = checked_feedback(feedback)
    found = numbers_of(body, stiffness, gravity, checked_damping(damping), fed_back)
    return *found, float(fed_back.delay)


def _of(
    function: str, body: Body, stiffness: Stiffness, gravity: Scalar, damping: Any, feedback: Any
) -> tuple[Crossings, float]:
    """Return the crossings of one person, and the delay (s)."""
    numbers, rigid, delay = checked_numbers(function, body, stiffness, gravity, damping, feedback)
    return _table(numbers, rigid), delay


def _refuse_traced(
    function: str, body: Body, stiffness: Stiffness, gravity: Scalar, damping: Any, feedback: Any
) -> None:
    """Refuse what is being traced: crossings are isolated by steps that depend on their values."""
    of_nerves = damping if isinstance(damping, list | tuple) else (damping,)
    if isinstance(feedback, Feedback):
        of_nerves = (*of_nerves, *feedback)
    if is_traced(*body, *stiffness, gravity, *of_nerves):
        raise InputError(
            f"{function} with damping or feedback is not for jax.vmap, jax.jit or jax.grad; call "
            "it person by person, or standfast.compute a study with axes"
        )


def _table(numbers: np.ndarray, rigid: np.ndarray) -> Crossings:
    table = all_crossings(numbers, rigid)
    # a root at 0, at every delay, is known not to stand whatever else rounding leaves open
    if table.uncertain[0] and not table.neutral[0]:
        raise ArithmeticError(
            "rounding leaves open which roots cross the imaginary axis; two may cross at once, or "
            "touch it: change a gain by a millionth"
        )
    return table


def numbers_of(
    body: Body, stiffness: Stiffness, gravity: Scalar, damping: Any, feedback: Feedback
) -> tuple[np.ndarray, np.ndarray]:
    """Return A, B, C, P, D of one person as (5, 3, 3, 1), and which joints are rigid, (3, 1)."""
    parts = (
        joint_inertia(body),
        damping,
        stiffness_rows(body, stiffness, gravity),
        feedback.proportional,
        feedback.derivative,
    )
    numbers = np.array([np.asarray(part, np.float64) for part in parts])[..., None]
    return numbers, np.isinf(np.array(stiffness.joints, np.float64))[:, None]
