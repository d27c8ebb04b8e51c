"""Persons whose gains and delays were measured: as a population, and assessed one by one."""

import csv
import math

import pytest
from scipy.stats import norm

import standfast as sf
from populations import RIGID, counted, events, law
from standfast.cli.app import main
from standfast.population.cohort.cohort import cohort_of
from standfast.population.cohort.counting import Block, count_block, histogram_shapes
from standfast.population.cohort.histograms import (
    Histograms,
    signed_bin_edges,
)
from standfast.population.people.study import PopulationStudy
from standfast.population.simulation import simulate
from standfast.population.summary.estimators import Distribution, fraction

G = 9.81


ONE = """id,height,mass,ankle_stiffness,feedback_delay_ms,ankle_proportional_gain
A,1.7,70,400,150,500
"""


def one_person(**feedback):
    content = {
        "gravity": G,
        "population": {"people": "one.csv", "size": 4096},
        "stiffness": {"ankle": {"distribution": "measured"}, "knee": RIGID, "hip": RIGID},
        "feedback": {
            "delay": {"distribution": "measured"},
            "proportional": {"ankle": {"distribution": "measured"}},
            "derivative": {"ankle": law("fixed", "mgh", value=0.3)},
        },
    }
    content["feedback"] |= feedback
    return content


def of_one(folder, content, **population):
    content = content | {"population": content["population"] | population}
    return PopulationStudy.from_dict(content, folder=folder)


def test_who_falls_without_delay_may_stand_in_a_later_window(tmp_path):
    """Half a swing late, P θ(t − τ) comes with the damping that is missing."""
    rows = [f"{delay},1.7,70,{delay}" for delay in (0.5, 1.5, 2.2)]
    (tmp_path / "one.csv").write_text("\n".join(["id,height,mass,feedback_delay", *rows]))
    content = one_person()
    content["stiffness"]["ankle"] = law("fixed", "mgh", value=2.0)
    gains = {"proportional": {"ankle": law("fixed", "mgh", value=0.2)}}
    content["feedback"] = {"delay": {"distribution": "measured"}, **gains}
    (found,) = counted(of_one(tmp_path, content, size=900))
    # of the persons in the order of the file only the second stands
    assert (found.rows > 0).tolist() == [[False, True], [True, False], [False, True]]
    assert found.critical_delay[:, 0].sum() == 900  # all already without delay
    assert found.by_springs.tolist() == [900, 0]


@pytest.fixture
def critical(tmp_path):
    """Critical delay of the person of ONE, who is in the file."""
    (tmp_path / "one.csv").write_text(ONE)
    body = sf.Body.from_height_mass(1.7, 70.0)
    mgh = -sf.stiffness_matrix(body, sf.Stiffness(0.0, 0.0, 0.0), gravity=G)[0, 0]
    K = sf.Stiffness(400.0, math.inf, math.inf)
    F = sf.Feedback((500.0, 0.0, 0.0), (0.3 * float(mgh), 0.0, 0.0))
    return sf.critical_delay(body, K, gravity=G, feedback=F)


ONE_NUMBER = 1e-9  # twelve digits are told, and the root is found to more


def test_gains_and_delays_are_measured_too(tmp_path, critical):
    found = simulate(of_one(tmp_path, one_person()), tmp_path / "p.h5").summary
    assert found["unstable_fraction"] == 0.0
    # all are one person, so it is told as one number
    same = found["same_for_everybody"]
    assert same["critical_delay"] == pytest.approx(critical, rel=ONE_NUMBER)
    assert same["delay_margin"] == pytest.approx(critical - 0.15, rel=ONE_NUMBER)
    assert found["critical_delay"] is found["delay_margin"] is None
    low, high = found["delay_borne"]["all"]["0.5"]["delay_interval"]
    assert low == high == same["critical_delay"]
    assert "nothing drives it" in found["drivers"]["delay_margin"]["remark"]
    more = one_person() | {"damping": {"ankle": {"distribution": "measured"}}}
    study = of_one(tmp_path, more)
    with pytest.raises(sf.InputError, match="no column ankle_damping, which the law of it"):
        study.read_people()


def test_intervals_cover_the_truth_in_95_of_100_samples(tmp_path, monkeypatch, critical):
    """Of one person, whose delay varies, the fraction and the margin's quantiles are known."""
    sigma = math.sqrt(math.log1p((0.07 / critical) ** 2))
    content = one_person(delay=law("lognormal", mean=critical, sd=0.07))
    log_mean = math.log(critical) - 0.5 * sigma**2
    share_known = norm.sf(0.5 * sigma)
    margin_known = critical - math.exp(log_mean + sigma * norm.ppf(0.9))
    inside = margins = 0
    # every block is a population of its own
    monkeypatch.setattr("standfast.population.people.study.LARGEST_BLOCK", 2048)
    seeds = 400
    study = of_one(tmp_path, content, size=seeds * 2048)
    cohort = cohort_of(study, study.read_people())
    for block in range(seeds):
        found = Histograms.empty(*histogram_shapes(cohort))
        found.add(count_block(study, cohort, Block(0, block)).histograms)
        share = fraction(*events([found]))
        inside += share.low <= share_known <= share.high
        counts = found.delay_margin[None]
        margin = Distribution(signed_bin_edges(), counts, lowest=-math.inf).quantile(0.1)
        margins += margin.low <= margin_known <= margin.high
    # three standard errors of so many seeds
    assert inside / seeds == pytest.approx(0.95, abs=0.033)
    assert margins / seeds == pytest.approx(0.95, abs=0.033)


PEOPLE = """id,height,mass,ankle_stiffness,knee_stiffness,hip_stiffness,ankle_proportional_gain
A,1.70,70,450,inf,inf,500
B,1.80,90,500,3000,900,
C,1.60,60,,inf,inf,500
"""


def rows_of(path):
    with path.open(encoding="utf-8") as file:
        return {row["id"]: row for row in csv.DictReader(file)}


def test_assess_tells_critical_delay_and_margin(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "people.csv").write_text(PEOPLE)
    assert main(["assess", "people.csv", "-o", "plain.csv", "--gravity", "9.81"]) == 0
    gains = ["--proportional", "ankle=0.8mgh", "--derivative", "ankle=200", "--damping", "hip=20"]
    gains += ["--gravity", "9.81"]
    assert main(["assess", "people.csv", *gains, "--delay", "0.15", "-o", "out.csv"]) == 0
    assert "with feedback 1 of 2 with known gains and delay stand" in capsys.readouterr().out
    rows = rows_of(tmp_path / "out.csv")
    for name, joints in (("A", (450.0, math.inf, math.inf)), ("B", (500.0, 3000.0, 900.0))):
        row = rows[name]
        body = sf.Body.from_height_mass(float(row["height_m"]), float(row["mass_kg"]))
        mgh = float(row["ankle_threshold_alone_Nm_rad"])
        gain = 500.0 if name == "A" else 0.8 * mgh
        assert float(row["ankle_proportional_gain_Nm_rad"]) == pytest.approx(gain, rel=1e-5)
        F = sf.Feedback((gain, 0.0, 0.0), (200.0, 0.0, 0.0), delay=0.15)
        K, B = sf.Stiffness(*joints), (0.0, 0.0, 20.0)
        tau = sf.critical_delay(body, K, gravity=9.81, damping=B, feedback=F)
        assert float(row["critical_delay_s"]) == pytest.approx(tau, rel=1e-4)
        assert float(row["delay_margin_s"]) == pytest.approx(tau - 0.15, rel=1e-3)
        stands = sf.is_stable(body, K, gravity=9.81, damping=B, feedback=F)
        assert row["stands_with_feedback"] == ("yes" if stands else "no")
    # whose ankle is not known is not judged; columns of springs alone are as without feedback
    assert rows["C"]["stands_with_feedback"] == rows["C"]["critical_delay_s"] == ""
    plain_rows = rows_of(tmp_path / "plain.csv")
    assert all(rows["B"][key] == plain_rows["B"][key] for key in ("stands", "safety_factor"))
    # without a delay the critical one is told alone
    assert main(["assess", "people.csv", *gains, "-o", "late.csv"]) == 0
    late = rows_of(tmp_path / "late.csv")
    assert late["A"]["critical_delay_s"] == rows["A"]["critical_delay_s"]
    assert late["A"]["delay_margin_s"] == late["A"]["stands_with_feedback"] == ""
    # and what was written is read again
    assert main(["assess", "out.csv", "--gravity", "9.81", "-o", "again.csv"]) == 0
    assert (tmp_path / "again.csv").read_text() == (tmp_path / "out.csv").read_text()


@pytest.mark.parametrize(("options", "sentence"), [
    (["--delay", "150"], "150 looks like milliseconds, write 0.15"),
    (["--proportional", "ankle"], "'ankle' is not JOINT=NUMBER, as ankle=1.2mgh"),
    (["--proportional", "ankel=3"], "did you mean 'ankle'?"),
    (["--derivative", "ankle=much"], "'much' is text; give a number"),
])  # fmt: skip
def test_wrong_options_of_assess_get_their_sentence(
    tmp_path, monkeypatch, capsys, options, sentence
):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "people.csv").write_text(PEOPLE)
    assert main(["assess", "people.csv", *options]) == 2
    said = capsys.readouterr().err
    assert sentence in said
    assert said.count("\n") == 1
