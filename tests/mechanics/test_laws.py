"""Published laws of feedback: their bodies, their units, and what becomes of them.

The delays and roots below are of a recomputation made before the package could do it, eigenvalues
stand in the source; all are given to the digits that are compared. The argument principle, apart
from both, counts roots on either side of each critical delay.
"""

import dataclasses
import math

import numpy as np
import pytest
import scipy.linalg

import standfast as sf
from delay_oracles import unstable_by_argument
from standfast.mechanics.law import CONFIDENCES, UNITS, Printed
from standfast.mechanics.laws import LAWS, LEFT_OUT
from standfast.mechanics.links import OneLink, TwoLinks
from standfast.mechanics.matrices import gravity_loads, joint_inertia, stiffness_rows
from standfast.parameters import JOINTS

# Critical delay (ms) and rightmost root (1/s; None: not known apart from the package).
FOUND = {
    "pasma-2017": (286.17, -1.6303),
    "independent-channel-0.5deg": (238, -0.648 + 3.282j),
    "independent-channel-1deg": (225, -0.611 + 3.414j),
    "independent-channel-2deg": (214, -0.602 + 3.542j),
    "independent-channel-4deg": (204, -1.411 + 3.388j),
    "independent-channel-8deg": (195, -1.570 + 3.329j),
    "light-touch-2017": (238, -1.00 + 1.12j),
    "dec-2015": (324, -1.32 + 0.71j),
    "asai-2009": (95, 0.127 + 0.683j),
    "wang-pd-det": (0, 0.715),
    "wang-pd-sto3": (37.4, -0.180 + 0.047j),
    "wang-fpd-det": (30.6, -0.053),
    "wang-fpd-sto3": (30.8, -0.061),
    "opty-park-2004": (32.9, -1.147 + 0.887j),
    "lqr-pydy": (34.4, None),
    "lqr-edwards2007": (25.9, None),
}
HALF, FULL = 0.51, 1.01  # units of the last digit: rounded, or rounded after a rounding
PRINTED_GAIN = 0.005  # half a unit of the last digit of gains of N·m/rad with two decimals
PRINTED_ROOT = 0.0005


def digits(number, least):
    """Half or one unit of the last of the digits that ``number`` is written with."""
    return least * 10.0 ** -max(0, len(repr(float(number)).rstrip("0").partition(".")[2]))


def matrices(law, gravity=None):
    """A, B, C, P, D of the free joints."""
    free = [JOINTS.index(joint) for joint in law.joints]
    whole = (
        joint_inertia(law.body),
        law.damping,
        stiffness_rows(law.body, law.stiffness, gravity or law.gravity),
        law.feedback.proportional,
        law.feedback.derivative,
    )
    return np.array([np.array(each, float)[np.ix_(free, free)] for each in whole])


def eigenvalues(a, b, c, p, d):
    """All roots without delay; P and D may be many."""
    inverse = np.linalg.inv(a)
    below = np.concatenate([-inverse @ (c + p), -inverse @ (b + d)], axis=-1)
    above = np.broadcast_to(np.eye(len(a), 2 * len(a), len(a)), below.shape)
    return np.linalg.eigvals(np.concatenate([above, below], axis=-2))


def far(found, roots):
    """The largest difference, of real or imaginary part, of roots to the nearest that was found."""
    gaps = found[..., None] - np.array(roots)
    nearest = np.take_along_axis(gaps, np.abs(gaps).argmin(-2)[..., None, :], -2)[..., 0, :]
    return np.maximum(np.abs(nearest.real), np.abs(nearest.imag)).max(-1)


def scaled(law, which, factor):
    """The law with one of its printed gains changed."""
    value, unit = getattr(law.printed, which)
    printed = law.printed._replace(**{which: Printed(np.multiply(value, factor), unit)})
    return dataclasses.replace(law, printed=printed)


def test_the_table_is_whole():
    assert set(FOUND) == set(LAWS)
    assert len(LAWS) == 16
    assert not set(LEFT_OUT) & set(LAWS)
    for name, law in LAWS.items():
        assert name == law.name
        assert law.title
        assert law.source
        assert law.confidence in CONFIDENCES
        assert {printed.unit for printed in law.printed} <= set(UNITS)


@pytest.mark.parametrize("name", [name for name, law in LAWS.items() if law.published])
def test_a_law_does_what_its_source_says(name):
    law = LAWS[name]
    assert sf.is_stable(**law.person) is law.published.stands
    assert (sf.unstable_roots(**law.person) == 0) is law.published.stands


@pytest.mark.parametrize("name", FOUND)
def test_critical_delay_and_rightmost_root(name):
    law, (delay, root) = LAWS[name], FOUND[name]
    found = 1000.0 * sf.critical_delay(**law.person)
    assert found == pytest.approx(delay, rel=0.0, abs=digits(delay, HALF))
    if root is not None:
        rightmost = sf.rightmost_root(**law.person)
        assert rightmost.real == pytest.approx(root.real, abs=digits(root.real, FULL))
        assert rightmost.imag == pytest.approx(root.imag, abs=digits(root.imag, FULL))


@pytest.mark.parametrize("name", FOUND)
def test_the_argument_principle_says_the_same(name):
    law = LAWS[name]
    delay = sf.critical_delay(**law.person)
    assert unstable_by_argument(matrices(law), law.delay) == sf.unstable_roots(**law.person)
    if delay > 0.0:
        assert unstable_by_argument(matrices(law), 0.999 * delay) == 0
        assert unstable_by_argument(matrices(law), 1.001 * delay) == 2


WANG = [name for name in LAWS if name.startswith("wang")]


def nearest_to_print(law, gravity=None):
    """How near gains that print as the law's, 4,000, bring all roots to the printed ones."""
    a, b, c, *gains = matrices(law, gravity)
    rng = np.random.default_rng(4)
    p, d = (
        gain + (gain != 0.0) * rng.uniform(-PRINTED_GAIN, PRINTED_GAIN, (4000, *gain.shape))
        for gain in gains
    )
    return far(eigenvalues(a, b, c, p, d), law.published.roots).min()


@pytest.mark.parametrize("name", WANG)
def test_published_eigenvalues_come_out_to_the_printed_digits(name):
    """The printed gains are rounded, and roots move by up to 0.0018 within their rounding.

    As printed they give all roots within two units of the last digit; gains that round to them give
    the printed digits themselves. Gravity of another digit, or a gain one per cent off, does not.
    """
    law = LAWS[name]
    assert far(eigenvalues(*matrices(law)), law.published.roots) < 4.0 * PRINTED_ROOT
    assert nearest_to_print(law) < PRINTED_ROOT
    assert nearest_to_print(law, gravity=9.80665) > PRINTED_ROOT
    assert nearest_to_print(law, gravity=9.80) > PRINTED_ROOT


@pytest.mark.parametrize("which", ["proportional", "derivative"])
@pytest.mark.parametrize("name", WANG)
def test_a_changed_gain_would_be_noticed_in_the_eigenvalues(name, which):
    assert nearest_to_print(scaled(LAWS[name], which, 1.01)) > PRINTED_ROOT


@pytest.mark.parametrize("which", ["proportional", "derivative"])
@pytest.mark.parametrize("name", FOUND)
def test_a_changed_gain_would_be_noticed_in_the_delays(name, which):
    """Five per cent move what the tests above compare."""
    delay, root = FOUND[name]
    changed = scaled(LAWS[name], which, 1.05).person
    found = 1000.0 * sf.critical_delay(**changed)
    moved = abs(found - delay) > digits(delay, HALF)
    if root is not None and not moved:
        gap = sf.rightmost_root(**changed) - root
        moved = abs(gap.real) > digits(root.real, FULL) or abs(gap.imag) > digits(root.imag, FULL)
    assert moved


def test_bodies_have_the_published_inertia_and_load():
    for law in LAWS.values():
        a = np.array(joint_inertia(law.body))
        load = sum(gravity_loads(law.body, law.gravity))
        assert load == pytest.approx(law.load, rel=1e-14)
        if isinstance(law.links, OneLink):
            assert a[0, 0] == pytest.approx(law.links.inertia, rel=1e-14)
            assert law.joints == ("ankle",)
            assert law.stiffness.joints[1:] == (math.inf, math.inf)
            assert sum(law.body.segment_mass) == pytest.approx(law.links.mass, rel=2e-3)


def test_a_point_mass_is_a_thousandth_heavier_and_nothing_else():
    link = OneLink(mass=60.0, inertia=60.0, load=60.0 * 9.81)
    body = link.body(9.81)
    assert sum(body.segment_mass) == pytest.approx(60.06, rel=1e-14)
    assert joint_inertia(body)[0][0] == pytest.approx(60.0, rel=1e-14)
    assert sum(gravity_loads(body, 9.81)) == pytest.approx(588.6, rel=1e-14)


def test_two_links_are_those_of_a_double_pendulum():
    """Written out: leg and trunk, angles of ankle and hip relative to each other."""
    links = TwoLinks(mass=(22.0, 48.0), inertia=(1.7, 3.3), com=(0.47, 0.33), leg=0.84)
    (m, n), (i, j), (c, d), h = links
    body, g = links.body(), 9.81
    hip = j + n * d**2
    cross = hip + n * h * d
    ankle = i + m * c**2 + hip + n * h**2 + 2.0 * n * h * d
    found = np.array(joint_inertia(body))[np.ix_([0, 2], [0, 2])]
    np.testing.assert_allclose(found, [[ankle, cross], [cross, hip]], rtol=1e-14)
    shank, thigh, upper = gravity_loads(body, g)
    assert shank + thigh + upper == pytest.approx(g * (m * c + n * (h + d)), rel=1e-14)
    assert upper == pytest.approx(g * n * d, rel=1e-14)
    law = LAWS["wang-pd-det"]
    assert law.joints == ("ankle", "hip")
    assert law.stiffness.joints == (0.0, math.inf, 0.0)
    assert law.load == pytest.approx(660.95, abs=0.005)
    assert gravity_loads(law.body, law.gravity)[2] == pytest.approx(156.33, abs=0.005)


def test_units_become_newton_metres_per_radian():
    law = LAWS["independent-channel-0.5deg"]
    assert law.feedback.proportional[0, 0] == pytest.approx(974.0, abs=0.05)  # 17 N·m/degree
    assert law.feedback.derivative[0, 0] == pytest.approx(286.5, abs=0.05)
    law = LAWS["asai-2009"]
    assert law.stiffness.ankle == pytest.approx(470.88, rel=1e-14)  # 0.8 mgh
    assert law.damping[0, 0] == 4.0
    assert law.feedback.proportional[0, 0] == pytest.approx(147.15, rel=1e-14)
    law = LAWS["light-touch-2017"]
    assert law.feedback.derivative[0, 0] == pytest.approx(188.0, abs=0.05)
    one_leg = law.printed._replace(proportional=Printed(450.0, "N·m/rad of one leg"))
    assert dataclasses.replace(law, printed=one_leg).feedback.proportional[0, 0] == 900.0


def test_matrices_keep_row_and_column():
    law = LAWS["wang-fpd-det"]
    assert law.feedback.proportional[0, 2] == 412.23
    assert law.feedback.proportional[2, 0] == -105.74
    assert not law.feedback.proportional[1].any()
    assert not law.feedback.proportional[:, 1].any()


@pytest.mark.parametrize("name", ["lqr-pydy", "lqr-edwards2007"])
def test_regulators_are_those_of_the_riccati_equation(name):
    """Weights 1 on all angles, rates and moments; gains as printed, to two decimals."""
    law = LAWS[name]
    a, b, c, p, d = matrices(law)
    assert not b.any()
    inverse = np.linalg.inv(a)
    plant = np.block([[np.zeros((3, 3)), np.eye(3)], [-inverse @ c, np.zeros((3, 3))]])
    moments = np.vstack([np.zeros((3, 3)), inverse])
    riccati = scipy.linalg.solve_continuous_are(plant, moments, np.eye(6), np.eye(3))
    gains = moments.T @ riccati
    np.testing.assert_allclose(np.hstack([p, d]), gains, rtol=0.0, atol=PRINTED_GAIN)
    if name == "lqr-pydy":
        found = np.sort(np.linalg.eigvals(plant - moments @ gains).real)
        closed = (-19.42, -14.62, -7.52, -7.00, -2.83, -2.82)
        np.testing.assert_allclose(found, closed, rtol=0.0, atol=PRINTED_ROOT * 10.0)


@pytest.mark.parametrize("name", LAWS)
def test_a_law_on_its_own_body_is_itself(name):
    law = LAWS[name]
    assert law.scale(law.body, law.gravity) == pytest.approx(1.0, rel=1e-14)
    found = law.on(law.body, law.gravity)
    assert found.keys() == law.person.keys()
    assert found["stiffness"] == pytest.approx(law.stiffness, rel=1e-14)
    pairs = zip((found["damping"], *found["feedback"]), (law.damping, *law.feedback), strict=True)
    for each, own in pairs:
        np.testing.assert_allclose(each, own, rtol=1e-14)


@pytest.mark.parametrize("name", ["pasma-2017", "wang-fpd-det", "lqr-edwards2007"])
def test_a_law_holds_a_heavier_body_as_its_own(name):
    """A, B, C, P and D are all of them three times as large."""
    law = LAWS[name]
    body = law.body
    heavy = body._replace(
        segment_mass=3.0 * body.segment_mass, segment_inertia=3.0 * body.segment_inertia
    )
    person = law.on(heavy, law.gravity)
    own = sf.critical_delay(**law.person)
    assert law.scale(heavy, law.gravity) == pytest.approx(3.0, rel=1e-14)
    assert sf.critical_delay(**person) == pytest.approx(own, rel=1e-9)
    assert person["feedback"].delay == law.delay
    unscaled = {**person, "damping": law.damping, "feedback": law.feedback}
    assert sf.critical_delay(**unscaled) != pytest.approx(own, rel=1e-2)


def test_a_law_is_put_on_bodies_alone():
    law = LAWS["dec-2015"]
    with pytest.raises(sf.InputError, match="body"):
        law.on(70.0)
    with pytest.raises(sf.InputError, match=r"gravity = -9\.81"):
        law.on(law.body, -9.81)


def test_the_overall_gain_of_dec_just_does_not_hold():
    """0.15 + 0.85 = 1: springs and feedback together are what topples, and no more."""
    law = LAWS["dec-2015"]
    _, _, c, p, _ = matrices(law)
    assert c + 0.85 * p == pytest.approx(0.0, abs=1e-12 * law.load)
    assert not sf.is_stable(**scaled(law, "proportional", 0.849).person)
    assert sf.is_stable(**scaled(law, "proportional", 0.851).person)


def test_laws_are_at_the_door():
    assert sf.LAWS is LAWS
    assert sf.critical_delay(**sf.LAWS["pasma-2017"].person) == pytest.approx(0.28617, abs=5e-6)


def test_a_law_that_is_none_is_named():
    near = next(iter(sf.LAWS))[:-1]
    with pytest.raises(KeyError, match="is not a law; did you mean"):
        sf.LAWS[near]
    with pytest.raises(sf.InputError, match="is not among the laws: it switches"):
        sf.LAWS["suzuki-2020"]
    assert "suzuki-2020" not in sf.LAWS
