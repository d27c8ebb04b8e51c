"""Populations with noise: how much who stands sways, against persons one by one."""

import copy
import csv
import json
import math

import h5py
import numpy as np
import pytest

import standfast as sf
from populations import ANKLES, RIGID, changed, counted, law, of
from standfast.cli.app import main
from standfast.cli.population_text import print_summary
from standfast.parameters import LOOPS, gain_name
from standfast.population.cohort.cohort import cohort_of
from standfast.population.cohort.counting import Block, count_block
from standfast.population.cohort.histograms import NO_SWAY, OPEN_SWAY
from standfast.population.people.study import PopulationStudy
from standfast.population.summary.answers import SWAY_ANSWERS, fits

G = 9.81
# Quantities are asked to 1e-6 of their variance, and kept as they are.
OF_KEPT = 2e-6
# A bin is at most 0.4 % wide.
OF_BINS = 4e-3
JOINTS = ("ankle", "knee", "hip")
EVERY = [
    *(f"{joint}_sway" for joint in JOINTS),
    "com_sway",
    "cop_sway",
    "cop_velocity",
    "cop_frequency",
]

NOISY = {
    **ANKLES,
    "noise": {"ankle": law("lognormal", "mgh", mean=1e-3, sd=3e-4)},
    "output": {"persons": True, "quantities": EVERY},
}
THREE = changed("stiffness.ankle", law("normal", "mgh", mean=0.8, sd=0.1))
THREE["stiffness"] |= {
    "knee": law("lognormal", "single_joint_critical", mean=3.0, sd=0.6),
    "hip": law("lognormal", "single_joint_critical", mean=3.0, sd=0.6),
}
THREE |= {
    "damping": {"ankle": 30.0, "knee": 30.0, "hip": 20.0},
    "feedback": {
        "delay": law("uniform", low=0.05, high=0.25),
        "proportional": {
            "ankle": law("normal", "mgh", mean=0.8, sd=0.2),
            "ankle_hip": law("normal", mean=0.0, sd=20.0),
        },
        "derivative": {"ankle": law("lognormal", "mgh", mean=0.3, sd=0.1)},
    },
    "noise": {"ankle": 1.0, "knee": law("uniform", low=0.0, high=1.0), "hip": 0.5},
    "output": {"persons": True, "quantities": EVERY},
}


def persons_of(study):
    cohort = cohort_of(study, None)
    counts = count_block(study, cohort, Block(0, 0))
    columns = np.frombuffer(counts.kept).reshape(-1, study.size)
    return [dict(zip(cohort.kept, column, strict=True)) for column in columns.T]


def one_by_one(p):
    """The sway of a person who is kept, by the library's functions of one person."""
    body = sf.Body.from_height_mass(float(p["height"]), float(p["mass"]))
    gains = {
        kind: np.reshape([p.get(gain_name(kind, *loop), 0.0) for loop in LOOPS], (3, 3))
        for kind in ("proportional", "derivative")
    }
    person = {
        "body": body,
        "stiffness": sf.Stiffness(*(p[f"{joint}_stiffness"] for joint in JOINTS)),
        "gravity": G,
        "damping": [p.get(f"{joint}_damping", 0.0) for joint in JOINTS],
        "feedback": sf.Feedback(**gains, delay=float(p["feedback_delay"])),
        "noise": [p.get(f"{joint}_noise", 0.0) for joint in JOINTS],
    }
    deviations = np.sqrt(np.diag(sf.sway_covariance(**person)))
    found = {f"{joint}_sway": each for joint, each in zip(JOINTS, deviations, strict=True)}
    if p["stable"] == 0:
        return found
    # by a sum over frequencies of its own
    f = np.geomspace(1e-5, 400.0, 60_001)
    density = sf.sway_spectrum(**person, frequency=f)

    def total(power):
        return np.trapezoid(power * f, np.log(f))

    found["com_sway"] = math.sqrt(total(density.com))
    found["cop_sway"] = math.sqrt(total(density.cop))
    found["cop_velocity"] = math.sqrt(total((math.tau * f) ** 2 * density.cop))
    found["cop_frequency"] = total(f * density.cop) / total(density.cop)
    return found


# What a sum over 60,000 frequencies leaves out, at worst of a lightly damped mode.
OF_SUMS = 1e-3


@pytest.mark.parametrize(("content", "asked"), [(NOISY, 8), (THREE, 5)])
def test_persons_are_those_of_the_functions_of_one(content, asked):
    persons = persons_of(of(content, size=60))
    seen = {True: 0, False: 0}
    for p in persons:
        stands = p["stable"] == 1
        if seen[stands] >= asked:
            continue
        seen[stands] += 1
        found = one_by_one(p)
        if not stands:
            assert found["ankle_sway"] == math.inf
            assert {p[name] for name in EVERY[:-1]} == {math.inf}
            assert math.isnan(p["cop_frequency"])
            continue
        for joint in JOINTS:
            assert p[f"{joint}_sway"] == pytest.approx(found[f"{joint}_sway"], rel=OF_KEPT)
        for name in EVERY[3:]:
            assert p[name] == pytest.approx(found[name], rel=OF_SUMS)
        # able to fail: a tenth more noise
        more = one_by_one({**p, "ankle_noise": 1.1 * p["ankle_noise"]})
        assert p["ankle_sway"] != pytest.approx(more["ankle_sway"], rel=1e-2)
    assert min(seen.values()) > 0


def test_histograms_count_who_sways_and_who_does_not():
    asked = ["cop_sway", "cop_frequency"]
    study = of({**NOISY, "output": {"persons": True, "quantities": asked}}, size=500)
    persons = persons_of(study)
    (found,) = counted(study)
    stands = sum(p["stable"] == 1 for p in persons)
    assert 0 < stands < 500
    for name, counts in zip(asked, found.sway, strict=True):
        assert counts.sum() == 500, name
        assert counts[:, NO_SWAY].sum() == 500 - stands, name
        assert counts[:, OPEN_SWAY].sum() == 0, name


TOLD = ("cop_sway", "cop_frequency")


@pytest.mark.parametrize("method", ["monte-carlo", "quasi-monte-carlo"])
def test_quantiles_are_those_of_the_persons(method, tmp_path):
    content = {**NOISY, "population": {**NOISY["population"], "method": method}}
    content["output"] = {"persons": True, "quantities": [*TOLD]}
    del content["population"]["sex"], content["population"]["age"]
    population = sf.simulate(of(content, size=600), tmp_path / "p.h5")
    assert fits(population.summary, SWAY_ANSWERS)
    sex = population.array("person_sex")
    shares = population.array("quantile")
    for name in TOLD:
        values = population.array(f"person_{name}")
        told = population.summary["sway"][name]
        there = np.isfinite(values)
        assert told["all"]["swaying"] == there.sum()
        assert told["all"]["persons"] == population.study.size
        for of_class, who in ((told["all"], there), (told["sex"]["female"], there & (sex == 1))):
            for share, found in of_class["quantiles"].items():
                low, high = ((1.0 + sign * OF_BINS) * found["value"] for sign in (-1.0, 1.0))
                one = 1.0 / who.sum()
                assert np.mean(values[who] < low) - one <= float(share)
                assert float(share) <= np.mean(values[who] < high) + one
                assert found["interval"][0] <= found["value"] <= found["interval"][1]
        curve = population.array(name)
        assert curve[np.searchsorted(shares, 0.5)] == pytest.approx(
            told["all"]["quantiles"]["0.5"]["value"], rel=OF_BINS
        )
        assert np.isnan(population.array(f"{name}_by_sex_and_age")[2]).all()
    with h5py.File(population.path) as file:
        assert file.attrs["format_version"] == 5
        assert file["cop_sway"].attrs["units"] == b"m"
        assert file["person_cop_sway"].attrs["units"] == b"m"


def test_counts_that_differ_between_quantities_are_told_of_each(tmp_path, capsys):
    """An integral may be open where another of the same person is not."""
    study = of({**NOISY, "output": {"persons": True, "quantities": [*TOLD]}}, size=600)
    summary = copy.deepcopy(sf.simulate(study, tmp_path / "p.h5").summary)
    swaying, all_of = (summary["sway"][TOLD[0]]["all"][n] for n in ("swaying", "persons"))
    print_summary(summary)
    none = f"(the other {all_of - swaying} persons have none, and are not in it"
    who = "persons who stand and are damped"
    told = capsys.readouterr().out
    assert f"97.5 %] of the {swaying} of {all_of} {who}\n  {none})\n" in told
    assert "cop sway:" not in told
    summary["sway"][TOLD[1]]["all"] |= {"swaying": swaying - 5, "left_open": 5}
    print_summary(summary)
    told = capsys.readouterr().out
    assert f"97.5 %] of\n  cop sway: the {swaying} of {all_of} {who}\n  {none})\n" in told
    of_other = f"  cop frequency: the {swaying - 5} of {all_of} {who}\n  {none}"
    assert f"{of_other}; of 5 persons more it is open)\n" in told


def test_noise_is_drawn_after_all_else():
    noisy = {**NOISY, "output": {"persons": True, "quantities": ["ankle_sway"]}}
    plain = {**ANKLES, "output": {"persons": True}}
    for one, other in zip(*(persons_of(of(each, size=32)) for each in (plain, noisy)), strict=True):
        assert one == {name: other[name] for name in one}


def test_without_noise_a_study_is_what_it_was():
    study = of(ANKLES)
    assert "noise" not in study.content
    assert study.content["output"] == {"persons": False}
    # of the program before there was noise
    assert study.fingerprint == FINGERPRINT
    silent = of({**ANKLES, "noise": {"ankle": 0.0}})
    assert (silent.sway, silent.content["output"]) == ((), {"persons": False})
    noisy = of({**ANKLES, "noise": {"ankle": 1.0}})
    assert noisy.sway == ("com_sway", "cop_sway", "cop_velocity", "cop_frequency")
    assert PopulationStudy.from_canonical(noisy.canonical).fingerprint == noisy.fingerprint


FINGERPRINT = "6c73001f1c171f02e764124f1aa4f1711b91ea90a7f6c59d7efa45bfd67c452a"


def test_springs_and_damping_sway_too():
    content = changed("stiffness.ankle", law("normal", "mgh", mean=1.3, sd=0.2))
    content["stiffness"] |= {"knee": RIGID, "hip": RIGID}
    content |= {"damping": {"ankle": 50.0}, "noise": {"ankle": 2.0}}
    content["output"] = {"persons": True, "quantities": ["ankle_sway"]}
    seen = 0
    for p in persons_of(of(content, size=50)):
        if p["stable"] == 0:
            assert p["ankle_sway"] == math.inf
            continue
        body = sf.Body.from_height_mass(float(p["height"]), float(p["mass"]))
        springs = sf.stiffness_matrix(body, sf.Stiffness(p["ankle_stiffness"], 0, 0), gravity=G)
        # sigma² / (2 B C)
        wanted = 2.0 / math.sqrt(2.0 * 50.0 * springs[0, 0])
        assert p["ankle_sway"] == pytest.approx(wanted, rel=OF_KEPT)
        seen += 1
    assert 10 < seen < 50


@pytest.mark.parametrize(
    ("key", "value", "sentence"),
    [
        ("noise", {"ancle": 1.0}, "[noise] has no key 'ancle'; did you mean 'ankle'?"),
        ("noise", {"ankle": -1.0}, "noise.ankle.value = -1 "),
        ("noise", {"ankle": law("fixed", "mgh", value=60.0)}, "0 to 50 √s: a multiple of mgh; if"),
        ("output", {"quantities": ["cop_sawy"]}, "no 'cop_sawy'; did you mean 'cop_sway'?"),
        ("output", {"quantities": "cop_sway"}, "is not a list of quantities"),
        ("output", {"quantities": []}, "output.quantities is an empty list"),
        ("output", {"quantities": ["cop_sway"] * 2}, "names a quantity twice"),
        ("output", {"quantities": ["stable"]}, "has no 'stable' (of a population with noise: "),
        ("noise", {"ankle": 0.0}, "output.quantities: ankle_sway is of persons with noise; give"),
        ("noise", {"ankle": {"distribution": "measured"}}, "noise.ankle: measured needs people"),
    ],
)
def test_what_is_wrong_is_said(key, value, sentence):
    with pytest.raises(sf.InputError) as error:
        of(changed(key, value, NOISY))
    assert sentence in str(error.value)


def test_the_command_tells_and_writes_all(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    rows = ["height,mass,sex,age,ankle_noise"]
    rows += [
        f"{1.6 + 0.001 * i:.3f},{60 + 0.1 * i:.1f},{'mf'[i % 2]},{(30, 70)[i % 3 == 0]},{1 + i % 2}"
        for i in range(40)
    ]
    (tmp_path / "people.csv").write_text("\n".join(rows) + "\n", encoding="utf-8")
    (tmp_path / "study.toml").write_text(
        """
        [population]
        people = "people.csv"
        size = 900
        seed = 1
        [stiffness]
        ankle = { distribution = "normal", relative_to = "mgh", mean = 0.67, sd = 0.08 }
        knee = { distribution = "fixed", value = inf }
        hip = { distribution = "fixed", value = inf }
        [feedback]
        delay = 0.12
        [feedback.proportional]
        ankle = { distribution = "fixed", relative_to = "mgh", value = 0.7 }
        [feedback.derivative]
        ankle = { distribution = "fixed", relative_to = "mgh", value = 0.3 }
        [noise]
        ankle = { distribution = "measured" }
        [output]
        quantities = ["cop_sway", "ankle_sway"]
        """,
        encoding="utf-8",
    )
    assert main(["population", "study.toml", "--csv", "s.csv"]) == 0
    told = capsys.readouterr().out
    assert "sway under noise: median [2.5 %, 97.5 %] of the " in told
    assert "ankle noise: measured" in told
    written = {path.name for path in tmp_path.iterdir()}
    assert {"study-sway-cop_sway.png", "study-sway-ankle_sway.png"} <= written
    assert main(["info", "study.h5", "--json"]) == 0
    sway = json.loads(capsys.readouterr().out)["sway"]
    lines = (tmp_path / "s.csv").read_text(encoding="utf-8").splitlines()
    head, everybody = (line.split(",") for line in lines[:2])
    median = float(everybody[head.index("cop_sway_median_mm")])
    assert median == pytest.approx(1e3 * sway["cop_sway"]["all"]["quantiles"]["0.5"]["value"])
    assert "ankle_sway_p97.5_deg" in head
    # women's noise is twice the men's
    low, high = (
        sway["cop_sway"]["sex"][sex]["quantiles"]["0.5"]["value"] for sex in ("male", "female")
    )
    assert 1.8 < high / low < 2.2
    ax = sf.plot.sway_by_class("study.h5", "cop_sway")
    thin, thick, dot = ax.lines[:3]
    of_all = sway["cop_sway"]["all"]["quantiles"]
    for line, shares in ((thin, ("0.025", "0.975")), (thick, ("0.25", "0.75")), (dot, ("0.5",))):
        wanted = [1e3 * of_all[share]["value"] for share in shares]
        assert list(line.get_xdata()) == pytest.approx(wanted)
    with pytest.raises(sf.InputError, match="has no sway 'com_sway'"):
        sf.plot.sway_by_class("study.h5", "com_sway")


def test_assess_has_the_sway_of_each_person(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    text = "height,mass,ankle_noise,feedback_delay\n"
    text += "1.7,70,0.8,0.1\n1.8,80,,0.1\n1.6,60,0.5,\n1.7,70,1,0.9\n"
    (tmp_path / "people.csv").write_text(text, encoding="utf-8")
    options = ["--ankle", "0.67mgh", "--knee", "inf", "--hip", "inf", "--damping", "ankle=0.045mgh"]
    gains = ["--proportional", "ankle=0.65mgh", "--derivative", "ankle=0.3mgh"]
    assert main(["assess", "people.csv", *options, *gains]) == 0
    with (tmp_path / "people-assessed.csv").open(encoding="utf-8") as file:
        first, unknown, untimed, falls = csv.DictReader(file)
    load = float(first["ankle_threshold_alone_Nm_rad"])
    person = {
        "body": sf.Body.from_height_mass(1.7, 70.0),
        "stiffness": sf.Stiffness(0.67 * load, math.inf, math.inf),
        "damping": (0.045 * load, 0, 0),
        "feedback": sf.Feedback((0.65 * load, 0, 0), (0.3 * load, 0, 0), 0.1),
    }
    covariance = sf.sway_covariance(**person, noise=(0.8, 0, 0))
    # of six digits, the load's too
    assert float(first["ankle_sway_rad"]) == pytest.approx(math.sqrt(covariance[0, 0]), rel=1e-4)
    assert (first["ankle_noise_Nm_sqrt_s"], unknown["ankle_noise_Nm_sqrt_s"]) == ("0.8", "")
    assert float(first["cop_sway_m"]) > 0.0
    for person, sway, frequency in ((unknown, "", ""), (untimed, "", ""), (falls, "inf", "")):
        assert (person["cop_sway_m"], person["cop_frequency_Hz"]) == (sway, frequency)
    # what is known without noise is told without it
    assert float(unknown["critical_delay_s"]) > 0.0
    found = sf.assess(
        "people.csv",
        otherwise={"ankle": "1.2mgh", "knee": math.inf, "hip": math.inf},
        nerves={"damping": {"ankle": 30}, "noise": {"ankle": 2.0}},
    )
    springs = sf.stiffness_matrix(
        sf.Body.from_height_mass(1.7, 70.0), sf.Stiffness(1.2 * load, 0, 0)
    )
    assert found.columns["ankle_sway_rad"][0] == pytest.approx(
        0.8 / math.sqrt(2.0 * 30.0 * springs[0, 0]), rel=1e-4
    )
