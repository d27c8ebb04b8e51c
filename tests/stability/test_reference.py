"""Every row of the reference tables: published numbers, and numbers checked with other programs."""

import math

import numpy as np
import pytest

import standfast as sf
from standfast.edwards2007 import published
from standfast.stability import springs

GRAVITY = 9.8
RIGID = math.inf
NOMINAL = sf.Body.edwards2007()
FIGURE_4 = sf.Stiffness(950.0, 2000.0, 738.0)


def printed(value: float, text: str) -> bool:
    """Whether the value rounds to the text as it was printed."""
    return f"{value:.{len(text.partition('.')[2])}f}" == text


def test_listed_values_are_the_papers():
    np.testing.assert_array_equal(NOMINAL.segment_mass, [6.478, 15.059, 51.648])
    np.testing.assert_array_equal(NOMINAL.segment_inertia, [0.122, 0.291, 3.012])
    np.testing.assert_array_equal(NOMINAL.segment_length, [0.431, 0.430])
    np.testing.assert_array_equal(NOMINAL.segment_com, [0.245, 0.244, 0.356])


def test_nominal_person_is_its_own_scaling():
    same = sf.Body.from_height_mass(1.753, 75.3, "edwards2007")
    for ours, listed in zip(same, NOMINAL, strict=True):
        np.testing.assert_array_equal(ours, listed)


@pytest.mark.parametrize(
    ("compute", "text"),
    [
        (lambda: springs.critical_ankle_stiffness(NOMINAL, RIGID, RIGID, GRAVITY), "731.154"),
        (lambda: springs.critical_hip_stiffness(NOMINAL, RIGID, RIGID, GRAVITY), "180.190"),
        (lambda: published.mass_above_ankle(NOMINAL), "73.185"),
        (lambda: published.centre_of_mass(NOMINAL), "1.01944"),
        (lambda: published.inertia_about_com(NOMINAL), "11.1126"),
        (lambda: published.inertia_about_ankle(NOMINAL), "87.170"),
        (lambda: springs.critical_hip_stiffness(NOMINAL, 1118.0, 2000.0, GRAVITY), "399.475"),
        (lambda: springs.critical_knee_stiffness(NOMINAL, 2000.0, 2000.0, GRAVITY), "614.77"),
        (lambda: published.angular_frequency(NOMINAL, FIGURE_4) / math.tau, "0.00365"),
        # 737.4 in some notes; 737.556 also follows from the reserve, 738 − 0.06323 |v|²/v_h²
        (lambda: springs.critical_hip_stiffness(NOMINAL, 950.0, 2000.0, GRAVITY), "737.556"),
        (lambda: published.hip_ankle_ratio(NOMINAL, 0), "0.42848"),
        (lambda: published.angular_frequency(NOMINAL, FIGURE_4, 1) / math.tau, "2.72682"),
        (lambda: published.hip_ankle_ratio(NOMINAL, 1), "-2.45953"),
        (lambda: sf.stiffness_reserve(NOMINAL, FIGURE_4, GRAVITY), "0.0632283"),
    ],
)
def test_computed_column(compute, text):
    assert printed(float(compute()), text)


def test_matrix_a():
    expected = np.array(
        [
            [87.1703835, 55.1877315, 25.3885993],
            [55.1877315, 36.1074804, 17.4639368],
            [25.3885993, 17.4639368, 9.5576609],
        ]
    )
    np.testing.assert_allclose(sf.inertia_matrix(NOMINAL), expected, atol=0.5e-7, rtol=0)


def test_gravity_loads():
    c = sf.stiffness_matrix(NOMINAL, sf.Stiffness(0.0, 0.0, 0.0), GRAVITY)
    np.testing.assert_allclose(
        -c[0], [731.1539998, 433.8432952, 180.1895424], atol=0.5e-7 + 2e-7, rtol=0
    )


def test_eigenvalues_and_shapes():
    result = sf.modes(NOMINAL, FIGURE_4, GRAVITY)
    assert f"{result.eigenvalues[0]:.5e}" == "5.24803e-04"
    assert printed(result.eigenvalues[1], "293.54400")
    assert printed(result.eigenvalues[2], "8608.51854")
    expected = [[1, 0.326334, 0.428479], [1, -0.396556, -2.459528], [1, -2.267707, 1.500183]]
    np.testing.assert_allclose(result.shapes.T, expected, atol=0.5e-6, rtol=0)


@pytest.mark.parametrize(
    ("knee", "row"),
    [
        (700.0, [RIGID, RIGID, RIGID, 3943.98, 702.032]),
        (800.0, [RIGID, RIGID, RIGID, 877.137, 474.202]),
        (1000.0, [RIGID, RIGID, 980.200, 469.655, 345.713]),
        (2000.0, [1288.896, 557.073, 352.779, 282.546, 247.016]),
        (RIGID, [372.485, 300.959, 249.441, 222.419, 205.778]),
    ],
)
def test_critical_hip_stiffness(knee, row):
    ours = [
        sf.critical_stiffness(NOMINAL, sf.Stiffness(ankle, knee, 0.0), GRAVITY).hip
        for ankle in (900.0, 1000.0, 1200.0, 1500.0, 2000.0)
    ]
    np.testing.assert_allclose(ours, row, atol=0.0051, rtol=0)


@pytest.mark.parametrize(
    ("height", "omegas", "critical_bmi"),
    [
        (1.611, [2.6952, 2.2121, 1.7647, 1.3149, 0.7875], 31.985),
        (1.753, [1.8058, 1.2520, 0.5442, -0.8332, -1.2198], 24.825),
        (1.895, [0.8550, -0.7153, -1.2024, -1.4745, -1.6610], 19.652),
    ],
)
def test_figure_5(height, omegas, critical_bmi):
    def omega(bmi):
        body = sf.Body.from_height_mass(height, bmi * height**2, "edwards2007")
        return published.angular_frequency(body, published.FIGURE_5)

    np.testing.assert_allclose(
        [omega(bmi) for bmi in (18.0, 21.0, 24.0, 27.0, 30.0)], omegas, atol=0.51e-4, rtol=0
    )
    assert omega(critical_bmi - 0.0005) > 0.0 > omega(critical_bmi + 0.0005)


@pytest.mark.parametrize(
    ("knee", "ankle", "hip"),
    [
        (700.0, 1912.24, 776.08),
        (800.0, 1638.88, 662.55),
        (1000.0, 1381.87, 555.81),
        (2000.0, 1081.44, 431.02),
    ],
)
def test_equal_rotation_points(knee, ankle, hip):
    ours = sf.equal_rotation(NOMINAL, knee, GRAVITY)
    np.testing.assert_allclose(ours, [ankle, hip], atol=0.0051, rtol=0)
    shape = sf.modes(NOMINAL, sf.Stiffness(ours[0], knee, ours[1]), GRAVITY).shapes[:, 0]
    assert shape[2] == pytest.approx(1.0, abs=1e-9)
