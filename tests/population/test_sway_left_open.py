"""Sway of persons of whom it is open whether they fall, or how much they sway: told as open."""

import math

import numpy as np
import pytest

import standfast as sf
from populations import RIGID, law
from standfast.cli.app import main
from standfast.cli.population_text import print_summary
from standfast.population.people.study import PopulationStudy

G = 9.81
# A bin is at most 0.4 % wide.
OF_BINS = 4e-3


def test_who_is_too_near_to_falling_has_no_sway_told(tmp_path, monkeypatch, capsys):
    """Of two persons at one delay, it is 1 - 3e-12 of the critical one of the first."""
    monkeypatch.chdir(tmp_path)
    bodies = [sf.Body.from_height_mass(*of_one) for of_one in ((1.7, 70.0), (1.72, 72.0))]
    springs = sf.Stiffness(400.0, math.inf, math.inf)
    gains = sf.Feedback((400.0, 0, 0), (200.0, 0, 0), 0.0)
    how = {"gravity": G, "damping": (30, 0, 0)}
    delay = (1.0 - 3e-12) * float(sf.critical_delay(bodies[0], springs, **how, feedback=gains))
    how |= {"feedback": gains._replace(delay=delay), "noise": (1, 0, 0)}
    with pytest.raises(ArithmeticError, match="too near to falling"):
        sf.sway_covariance(bodies[0], springs, **how)
    other = math.sqrt(sf.sway_covariance(bodies[1], springs, **how)[0, 0])
    (tmp_path / "people.csv").write_text("height,mass\n1.7,70\n1.72,72\n", encoding="utf-8")
    content = {
        "gravity": G,
        "population": {"people": "people.csv", "size": 40, "seed": 1},
        "stiffness": {"ankle": law("fixed", value=400.0), "knee": RIGID, "hip": RIGID},
        "damping": {"ankle": 30.0},
        "feedback": {
            "delay": law("fixed", value=delay),
            "proportional": {"ankle": law("fixed", value=400.0)},
            "derivative": {"ankle": law("fixed", value=200.0)},
        },
        "noise": {"ankle": 1.0},
        "output": {"persons": True, "quantities": ["ankle_sway", "cop_frequency"]},
    }
    population = sf.simulate(PopulationStudy.from_dict(content, folder=tmp_path), "two.h5")
    near = population.array("person_height") < 1.71
    left_open = int(near.sum())
    assert 0 < left_open < 40
    assert population.array("person_stable").all()
    assert population.summary["left_open_by_rounding"] == left_open
    for name in ("ankle_sway", "cop_frequency"):
        values = population.array(f"person_{name}")
        assert np.isnan(values[near]).all()
        told = population.summary["sway"][name]["all"]
        assert (told["persons"], told["left_open"]) == (40, left_open)
        assert told["swaying"] == 40 - left_open
        wanted = other if name == "ankle_sway" else values[~near][0]
        for of_share in told["quantiles"].values():  # everybody who is told is the other person
            assert of_share["value"] == pytest.approx(wanted, rel=OF_BINS)
    assert main(["info", "two.h5"]) == 0
    assert f"of {left_open} persons more it is open" in capsys.readouterr().out
    nerves = {key: content[key] for key in ("damping", "noise")}
    loops = {"proportional": {"ankle": 400.0}, "derivative": {"ankle": 200.0}}
    assessed = sf.assess(
        "people.csv",
        gravity=G,
        otherwise={"ankle": 400.0, "knee": math.inf, "hip": math.inf},
        nerves={**nerves, "feedback": {"delay": delay, **loops}},
    )
    assert assessed.columns["stands_with_feedback"].tolist() == ["yes", "yes"]
    for name in ("ankle_sway_rad", "cop_sway_m", "cop_velocity_m_s", "cop_frequency_Hz"):
        assert np.isnan(assessed.columns[name]).tolist() == [True, False], name


def on_the_boundary(which):
    """Two bodies of people, their springs and nerves: the first, or both, right where they fall."""
    bodies = [sf.Body.from_height_mass(*of_one) for of_one in ((1.7, 70.0), (1.72, 72.0))]
    if which == "gain":  # springs and gain together hold exactly what topples, of everybody
        ankle, gain = (law("fixed", "mgh", value=part) for part in (0.4, 0.6))
        delay = 0.1
    else:
        ankle = gain = law("fixed", value=400.0)
        feedback = sf.Feedback((400.0, 0, 0), (200.0, 0, 0), 0.0)
        springs = sf.Stiffness(400.0, math.inf, math.inf)
        how = {"gravity": G, "damping": (30, 0, 0), "feedback": feedback}
        delay = float(sf.critical_delay(bodies[0], springs, **how))
        how["feedback"] = feedback._replace(delay=delay)
        with pytest.raises(ArithmeticError, match="leaves open whether the person stands"):
            sf.sway_covariance(bodies[0], springs, **how)
        assert math.isfinite(sf.sway_covariance(bodies[1], springs, **how)[0, 0])
        # a billionth later it falls for sure
        how["feedback"] = feedback._replace(delay=(1.0 + 1e-9) * delay)
        assert math.isinf(sf.sway_covariance(bodies[0], springs, **how)[0, 0])
    return {
        "gravity": G,
        "population": {"people": "people.csv", "size": 40, "seed": 1},
        "stiffness": {"ankle": ankle, "knee": RIGID, "hip": RIGID},
        "damping": {"ankle": 30.0},
        "feedback": {
            "delay": law("fixed", value=delay),
            "proportional": {"ankle": gain},
            "derivative": {"ankle": law("fixed", value=200.0)},
        },
        "noise": {"ankle": 1.0},
        "output": {"persons": True, "quantities": ["ankle_sway", "cop_frequency"]},
    }


@pytest.mark.parametrize("which", ["delay", "gain"])
def test_who_stands_right_on_the_boundary_is_left_open_and_not_counted_as_fallen(
    which, tmp_path, monkeypatch, capsys
):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "people.csv").write_text("height,mass\n1.7,70\n1.72,72\n", encoding="utf-8")
    content = on_the_boundary(which)
    population = sf.simulate(PopulationStudy.from_dict(content, folder=tmp_path), "two.h5")
    near = (population.array("person_height") < 1.71) | (which == "gain")
    left_open = int(near.sum())
    assert left_open > 0
    assert population.summary["left_open_by_rounding"] == left_open
    for name in ("ankle_sway", "cop_frequency"):
        values = population.array(f"person_{name}")
        assert (np.isnan(values) == near).all()
        assert np.isfinite(values[~near]).all()
        told = population.summary["sway"][name]["all"]
        # nobody is among those who have no sway
        assert (told["swaying"], told["left_open"]) == (40 - left_open, left_open)
    print_summary(population.summary)
    assert (
        f"the other 0 persons have none, and are not in it; of {left_open} persons more it is"
        in (capsys.readouterr().out)
    )
    if which == "delay":
        gains = {"proportional": {"ankle": 400.0}, "derivative": {"ankle": 200.0}}
        delay = content["feedback"]["delay"]["value"]
        assessed = sf.assess(
            "people.csv",
            otherwise={"ankle": 400.0, "knee": math.inf, "hip": math.inf},
            gravity=G,
            nerves={
                "damping": {"ankle": 30.0},
                "feedback": {"delay": delay, **gains},
                "noise": {"ankle": 1.0},
            },
        )
        assert np.isnan(assessed.columns["ankle_sway_rad"]).tolist() == [True, False]
