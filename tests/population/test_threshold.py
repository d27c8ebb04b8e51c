"""Right at the threshold: by definition a person falls there, and rounding throws no dice."""

import math
from fractions import Fraction

import numpy as np
import pytest

import standfast as sf
from people import random_body
from populations import GOOD, RIGID, events, law, of
from populations import counted as counted_of
from standfast.cli.app import main
from standfast.population.cohort.counting import DETAILED
from standfast.population.people.study import PopulationStudy
from standfast.population.simulation import simulate
from standfast.stability.exact import stands_exactly
from standfast.stability.rounding import near_threshold, rounding_decides

WOMEN = {"builtin": "nhanes-2017-2018", "sex": "female", "age": "65+", "size": 20_000, "seed": 5}
AT = {"ankle": law("fixed", "mgh", value=1.0), "knee": RIGID, "hip": RIGID}
ULP = 2.0**-52


def study(**stiffness):
    return PopulationStudy.from_dict(
        {"gravity": 9.81, "population": WOMEN, "stiffness": {**AT, **stiffness}}
    )


OWN = law("fixed", "single_joint_critical", value=1.0)
RIGHT_AT = {
    "ankle, of mgh": {},
    "knee": {"ankle": RIGID, "knee": OWN},
    "hip": {"ankle": RIGID, "hip": OWN},
    "hip below, ankle far above": {"ankle": law("fixed", "mgh", value=1e4), "hip": OWN},
}


@pytest.mark.parametrize("name", RIGHT_AT)
def test_right_at_a_threshold_everybody_falls(name):
    fallen, persons = events(counted_of(study(**RIGHT_AT[name])))
    assert fallen.tolist() == persons.tolist() == [20_000]


@pytest.mark.parametrize(
    ("value", "falls"), [(1.0 - ULP / 2, 20_000), (1.0, 20_000), (1.0 + ULP, 0)]
)
def test_an_ulp_beside_it_decides(value, falls):
    found = counted_of(study(ankle=law("fixed", "mgh", value=value)))
    assert events(found)[0].tolist() == [falls]
    assert found[0].settled.tolist() == [20_000]


def test_scattered_proportions_and_both_methods_agree():
    for method in ("monte-carlo", "quasi-monte-carlo"):
        content = {"gravity": 9.81, "population": WOMEN, "stiffness": AT}
        found = of(content, proportions="scattered", method=method, size=5000)
        fallen, persons = events(counted_of(found))
        assert fallen.tolist() == persons.tolist()


def test_blocks_that_are_only_asked_who_falls_are_settled_too(monkeypatch):
    assert DETAILED > 0
    monkeypatch.setattr("standfast.population.cohort.counting.DETAILED", 0)
    fallen, persons = events(counted_of(study()))
    assert fallen.tolist() == persons.tolist()


def test_the_answers_at_the_threshold_agree_with_each_other(tmp_path, capsys):
    content = {"gravity": 9.81, "population": WOMEN, "stiffness": AT, "output": {"persons": True}}
    found = simulate(PopulationStudy.from_dict(content), tmp_path / "p.h5")
    summary = found.summary
    assert summary["unstable_fraction"] == 1.0
    assert summary["settled_exactly"] == 20_000
    assert summary["safety_factor"] is None
    assert summary["same_for_everybody"] == {"safety_factor": 1.0}
    for share in ("0.5", "0.99"):
        assert summary["required_stiffness"]["ankle"][share]["multiple_interval"] == [1.0, 1.0]
        assert summary["required_stiffness"]["all"][share]["multiple"] == 1.0
    assert "all 524,288 looked at fall" in summary["drivers"]["unstable"]["remark"]
    assert "safety factor is 1 for all" in summary["drivers"]["safety_factor"]["remark"]
    multiple = found.array("multiple")
    at_one = np.flatnonzero(multiple == 1.0)[0]
    for joint in ("ankle", "all"):
        assert found.array(f"risk_by_{joint}_multiple")[at_one] == 1.0
    assert (found.array("risk_by_hip_multiple") == 1.0).all()
    assert found.array("survival")[np.flatnonzero(found.array("safety_factor") == 1.0)[0]] == 0.0
    assert not found.array("person_stable").any()
    assert (found.array("person_safety_factor") <= 1.0).all()
    (tmp_path / "s.toml").write_text(
        'gravity = 9.81\n[population]\nbuiltin = "nhanes-2017-2018"\nsex = "female"\nage = "65+"\n'
        "size = 20000\nseed = 5\n[stiffness]\nknee = {distribution = 'fixed', value = inf}\n"
        "hip = {distribution = 'fixed', value = inf}\n"
        "ankle = {distribution = 'fixed', relative_to = 'mgh', value = 1.0}\n"
    )
    assert main(["population", str(tmp_path / "s.toml"), "-o", str(tmp_path / "s.h5"),
                 "--no-figures"]) == 0  # fmt: skip
    told = capsys.readouterr().out
    assert "unstable   100 %" in told
    assert "20,000 persons within rounding of a threshold, settled in exact arithmetic" in told
    assert "safety factor: 1, the same for everybody" in told


def test_a_constant_beside_the_threshold_is_told_as_one_number(tmp_path):
    summary = simulate(study(ankle=law("fixed", "mgh", value=0.9)), tmp_path / "p.h5").summary
    assert summary["settled_exactly"] == 0
    assert summary["same_for_everybody"] == {"safety_factor": 0.9}
    assert summary["safety_factor"] is None
    assert "safety factor is 0.9 for all" in summary["drivers"]["safety_factor"]["remark"]
    multiple = summary["required_stiffness"]["ankle"]["0.5"]
    assert multiple["multiple"] == pytest.approx(1.0 / 0.9, rel=1e-11)
    assert multiple["multiple_interval"] == [multiple["multiple"]] * 2


def test_springs_alone_are_settled_where_there_is_feedback(tmp_path):
    content = {
        "gravity": 9.81,
        "population": {**WOMEN, "size": 2000},
        "stiffness": AT,
        "feedback": {"delay": 0.1, "proportional": {"ankle": law("fixed", "mgh", value=0.5)},
                     "derivative": {"ankle": law("fixed", "mgh", value=0.3)}},
    }  # fmt: skip
    summary = simulate(PopulationStudy.from_dict(content), tmp_path / "p.h5").summary
    assert summary["unstable_by_springs_alone"] == 1.0
    assert summary["unstable_fraction"] < 0.5
    assert summary["settled_exactly"] == 2000


def test_nobody_of_an_ordinary_study_is_settled():
    assert counted_of(PopulationStudy.from_dict(GOOD))[0].settled.tolist() == [0]


def verdict_in_fractions(body, gravity, stiffness):
    """The carried loads from the hip down in exact fractions, for one person."""
    g = Fraction(gravity)
    (ms, mt, mb), (hs, ht), (es, et, eb) = (
        [Fraction(float(v)) for v in part]
        for part in (body.segment_mass, body.segment_length, body.segment_com)
    )
    load = g * mb * eb
    own = [g * (ms * es + (mt + mb) * hs), g * (mt * et + mb * ht)]
    for k in (stiffness[2], stiffness[1]):
        if not math.isinf(k):
            if Fraction(k) <= load:
                return False
            load = load / (1 - load / Fraction(k))
        load += own.pop()
    return math.isinf(stiffness[0]) or Fraction(stiffness[0]) > load


def test_whole_numbers_give_the_verdicts_of_fractions():
    """Of stiffnesses drawn anyhow, near a threshold, right at it by floats, and rigid."""
    rng = np.random.default_rng(41)
    bodies, numbers = [], []
    for _ in range(400):
        body = random_body(rng)
        k = 10.0 ** rng.uniform(1.0, 4.0, 3)
        k[rng.random(3) < 0.3] = math.inf
        critical = sf.critical_stiffness(body, sf.Stiffness(*k), gravity=9.81)
        joint = rng.integers(3)
        if math.isfinite(critical.joints[joint]) and rng.random() < 0.8:
            k[joint] = critical.joints[joint] * (1.0 + rng.integers(-3, 4) * ULP)
        bodies.append(body)
        numbers.append(k)
    stacked = sf.Body._make(np.stack(parts, axis=1) for parts in zip(*bodies, strict=True))
    found = stands_exactly(stacked, 9.81, np.array(numbers).T, [None] * 3)
    wanted = [verdict_in_fractions(b, 9.81, k) for b, k in zip(bodies, numbers, strict=True)]
    assert found.tolist() == wanted
    assert 50 < sum(wanted) < 350
    people = zip(bodies, numbers, strict=True)
    plain = [sf.is_stable(body, sf.Stiffness(*k), gravity=9.81) for body, k in people]
    assert plain != wanted  # rounding does decide some of them


def test_the_sieve_lets_nobody_through_whom_rounding_decides():
    """Also with stiffnesses that are near two or three of their loads."""
    rng = np.random.default_rng(43)
    decided = 0
    for _ in range(3000):
        body = random_body(rng)
        gravity = 9.81
        hip, knee, ankle = rng.uniform(0.5, 5.0, 3) * 1000.0
        nearness = 10.0 ** rng.uniform(-17.0, -4.0, 3) * rng.choice([-1.0, 1.0], 3)
        rigid = sf.Stiffness(ankle, knee, hip)
        if rng.random() < 0.6:
            (_, _, at_hip) = sf.critical_stiffness(
                body, sf.Stiffness(math.inf, math.inf, 0.0), gravity
            ).joints
            hip = at_hip * (1.0 + abs(nearness[2]))
        at_knee = sf.critical_stiffness(body, sf.Stiffness(math.inf, 0.0, hip), gravity).knee
        if rng.random() < 0.6 and at_knee < 1e11:
            knee = at_knee * (1.0 + abs(nearness[1]))
        knee = min(knee, 1e12)
        at_ankle = sf.critical_stiffness(body, sf.Stiffness(0.0, knee, hip), gravity).ankle
        if rng.random() < 0.8 and at_ankle < 1e11:
            ankle = at_ankle * (1.0 + nearness[0])
        given = rigid._replace(ankle=ankle, knee=knee, hip=hip)
        if rounding_decides(body, given, gravity, scaling=6 * 2.0**-53):
            decided += 1
            assert near_threshold(body, given, gravity)
    assert decided > 200
