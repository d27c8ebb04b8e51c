"""With what a page opens: an atlas at a person who stands, where there is one on its map."""

import math

import numpy as np
import pytest

import standfast as sf
from standfast.anthropometry.body import REFERENCE_PEOPLE
from standfast.explore.opening import (
    is_of_springs_alone,
    springs_first,
    standing_start,
    standing_start_of_study,
)
from standfast.explore.planes import Planes
from standfast.explore.sliders import start_of
from standfast.quantities import QUANTITIES, Person
from studies import GOOD

ANKLE, HIP = "ankle_stiffness", "hip_stiffness"
# At 300 of 4 values nobody stands; else the middle of the map falls, and its stiff corner stands.
AXES = {
    "ankle": [100.0, 200.0, 300.0, 500.0, 1100.0, 1300.0, 1500.0],
    "knee": [300.0, 1000.0, 2000.0, 4000.0],
    "hip": [50.0, 100.0, 150.0, 200.0, 500.0, 800.0],
}


def swept(folder, quantities):
    content = {**GOOD, "stiffness": AXES, "output": {"quantities": quantities}}
    return sf.sweep(content, folder / f"{quantities[0]}.h5")


@pytest.fixture(scope="module")
def atlas(tmp_path_factory):
    return swept(tmp_path_factory.mktemp("opening"), ["stable"])


def opened(atlas, person=None, stops=None):
    stops = stops or atlas.axes
    start = start_of(atlas.study, person or {}, stops=stops)
    planes = Planes(atlas)
    found = standing_start(planes, stops, start, (ANKLE, HIP))
    planes.close()
    return start, found


def stands(atlas, at):
    index = tuple(int(np.flatnonzero(axis == at[name])[0]) for name, axis in atlas.axes.items())
    return bool(np.asarray(atlas["stable"])[index])


def test_an_atlas_opens_at_who_stands_well_inside_the_limit(atlas):
    start, found = opened(atlas)
    assert not stands(atlas, start)
    assert stands(atlas, found)
    changed = {name for name in start if start[name] != found[name]}
    assert changed == {ANKLE, HIP}
    softer = {**found, ANKLE: AXES["ankle"][AXES["ankle"].index(found[ANKLE]) - 1]}
    assert stands(atlas, softer)


def test_who_stands_at_the_start_stays(atlas):
    start, found = opened(atlas, {"ankle_stiffness": 1500.0, "hip_stiffness": 800.0})
    assert stands(atlas, start)
    assert found == start


def test_where_nobody_stands_the_middle_stays(atlas):
    start, found = opened(atlas, {"knee_stiffness": 300.0})
    knee = np.asarray(atlas["stable"])[:, 0]
    assert not knee.any()
    assert found == start


def test_of_a_thinned_atlas_only_values_that_the_page_has_are_taken(atlas):
    stops = {name: axis[::2] if name == ANKLE else axis for name, axis in atlas.axes.items()}
    _, found = opened(atlas, stops=stops)
    assert found[ANKLE] in stops[ANKLE]
    assert stands(atlas, found)


def test_a_margin_tells_who_stands_too_and_a_threshold_does_not(atlas, tmp_path):
    _, by_verdict = opened(atlas)
    for quantity in ("safety_factor", "stiffness_reserve"):
        assert opened(swept(tmp_path, [quantity]))[1] == by_verdict
    start, found = opened(swept(tmp_path, ["critical_hip_stiffness"]))
    assert found == start


def test_with_gains_feedback_tells_who_stands_and_springs_do_not(tmp_path):
    """At the start the springs are too soft for gravity, and feedback may hold the person."""
    gains = {"proportional": {"ankle": 600.0}, "derivative": {"ankle": 250.0}}

    def opened_with(quantity, soft):
        content = {
            **GOOD, "stiffness": {"ankle": soft, "knee": math.inf, "hip": [50.0, 3000.0, 9000.0]},
            "damping": {"hip": 50.0}, "feedback": {"delay": 0.1, **gains},
            "output": {"quantities": [quantity]},
        }  # fmt: skip
        start, found = opened(
            sf.sweep(content, tmp_path / f"{quantity}.h5"),
            {"ankle_stiffness": soft[0], "hip_stiffness": 50.0},
        )
        body = sf.Body.from_height_mass(start["height"], start["mass"], start["body_model"])
        late = sf.Feedback((600.0, 0.0, 0.0), (250.0, 0.0, 0.0), 0.1)

        def stands(at, **fed_back):
            K = sf.Stiffness(at[ANKLE], math.inf, at[HIP])
            return sf.is_stable(body, K, at["gravity"], damping=(0.0, 0.0, 50.0), **fed_back)

        assert not stands(start, feedback=late)
        return start, found, stands(found), stands(found, feedback=late)

    for quantity in ("decay_rate", "delay_margin", "damping_ratio"):
        _, _, by_springs, fed_back = opened_with(quantity, [200.0, 400.0, 500.0])
        assert (by_springs, fed_back) == (False, True)
    for quantity in ("safety_factor", "stiffness_reserve", "frequency", "eigenvalue_1"):
        start, found, _, _ = opened_with(quantity, [200.0, 400.0, 1500.0])  # 1500 holds by itself
        assert found == start


FEEDBACK = {
    "delay": {"start": 0.0, "stop": 0.8, "num": 81},
    "proportional": {"ankle": {"start": 0.0, "stop": 900.0, "num": 31}},
    "derivative": {"ankle": 200.0},
}
DELAY, GAIN = "feedback_delay", "ankle_proportional_gain"


def start_of_study(changes, plane, *, by_springs=False):
    study = sf.Study.from_dict({**GOOD, **changes})
    start = start_of(study, {})
    found = standing_start_of_study(study, start, plane, by_springs=by_springs)
    return study, start, found


def test_a_study_of_springs_opens_at_who_stands():
    _, start, found = start_of_study({"stiffness": AXES}, (ANKLE, HIP))
    assert {name for name in start if start[name] != found[name]} == {ANKLE, HIP}
    body = sf.Body.from_height_mass(start["height"], start["mass"], start["body_model"])

    def falls(at):
        K = sf.Stiffness(at[ANKLE], at["knee_stiffness"], at[HIP])
        return not sf.is_stable(body, K, gravity=at["gravity"])

    assert falls(start)
    assert not falls(found)
    # an axis that the study fixes is left alone
    fixed = {**AXES, "ankle": 100.0, "knee": 300.0}
    _, start, found = start_of_study({"stiffness": fixed}, (ANKLE, HIP))
    assert found == start


def test_a_study_of_feedback_opens_at_who_stands_with_it():
    changes = {
        "stiffness": {"ankle": 500.0, "knee": math.inf, "hip": math.inf}, "feedback": FEEDBACK,
    }  # fmt: skip
    study, start, found = start_of_study(changes, (DELAY, GAIN))
    assert {name for name in start if start[name] != found[name]} == {DELAY, GAIN}
    at = {**found, "body_model": REFERENCE_PEOPLE[found["body_model"]]}
    assert QUANTITIES["delay_margin"].of_one_joint(Person.of(at)) > 0.0
    assert found[DELAY] in study.axes[DELAY]
    # feedback is nothing to a page of springs alone, and without stiffness nobody stands
    _, start, found = start_of_study(
        {**changes, "stiffness": {"ankle": 0.0, "knee": math.inf, "hip": math.inf}},
        (DELAY, GAIN),
        by_springs=True,
    )
    assert found == start


def test_a_measured_body_opens_at_who_stands():
    body = sf.Body.from_height_mass(1.8, 90.0, "winter")
    _, start, found = start_of_study({"body": body, "stiffness": AXES}, (ANKLE, HIP))
    K = sf.Stiffness(found[ANKLE], found["knee_stiffness"], found[HIP])
    assert start != found
    assert sf.is_stable(body, K, gravity=found["gravity"])


def test_what_springs_alone_decide_comes_first():
    names = springs_first(["stable", "critical_delay", "frequency", "cop_sway", "safety_factor"])
    assert names[:2] == ("safety_factor", "frequency")


@pytest.mark.parametrize(("changes", "alone"), [
    ({}, False),
    ({"feedback": {"delay": 0.1, "proportional": {"ankle": 500.0}}}, True),
])  # fmt: skip
def test_feedback_of_several_joints_leaves_springs_alone(changes, alone):
    assert is_of_springs_alone(sf.Study.from_dict({**GOOD, **changes})) == alone
