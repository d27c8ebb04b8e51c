"""Pairs of float64 for the few sums whose terms cancel near the threshold of stability.

A *pair* ``(high, low)`` is the unevaluated sum of two float64, good to about 79 bits. Factors are
split with a bit mask, so that the partial products are exact: a compiler that contracts
``a * b + c`` into one rounding, as XLA does on CPUs and GPUs, then changes nothing that matters.
(Dekker's splitting and the usual error term ``a * b - p`` do not survive such a compiler.)
"""

from typing import TypeAlias

import numpy as np

from standfast.numerics.arrays import Scalar, namespace

Pair: TypeAlias = tuple[Scalar, Scalar]

_UPPER_BITS = np.int64(-(1 << 27))  # sign, exponent and the leading 26 of 53 bits


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


def negate(x: Pair) -> Pair:
    """Return the negative of a pair."""
    return -x[0], -x[1]


def multiply(x: Pair, y: Pair) -> Pair:
    """Return the product of two pairs."""
    head, tail = product(x[0], y[0])
    return _normalised(head, tail + (x[0] * y[1] + x[1] * y[0]))


def difference_of_products(x: Pair, y: Pair, z: Pair) -> Scalar:
    """Return x y − z, right to the last digits also where the two nearly cancel."""
    x_high, x_low = _split(x[0])
    y_high, y_low = _split(y[0])
    tail = (x_high * y_low + x_low * y_high) + (x_low * y_low + (x[0] * y[1] + x[1] * y[0]))
    # the head is exact, and so is its difference from z where the digits would otherwise be lost
    return (x_high * y_high - z[0]) + (tail - z[1])


def _split(a: Scalar) -> Pair:
    xp = namespace(a)
    a = xp.asarray(a)
    high = (a.view(xp.int64) & _UPPER_BITS).view(xp.float64)
    return high, a - high


def _normalised(head: Scalar, tail: Scalar) -> Pair:
    high = head + tail
    return high, tail - (high - head)
