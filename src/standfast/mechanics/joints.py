"""The joints' stiffness, and the check of a person at the border of the public functions."""

from typing import Any, NamedTuple

import numpy as np

from standfast.anthropometry.body import Body
from standfast.errors import InputError
from standfast.numerics.arrays import Scalar, namespace
from standfast.parameters import STIFFNESSES, checked_leaf, checked_scalar


class _StiffnessFields(NamedTuple):
    ankle: Scalar
    knee: Scalar
    hip: Scalar


class Stiffness(_StiffnessFields):
    """Stiffness of ankle, knee and hip in N·m/rad, both legs together; ``math.inf`` is rigid.

    A named tuple: ``ankle, knee, hip = Stiffness(950.0, 2000.0, 738.0)``.

    Raises
    ------
    InputError
        for a negative stiffness, NaN or text.
    """

    __slots__ = ()

    def __new__(cls, ankle: Any, knee: Any, hip: Any) -> "Stiffness":
        """Check every plain value and keep it as a float."""
        return super().__new__(cls, *map(checked_leaf, STIFFNESSES, (ankle, knee, hip)))

    def _replace(self, **changes: Any) -> "Stiffness":
        """Return the stiffnesses with some changed, checked like any others."""
        return Stiffness(**{**self._asdict(), **changes})


def checked_person(body: Body, stiffness: Stiffness, gravity: Scalar) -> Any:
    """Check the arguments of a public function, each of one person; return their array library."""
    if not isinstance(body, Body):
        raise InputError(
            f"body = {body!r} is not a Body; make one with Body.from_height_mass or "
            "Body.edwards2007"
        )
    if not isinstance(stiffness, Stiffness):
        raise InputError(
            f"stiffness = {stiffness!r} is not a Stiffness; write Stiffness(ankle=…, knee=…, hip=…)"
        )
    for name, values, shape in zip(Body._fields, body, ((3,), (3,), (2,), (3,)), strict=True):
        if np.shape(values) != shape:
            raise InputError(
                f"{name} has the shape {np.shape(values)}, not {shape}; "
                "one person at a time, or map over them with jax.vmap"
            )
    for name, value in zip(STIFFNESSES, stiffness, strict=True):
        checked_scalar(name, value)
    checked_scalar("gravity", gravity)
    return namespace(*body, *stiffness, gravity)
