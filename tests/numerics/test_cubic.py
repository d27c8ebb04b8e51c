"""The largest root of a cubic against the roots that it was made of."""

import jax
import numpy as np
import pytest

from standfast.numerics.cubic import COSINE, largest_root

# The start is a polynomial of 2e-7, over roots that lie apart.
START_RTOL = 2e-6
# Rounding of the coefficients, over roots at least a tenth apart.
ROOT_RTOL = 1e-13
COUNT = 20_000


def coefficients(roots):
    low, middle, high = np.sort(roots, axis=0)
    e1, e2, e3 = low + middle + high, low * middle + (low + middle) * high, low * middle * high
    return (e1, e2, e3), high


def apart(random, scale):
    """Roots of either sign, at least a tenth of the scale apart."""
    low = random.uniform(-1.0, 1.0, COUNT)
    gaps = random.uniform(0.1, 2.0, (2, COUNT))
    return scale * np.stack([low, low + gaps[0], low + gaps.sum(axis=0)])


def test_the_polynomial_is_viete_s_cosine():
    s = np.linspace(0.0, 1.0, 1001)
    assert np.abs(np.polyval(COSINE[::-1], s) - np.cos(np.arccos(s) * 2.0 / 3.0)).max() < 2e-7


@pytest.mark.parametrize("scale", [1e-6, 1.0, 1e6])
@pytest.mark.parametrize("compiled", [False, True])
def test_the_largest_root_is_found(scale, compiled):
    random = np.random.default_rng(int(np.log10(scale)) + 6)
    roots = apart(random, scale)
    of, largest = coefficients(roots)
    for steps, rtol in ((0, START_RTOL), (2, ROOT_RTOL)):

        def solve(*e, steps=steps):
            return largest_root(*e, steps=steps)

        found = np.asarray((jax.jit(solve) if compiled else solve)(*of))
        assert np.abs(found - largest).max() < rtol * 4.0 * scale
    wrong = largest_root(of[0], of[1], of[2] * (1.0 + 1e-3), steps=2)
    assert np.abs(wrong - largest).max() > ROOT_RTOL * 4.0 * scale
