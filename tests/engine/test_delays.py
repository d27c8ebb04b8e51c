"""Grids of delayed feedback against the functions of one person, and verdicts of springs."""

import itertools
import math
from typing import Any

import numpy as np
import pytest

import standfast as sf
from delay_oracles import crossings_by_pencil
from delay_people import random_persons
from standfast.engine import delays as engine
from standfast.engine.grid import Evaluator
from standfast.engine.mapping import in_batches
from standfast.quantities import QUANTITIES
from standfast.stability.delay.persons import all_crossings
from standfast.stability.sway.persons import variances
from standfast.study import grid

# Two compilers of one formula round differently; what they find differs by this at most.
LAST_DIGITS = 1e-9

CHART: dict[str, Any] = {
    "title": "Every quantity of feedback, on unequal axes",
    "gravity": 9.8,
    "stiffness": {"knee": [1500.0, math.inf], "ankle": 450.0, "hip": [600.0, math.inf]},
    "feedback": {
        "derivative": {"ankle": [0.0, 250.0, 400.0], "hip": 20.0},
        "delay": [0.0, 0.03, 0.1, 0.25, 0.6],
        "proportional": {"ankle": [0.0, 300.0, 500.0, 800.0], "hip_ankle": 30.0},
    },
    "damping": {"ankle": 10.0, "knee": 15.0, "hip": 12.0},
    "body": {"model": "edwards2007", "height": [1.6, 1.9], "bmi": 23.0},
    "output": {"quantities": [name for name, row in QUANTITIES.items() if row.fed_back]},
}
SPRINGS_AT_ZERO: dict[str, Any] = {
    **CHART,
    "stiffness": {
        "ankle": {"start": 300, "stop": 1500, "num": 23},
        "knee": [500.0, 2000.0, math.inf],
        "hip": {"start": 100, "stop": 900, "num": 7},
    },
    "feedback": {"proportional": {"ankle": [0.0, 400.0]}, "derivative": {"ankle": [0.0, 100.0]}},
    "output": {"quantities": ["stable"]},
}


def whole(study: sf.Study) -> dict[str, np.ndarray]:
    atlas = sf.compute(study)
    return {name: np.asarray(atlas[name]) for name in study.quantities}


def points(study: sf.Study, count: int = 60):
    """Yield some persons with feedback, and of each quantity the index of its value."""
    everyone = list(itertools.product(*(range(len(axis)) for axis in study.axes.values())))
    chosen = np.random.default_rng(12).permutation(len(everyone))[:count]
    for place in (everyone[number] for number in chosen):
        at = dict(zip(study.axes, place, strict=True))
        given = {**study.fixed, **{name: study.axes[name][i] for name, i in at.items()}}
        mass = given["bmi"] * given["height"] ** 2
        body = sf.Body.from_height_mass(given["height"], mass, given["body_model"])
        stiffness = sf.Stiffness(*(given[f"{j}_stiffness"] for j in ("ankle", "knee", "hip")))

        def gains(kind: str, given: dict[str, Any] = given) -> list[list[float]]:
            joints = ("ankle", "knee", "hip")
            names = [[r if r == c else f"{r}_{c}" for c in joints] for r in joints]
            return [[float(given.get(f"{n}_{kind}_gain", 0.0)) for n in row] for row in names]

        fed_back = sf.Feedback(
            gains("proportional"), gains("derivative"), float(given.get("feedback_delay", 0.0))
        )
        damping = [float(given.get(f"{j}_damping", 0.0)) for j in ("ankle", "knee", "hip")]
        index = {q: tuple(at[axis] for axis in study.axes_of(q)) for q in study.quantities}
        person = {"gravity": given["gravity"], "damping": damping, "feedback": fed_back}
        yield body, stiffness, person, index


@pytest.fixture(scope="module", params=["compiled", "at once"])
def chart(request):
    """The chart in small chunks, compiled and not."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(grid, "FED_BACK_PERSONS", 64)
        patch.setattr(grid, "FED_BACK_NUMBERS", 256)
        patch.setattr(engine, "FEW", 0 if request.param == "compiled" else 10**9)
        content = CHART
        if request.param == "compiled":  # each number of free joints compiles anew
            content = {**CHART, "stiffness": {**CHART["stiffness"], "hip": 600.0}}
        study = sf.Study.from_dict(content)
        return study, whole(study)


def test_every_quantity_equals_the_function_of_one_person(chart):
    study, arrays = chart
    for body, stiffness, person, index in points(study):
        found = {name: arrays[name][index[name]] for name in study.quantities}
        assert found["stable"] == sf.is_stable(body, stiffness, **person)
        assert found["unstable_roots"] == sf.unstable_roots(body, stiffness, **person)
        delay = sf.critical_delay(body, stiffness, **person)
        assert found["critical_delay"] == pytest.approx(delay, rel=LAST_DIGITS)
        own = person["feedback"].delay
        assert found["delay_margin"] == pytest.approx(delay - own, abs=LAST_DIGITS)
        root = sf.rightmost_root(body, stiffness, **person)
        near = LAST_DIGITS * (1.0 + abs(root)) ** 2
        assert found["decay_rate"] == pytest.approx(-root.real, abs=near)
        assert found["sway_frequency"] == pytest.approx(root.imag / math.tau, abs=near)
        assert found["damping_ratio"] == pytest.approx(-root.real / abs(root), abs=near)


def test_the_chart_has_both_verdicts_and_delays_of_all_kinds(chart):
    _, arrays = chart
    assert 0.05 < arrays["stable"].mean() < 0.95
    delays = arrays["critical_delay"]
    assert (delays == 0.0).any()
    assert ((delays > 0.0) & np.isfinite(delays)).any()
    assert arrays["unstable_roots"].max() > 2


def test_a_verdict_is_a_decay_that_is_positive(chart):
    _, arrays = chart
    assert ((arrays["decay_rate"] > 0.0) == (arrays["stable"] == 1)).all()


def test_without_gains_every_verdict_is_that_of_springs():
    """At the points of a grid with feedback at which all gains are 0, with any damping."""
    with_gains = whole(sf.Study.from_dict(SPRINGS_AT_ZERO))["stable"]
    springs = {k: v for k, v in SPRINGS_AT_ZERO.items() if k not in ("feedback", "damping")}
    study = sf.Study.from_dict(SPRINGS_AT_ZERO)
    places = {name: list(study.axes).index(name) for name in study.axes}
    index: list[Any] = [slice(None)] * len(places)
    for name in ("ankle_proportional_gain", "ankle_derivative_gain"):
        index[places[name]] = 0
    without = whole(sf.Study.from_dict(springs))["stable"]
    assert 0.1 < without.mean() < 0.9
    np.testing.assert_array_equal(with_gains[tuple(index)], without)


def test_without_gains_a_verdict_within_rounding_is_settled_exactly():
    """Ankles ulp by ulp through the threshold, beside gains that are 0 and others."""
    body = sf.Body.from_height_mass(1.6, 23.0 * 1.6**2, "edwards2007")
    threshold = sf.critical_stiffness(body, sf.Stiffness(0.0, 1500.0, 600.0), 9.8).ankle
    ankles = threshold + np.arange(-20, 20) * np.spacing(threshold)
    content = {
        **CHART,
        "body": {**CHART["body"], "height": 1.6},
        "stiffness": {"ankle": ankles.tolist(), "knee": 1500.0, "hip": 600.0},
        "feedback": {"proportional": {"ankle": [0.0, 300.0]}},
        "output": {"quantities": ["stable"]},
    }
    with_gains = whole(sf.Study.from_dict(content))["stable"]
    springs = {k: v for k, v in content.items() if k not in ("feedback", "damping")}
    without = whole(sf.Study.from_dict(springs))["stable"]
    assert set(without) == {0, 1}
    axis = list(sf.Study.from_dict(content).axes).index("ankle_proportional_gain")
    np.testing.assert_array_equal(np.take(with_gains, 0, axis), without)


def test_one_free_joint_takes_the_closed_form_and_finds_the_same():
    content = {**CHART, "stiffness": {"ankle": 450.0, "knee": math.inf, "hip": math.inf}}
    study = sf.Study.from_dict(content)
    ways = {group.quantities: group.way for group in study.grid.groups}
    assert {way for names, way in ways.items() if "critical_delay" in names} == {"numbers"}
    arrays = whole(study)
    for body, stiffness, person, index in points(study):
        delay = sf.critical_delay(body, stiffness, **person)
        assert arrays["critical_delay"][index["critical_delay"]] == pytest.approx(delay, rel=1e-12)
        count = sf.unstable_roots(body, stiffness, **person)
        assert arrays["unstable_roots"][index["unstable_roots"]] == count


def test_a_first_step_below_zero_is_not_taken_for_the_crossing():
    """Compiled, Newton's method went from a wide bracket to the mirror image −ω of this person's.

    One of a million random persons (``benchmarks/feedback_check.py``, block 30).
    """
    person = random_persons(np.random.default_rng((2007, 30)), 20_000)[np.array([7660])]
    found = all_crossings(person.numbers, person.rigid, apply=in_batches)
    known = [omega for omega, _ in crossings_by_pencil(person.matrices(0))]
    assert sorted(found.frequency) == pytest.approx(sorted(known), rel=LAST_DIGITS)
    assert not found.uncertain.any()


def test_what_is_left_open_is_counted():
    # gains that hold exactly what topples: a root at 0
    load = float(
        sf.stiffness_matrix(sf.Body.edwards2007(), sf.Stiffness(0.0, math.inf, math.inf), 9.8)[0, 0]
    )
    at_zero = sf.Study.from_dict({
        **CHART,
        "body": {"model": "edwards2007", "height": 1.753, "mass": 75.3},
        "stiffness": {"ankle": 0.0, "knee": math.inf, "hip": math.inf},
        "feedback": {"proportional": {"ankle": [-load, 2000.0]}, "derivative": {"ankle": 200.0}},
        "output": {"quantities": ["stable"]},
    })  # fmt: skip
    evaluate = Evaluator(at_zero)
    (stable,) = (evaluate(tile)[0] for tile in at_zero.grid.shard(0))
    np.testing.assert_array_equal(np.squeeze(stable)[0], 0)
    assert evaluate.left_open == 1


def test_an_atlas_of_feedback_is_named_and_the_same_for_any_number_of_threads(tmp_path):
    path, again = tmp_path / "chart.h5", tmp_path / "again.h5"
    quantities = ["critical_delay", "stable"]
    study = sf.Study.from_dict({**CHART, "output": {"quantities": quantities}})
    atlas = sf.sweep(study, path)
    sf.sweep(study, again, threads=1)
    assert path.read_bytes() == again.read_bytes()
    assert atlas["critical_delay"].units == "s"
    assert atlas["stable"].dims == tuple(study.axes)
    assert atlas["critical_delay"].dims == tuple(n for n in study.axes if n != "feedback_delay")


FALLING: dict[str, Any] = {
    **CHART,
    "stiffness": {"ankle": [100.0, 300.0, 450.0], "knee": 1500.0, "hip": [300.0, 600.0]},
    "feedback": {**CHART["feedback"], "delay": [0.0, 0.1]},
    "noise": {"ankle": 1.0, "hip": 0.3},
}


def test_crossings_are_looked_for_of_whom_the_quantities_need(monkeypatch):
    """Of sway, who has an odd number of unstable roots falls at every delay, and costs nothing."""
    tables = []

    def remembered(*args, **how):
        tables.append((how["of"], all_crossings(*args, **how)))
        return tables[-1][1]

    monkeypatch.setattr(engine, "all_crossings", remembered)
    sway = ["ankle_sway", "com_sway", "cop_frequency"]
    alone = whole(sf.Study.from_dict({**FALLING, "output": {"quantities": sway}}))
    for of, table in tables:
        assert of == "who may stand"
        assert (table.unstable[table.person] % 2 == 0).all()
    odd = sum(int((table.unstable % 2 == 1).sum()) for _, table in tables)
    assert odd > 50
    tables.clear()
    beside = [*sway, "decay_rate"]
    together = whole(sf.Study.from_dict({**FALLING, "output": {"quantities": beside}}))
    assert {of for of, _ in tables} == {"who may stand"}
    tables.clear()
    # a rightmost root is found without them
    of_root = whole(sf.Study.from_dict({**FALLING, "output": {"quantities": ["decay_rate"]}}))
    assert not tables
    np.testing.assert_array_equal(of_root["decay_rate"], together["decay_rate"])

    def of_everybody(*args, **how):
        tables.append(("everybody", all_crossings(*args, **{**how, "of": "everybody"})))
        return tables[-1][1]

    monkeypatch.setattr(engine, "all_crossings", of_everybody)
    with_all = whole(sf.Study.from_dict({**FALLING, "output": {"quantities": sway}}))
    assert any((table.unstable[table.person] % 2 == 1).any() for _, table in tables)
    for name in sway:
        np.testing.assert_array_equal(alone[name], together[name])
        np.testing.assert_array_equal(alone[name], with_all[name])


def test_variances_of_quantities_of_one_call_are_found_together(monkeypatch):
    asked = []

    def remembered(rows, *args, **how):
        asked.append(rows)
        return variances(rows, *args, **how)

    monkeypatch.setattr(engine, "variances", remembered)
    names = [name for name, row in QUANTITIES.items() if row.variances]
    together = sf.compute(sf.Study.from_dict({**FALLING, "output": {"quantities": names}}))
    assert [len(rows) for rows in asked] == [len(names)] == [7]
    for name in names:
        alone = sf.compute(sf.Study.from_dict({**FALLING, "output": {"quantities": [name]}}))
        # refined by another's needs, never less than by its own
        np.testing.assert_allclose(alone[name], together[name], rtol=engine.OF_GRIDS)
