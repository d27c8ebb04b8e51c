"""Coupling as axes of a study: every quantity as Python gives it, in a file that others open."""

import itertools

import numpy as np
import pytest
import xarray

import standfast as sf
from standfast.quantities import QUANTITIES
from studies import GOOD, UNEQUAL, changed

# A grid and a single person round in another order: relative, and for numbers near 0 absolute.
RTOL, ATOL = 1e-10, 1e-9
OF_PYTHON = {
    "stable": sf.is_stable,
    "stability_determinant": sf.stability_determinant,
    "critical_ankle_stiffness": lambda *person: sf.critical_stiffness(*person).ankle,
    "critical_knee_stiffness": lambda *person: sf.critical_stiffness(*person).knee,
    "critical_hip_stiffness": lambda *person: sf.critical_stiffness(*person).hip,
    "stiffness_reserve": sf.stiffness_reserve,
    "safety_factor": sf.safety_factor,
    "eigenvalue_1": lambda *person: sf.modes(*person).eigenvalues[0],
    "eigenvalue_2": lambda *person: sf.modes(*person).eigenvalues[1],
    "eigenvalue_3": lambda *person: sf.modes(*person).eigenvalues[2],
    "frequency": sf.frequency,
    "growth_rate": sf.growth_rate,
    "hip_ankle_ratio": lambda *person: sf.modes(*person).shapes[2, 0],
    "knee_ankle_ratio": lambda *person: sf.modes(*person).shapes[1, 0],
}
COUPLED = {
    "title": "Coupled",
    "gravity": 9.8,
    "body": {"model": "edwards2007", "height": 1.753, "mass": 75.3},
    "stiffness": {
        "ankle": [700.0, 1000.0, 1500.0],
        "knee": [1000.0, 2000.0, np.inf],
        "hip": [300.0, 738.0],
        "ankle_knee": [0.0, 30.0, 100.0],
        "knee_hip": {"start": -40, "stop": 80, "num": 4},
        "ankle_hip": 12.5,
    },
    "output": {"quantities": list(OF_PYTHON)},
}


@pytest.fixture(scope="module")
def opened(tmp_path_factory):
    path = tmp_path_factory.mktemp("coupled") / "coupled.h5"
    sf.sweep(sf.Study.from_dict(COUPLED), path)
    with xarray.open_dataset(path, engine="h5netcdf") as dataset:
        yield dataset


def person_at(dataset, index):
    names = ("ankle", "knee", "hip", "ankle_knee", "knee_hip", "ankle_hip")
    at = {name: dataset[f"{name}_stiffness"] for name in names}
    values = {n: float(v[index[v.dims[0]]] if v.dims else v) for n, v in at.items()}
    return sf.Body.edwards2007(), sf.Stiffness(**values), 9.8


def test_every_quantity_is_that_of_python(opened):
    assert set(OF_PYTHON) <= set(QUANTITIES)
    worst = dict.fromkeys(OF_PYTHON, 0.0)
    axes = opened.stable.dims
    assert len(axes) == 5
    places = list(itertools.product(*(range(n) for n in opened.stable.shape)))
    for place in places[::5]:  # 5 divides no axis, so all their values come up
        index = dict(zip(axes, place, strict=True))
        person = person_at(opened, index)
        for name, function in OF_PYTHON.items():
            variable = opened[name]
            found = float(variable[{axis: index[axis] for axis in variable.dims}])
            wanted = float(function(*person))
            assert found == pytest.approx(wanted, rel=RTOL, abs=ATOL), (name, person)
            if np.isfinite(wanted):
                worst[name] = max(worst[name], abs(found))
    assert min(worst.values()) > 0.0


def test_axes_of_coupling_have_their_units_and_values(opened):
    assert opened.ankle_knee_stiffness.values.tolist() == [0.0, 30.0, 100.0]
    assert opened.ankle_knee_stiffness.attrs["units"] == "N·m/rad"
    assert float(opened.ankle_hip_stiffness) == 12.5
    assert opened.critical_ankle_stiffness.dims == (
        "knee_stiffness", "hip_stiffness", "ankle_knee_stiffness", "knee_hip_stiffness",
    )  # fmt: skip


def test_damping_and_feedback_change_nothing_of_springs():
    """What springs give has no axis of them; the file names them."""
    content = {**GOOD, "damping": {"ankle": [0.0, 10.0]}}
    content = changed("output.quantities", ["safety_factor", "frequency"], content)
    found = sf.compute(sf.Study.from_dict(content))
    plain = sf.compute(sf.Study.from_dict(changed("damping", None, content)))
    for name in ("safety_factor", "frequency"):
        assert found[name].dims == ("ankle_stiffness",)
        np.testing.assert_array_equal(found[name].values, plain[name].values)


def test_a_coupling_of_zero_is_none():
    """Given as one value 0 it leaves every bit as it is, since nothing of it is computed."""
    names = ["stable", "critical_hip_stiffness", "safety_factor", "stiffness_reserve"]
    content = changed("output.quantities", names, UNEQUAL)
    plain = sf.compute(sf.Study.from_dict(content))
    zero = sf.compute(sf.Study.from_dict(changed("stiffness.knee_hip", 0.0, content)))
    for name in names:
        np.testing.assert_array_equal(zero[name].values, plain[name].values)


def test_verdicts_on_an_axis_of_coupling_are_at_zero_those_of_plain_springs():
    content = changed("output.quantities", ["stable"], UNEQUAL)
    plain = sf.compute(sf.Study.from_dict(content))["stable"]
    axis = sf.compute(sf.Study.from_dict(changed("stiffness.ankle_hip", [-9.0, 0.0, 9.0], content)))
    at_zero = axis["stable"].sel(ankle_hip_stiffness=0.0).transpose(*plain.dims)
    np.testing.assert_array_equal(at_zero.values, plain.values)
