"""Complex numbers as two real ones, which compilers make vectors of."""

from typing import NamedTuple

from standfast.numerics.arrays import Scalar


class Complex(NamedTuple):
    """A complex number: real and imaginary part."""

    re: Scalar
    im: Scalar


def times(p: Complex, q: Complex) -> Complex:
    """Return p q."""
    return Complex(p.re * q.re - p.im * q.im, p.re * q.im + p.im * q.re)


def less(p: Complex, q: Complex) -> Complex:
    """Return p − q."""
    return Complex(p.re - q.re, p.im - q.im)


def plus(p: Complex, q: Complex) -> Complex:
    """Return p + q."""
    return Complex(p.re + q.re, p.im + q.im)


def square_of(p: Complex) -> Scalar:
    """Return |p|²."""
    return p.re * p.re + p.im * p.im


def along(p: Complex, q: Complex) -> Scalar:
    """Return Re(p q̄)."""
    return p.re * q.re + p.im * q.im
