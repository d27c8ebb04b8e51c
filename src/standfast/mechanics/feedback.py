"""Damping of the joints and delayed feedback: B, P, D and τ of the equation of motion.

A q̈ + B q̇ + C q = −P q(t − τ) − D q̇(t − τ). B is symmetric and takes energy; P and D are any
matrices, row = joint that makes the moment, column = joint whose rotation is sensed. A study gives
them number by number, Python as three numbers (the diagonal) or as a matrix.
"""

from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

import numpy as np

from standfast.anthropometry.body import Body
from standfast.errors import InputError, says_its_arguments, shortened
from standfast.mechanics.joints import Stiffness
from standfast.mechanics.matrices import joint_inertia, stiffness_rows
from standfast.numerics.arrays import Array, Matrix, Scalar, in_numpy, is_of_jax, namespace
from standfast.parameters import (
    DAMPINGS,
    JOINTS,
    LOOPS,
    PARAMETERS,
    checked_leaf,
    checked_number,
    checked_scalar,
    gain_name,
    is_typed_in,
    is_written,
)

NONE = (0.0, 0.0, 0.0)

# A matrix that is symmetric or semidefinite but for the rounding of whoever computed it, relative
# to its largest entry.
ROUNDED = 1e-12

# Gains of the ankle that would be weak in N·m/rad, a few hundredths of what topples a person, and
# are usual in N·m per degree.
PER_DEGREE = (5.0, 40.0)
DEGREES = 57.3  # in a radian, to the digits that a note needs


class _FeedbackFields(NamedTuple):
    proportional: Array
    derivative: Array
    delay: Scalar


class Feedback(_FeedbackFields):
    """Feedback of joint rotations, as a named tuple (so a JAX pytree too).

    Attributes
    ----------
    proportional : (3, 3), N·m/rad
        moment at the row's joint per rotation of the column's joint, against it.
    derivative : (3, 3), N·m·s/rad
        the same per rate of rotation.
    delay : s
        from sensing to moment, of all loops.

    Three numbers are a diagonal. Numbers and lists of numbers are checked; arrays of JAX and
    matrices of a batch pass unseen.

    Raises
    ------
    InputError
        for another shape, text, NaN, or a delay that is negative or in milliseconds.

    Examples
    --------
    >>> import standfast as sf
    >>> F = sf.Feedback(proportional=(900, 0, 0), derivative=(300, 0, 0), delay=0.1)
    >>> float(F.proportional[0, 0]), F.delay
    (900.0, 0.1)
    """

    __slots__ = ()

    @says_its_arguments()
    def __new__(cls, proportional: Any, derivative: Any = NONE, delay: Any = 0.0) -> "Feedback":
        """Check every plain value and keep the gains as read-only float64 matrices."""
        parts = (proportional, derivative, delay)
        if any(part is None for part in parts) and not any(map(is_typed_in, parts)):
            return super().__new__(cls, *parts)  # None alone is a mark of a program
        if delay is None:
            checked_scalar("feedback_delay", delay)
        gains = (("proportional", proportional), ("derivative", derivative))
        p, d = (_matrix(f"{kind} gains", values, _gain_of(kind)) for kind, values in gains)
        return super().__new__(cls, p, d, checked_leaf("feedback_delay", delay))

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Feedback) and all(map(np.array_equal, self, other))

    def __ne__(self, other: object) -> bool:
        return not self == other

    __hash__ = None  # type: ignore[assignment] # arrays have none either

    def _replace(self, **changes: Any) -> "Feedback":
        """Return the feedback with some values changed, checked like any other."""
        return Feedback(**{**self._asdict(), **changes})


def checked_feedback(feedback: Any) -> Feedback:
    """Check the feedback that a public function is given, of one person; None is no feedback."""
    if feedback is None:
        return Feedback(NONE)
    if not isinstance(feedback, Feedback):
        raise InputError(
            f"feedback = {shortened(feedback)} is not a Feedback; "
            "write Feedback(proportional=…, derivative=…, delay=…)"
        )
    for kind in ("proportional", "derivative"):
        values = getattr(feedback, kind)
        shape = np.shape(values)
        if shape != (3, 3):
            raise InputError(
                f"{kind} gains have the shape {shape}, not (3, 3); "
                "one person at a time, or map over them with jax.vmap"
            )
        if is_of_jax(values):  # others were checked when the feedback was made
            _matrix(f"{kind} gains", in_numpy(values), _gain_of(kind))
    checked_scalar("feedback_delay", feedback.delay)
    return feedback


def checked_damping(damping: Any) -> Array:
    """Return the damping B that a public function is given as a matrix (3, 3), N·m·s/rad.

    None is no damping, three numbers are a diagonal.

    Raises
    ------
    InputError
        for another shape, NaN, or a matrix that is not symmetric or puts energy in.
    """
    matrix = _matrix("damping", NONE if damping is None else in_numpy(damping), _damping_of)
    if np.shape(matrix) == (3,):  # three numbers that are being traced
        matrix = namespace(matrix).diag(matrix)
    if np.shape(matrix) != (3, 3):
        raise InputError(
            f"damping has the shape {np.shape(matrix)}, not (3, 3); "
            "one person at a time, or map over them with jax.vmap"
        )
    if isinstance(matrix, np.ndarray):
        least = -ROUNDED * np.abs(matrix).max()
        if (np.abs(matrix - matrix.T) > -least).any():
            raise InputError(
                f"damping = {shortened(matrix.tolist())} is not symmetric; give ankle, knee, hip, "
                "or a symmetric matrix (what is not symmetric is a derivative gain of Feedback)"
            )
        if np.linalg.eigvalsh(matrix)[0] < least:
            raise InputError(
                f"damping = {shortened(matrix.tolist())} puts energy in for some motion; "
                "give a positive semidefinite matrix"
            )
    return matrix


def damping_rows(given: Mapping[str, Any]) -> Matrix:
    """Return B as rows, of parameters by name; what is not given is the plain number 0."""
    ankle, knee, hip = (given.get(name, 0.0) for name in DAMPINGS)
    return ((ankle, 0.0, 0.0), (0.0, knee, 0.0), (0.0, 0.0, hip))


def gain_rows(given: Mapping[str, Any], kind: str) -> Matrix:
    """Return P (``kind`` "proportional") or D ("derivative") as rows, of parameters by name."""
    gains = [given.get(gain_name(kind, *loop), 0.0) for loop in LOOPS]
    return tuple(gains[:3]), tuple(gains[3:6]), tuple(gains[6:])


def equation_of(
    body: Body, stiffness: Stiffness, gravity: Scalar, given: Mapping[str, Any]
) -> tuple[Matrix, Matrix, Matrix, Matrix, Matrix]:
    """Return A, B, C, P and D as rows; ``given`` holds damping and gains by name."""
    return (
        joint_inertia(body),
        damping_rows(given),
        stiffness_rows(body, stiffness, gravity),
        gain_rows(given, "proportional"),
        gain_rows(given, "derivative"),
    )


def delay_of(given: Mapping[str, Any]) -> Scalar:
    """Return τ, of parameters by name (s)."""
    return given.get("feedback_delay", 0.0)


def likely_per_degree(parameters: Mapping[str, Any]) -> str | None:
    """Return a note if the ankle's gain looks like N·m per degree, which cannot be refused."""
    name = gain_name("proportional", "ankle", "ankle")
    gain = parameters.get(name)
    if not isinstance(gain, float) or not PER_DEGREE[0] <= gain <= PER_DEGREE[1]:
        return None
    return (
        f"{name} = {gain:g} N·m/rad is weak; if it is meant in N·m per degree, "
        f"write {gain * DEGREES:.4g} ({DEGREES} times as much)"
    )


def _gain_of(kind: str) -> Callable[[str, str], str]:
    return lambda moment, rotation: gain_name(kind, moment, rotation)


def _damping_of(moment: str, rotation: str) -> str:
    return f"{moment}_damping" if moment == rotation else f"{moment}_{rotation}_damping"


def _matrix(what: str, values: Any, name_of: Callable[[str, str], str]) -> Array:
    """Check three numbers or a matrix, and return a matrix; let those of programs pass."""
    values = values if is_of_jax(values) else in_numpy(values)
    if not is_written(values):
        return values
    if isinstance(values, np.ndarray) and values.ndim > 2:
        return values
    rows = values
    if isinstance(values, list | tuple | np.ndarray) and len(values) == 3:
        if all(np.ndim(value) == 0 for value in values):
            rows = [[values[i] if i == j else 0.0 for j in range(3)] for i in range(3)]
        if all(isinstance(row, list | tuple | np.ndarray) and len(row) == 3 for row in rows):
            return _checked_entries(rows, name_of)
    raise InputError(
        f"{what} = {shortened(values)} are not three numbers or a 3 × 3 matrix; "
        f"give {', '.join(JOINTS)}, or three rows of three (row: moment, column: rotation)"
    )


def _checked_entries(rows: Any, name_of: Callable[[str, str], str]) -> Array:
    entries = [entry for row in rows for entry in row]
    library = namespace(*entries)
    if library is not np:
        return library.stack([library.asarray(entry) for entry in entries]).reshape(3, 3)
    numbers = []
    for loop, entry in zip(LOOPS, entries, strict=True):
        name = name_of(*loop)
        # a damping that couples joints has no row of its own, and may be negative
        row = PARAMETERS.get(name) or PARAMETERS[gain_name("derivative", *loop)]
        numbers.append(checked_number(name, entry, row=row))
    matrix = np.array(numbers).reshape(3, 3)
    matrix.flags.writeable = False
    return matrix
