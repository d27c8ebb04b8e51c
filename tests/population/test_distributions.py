"""Laws of stiffness: the stiffnesses that come out have the distributions that went in."""

import math

import numpy as np
import pytest
from scipy import stats

from populations import GOOD, RIGID, changed, drawn, law, of
from standfast.anthropometry.body import Body
from standfast.engine.mapping import map_over_batch
from standfast.mechanics.matrices import joint_gravity
from standfast.parameters import JOINTS
from standfast.population.cohort.cohort import cohort_of
from standfast.population.cohort.persons import person_of
from standfast.population.people.builtin import READY_DELAYS, READY_DISTRIBUTIONS
from standfast.population.people.distributions import checked_distribution

SIZE = 2**16
ACCIDENT = 1e-3  # p-value below which a seeded test of a distribution fails


def persons(content, **population):
    """Who the first block of a study's persons are."""
    study = of(content, size=SIZE, **population)
    cohort = cohort_of(study, study.read_people())
    numbers = cohort.numbers(cohort.sampler.variates(0, 0, SIZE))
    return drawn(cohort, numbers)


@pytest.mark.parametrize("relative_to", ["absolute", "single_joint_critical", "mgh"])
@pytest.mark.parametrize("joint", JOINTS)
@pytest.mark.parametrize(
    ("given", "wanted"),
    [
        (law("normal", mean=1.5, sd=0.9), stats.truncnorm(-1.5 / 0.9, np.inf, 1.5, 0.9)),
        (law("normal", mean=2.0, sd=0.1), stats.norm(2.0, 0.1)),
        (law("uniform", low=0.5, high=2.5), stats.uniform(0.5, 2.0)),
    ],
)
def test_a_law_gives_its_distribution(joint, relative_to, given, wanted):
    found = persons(changed(f"stiffness.{joint}", {**given, "relative_to": relative_to}))
    load = {
        "absolute": 1.0,
        "single_joint_critical": found[f"{joint}_load"],
        "mgh": found["ankle_load"],
    }[relative_to]
    assert stats.kstest(found[f"{joint}_stiffness"] / load, wanted.cdf).pvalue > ACCIDENT


def test_a_lognormal_law_is_given_by_its_own_mean_and_sd():
    found = persons(changed("stiffness.ankle", law("lognormal", mean=900.0, sd=300.0)))
    stiffness = found["ankle_stiffness"]
    errors = 4.0 / math.sqrt(SIZE)
    assert stiffness.mean() == pytest.approx(900.0, rel=errors)
    assert stiffness.std() == pytest.approx(300.0, rel=4.0 * errors)
    assert stats.kstest(np.log(stiffness), "norm", stats.norm.fit(np.log(stiffness))).pvalue > 0.01


def test_fixed_rigid_and_measured(tmp_path):
    (tmp_path / "p.csv").write_text(
        "height,mass,knee_stiffness\n1.7,70,800\n1.8,80,inf\n1.6,60,500\n"
    )
    content = changed("stiffness.ankle", law("fixed", "mgh", value=1.5))
    content["stiffness"] |= {"knee": {"distribution": "measured"}, "hip": RIGID}
    content["population"] = {"people": str(tmp_path / "p.csv")}
    found = persons(content)
    assert found["ankle_stiffness"] == pytest.approx(1.5 * found["ankle_load"])
    assert np.isinf(found["hip_stiffness"]).all()
    by_height = {1.7: 800.0, 1.8: math.inf, 1.6: 500.0}
    wanted = [by_height[height] for height in found["height"].tolist()]
    assert found["knee_stiffness"].tolist() == wanted


def test_loads_are_those_of_the_scaled_body():
    found = persons(changed("population.body_model", "de-leva-female"))
    for row in range(5):
        body = Body.from_height_mass(
            float(found["height"][row]), float(found["mass"][row]), model="de-leva-female"
        )
        loads, _, _ = joint_gravity(body, 9.81)
        ours = [found[f"{joint}_load"][row] for joint in JOINTS]
        assert ours == pytest.approx(loads, rel=1e-12)


def test_every_ready_law_is_a_law():
    for place, laws in READY_DISTRIBUTIONS.items():
        parameter = "feedback_delay" if place == "feedback.delay" else f"{place}_stiffness"
        for name in laws:
            assert checked_distribution(parameter, {"law": name}).numbers[0] > 0.0
    assert READY_DISTRIBUTIONS["feedback.delay"].keys() == READY_DELAYS.keys()


def test_scattered_proportions_have_the_measured_spread():
    """ANSUR II, women: shank 4.33 %, thigh 4.60 % of their means; stature is kept."""
    fixed = persons(changed("population.proportions", "fixed"))
    content = changed("population.proportions", "scattered")
    study = of(content, size=SIZE)
    cohort = cohort_of(study, None)
    numbers = dict(zip(cohort.names, cohort.sampler.variates(0, 0, SIZE), strict=True))
    # loads are linear in the lengths: their spread at equal height and mass tells the scatter
    scattered = drawn(cohort, np.array([numbers[name] for name in cohort.names]))
    assert scattered["height"] == pytest.approx(fixed["height"])
    hip = scattered["hip_load"] / fixed["hip_load"] - 1.0
    # legs longer by x shorten the upper body: (0.246 s + 0.245 t) / (0.961 - 0.491)
    wanted = math.hypot(0.246 * 0.0433, 0.245 * 0.0460) / 0.470
    assert hip.std() == pytest.approx(wanted, rel=0.05)
    assert hip.mean() == pytest.approx(0.0, abs=4.0 * wanted / math.sqrt(SIZE))


OTHER_NUMBERS = {
    "gravity": ("gravity", 1.62),
    "subpopulation": ("population.age", "65+"),
    "mean": ("stiffness.ankle.mean", 1.2),
    "sd": ("stiffness.knee.sd", 0.9),
    "range": ("stiffness.hip", law("uniform", low=100.0, high=300.0)),
    "persons": ("population.size", 70),
}
OTHER_STRUCTURES = {
    "kind": ("stiffness.hip", law("normal", mean=600.0, sd=100.0)),
    "load": ("stiffness.hip", law("uniform", "mgh", low=0.5, high=2.0)),
    "rigid": ("stiffness.hip", RIGID),
    "no spread": ("stiffness.ankle.sd", 0.0),
    "body model": ("population.body_model", "de-leva-female"),
    "groups": ("population.age", None),
}


def test_another_number_compiles_no_program_and_another_structure_does():
    traced = []

    def stiffness_of(model, given):
        traced.append(model)
        person = person_of(model, given)
        return dict(zip(JOINTS, person.stiffness.joints, strict=True))

    def found(content):
        study = of(content, size=content["population"]["size"])
        cohort = cohort_of(study, None)
        numbers = cohort.numbers(cohort.sampler.variates(0, 0, study.block_size))
        return map_over_batch(stiffness_of, cohort.model, cohort.names)(numbers)

    plain = found(GOOD)
    for key, value in OTHER_NUMBERS.values():
        other = found(changed(key, value))
        # and it is not ignored
        assert any(other[j].mean() != plain[j].mean() for j in JOINTS), key
    assert len(traced) == 1
    for key, value in OTHER_STRUCTURES.values():
        found(changed(key, value))
    assert len(traced) == 1 + len(OTHER_STRUCTURES)


def test_persons_are_the_same_in_any_company():
    cohort = cohort_of(of(GOOD), None)
    numbers = cohort.numbers(cohort.sampler.variates(0, 0, 2**14))
    together = drawn(cohort, numbers)
    for first, last in ((0, 1), (0, 4096), (4000, 4500), (7, 9000)):
        alone = drawn(cohort, numbers[:, first:last])
        for name, values in together.items():
            assert alone[name].tolist() == values[first:last].tolist()
