"""The tables, their composition, scaling."""

import math

import numpy as np
import pytest

import standfast as sf
from standfast.anthropometry import tables as segments
from standfast.anthropometry.body import BODY_SOURCES, REFERENCE_PEOPLE

# De Leva's two rows of the trunk, to the cervicale and to the mid-shoulder, put its centre of mass
# at heights that differ by 1e-5 of stature: no composition is better than that.
COMPOSITION = 1e-5


@pytest.mark.parametrize(
    ("model", "com", "gyration"),
    [("de-leva-male", 0.18984, 0.13023), ("de-leva-female", 0.19826, 0.12927)],
)
def test_composed_upper_body(model, com, gyration):
    """Centre of mass above the hip and radius of gyration, as fractions of stature."""
    mass, height, inertia = segments.upper_body(model)
    assert mass == pytest.approx({"de-leva-male": 0.6028, "de-leva-female": 0.5823}[model])
    assert height == pytest.approx(com, abs=COMPOSITION)
    assert math.sqrt(inertia / mass) == pytest.approx(gyration, abs=COMPOSITION)


def test_winters_upper_body_is_measured_to_the_shoulder():
    body = sf.Body.from_height_mass(1.0, 10.0, "winter")
    assert body.segment_com[2] == pytest.approx(0.626 * 0.288)
    gyration = math.sqrt(body.segment_inertia[2] / body.segment_mass[2])
    assert gyration == pytest.approx(0.496 * 0.288)


def test_sagittal_motion_uses_the_transverse_radii():
    """De Leva's sagittal column would make the upper body about 7 % too inert."""
    rows = segments.DE_LEVA["de-leva-male"]
    assert rows["shank"].gyration == 0.246
    assert rows["trunk"].gyration == 0.306


@pytest.mark.parametrize("model", sf.BODY_MODELS)
def test_masses_are_of_both_legs_and_leave_out_the_feet(model):
    body = sf.Body.from_height_mass(1.75, 80.0, model)
    assert 0.96 * 80.0 < body.segment_mass.sum() < 0.98 * 80.0


@pytest.mark.parametrize("model", sf.BODY_MODELS)
def test_masses_scale_with_mass_lengths_with_height_inertias_with_both(model):
    one = sf.Body.from_height_mass(1.5, 50.0, model)
    other = sf.Body.from_height_mass(1.8, 75.0, model)
    np.testing.assert_allclose(other.segment_mass, 1.5 * one.segment_mass, rtol=1e-15)
    np.testing.assert_allclose(other.segment_length, 1.2 * one.segment_length, rtol=1e-15)
    np.testing.assert_allclose(other.segment_com, 1.2 * one.segment_com, rtol=1e-15)
    np.testing.assert_allclose(
        other.segment_inertia, 1.5 * 1.2**2 * one.segment_inertia, rtol=1e-15
    )


@pytest.mark.parametrize("body", [sf.Body.edwards2007(), sf.Body.from_height_mass(1.8, 80.0)])
def test_a_body_is_frozen(body):
    with pytest.raises(AttributeError):
        body.segment_mass = 1.0
    with pytest.raises(ValueError, match="read-only"):
        body.segment_mass[0] = 1.0


def test_every_model_names_its_source():
    assert set(REFERENCE_PEOPLE) == set(sf.BODY_MODELS)
    assert set(BODY_SOURCES) == set(sf.BODY_MODELS)
    assert all(BODY_SOURCES.values())


def test_bodies_compare_by_value():
    assert sf.Body.from_height_mass(1.8, 80.0) == sf.Body.from_height_mass(1.8, 80.0)
    assert sf.Body.from_height_mass(1.8, 80.0) != sf.Body.from_height_mass(1.8, 81.0)
