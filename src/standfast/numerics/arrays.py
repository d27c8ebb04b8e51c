"""Float64 arrays of NumPy or JAX: which library a formula runs in.

Every formula of the package is written once and asks its own arguments which library they belong
to (the ``__array_namespace__`` of the array API standard). On plain numbers it runs in NumPy, at
once and always in float64; inside ``jit`` and ``vmap`` the same lines are traced by JAX.
"""

import math
import sys
from typing import Any, TypeAlias

import numpy as np

from standfast.errors import InputError

Scalar: TypeAlias = Any  # float, NumPy or JAX float64 of shape ()
Array: TypeAlias = Any  # NumPy or JAX array; the shape stands in the docstring
Vector: TypeAlias = tuple[Scalar, Scalar, Scalar]
Matrix: TypeAlias = tuple[Vector, Vector, Vector]

ROUNDOFF = 2.0**-53  # unit roundoff of float64
TURN = 2.0 * math.pi  # rad


def namespace(*values: Any) -> Any:
    """Return the array library of ``values``: JAX if any of them belongs to it, else NumPy.

    Raises
    ------
    InputError
        for another precision than float64, which JAX makes without a word unless
        ``jax.config.update("jax_enable_x64", True)`` was called.
    """
    library = np
    for value in values:
        dtype = getattr(value, "dtype", np.float64)
        if dtype != np.float64 and getattr(dtype, "kind", "") == "f":
            raise InputError(
                f"standfast computes in float64 and was given {dtype}; {_way_to_float64(value)}"
            )
        find = getattr(value, "__array_namespace__", None)
        if find is not None and (found := find()) is not np:
            library = found
    return library


def _way_to_float64(value: Any) -> str:
    jax = sys.modules.get("jax")
    if jax is None or jax.config.jax_enable_x64 or isinstance(value, np.ndarray | np.generic):
        return 'write .astype("float64")'
    return 'call jax.config.update("jax_enable_x64", True) before making or tracing it'


def is_traced(*values: Any) -> bool:
    """Return whether any of some values is being traced by JAX, so has no number yet."""
    jax = sys.modules.get("jax")  # who traces has imported it
    return jax is not None and any(isinstance(value, jax.core.Tracer) for value in values)


def is_of_jax(value: Any) -> bool:
    """Return whether a value is an array of JAX, traced or with numbers."""
    jax = sys.modules.get("jax")
    return jax is not None and isinstance(value, jax.Array)


def in_numpy(value: Any) -> Any:
    """Return what has numbers, as an array of JAX or a series of pandas, as an array of NumPy.

    What is being traced, and what is no array, comes back as it is.
    """
    if isinstance(value, np.ndarray | np.generic) or is_traced(value):
        return value
    return np.asarray(value) if hasattr(value, "__array__") else value


def stacked(rows: Matrix) -> Array:
    """Return a matrix given by its rows as an array (3, 3)."""
    xp = namespace(*(entry for row in rows for entry in row))
    return xp.stack([xp.stack([xp.asarray(entry) for entry in row]) for row in rows])
