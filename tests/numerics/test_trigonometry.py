"""Cosine and sine of many angles against 40 digits."""

import jax
import mpmath
import numpy as np
import pytest

from standfast.numerics import trigonometry
from standfast.numerics.trigonometry import cosine_and_sine

PROMISED = 3e-16


def angles():
    rng = np.random.default_rng(4)
    near = np.nextafter(np.pi / 4.0 * np.arange(-40, 41), rng.choice([-np.inf, np.inf], 81))
    wide = rng.uniform(-1.0, 1.0, 300) * 10.0 ** rng.uniform(-8.0, 6.0, 300)
    return np.concatenate([near, wide, np.pi / 4.0 * np.arange(-9, 10), [0.0, 1e6, -1e6]])


def worst(found):
    exact = [(mpmath.cos(x), mpmath.sin(x)) for x in map(mpmath.mpf, angles())]
    apart = [
        abs(mpmath.mpf(float(mine)) - known)
        for kind, of in enumerate(found)
        for mine, known in zip(of, (each[kind] for each in exact), strict=True)
    ]
    return float(max(apart))


@pytest.mark.parametrize("compiled", [False, True])
def test_is_right_to_its_promise(compiled):
    with jax.enable_x64(True), mpmath.workdps(40):
        way = jax.jit(cosine_and_sine) if compiled else cosine_and_sine
        assert worst(way(angles())) < PROMISED


def test_a_wrong_coefficient_is_noticed(monkeypatch):
    first, *others = trigonometry.SINE
    monkeypatch.setattr(trigonometry, "SINE", (first * (1.0 + 1e-12), *others))
    with mpmath.workdps(40):
        assert worst(cosine_and_sine(angles())) > PROMISED


def test_slopes_are_those_of_cosine_and_sine():
    with jax.enable_x64(True):
        for x in (0.3, 2.0, 100.0):
            slopes = jax.jacfwd(lambda y: jax.numpy.stack(cosine_and_sine(y)))(x)
            np.testing.assert_allclose(slopes, [-np.sin(x), np.cos(x)], atol=1e-12)
