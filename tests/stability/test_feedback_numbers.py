"""Numbers of the literature and of closed forms: limits of feedback, published laws."""

import math

import numpy as np
import pytest

import standfast as sf
from delay_people import of_matrices, one_link
from standfast.stability.delay.persons import all_crossings, all_rightmost

SEED = 20075
PRINTED = 6e-4  # of numbers printed to three decimals
# of four digits, computed from gains and bodies that are themselves printed to three or four
FOUR_DIGITS = 2e-3
BESIDE_LIMIT = 1e-3  # relative distance from the longest delay that can be borne

G = 9.81
BODY = {"inertia": 73.3964, "load": 743.207, "proportional": 854.688, "derivative": 180.912}
PASMA = {
    "inertia": 66,
    "load": 610.7,
    "stiffness": 40.5,
    "damping": 68.8,
    "proportional": 943.9,
    "derivative": 313.5,
}
ASAI = {
    "inertia": 60, "load": 588.6, "stiffness": 0.8 * 588.6, "damping": 4.0,
    "proportional": 0.25 * 588.6, "derivative": 10.0,
}  # fmt: skip
# inertia, load, stiffness, damping, P, D, delay, rightmost root, critical delay
ONE_LINK_LAWS = {
    "pasma2017": ((66, 610.7, 40.5, 68.8, 943.9, 313.5), 0.097, -1.6303, 0.28617),
    "jner2017_pda": ((80.8, 680.8, 94.4, 10.9, 908.2, 591.7), 0.104, -0.65, 0.212),
    "masani2006": ((66, 648.6, 0, 0, 750, 350), 0.10, -0.387, 0.298),
    "maurer_peterka2005": ((66, 648.6, 0, 0, 970, 276), 0.171, -1.24 + 3.25j, 0.232),
    "peterka2002": ((81.1, 732.2, 0, 0, 957, 250), 0.175, -0.70 + 2.04j, 0.239),
    "ic_surface_tilt_0.5deg": ((70.57, 633.65, 0, 0, 974.0, 286.5), 0.2, -0.648 + 3.282j, 0.238),
    "ic_surface_tilt_8deg": ((70.57, 633.65, 0, 0, 1203.2, 286.5), 0.11, -1.570 + 3.329j, 0.195),
    "light_touch_2017": ((70.57, 633.65, 0, 0, 753.0, 188.0), 0.10592, -1.00 + 1.12j, 0.238),
    "dec_2015": ((70.57, 633.65, 95.0, 28.5, 633.7, 190.1), 0.16, -1.32 + 0.71j, 0.324),
    "asai2009": ((60, 588.6, 470.88, 4.0, 147.15, 10.0), 0.2, 0.127 + 0.683j, 0.095),
}
WANG = {
    "fpd_det": ([[341.49, 412.23], [-105.74, 364.04]], [[68.84, 47.65], [19.93, 23.44]]),
    "fpd_sto3": ([[454.75, 318.62], [-74.46, 334.14]], [[55.29, 50.18], [16.15, 24.50]]),
    "pd_det": ([[883.80, 0.0], [0.0, 222.05]], [[18.33, 0.0], [0.0, 8.99]]),
    "pd_sto3": ([[972.25, 0.0], [0.0, 236.58]], [[29.68, 0.0], [0.0, 10.57]]),
}
# published eigenvalues, and delay and angular frequency at which stability is lost
WANG_FOUND = {
    "pd_det": ([-2.344 + 8.717j, -0.987, 0.715], None),
    "pd_sto3": ([-2.940 + 9.115j, -0.181 + 0.046j], (0.0374, 0.19)),
    "fpd_det": ([-2.097 + 8.550j, -1.020, -0.053], (0.0306, 9.10)),
    "fpd_sto3": ([-2.091 + 8.535j, -0.981, -0.061], (0.0308, 9.10)),
}
LQR_P = [[1082.01, 536.97, 206.43], [1221.94, 1060.64, 484.58], [74.93, 106.72, 243.93]]
LQR_D = [[367.02, 220.58, 94.11], [437.23, 299.13, 147.41], [37.99, 38.19, 38.52]]
LQR_PYDY_P = [[1054.37, 426.90, 153.86], [707.67, 610.18, 251.28], [12.13, 43.67, 132.47]]
LQR_PYDY_D = [[365.78, 173.58, 67.28], [263.84, 158.58, 72.18], [11.61, 16.45, 19.12]]


def table_of(person):
    return all_crossings(person.numbers, person.rigid)


def rightmost(person, delay):
    root, proven = all_rightmost(person.numbers, person.rigid, np.array([delay]))
    assert proven.all()
    return root[0]


def stacked(people):
    numbers = np.concatenate([person.numbers for person in people], axis=-1)
    rigid = np.concatenate([person.rigid for person in people], axis=-1)
    return all_crossings(numbers, rigid)


@pytest.mark.parametrize("damping", [0.0, 40.0, 300.0])
def test_no_gains_stabilise_beyond_the_limit(damping):
    """τ < √(2/a) without damping, (b + √(b² + 2a))/a with it: a triple root at 0 is the corner."""
    inertia, load, stiffness = 70.0, 700.0, 100.0
    a, b = (load - stiffness) / inertia, damping / inertia
    limit = (b + math.sqrt(b**2 + 2.0 * a)) / a
    rng = np.random.default_rng(SEED)
    fixed = {"inertia": inertia, "load": load, "stiffness": stiffness, "damping": damping}
    # gains from just above what gravity asks, and derivative gains around the corner a τ − b
    p = a * inertia * (1.0 + 10.0 ** rng.uniform(-7.0, 1.0, 4000))
    corner = (a * limit - b) * inertia
    d = corner * (1.0 + rng.uniform(-0.9, 3.0, 4000) * 10.0 ** rng.uniform(-4.0, 0.0, 4000))
    many = [one_link(**fixed, proportional=p[i], derivative=d[i]) for i in range(4000)]
    table = stacked(many)
    either = np.array([limit * (1.0 - 20 * BESIDE_LIMIT), limit * (1.0 + BESIDE_LIMIT)])
    stable = table.stable_at(either)
    assert stable[:, 0].any()
    assert not stable[:, 1].any()


def test_the_limit_of_a_point_mass():
    assert math.sqrt(2.0 / G) == pytest.approx(0.4515, abs=1e-4)
    a = G
    d, p = a * 0.4515, a * (1.0 + 1e-4)
    shorter = one_link(1.0, G, proportional=p, derivative=0.98 * d)
    assert 0.43 < table_of(shorter).critical_delay()[0] < math.sqrt(2.0 / G)


@pytest.mark.parametrize(
    ("delay", "real"),
    [(0.05, -1.061), (0.1, -0.805), (0.15, -0.452), (0.175, -0.251), (0.2, -0.045),
     (0.21, 0.036), (0.3, 0.649)],
)  # fmt: skip
def test_rightmost_roots_of_one_person_over_the_delay(delay, real):
    assert rightmost(one_link(**BODY), delay).real == pytest.approx(real, abs=PRINTED)


def test_when_one_person_loses_stability():
    assert table_of(one_link(**BODY)).critical_delay()[0] == pytest.approx(0.2056, abs=5e-5)
    weaker = one_link(**(BODY | {"derivative": 170.0}))
    assert table_of(weaker).critical_delay()[0] != pytest.approx(0.2056, abs=5e-5)


@pytest.mark.parametrize("name", ONE_LINK_LAWS)
def test_laws_of_one_link(name):
    numbers, delay, root, critical = ONE_LINK_LAWS[name]
    names = ("inertia", "load", "stiffness", "damping", "proportional", "derivative")
    person = one_link(**dict(zip(names, numbers, strict=True)))
    found = rightmost(person, delay)
    assert found.real == pytest.approx(np.real(root), abs=6e-3)
    if np.imag(root):
        assert found.imag == pytest.approx(np.imag(root), abs=6e-3)
    assert table_of(person).critical_delay()[0] == pytest.approx(critical, abs=6e-4)


def test_pasma_and_asai_to_their_digits():
    assert rightmost(one_link(**PASMA), 0.097) == pytest.approx(-1.6303, abs=5e-5)
    assert table_of(one_link(**PASMA)).critical_delay()[0] == pytest.approx(0.28617, abs=5e-6)
    assert rightmost(one_link(**ASAI), 0.2) == pytest.approx(0.127 + 0.683j, abs=PRINTED)
    assert table_of(one_link(**ASAI)).critical_delay()[0] == pytest.approx(0.095, abs=5e-4)
    assert not table_of(one_link(**ASAI)).stable_at(np.array([0.2]))[0, 0]


def two_link(lower, com_lower, com_upper, masses, inertias):
    """A and G of two links in relative angles: feet fixed, ankle and hip."""
    (m1, m2), (i1, i2) = masses, inertias
    m11 = i1 + m1 * com_lower**2 + m2 * lower**2
    m12, m22 = m2 * lower * com_upper, i2 + m2 * com_upper**2
    upper_load = G * m2 * com_upper
    load = G * (m1 * com_lower + m2 * lower) + upper_load
    a = [[m11 + 2 * m12 + m22, m12 + m22], [m12 + m22, m22]]
    return np.array(a), np.array([[load, upper_load], [upper_load, upper_load]])


@pytest.mark.parametrize("name", WANG)
def test_wang_and_van_den_bogert(name):
    a, g = two_link(0.84353, 0.46647, 0.32905, (22.699, 48.429), (1.71647, 3.29194))
    p, d = map(np.array, WANG[name])
    person = of_matrices(a, np.zeros((2, 2)), -g, p, d)
    published, lost = WANG_FOUND[name]
    whole = np.block(
        [[np.zeros((2, 2)), np.eye(2)], [np.linalg.solve(a, g - p), -np.linalg.solve(a, d)]]
    )
    found = np.linalg.eigvals(whole)
    for each in published:
        assert abs(found - each).min() < 2.5e-3
    best = max(published, key=lambda s: s.real)
    assert rightmost(person, 0.0) == pytest.approx(best, abs=2.5e-3)
    table = table_of(person)
    if lost is None:
        assert table.unstable[0] == 1
        assert table.critical_delay()[0] == 0.0
    else:
        critical, omega = table.critical_delay()[0], lost[1]
        assert critical == pytest.approx(lost[0], abs=1e-4)
        first = np.argmin(table.angle / table.frequency + (table.direction < 0.0) * 1e9)
        assert table.frequency[first] == pytest.approx(omega, abs=6e-3)


def test_park_and_three_joint_gains():
    a, g = two_link(0.878, 0.5716, 0.3145, (32.126, 48.831), (1.7992, 2.4812))
    park = of_matrices(
        a,
        np.zeros((2, 2)),
        -g,
        np.array([[950, 175], [45, 290.0]]),
        np.array([[185, 50], [60, 26.0]]),
    )
    assert table_of(park).critical_delay()[0] == pytest.approx(0.0329, abs=6e-5)
    assert rightmost(park, 0.0) == pytest.approx(-1.147 + 0.887j, abs=FOUR_DIGITS)
    pydy = sf.Body(
        segment_mass=(6.769, 17.010, 32.440), segment_inertia=(0.101, 0.282, 1.485),
        segment_length=(0.611, 0.424), segment_com=(0.387, 0.193, 0.305),
    )  # fmt: skip
    for body, p, d, gravity, critical in (
        (pydy, LQR_PYDY_P, LQR_PYDY_D, G, 0.0344),
        (sf.Body.edwards2007(), LQR_P, LQR_D, 9.8, 0.0259),
    ):
        found = sf.critical_delay(
            body, sf.Stiffness(0.0, 0.0, 0.0), gravity, feedback=sf.Feedback(p, d)
        )
        assert found == pytest.approx(critical, abs=1e-4)
