"""What is no plain number, but has one, is checked like it; what is traced alone passes unseen."""

import jax
import jax.numpy as jnp
import numpy as np
import pandas as pd
import pytest

import standfast as sf

BODY, K = sf.Body.edwards2007(), sf.Stiffness(900.0, 1500.0, 400.0)
UPRIGHT = (0.0, 0.0, 0.0)
GAINS = (600.0, 0.0, 0.0)


def stands(body=BODY, stiffness=K, **more):
    return sf.is_stable(body, stiffness, **more)


@pytest.fixture(autouse=True)
def double():
    with jax.enable_x64(True):
        yield


@pytest.mark.parametrize(
    ("call", "sentence"),
    [
        (lambda: stands(sf.Body(*[-jnp.asarray(x) for x in BODY])), "of the shank = -"),
        (lambda: sf.Body(pd.Series([6, -15, 50]), *BODY[1:]), "of the thigh = -15"),
        (lambda: stands(stiffness=sf.Stiffness(jnp.array(-900.0), 1500, 400)), "ankle_.* = -900"),
        (lambda: sf.modes(BODY, sf.Stiffness(900, jnp.array(np.nan), 400)), "knee_.* is NaN"),
        (lambda: stands(gravity=jnp.array(-9.8)), "gravity = -9.8 is outside"),
        (lambda: sf.Body.from_height_mass(jnp.array(175.0), 70.0), "height = 175 is outside"),
        (lambda: sf.Body.from_height_mass(jnp.array(1.1), 290.0), "a BMI of"),
        (lambda: stands(feedback=sf.Feedback(GAINS, delay=jnp.array(-0.1))), "delay = -0.1"),
        (lambda: stands(feedback=sf.Feedback(jnp.full((3, 3), jnp.nan))), "ankle_.*is NaN"),
        (lambda: stands(damping=jnp.array([-1.0, 0.0, 0.0])), "ankle_damping = -1"),
        (lambda: sf.Feedback(None, GAINS), "proportional gains = None are not three numbers"),
        (lambda: sf.Feedback(GAINS, delay=None), "feedback_delay is None"),
        (lambda: sf.Feedback(x for x in GAINS), "proportional gains = <generator"),
        (lambda: sf.Body([6, 15, 50], None, (0.4, 0.4), (0.2, 0.2, 0.3)), "segment_inertia = None"),
        (lambda: sf.Body((x for x in (6, 15, 50)), *BODY[1:]), "segment_mass = <generator"),
        (lambda: sf.kinetic_energy(BODY, (np.nan, 0, 0), UPRIGHT), "rotation = .* is not three"),
        (lambda: sf.kinetic_energy(BODY, UPRIGHT, jnp.array([0, jnp.inf, 0])), "velocity = .*not"),
        (lambda: sf.potential_energy(BODY, K, ("1", 0, 0)), "rotation = .* is not three numbers"),
    ],
)  # fmt: skip
def test_it_is_refused(call, sentence):
    with pytest.raises(sf.InputError, match=sentence):
        call()


def test_right_ones_are_taken():
    body = sf.Body(*map(jnp.asarray, BODY))
    stiffness = sf.Stiffness(*map(jnp.asarray, K))
    assert float(sf.safety_factor(body, stiffness)) == pytest.approx(
        sf.safety_factor(BODY, sf.Stiffness(*K.joints)), rel=1e-12
    )
    assert sf.Body(pd.Series(BODY.segment_mass), *BODY[1:]) == BODY
    assert sf.Stiffness(jnp.array(np.inf), 1500.0, 400.0).ankle == np.inf


def test_slopes_are_kept_in_records_though_they_are_negative():
    slopes = jax.grad(lambda k: sf.critical_stiffness(BODY, k).ankle)(sf.Stiffness(*K.joints))
    assert slopes.knee < 0.0
    by_body = jax.grad(lambda body: sf.stiffness_reserve(body, K))(BODY)
    assert isinstance(by_body, sf.Body)
    assert (by_body.segment_mass < 0.0).all()


def test_float32_is_told_what_to_do():
    """The way to double precision, where it is on, and where it is not."""
    ankle = np.float32([900.0, 1000.0])

    def reserve(ankle):
        return sf.stiffness_reserve(BODY, sf.Stiffness(ankle, 1500.0, 400.0))

    with pytest.raises(sf.InputError, match=r'given float32; write .astype\("float64"\)'):
        jax.vmap(reserve)(ankle)
    with (
        jax.enable_x64(False),
        pytest.raises(sf.InputError, match=r'call jax.config.update\("jax_enable_x64", True\)'),
    ):
        jax.vmap(reserve)(ankle)
