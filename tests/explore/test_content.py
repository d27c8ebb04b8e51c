"""What the page is told."""

import json
import math
from html.parser import HTMLParser
from importlib.resources import files

import numpy as np
import pytest

import standfast as sf
from standfast.anthropometry.body import REFERENCE_PEOPLE
from standfast.anthropometry.tables import ANKLE_HEIGHT
from standfast.explore.content import (
    NOMINAL,
    NOMINAL_START,
    chosen_quantities,
    content_of,
    content_text,
    plane_of,
)
from standfast.explore.sliders import round_step, start_of
from standfast.figures.choosing import CUT_AT, RUNNING_AWAY
from standfast.parameters import OWN_BODY, PARAMETERS, STANDARD_GRAVITY
from standfast.quantities import QUANTITIES
from studies import GOOD, UNEQUAL, changed

NERVES = {"feedback": {"delay": 0.1, "proportional": {"ankle": 500.0}}}


def told(content, person=None, *, atlas=False, wanted=(), **more):
    study = sf.Study.from_dict(content)
    stops = study.axes if atlas else None
    return content_of(
        study,
        start=start_of(study, person or {}, stops=stops),
        quantities=chosen_quantities(study, wanted, live=not atlas),
        stops=stops,
        **more,
    )


def rows(content):
    return {row["name"]: row for row in content["parameters"]}


def test_the_nominal_adult_has_every_parameter_and_just_stands():
    found = told(NOMINAL, NOMINAL_START)
    free = set(PARAMETERS) - set(OWN_BODY) - {"bmi"}
    assert set(rows(found)) == free
    assert {n: r["start"] for n, r in rows(found).items() if r["start"] != 0.0} == {
        "gravity": 9.80665, "body_model": "edwards2007", "height": 1.753, "mass": 75.3,
        "ankle_stiffness": 1200.0, "knee_stiffness": 2000.0, "hip_stiffness": 500.0,
    }  # fmt: skip
    body = sf.Body.from_height_mass(1.753, 75.3, "edwards2007")
    assert 1.0 < sf.safety_factor(body, sf.Stiffness(1200.0, 2000.0, 500.0)) < 1.2
    assert found["start"] == {
        "x": "ankle_stiffness", "y": "hip_stiffness", "quantity": "safety_factor",
    }  # fmt: skip
    assert {row["name"] for row in found["quantities"]} == set(QUANTITIES)
    assert (found["source"], found["served"], found["token"]) == ("formulas", False, None)


@pytest.mark.parametrize(("content", "atlas"), [
    (NOMINAL, False), (GOOD, False), (UNEQUAL, False), ({**GOOD, **NERVES}, False),
    (NOMINAL, True), (UNEQUAL, True),
])  # fmt: skip
def test_every_slider_starts_within_its_ends_and_these_within_the_table(content, atlas):
    found = told(content, atlas=atlas)
    kinds = {"range", "choice"} if not atlas else {"stops", "fixed"}
    for name, row in rows(found).items():
        assert row["kind"] in kinds
        start = math.inf if row["start"] == "inf" else row["start"]
        if row["kind"] == "range" and math.isfinite(start):
            assert PARAMETERS[name].lowest <= row["from"] <= start <= row["to"]
            assert row["to"] <= PARAMETERS[name].highest
            assert 100.0 <= (row["to"] - row["from"]) / row["step"] <= 500.0
        if row["kind"] == "stops":
            assert row["start"] in row["stops"]


def test_a_study_sets_starts_spans_and_quantities():
    found = told(changed("body.bmi", 25.0, changed("body.mass", None)))
    assert "mass" not in rows(found)
    assert rows(found)["bmi"]["start"] == 25.0
    ankle = rows(found)["ankle_stiffness"]
    assert (ankle["from"], ankle["to"]) == (0.0, 1000.0)
    assert found["quantities"][0]["name"] == found["start"]["quantity"] == "stable"
    assert len(found["quantities"]) == len(QUANTITIES)
    only = told(GOOD, wanted=["frequency", "stable"])
    assert [row["name"] for row in only["quantities"]] == ["frequency", "stable"]


def test_an_atlas_has_its_axes_and_nothing_else():
    found = told(UNEQUAL, atlas=True, token="secret")  # noqa: S106 - of the test
    study = sf.Study.from_dict(UNEQUAL)
    assert set(rows(found)) == set(study.parameters)
    for name, axis in study.axes.items():
        stops = [math.inf if stop == "inf" else stop for stop in rows(found)[name]["stops"]]
        assert stops == axis.tolist()
    assert [row["axes"] for row in found["quantities"]] == [
        list(study.axes_of(name)) for name in study.quantities
    ]
    assert (found["source"], found["served"], found["token"]) == ("atlas", True, "secret")


def test_noise_is_of_nerves_and_its_quantities_are_told_apart():
    found = told(NOMINAL, NOMINAL_START)
    sways = {row["name"] for row in found["quantities"] if row["of_noise"]}
    assert sways == {
        "ankle_sway", "knee_sway", "hip_sway", "com_sway", "cop_sway", "cop_velocity",
        "cop_frequency",
    }  # fmt: skip
    assert [row["words"] for row in found["quantities"]][-3:] == [
        "CoP sway", "CoP velocity", "CoP frequency",
    ]  # fmt: skip
    content = {**UNEQUAL, "noise": {"ankle": [1.0, 2.0]}, "output": {"quantities": ["ankle_sway"]}}
    noisy = told(content, atlas=True)
    assert rows(noisy)["ankle_noise"]["stops"] == [1.0, 2.0]


def test_an_embedded_atlas_carries_its_values():
    found = told(UNEQUAL, atlas=True, embedded={"stable": "eJw="})
    assert found["source"] == "embedded"
    assert found["embedded"]["values"] == {"stable": "eJw="}


def test_an_atlas_takes_the_nearest_value_of_a_person():
    person = {"hip_stiffness": 460.0, "body_model": "winter", "knee_stiffness": math.inf}
    start = {name: row["start"] for name, row in rows(told(UNEQUAL, person, atlas=True)).items()}
    assert start["hip_stiffness"] == pytest.approx(100.0 + 1400.0 / 6.0 * 2.0)  # of 333, 567
    assert start["body_model"] == "winter"
    assert start["knee_stiffness"] == "inf"


@pytest.mark.parametrize(("person", "words"), [
    ({"hip_stiffness": 4000.0}, "hip_stiffness = 4000 is not on its axis \\(100 to 1500\\)"),
    ({"body_model": "edwards2007"}, "not on its axis \\(de-leva-female, winter\\)"),
    ({"feedback_delay": 0.1}, "feedback_delay is no axis of the atlas"),
])  # fmt: skip
def test_what_an_atlas_does_not_hold_is_said(person, words):
    with pytest.raises(sf.InputError, match=words):
        told(UNEQUAL, person, atlas=True)


def test_a_person_has_one_of_mass_and_bmi():
    of_mass = rows(told(GOOD, {"bmi": 20.0, "height": 2.0}))
    assert of_mass["mass"]["start"] == pytest.approx(80.0)
    assert "bmi" not in of_mass
    of_bmi = changed("body.bmi", 25.0, changed("body.mass", None))
    assert rows(told(of_bmi, {"mass": 80.0, "height": 2.0}))["bmi"]["start"] == pytest.approx(20.0)
    with pytest.raises(sf.InputError, match="give mass or bmi"):
        told(GOOD, {"mass": 80.0, "bmi": 20.0})
    with pytest.raises(sf.InputError, match="BMI"):
        told(GOOD, {"mass": 600.0, "height": 1.0})


def own_body(**more):
    body = sf.Body.from_height_mass(1.8, 90.0, "winter")
    return {**GOOD, "body": body, **more}


def test_measured_segments_are_a_reference_of_height_1():
    found = told(own_body())
    body = sf.Body.from_height_mass(1.8, 90.0, "winter")
    own = found["people"]["own"]
    assert [own[name] for name in OWN_BODY] == [float(n) for part in body for n in part]
    assert (own["height"], own["mass"]) == (1.0, 1.0)
    model = rows(found)["body_model"]
    assert (model["kind"], model["start"]) == ("fixed", "own")
    assert not {"height", "mass", "bmi", *OWN_BODY} & set(rows(found))
    with pytest.raises(sf.InputError, match="height is not for a body of measured segments"):
        told(own_body(), {"height": 1.7})


def test_segments_that_vary_have_no_sliders():
    content = own_body()
    parts = {name: list(part) for name, part in content["body"]._asdict().items()}
    masses = dict(zip(("shank", "thigh", "upper_body"), parts["segment_mass"], strict=True))
    masses["shank"] = [masses["shank"], 1.1 * masses["shank"]]
    varying = {**content, "body": {**parts, "segment_mass": masses}}
    with pytest.raises(sf.InputError, match="shank_mass vary in the study"):
        told(varying)
    assert rows(told(varying, atlas=True))["shank_mass"]["kind"] == "stops"


def test_people_are_those_of_the_package():
    found = told(NOMINAL, NOMINAL_START)["people"]
    assert set(found) == set(REFERENCE_PEOPLE)
    for model, person in REFERENCE_PEOPLE.items():
        numbers = [float(n) for part in person.body for n in part]
        assert [found[model][name] for name in OWN_BODY] == numbers
        assert found[model]["height"] == person.height
        assert found[model]["mass"] == person.mass


def test_numbers_of_the_package_are_told_and_stand_in_no_script():
    constants = told(NOMINAL, NOMINAL_START)["constants"]
    assert constants["gravity"] == PARAMETERS["gravity"].default
    assert constants["ankle_height"] == ANKLE_HEIGHT
    assert (constants["running_away"], constants["cut_at"]) == (RUNNING_AWAY, CUT_AT)
    assert constants["seen"]["cop_velocity"] == {"unit": "mm/s", "factor": 1000.0}
    assert constants["seen"]["hip_sway"]["factor"] == pytest.approx(180.0 / math.pi)
    assert "cop_frequency" not in constants["seen"]
    scripts = "".join(
        file.read_text(encoding="utf-8")
        for file in (files("standfast.explore") / "page").iterdir()
        if file.name.endswith(".js")
    )
    for number in (STANDARD_GRAVITY, ANKLE_HEIGHT):
        assert str(number) not in scripts


def test_the_map_opens_on_the_axes_of_the_figures():
    feedback = {**changed("stiffness.ankle", [float(k) for k in range(9)]), "feedback": {
        "delay": {"start": 0.0, "stop": 0.3, "num": 11}, "proportional": {"ankle": 500.0},
    }}  # fmt: skip
    study = sf.Study.from_dict(feedback)
    assert plane_of(study, "stable", live=True) == ("feedback_delay", "ankle_stiffness")
    short = sf.Study.from_dict(GOOD)
    assert plane_of(short, "stable", live=True) == ("ankle_stiffness", "hip_stiffness")
    with pytest.raises(sf.InputError, match="not two axes of numbers"):
        plane_of(short, "stable", live=False)


def test_a_quantity_that_is_not_there_is_said():
    study = sf.Study.from_dict(GOOD)
    with pytest.raises(sf.InputError, match=r"no 'frequenzy'; did you mean 'frequency'\?$"):
        chosen_quantities(study, ["frequenzy"], live=True)
    with pytest.raises(sf.InputError, match="no 'frequency' \\(quantities: stable\\)"):
        chosen_quantities(study, ["frequency"], live=False)


@pytest.mark.parametrize("title", ["</script><script>alert(1)</script>", "<!-- a & b", "]]>"])
def test_a_title_cannot_leave_the_script_that_it_stands_in(title):
    text = content_text(told({**GOOD, "title": title}))
    assert not {"<", ">", "&"} & set(text)
    found = []

    class Reader(HTMLParser):
        def handle_starttag(self, tag, attrs):
            found.append(tag)

    Reader().feed(f'<script type="application/json">{text}</script>')
    assert found == ["script"]
    assert json.loads(text)["title"] == title


def test_numbers_that_json_has_not_have_words():
    found = told(changed("stiffness.knee", math.inf), subjects=[
        {"label": "S1", "values": {"knee_stiffness": np.inf, "mass": 70.0}},
    ])  # fmt: skip
    text = content_text(found)
    again = json.loads(text, parse_constant=pytest.fail)
    assert rows(again)["knee_stiffness"]["start"] == "inf"
    assert again["subjects"][0]["values"] == {"knee_stiffness": "inf", "mass": 70.0}


def test_limits_are_where_standing_ends():
    limits = {row["name"]: row["limit"] for row in told(NOMINAL, NOMINAL_START)["quantities"]}
    assert {name: limit for name, limit in limits.items() if limit is not None} == {
        "stiffness_reserve": 0.0, "safety_factor": 1.0, "eigenvalue_1": 0.0, "frequency": 0.0,
        "delay_margin": 0.0, "decay_rate": 0.0, "damping_ratio": 0.0,
    }  # fmt: skip


def test_with_gains_springs_have_no_limit_of_standing_in_an_atlas():
    names = ["safety_factor", "stiffness_reserve", "frequency", "eigenvalue_1"]
    late = ["delay_margin", "decay_rate", "damping_ratio"]
    content = {**UNEQUAL, "output": {"quantities": [*names, *late]}}
    for more, without in (({}, set()), (NERVES, set(names))):
        found = told({**content, **more}, atlas=True)["quantities"]
        assert {row["name"] for row in found if row["limit"] is None} == without


@pytest.mark.parametrize(("size", "step"), [(1.0, 1.0), (9.9, 5.0), (0.0499, 0.02), (25.0, 20.0)])
def test_steps_are_round(size, step):
    assert round_step(size) == step


def test_what_jumps_from_a_root_or_a_mode_to_another_has_no_contours():
    jumping = {row["name"] for row in told(UNEQUAL)["quantities"] if row["jumps"]}
    modes = {"hip_ankle_ratio", "knee_ankle_ratio"}
    assert jumping == {"sway_frequency", "damping_ratio", *modes}
