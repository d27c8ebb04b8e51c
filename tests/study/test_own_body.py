"""A study of a body given segment by segment: the same numbers as that body gets anywhere else."""

import math
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest

import standfast as sf
from standfast.engine.grid import Evaluator
from standfast.parameters import OWN_BODY, PARAMETERS, SEGMENT_NUMBERS
from standfast.quantities import QUANTITIES
from standfast.stability.exact import exact_threshold
from standfast.thresholds.planes import planes_of

STUDY = Path(__file__).parents[2] / "studies" / "own-body.toml"
MEASURED = sf.Body(
    segment_mass=(5.6, 14.2, 46.8),
    segment_inertia=(0.085, 0.24, 2.72),
    segment_length=(0.385, 0.405),
    segment_com=(0.22, 0.235, 0.344),
)
STIFFNESS = {
    "ankle": {"start": 300, "stop": 1500, "num": 7},
    "knee": [900.0, 1500.0, math.inf],
    "hip": [200.0, 400.0],
}
# Quantities that springs decide; the same functions of one person, mapped and not.
RTOL = 1e-12


def study_of(body, **more):
    return sf.Study.from_dict({"body": body, "stiffness": STIFFNESS, "gravity": 9.81, **more})


def test_measured_segments_decide_who_falls():
    stiffness = sf.Stiffness(900.0, 1500.0, 400.0)
    scaled = sf.Body.from_height_mass(1.66, 68.0)
    assert round(float(sf.safety_factor(scaled, stiffness)), 3) == 1.050
    assert round(float(sf.safety_factor(MEASURED, stiffness)), 3) == 0.971
    study = sf.Study.from_toml(STUDY)
    of_grid = sf.compute(study).sel(ankle_stiffness=900, knee_stiffness=1500, hip_stiffness=400)
    assert not of_grid.stable
    assert round(float(of_grid.safety_factor), 3) == 0.971


def test_every_quantity_is_that_of_the_body_alone():
    names = [row.name for row in QUANTITIES.values() if row.reference is not None]
    study = study_of(MEASURED, output={"quantities": names})
    found = sf.compute(study)
    functions = {
        "stable": sf.is_stable,
        "stiffness_reserve": sf.stiffness_reserve,
        "safety_factor": sf.safety_factor,
        "stability_determinant": sf.stability_determinant,
        "critical_ankle_stiffness": lambda *of: sf.critical_stiffness(*of).ankle,
        "critical_hip_stiffness": lambda *of: sf.critical_stiffness(*of).hip,
        "eigenvalue_1": lambda *of: sf.modes(*of).eigenvalues[0],
        "eigenvalue_3": lambda *of: sf.modes(*of).eigenvalues[2],
    }
    for name, function in functions.items():
        for index in np.ndindex(7, 3, 2):
            springs = [study.axes[f"{j}_stiffness"][i] for j, i in zip(
                ("ankle", "knee", "hip"), index, strict=True)]  # fmt: skip
            wanted = function(MEASURED, sf.Stiffness(*springs), 9.81)
            at = dict(zip((f"{j}_stiffness" for j in ("ankle", "knee", "hip")), index, strict=True))
            value = found[name].isel({axis: at[axis] for axis in found[name].dims})
            np.testing.assert_allclose(float(value), float(wanted), rtol=RTOL, err_msg=name)


def test_it_may_be_given_in_three_ways():
    by_lists = {name: part.tolist() for name, part in MEASURED._asdict().items()}
    by_segment = {
        part: {PARAMETERS[name].key: value for name, value in zip(names, values, strict=True)}
        for (part, names), values in zip(SEGMENT_NUMBERS.items(), MEASURED, strict=True)
    }
    studies = [study_of(body) for body in (MEASURED, by_lists, by_segment)]
    assert len({study.fingerprint for study in studies}) == 1
    study = studies[0]
    assert sf.Study.from_canonical(study.canonical) == study
    assert [study.fixed[name] for name in OWN_BODY] == [v for part in MEASURED for v in part]
    assert "body_model" not in study.parameters
    other = study_of(MEASURED._replace(segment_com=(0.22, 0.235, 0.345)))
    assert other.fingerprint != study.fingerprint
    assert study.difference(other) == "upper_body_com: 0.345 there, 0.344 here"


def test_a_difference_of_bodies_is_short():
    study, scaled = study_of(MEASURED), study_of({"height": 1.66, "mass": 68})
    assert study.difference(scaled) == (
        "body: scaled from height and mass there, own segments here"
    )
    assert scaled.difference(study) == (
        "body: own segments there, scaled from height and mass here"
    )
    grown = [1.01 * part for part in MEASURED[:3]]
    other = study_of(sf.Body(*grown, MEASURED.segment_com))
    assert study.difference(other) == (
        "body: other segments there (shank_mass, thigh_mass, … of 8 numbers)"
    )


def test_a_segment_may_vary_and_stands_in_the_file(tmp_path):
    body = {**MEASURED._asdict(), "segment_mass": [5.6, 14.2, {"start": 40, "stop": 50, "num": 5}]}
    study = study_of(body, output={"quantities": ["critical_ankle_stiffness"]})
    assert study.axes_of("critical_ankle_stiffness") == (
        "upper_body_mass", "knee_stiffness", "hip_stiffness",
    )  # fmt: skip
    atlas = sf.sweep(study, tmp_path / "own.h5").to_xarray()
    assert atlas.upper_body_mass.attrs["units"] == "kg"
    assert float(atlas.thigh_com) == 0.235
    for mass in study.axes["upper_body_mass"]:
        one = MEASURED._replace(segment_mass=(5.6, 14.2, float(mass)))
        wanted = sf.critical_stiffness(one, sf.Stiffness(900.0, 1500.0, 400.0), 9.81).ankle
        got = atlas.critical_ankle_stiffness.sel(
            upper_body_mass=mass, knee_stiffness=1500, hip_stiffness=400
        )
        np.testing.assert_allclose(float(got), float(wanted), rtol=RTOL)


def test_verdicts_at_the_threshold_are_those_of_fractions():
    """Ankles ulp by ulp through the exact threshold, which plain rationals give anew here."""
    given = dict(zip(OWN_BODY, (float(v) for part in MEASURED for v in part), strict=True))
    exactly = {name: Fraction(value) for name, value in given.items()}
    g, knee, hip = Fraction(9.81), Fraction(1500), Fraction(400)
    upper = g * exactly["upper_body_mass"] * exactly["upper_body_com"]
    thigh = g * (
        exactly["thigh_mass"] * exactly["thigh_com"]
        + exactly["upper_body_mass"] * exactly["thigh_length"]
    )
    shank = g * (
        exactly["shank_mass"] * exactly["shank_com"]
        + (exactly["thigh_mass"] + exactly["upper_body_mass"]) * exactly["shank_length"]
    )
    at_knee = thigh + upper * hip / (hip - upper)
    threshold = shank + at_knee * knee / (knee - at_knee)
    springs = {"knee_stiffness": 1500.0, "hip_stiffness": 400.0}
    assert exact_threshold({**given, "gravity": 9.81, **springs}) == threshold
    ankles = [float(threshold)]
    for _ in range(40):
        ankles = [math.nextafter(ankles[0], 0.0), *ankles, math.nextafter(ankles[-1], math.inf)]
    study = sf.Study.from_dict(
        {
            "body": MEASURED,
            "gravity": 9.81,
            "stiffness": {"ankle": ankles, "knee": 1500.0, "hip": 400.0},
        }
    )
    evaluator = Evaluator(study)
    (found,) = evaluator(study.grid.tile(0, 0))
    assert found[: len(ankles)].tolist() == [int(Fraction(k) > threshold) for k in ankles]
    assert evaluator.resolved_exactly > 0


def test_a_body_that_nobody_has_is_refused():
    for changes, sentence in (
        ({"segment_com": [0.4, 0.235, 0.344]}, "the centre of mass of the shank lies 0.4 m above"),
        ({"segment_inertia": [0.085, 0.24, 27.2]}, "the upper body of 46.8 kg and 27.2 kg·m² has"),
        ({"segment_mass": [0.5, 0.6, 0.7]}, "the shank of 0.5 kg and 0.085 kg·m² has a radius"),
        ({"segment_mass": [5.6, 14.2, 690.0]}, "the segments weigh 709.8 kg together, and a pers"),
        ({"segment_mass": [5.6, -14.2, 46.8]}, "body.segment_mass.thigh = -14.2 is outside the"),
        ({"segment_length": [38.5, 40.5]}, "body.segment_length.shank = 38.5 is outside the all"),
        ({"segment_mass": [5.6, 14.2]}, "body.segment_mass = [5.6, 14.2] is not 3 numbers; give "),
        ({"segment_mass": 66.0}, "body.segment_mass = 66.0 is not 3 numbers; give shank, thigh"),
        ({"segment_mass": {"shin": 5.6}}, "[body.segment_mass] has no key 'shin'"),
        ({"segment_mass": {"shank": 5.6}}, "body.segment_mass.thigh is missing; a body of its own"),
        ({"height": 1.66}, "[body] has own segments and height; give all segments of the person"),
        ({"height": [1.6, 1.7], "mass": 68}, "[body] has own segments and height and mass; give"),
        ({"model": "winter"}, "[body] has own segments and model; give all segments of the pers"),
        (
            {"segment_length": [{"start": 0.2, "stop": 0.4, "num": 3}, 0.405]},
            "the centre of mass of the shank lies 0.22 m above its lower end, but the shank is 0.2",
        ),
    ):
        with pytest.raises(sf.InputError) as caught:
            study_of({**MEASURED._asdict(), **changes})
        assert sentence in str(caught.value)


@pytest.mark.parametrize(
    ("changes", "hint"),
    [
        ({"segment_mass": [5600, 14200, 46800]}, "5600 looks like grams, write 5.6"),
        ({"segment_length": [38.5, 40.5]}, "38.5 looks like centimetres, write 0.385"),
        ({"segment_length": [385, 405]}, "385 looks like millimetres, write 0.385"),
        ({"segment_com": [22, 23.5, 34.4]}, "22 looks like centimetres, write 0.22"),
        ({"segment_com": [190, 235, 344]}, "190 looks like millimetres, write 0.19"),
        ({"segment_inertia": [850, 2400, 27200]}, "2400 looks like kg·cm², write 0.24"),
        ({"segment_inertia": [850, 0.24, 2.72]}, "mass; in kg·cm²? write 0.085"),
        ({"segment_mass": ["5,6", 14.2, 46.8]}, "decimals have a point, write 5.6"),
    ],
)
def test_a_slip_of_units_is_guessed(changes, hint):
    with pytest.raises(sf.InputError) as caught:
        study_of({**MEASURED._asdict(), **changes})
    assert str(caught.value).endswith(hint)


def test_its_limits_are_those_of_the_body():
    planes = list(planes_of(sf.Study.from_toml(STUDY)))
    assert len(planes) == 3
    assert all(plane.body == MEASURED for plane in planes)
