"""Numbers with a bound of their error: what float64 may have done to a few sums and quotients.

A *bounded* number says that the exact one lies within ``error`` of ``value``. Each operation adds
its own rounding to what it hands on. Multiplied and added in one rounding, as XLA does, it is less;
a quotient may be a product with a reciprocal. Sums and products of errors are rounded too, by far
less than what :func:`is_above` and :func:`is_below` leave beside them. Nothing here underflows: the
least number that is not 0 is a difference of loads, above 1e-25.
"""

from typing import NamedTuple

from standfast.numerics.arrays import ROUNDOFF, Scalar, namespace

BESIDE = 1.25  # of a bound, so that its own rounding does not matter


class Bounded(NamedTuple):
    """A number of float64 and how far the exact one may be away."""

    value: Scalar
    error: Scalar


def plus(x: Bounded, y: Bounded) -> Bounded:
    """Return x + y."""
    value = x.value + y.value
    return Bounded(value, x.error + y.error + ROUNDOFF * abs(value))


def minus(x: Bounded, y: Bounded) -> Bounded:
    """Return x − y."""
    return plus(x, Bounded(-y.value, y.error))


def times(x: Bounded, y: Bounded) -> Bounded:
    """Return x y."""
    value = x.value * y.value
    carried = abs(x.value) * y.error + abs(y.value) * x.error + x.error * y.error
    return Bounded(value, carried + ROUNDOFF * abs(value))


def over(x: Bounded, y: Bounded) -> Bounded:
    """Return x / y; the bound is infinite where y could be 0, or nearly."""
    xp = namespace(*x, *y)
    known = abs(y.value) > 2.0 * y.error
    size = xp.where(known, abs(y.value), 1.0)
    value = x.value / y.value
    carried = (abs(x.value) * y.error + size * x.error) / (size * (size - y.error))
    return Bounded(value, xp.where(known, carried + 3.0 * ROUNDOFF * abs(value), xp.inf))


def is_above(x: Bounded) -> Scalar:
    """Return whether the exact number is positive for certain."""
    return x.value > BESIDE * x.error


def is_below(x: Bounded) -> Scalar:
    """Return whether the exact number is negative for certain."""
    return x.value < -BESIDE * x.error
