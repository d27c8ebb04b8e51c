"""The joints' stiffness, and the check of a person at the border of the public functions."""

from collections.abc import Iterable
from typing import Any, NamedTuple

import numpy as np

from standfast.anthropometry.body import Body, checked_segments
from standfast.errors import InputError, says_its_arguments, shortened
from standfast.numerics.arrays import Scalar, Vector, in_numpy, is_of_jax, namespace
from standfast.parameters import COUPLINGS, STIFFNESSES, checked_leaf, checked_scalar, is_typed_in

NAMES = (*STIFFNESSES, *COUPLINGS)
NO_COUPLING: Vector = (0.0, 0.0, 0.0)


class _StiffnessFields(NamedTuple):
    ankle: Scalar
    knee: Scalar
    hip: Scalar
    ankle_knee: Scalar
    knee_hip: Scalar
    ankle_hip: Scalar


class Stiffness(_StiffnessFields):
    """Stiffness of ankle, knee and hip in N·m/rad, both legs together; ``math.inf`` is rigid.

    ``ankle_knee``, ``knee_hip`` and ``ankle_hip`` couple two joints, as muscles across both do:
    the moment at the one per rotation of the other, and the other way round. Left out they are 0.
    The coupling of a rigid joint means nothing.

    A named tuple: ``ankle, knee, hip = Stiffness(950.0, 2000.0, 738.0).joints``.

    Raises
    ------
    InputError
        for a negative stiffness of a joint, NaN or text.

    Examples
    --------
    >>> import math
    >>> import standfast as sf
    >>> K = sf.Stiffness(ankle=950, knee=math.inf, hip=738, ankle_knee=30)
    >>> K.joints
    (950.0, inf, 738.0)
    """

    __slots__ = ()

    @says_its_arguments("a rigid joint is math.inf")
    def __new__(
        cls,
        ankle: Any,
        knee: Any,
        hip: Any,
        ankle_knee: Any = 0.0,
        knee_hip: Any = 0.0,
        ankle_hip: Any = 0.0,
    ) -> "Stiffness":
        """Check every plain value and keep it as a float."""
        values = (ankle, knee, hip, ankle_knee, knee_hip, ankle_hip)
        if any(map(is_typed_in, values)):
            # None alone, or beside what is traced, is a mark of a program
            for name, value in zip(NAMES, values, strict=True):
                if value is None:
                    checked_scalar(name, value)
        return super().__new__(cls, *map(checked_leaf, NAMES, values))

    @classmethod
    def _make(cls, iterable: Iterable[Any]) -> "Stiffness":  # type: ignore[override] # mypy
        """Make one of values that are right: of three joints, or of six numbers."""
        values = tuple(iterable)
        return super()._make(values if len(values) > 3 else (*values, *NO_COUPLING))

    def _replace(self, **changes: Any) -> "Stiffness":
        """Return the stiffnesses with some changed, checked like any others."""
        return Stiffness(**{**self._asdict(), **changes})

    @property
    def joints(self) -> Vector:
        """Ankle, knee and hip, without what couples them."""
        return self.ankle, self.knee, self.hip

    @property
    def couplings(self) -> Vector:
        """What couples ankle and knee, knee and hip, ankle and hip."""
        return self.ankle_knee, self.knee_hip, self.ankle_hip

    @property
    def is_coupled(self) -> bool:
        """Whether anything couples the joints, or could: a coupling that is traced is not known."""
        return coupled(self.couplings)


def coupled(couplings: Vector) -> bool:
    """Return whether any of some couplings is, or could be, another number than 0."""
    return not all(isinstance(k, int | float) and k == 0.0 for k in couplings)


def checked_body(body: Body) -> None:
    """Refuse what is not the body of one person."""
    if not isinstance(body, Body):
        raise InputError(
            f"body = {shortened(body)} is not a Body; make one with Body.from_height_mass or "
            "Body.edwards2007, or of measured segments with Body(segment_mass=…, …)"
        )
    for name, values, shape in zip(Body._fields, body, ((3,), (3,), (2,), (3,)), strict=True):
        if np.shape(values) != shape:
            raise InputError(
                f"{name} has the shape {np.shape(values)}, not {shape}; "
                "one person at a time, or map over them with jax.vmap"
            )
        if is_of_jax(values):  # others were checked when the body was made
            checked_segments(name, in_numpy(values), *shape)


def checked_person(body: Body, stiffness: Stiffness, gravity: Scalar) -> Any:
    """Check the arguments of a public function, each of one person; return their array library."""
    checked_body(body)
    if not isinstance(stiffness, Stiffness):
        raise InputError(_no_stiffness(stiffness))
    for name, value in zip(NAMES, stiffness, strict=True):
        checked_scalar(name, value)
    checked_scalar("gravity", gravity)
    return namespace(*body, *stiffness, gravity)


def _no_stiffness(given: Any) -> str:
    """Say what to write instead of what is no Stiffness."""
    write = "write Stiffness(ankle=…, knee=…, hip=…)"
    matrix = np.array(given, object) if isinstance(given, list | tuple | np.ndarray) else given
    if np.shape(matrix) != (3, 3):
        return f"stiffness = {given!r} is not a Stiffness; {write}"
    couplings = f"{write[:-1]}, ankle_knee=…, knee_hip=…, ankle_hip=…)"
    if (matrix == matrix.T).all():
        return f"stiffness is a matrix, not a Stiffness; {couplings}"
    return (
        f"stiffness = {shortened(matrix.tolist())} is not symmetric, and springs are, because they "
        f"store energy; {couplings}, and put what is not symmetric into Feedback(proportional=…)"
    )
