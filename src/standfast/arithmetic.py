"""The numbers the physics runs on: float64 arrays of NumPy or JAX, and pairs of them.

Every formula of the package is written once and asks its own arguments which library they belong
to (the ``__array_namespace__`` of the array API standard). On plain numbers it runs in NumPy, at
once and always in float64; inside ``jit`` and ``vmap`` the same lines are traced by JAX.

A *pair* ``(high, low)`` is the unevaluated sum of two float64, good to about 79 bits. Pairs carry
the few sums whose terms cancel near the threshold of stability. Factors are split with a bit mask,
so that the partial products are exact: a compiler that contracts ``a * b + c`` into one rounding,
as XLA does on CPUs and GPUs, then changes nothing that matters. (Dekker's splitting and the usual
error term ``a * b - p`` do not survive such a compiler.)
"""

from typing import Any, TypeAlias

import numpy as np

Scalar: TypeAlias = Any  # float, NumPy or JAX float64 of shape ()
Array: TypeAlias = Any  # NumPy or JAX array; the shape stands in the docstring
Vector: TypeAlias = tuple[Scalar, Scalar, Scalar]
Matrix: TypeAlias = tuple[Vector, Vector, Vector]
Pair: TypeAlias = tuple[Scalar, Scalar]

_UPPER_BITS = np.int64(-(1 << 27))  # sign, exponent and the leading 26 of 53 bits


def namespace(*values: Any) -> Any:
    """Return the array library of ``values``: JAX if any of them belongs to it, else NumPy.

    Raises
    ------
    TypeError
        if a value is of another precision than float64. JAX makes it so without a word unless
        ``jax.config.update("jax_enable_x64", True)`` was called.
    """
    library = np
    for value in values:
        dtype = getattr(value, "dtype", np.float64)
        if dtype != np.float64 and getattr(dtype, "kind", "") == "f":
            raise TypeError(
                f"standfast computes in float64 and was given {dtype}; "
                'call jax.config.update("jax_enable_x64", True) before tracing it'
            )
        find = getattr(value, "__array_namespace__", None)
        if find is not None and (found := find()) is not np:
            library = found
    return library


def dot(a: Vector, b: Vector) -> Scalar:
    """Scalar product a · b."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a: Vector, b: Vector) -> Vector:
    """Vector product a × b."""
    return (
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    )


def scaled(factor: Scalar, a: Vector) -> Vector:
    """Vector a times a factor."""
    return (factor * a[0], factor * a[1], factor * a[2])


def applied(matrix: Matrix, a: Vector) -> Vector:
    """Matrix, given by its rows, times vector."""
    return (dot(matrix[0], a), dot(matrix[1], a), dot(matrix[2], a))


def product(a: Scalar, b: Scalar) -> Pair:
    """Return a · b as a pair, to 79 bits."""
    a_high, a_low = _split(a)
    b_high, b_low = _split(b)
    head = a_high * b_high
    tail = (a_high * b_low + a_low * b_high) + a_low * b_low
    return _normalised(head, tail)


def add(x: Pair, y: Pair) -> Pair:
    """Return the sum of two pairs."""
    total = x[0] + y[0]
    virtual = total - x[0]
    rest = (x[0] - (total - virtual)) + (y[0] - virtual)
    return _normalised(total, rest + (x[1] + y[1]))


def minus(x: Pair) -> Pair:
    """Return the negative of a pair."""
    return -x[0], -x[1]


def multiply(x: Pair, y: Pair) -> Pair:
    """Return the product of two pairs."""
    head, tail = product(x[0], y[0])
    return _normalised(head, tail + (x[0] * y[1] + x[1] * y[0]))


def product_less(x: Pair, y: Pair, z: Pair) -> Scalar:
    """Return x y − z, right to the last digits also where the two nearly cancel."""
    x_high, x_low = _split(x[0])
    y_high, y_low = _split(y[0])
    tail = (x_high * y_low + x_low * y_high) + (x_low * y_low + (x[0] * y[1] + x[1] * y[0]))
    # the head is exact, and so is its difference from z where the digits would otherwise be lost
    return (x_high * y_high - z[0]) + (tail - z[1])


# Starts the reciprocal within an eighth: subtracted from the bits of a float64, it negates the
# exponent and nearly inverts the fraction.
_RECIPROCAL_BITS = np.int64(0x7FDE6238502484BA)


def reciprocal(a: Scalar) -> Scalar:
    """Return 1/a to the last digit but one, for normal numbers; else any number.

    Three steps, each of which cubes the error. XLA keeps the values of every division in memory
    before it goes on; of multiplications it makes one loop.
    """
    xp = namespace(a)
    inverse = (_RECIPROCAL_BITS - xp.asarray(a).view(xp.int64)).view(xp.float64)
    for _ in range(3):
        error = 1.0 - a * inverse
        inverse = inverse + inverse * (error + error * error)
    return inverse


def _split(a: Scalar) -> Pair:
    xp = namespace(a)
    a = xp.asarray(a)
    high = (a.view(xp.int64) & _UPPER_BITS).view(xp.float64)
    return high, a - high


def _normalised(head: Scalar, tail: Scalar) -> Pair:
    high = head + tail
    return high, tail - (high - head)
