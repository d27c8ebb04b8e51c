"""Populations with damping and delayed feedback: who stands at which delay."""

import copy
import json
import math

import h5py
import numpy as np
import pytest

import plain_population as plain
import standfast as sf
from delay_oracles import unstable_by_argument
from populations import ANKLES, GOOD, changed, counted, events, law, of
from standfast.cli.app import main
from standfast.figures.population import draw
from standfast.parameters import LOOPS, gain_name
from standfast.population.cohort.cohort import cohort_of
from standfast.population.cohort.counting import Block, count_block
from standfast.population.cohort.histograms import (
    bin_edges,
    signed_bin_edges,
    signed_bin_of,
)
from standfast.population.people.distributions import checked_distribution
from standfast.population.people.sections import likely_slips
from standfast.population.people.study import PopulationStudy
from standfast.population.simulation import simulate
from standfast.population.summary.answers import FED_BACK_ANSWERS, fits
from standfast.population.summary.estimators import Distribution
from standfast.population.summary.file import open_population
from standfast.stability.delay.persons import all_crossings
from standfast.study.canonical import fingerprint_of

G = 9.81
SIZE = 200_000

# Three free joints, gains across joints of either sign.
JOINTS = changed("stiffness.ankle", law("normal", "mgh", mean=0.8, sd=0.1))
JOINTS["stiffness"] |= {
    "knee": law("lognormal", "single_joint_critical", mean=3.0, sd=0.6),
    "hip": law("lognormal", "single_joint_critical", mean=3.0, sd=0.6),
}
JOINTS |= {
    "damping": {"ankle": 30.0, "knee": 30.0, "hip": 20.0},
    "feedback": {
        "delay": law("uniform", low=0.05, high=0.35),
        "proportional": {
            "ankle": law("normal", "mgh", mean=0.8, sd=0.3),
            "ankle_hip": law("normal", mean=0.0, sd=20.0),
        },
        "derivative": {"ankle": law("lognormal", "mgh", mean=0.3, sd=0.1), "hip_ankle": -3},
    },
}


def plain_ankles(random, size):
    """The persons of ANKLES by plain NumPy: critical delays and own delays."""
    height, mass = plain.drawn_group(
        random, size, 1.61008, 0.06866, 10.5831, 2.88009, 0.40285, -0.0515
    )
    mgh, _, _ = plain.loads(height, mass, G)
    stiffness = mgh * plain.truncated_normal(random, size, 0.6, 0.06)
    damping = random.uniform(5.0, 40.0, size)
    delay = plain.lognormal(random, size, 0.3, 0.08)
    gain = mgh * plain.lognormal(random, size, 0.7, 0.15)
    rate = mgh * plain.truncated_normal(random, size, 0.35, 0.1)
    numbers = plain.inertia(height, mass), damping, stiffness - mgh, gain, rate
    return numbers, plain.critical_delay_of_a_faller(*numbers), delay


def test_the_plain_critical_delay_is_that_of_the_argument_principle():
    numbers, critical, _ = plain_ankles(np.random.default_rng(4), 25)
    for one, tau in zip(np.array(numbers).T, critical, strict=True):
        matrices = one[:, None, None]
        if tau > 0.0:
            assert unstable_by_argument(matrices, 0.999 * tau) == 0
            assert unstable_by_argument(matrices, 1.001 * tau) == 2
        else:
            assert unstable_by_argument(matrices, 1e-6) > 0


@pytest.mark.parametrize("method", ["monte-carlo", "quasi-monte-carlo"])
def test_the_fraction_and_the_delays_borne_are_those_of_plain_numpy(method, monkeypatch):
    monkeypatch.setattr("standfast.population.people.study.LARGEST_BLOCK", 2**14)
    found = counted(of(ANKLES, size=SIZE, method=method, seed=3))
    falls, persons = (each.sum() for each in events(found))
    _, critical, delay = plain_ankles(np.random.default_rng(11), SIZE)

    def standard_errors(theirs):
        p, q = falls / persons, theirs / SIZE
        return abs(p - q) / math.sqrt(p * (1.0 - p) / persons + q * (1.0 - q) / SIZE)

    assert 0.1 < falls / persons < 0.5
    assert standard_errors((delay >= critical).sum()) < 4.0
    # the comparison can fail: nerves 3 % slower
    assert standard_errors((1.03 * delay >= critical).sum()) > 4.0
    counts = np.array([each.critical_delay.sum(axis=0) for each in found])
    margins = np.array([each.delay_margin for each in found])
    for ours, theirs in (
        (Distribution(bin_edges(), counts), critical),
        (Distribution(signed_bin_edges(), margins, lowest=-math.inf), critical - delay),
    ):
        assert ours.size == persons
        for share in (0.05, 0.5, 0.9):
            below = np.mean(theirs < ours.quantile(share).value)
            assert abs(below - share) < 6.0 * math.sqrt(share * (1.0 - share) / SIZE)
    assert sum(each.left_open[0] for each in found) == 0


GAIN_NAMES = {k: [gain_name(k, *loop) for loop in LOOPS] for k in ("proportional", "derivative")}


def test_three_joints_are_judged_as_the_argument_principle_counts():
    study = of(copy.deepcopy(JOINTS) | {"output": {"persons": True}}, size=800)
    cohort = cohort_of(study, None)
    counts = count_block(study, cohort, Block(0, 0))
    columns = np.frombuffer(counts.kept).reshape(-1, 800)
    persons = [dict(zip(cohort.kept, column, strict=True)) for column in columns.T]
    falls = counts.histograms["classes"].sum(axis=(0, 1, 2))[1]
    assert falls == sum(person["stable"] == 0 for person in persons)
    verdicts = set()
    for p in persons[:40]:
        body = sf.Body.from_height_mass(float(p["height"]), float(p["mass"]))
        K = sf.Stiffness(*(p[f"{joint}_stiffness"] for joint in ("ankle", "knee", "hip")))
        B = np.diag([p[f"{joint}_damping"] for joint in ("ankle", "knee", "hip")])
        P, D = (
            np.array([p.get(name, 0.0) for name in names]).reshape(3, 3)
            for names in GAIN_NAMES.values()
        )
        assert (D[2, 0], P[0, 2] != 0.0) == (-3.0, True)
        equation = np.array([sf.inertia_matrix(body), B, sf.stiffness_matrix(body, K, G), P, D])
        stands = unstable_by_argument(equation, float(p["feedback_delay"])) == 0
        assert stands == (p["stable"] == 1)
        verdicts.add(stands)
        if (tau := float(p["critical_delay"])) in (0.0, math.inf):
            assert tau == math.inf or unstable_by_argument(equation, 0.0) > 0
        else:
            assert unstable_by_argument(equation, 0.999 * tau) == 0
            assert unstable_by_argument(equation, 1.001 * tau) > 0
    assert verdicts == {True, False}


def random_persons(seed, size):
    random = np.random.default_rng(seed)
    body = sf.Body.from_height_mass(1.7, 70.0)
    rigid = sf.Stiffness(0.0, 0.0, 0.0)
    scale = np.array([600.0, 300.0, 150.0])
    numbers = np.zeros((5, 3, 3, size))
    numbers[0] = np.asarray(sf.inertia_matrix(body))[..., None]
    numbers[2] = np.asarray(sf.stiffness_matrix(body, rigid))[..., None]
    for i in range(3):
        numbers[1, i, i] = random.uniform(0.0, 30.0, size)
        numbers[2, i, i] += scale[i] * random.uniform(0.5, 3.0, size)
        numbers[3, i, i] = scale[i] * random.uniform(-0.5, 1.0, size)
        numbers[4, i, i] = scale[i] * random.uniform(-0.05, 0.2, size)
    return numbers, np.zeros((3, size), bool)


def test_the_shortcut_leaves_out_only_who_stands_at_no_delay():
    numbers, rigid = random_persons(1, 400)
    delay = np.random.default_rng(2).uniform(0.0, 0.3, 400)
    delay[:50] = 0.0
    whole = all_crossings(numbers, rigid)
    short = all_crossings(numbers, rigid, of="who may stand")
    assert short.person.size < whole.person.size
    assert np.array_equal(short.critical_delay(), whole.critical_delay())
    stands = whole.stable_each(delay)
    assert np.array_equal(short.stable_each(delay), stands)
    assert 10 < stands.sum() < 390
    for n in range(400):
        assert stands[n] == whole.stable_at(delay[n : n + 1])[n, 0]
    # at the very crossing nobody stands
    first = whole.critical_delay()
    lost = (first > 0.0) & np.isfinite(first)
    assert not whole.stable_each(first)[lost].any()
    assert whole.stable_each(0.999 * first)[lost].all()


def test_what_is_given_without_gains_changes_nothing():
    """Neither counts nor draws; and zero gains are none. Older studies keep their fingerprint."""
    study = of(GOOD)
    assert fingerprint_of(study.canonical) == study.fingerprint
    assert study.fingerprint == "3aaf50dc983c" + study.fingerprint[12:]
    plainly = counted(study)
    assert events(plainly) == (11144, 40_000)
    zero = {"delay": 0.2, "proportional": {"ankle": 0.0}}
    more = of(GOOD | {"damping": {"hip": law("normal", mean=5, sd=1)}, "feedback": zero})
    assert more.fingerprint != study.fingerprint
    assert PopulationStudy.from_canonical(more.canonical).canonical == more.canonical
    for one, other in zip(counted(more), plainly, strict=True):
        assert one.to_bytes() == other.to_bytes()
    # with feedback persons are drawn as without it
    fed_back = cohort_of(of(GOOD | {"feedback": ANKLES["feedback"]}), None).sampler
    by_springs = cohort_of(study, None).sampler.variates(0, 1, 100)
    assert np.array_equal(fed_back.variates(0, 1, 100)[: len(by_springs)], by_springs)


def test_the_file_is_the_same_for_any_threads_and_parts(tmp_path, monkeypatch):
    monkeypatch.setattr("standfast.population.people.study.BLOCKS_PER_SHARD", 1)
    monkeypatch.setattr("standfast.population.people.study.LARGEST_BLOCK", 2**14)
    monkeypatch.setattr("standfast.population.summary.sensitivity.SENSITIVITY_SIZE", 2**9)
    study = of(ANKLES, size=100_000)
    for name, threads in (("one.h5", 1), ("three.h5", 3)):
        simulate(study, tmp_path / name, threads=threads)
    for part in (2, 1):
        simulate(study, tmp_path / "parts.h5", part=(part, 2))
    simulate(study, tmp_path / "parts.h5")
    assert len({(tmp_path / f"{n}.h5").read_bytes() for n in ("one", "three", "parts")}) == 1


def test_the_file_tells_prints_and_draws(tmp_path, capsys):
    study = of(ANKLES, size=20_000, age="20+")
    path = tmp_path / "p.h5"
    found = simulate(study, path)
    summary = found.summary
    assert fits(json.loads(json.dumps(summary)), FED_BACK_ANSWERS)
    assert 0.99 < summary["unstable_by_springs_alone"] <= 1.0
    borne = summary["delay_borne"]["all"]
    assert borne["0.5"]["delay"] > borne["0.9"]["delay"] > borne["0.95"]["delay"]
    assert summary["delay_borne"]["sex"]["female"] == borne
    delay, standing = found.array("delay"), found.array("standing")
    at_90 = np.interp(borne["0.9"]["delay"], delay, standing)
    assert at_90 == pytest.approx(0.9, abs=2e-3)
    by_both = found.array("standing_by_sex_and_age")
    assert np.isfinite(by_both[..., 0]).sum() == 1
    drivers = summary["drivers"]["delay_margin"]
    assert {"feedback delay", "ankle damping", "ankle proportional gain"} < set(drivers)
    assert sum(each["first"] for each in drivers.values()) < 1.02
    names = {path.name for each in draw(found, tmp_path / "p") for path in each.paths}
    assert {"p-risk-map.png", "p-standing-by-delay.png", "p-drivers-delay_margin.png"} <= names
    assert main(["info", str(path)]) == 0
    told = capsys.readouterr().out
    assert "by springs alone, without feedback" in told
    assert "ankle derivative gain: normal mean 0.35, sd 0.1 s of the own threshold" in told
    assert "delay up to which that share stands, s" in told
    with h5py.File(path, "r+") as file:
        assert file.attrs["format_version"] == 4
        assert file["delay_borne"].attrs["units"] == b"s"
        file.attrs["format_version"] = np.int32(3)
    with pytest.raises(sf.InputError, match="the study inside is of another format version"):
        open_population(path)


def test_bins_of_either_sign_hold_what_lies_between_their_edges():
    values = np.array([-9.3, -0.31, -1e-3, -1e-5, 0.0, 1e-5, 2e-3, 0.4, 8.0, math.inf])
    edges, bins = signed_bin_edges(), signed_bin_of(values)
    assert (np.diff(edges) > 0.0).all()
    assert np.array_equal(bins, np.searchsorted(edges, values, side="right"))


@pytest.mark.parametrize(("key", "value", "sentence"), [
    ("feedback.delay", 120, "feedback.delay.value = 120 is outside the allowed range, 0 to 10 s; "
     "120 looks like milliseconds, write 0.12"),
    ("feedback.delay", law("normal", mean=150, sd=20), "150 looks like milliseconds"),
    ("feedback.delay", -0.1, "feedback comes after what it senses, write 0.1"),
    ("feedback.delay", law("fixed", "mgh", value=0.1), "feedback.delay.relative_to = 'mgh' is not"),
    ("feedback.delay", "late", "feedback.delay = 'late' is not a law; write [feedback.delay]"),
    ("feedback.delay", {"law": "yuong"}, "feedback.delay.law = 'yuong' is not known; did you mean"),
    ("feedback.proportional.ankle", -400, "a gain acts against the rotation, so a negative one "
     "topples"),
    ("feedback.proportional.ankle", law("normal", "mgh", mean=900, sd=90),
     "feedback.proportional.ankle.mean = 900 is outside the allowed range, 0 to 50: a multiple of "
     'mgh; if it is in N·m/rad, write relative_to = "absolute"'),
    ("feedback.derivative.ankle", law("normal", "mgh", mean=300, sd=3), "0 to 50 s: a multiple of "
     "mgh; if it is in N·m·s/rad"),
    ("feedback.derivative.ankle_hip", law("lognormal", mean=-3, sd=1), "-3 has no lognormal"),
    ("feedback.derivative.ankle_hip", law("normal", mean=-3, sd=-1), "sd = -1 is outside"),
    ("feedback.derivative.ankel", 5, "did you mean 'ankle'?"),
    ("feedback.gain", 5, "[feedback] has no key 'gain'"),
    ("feedback", 5, "[feedback] = 5 is not a table"),
    ("damping.ankle", -5, "damping.ankle.value = -5 is outside the allowed range"),
    ("damping.toe", 5, "[damping] has no key 'toe'"),
    ("damping.knee", {"distribution": "measured"}, "damping.knee: measured needs people with"),
])  # fmt: skip
def test_wrong_nerves_get_their_sentence(key, value, sentence):
    with pytest.raises(sf.InputError) as caught:
        PopulationStudy.from_dict(changed(key, value, ANKLES))
    assert sentence in str(caught.value)
    assert "\n" not in str(caught.value)


def test_gains_of_another_unit_are_noted():
    def notes(value):
        return likely_slips((("ankle_proportional_gain", value),))

    def gain(**given):
        return checked_distribution("ankle_proportional_gain", {"distribution": "fixed", **given})

    assert "N·m per degree, write 974.1" in notes(gain(value=17))[0]
    assert 'write relative_to = "mgh"' in notes(gain(value=1.3))[0]
    assert notes(gain(value=974.0)) == notes(gain(value=1.3, relative_to="mgh")) == []
