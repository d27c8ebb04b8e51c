"""The files that the examples of docstrings and pages read, small."""

import math
from pathlib import Path

import numpy as np

import standfast as sf
from recordings import sway, table

ROOT = Path(__file__).parents[2]
GRID = {"start": 0, "stop": 2000, "num": 21}
PEOPLE = "id,sex,age,height,mass\nA,female,71,1.62,60\nB,male,68,1.78,84\nC,female,35,1.70,66\n"
STUDY = """\
title = "A few stiffnesses"
[body]
height = 1.66
mass = 68
[stiffness]
ankle = [800, 900]
knee = 1500
hip = [300, 400, 500]
[output]
quantities = ["stable", "safety_factor"]
"""
LIMITS = {
    "title": "Nominal adult",
    "gravity": 9.8,
    "body": {"model": "edwards2007", "height": 1.753, "mass": 75.3},
    "stiffness": {"ankle": GRID, "knee": [1000, 2000, math.inf], "hip": GRID},
    "output": {"quantities": ["stable", "safety_factor", "critical_ankle_stiffness"]},
}
# One link with feedback of the ankle, over the delay.
LOCUS = {
    "gravity": 9.81,
    "body": {"height": 1.75, "mass": 75},
    "stiffness": {"ankle": 500, "knee": math.inf, "hip": math.inf},
    "damping": {"ankle": 5},
    "feedback": {
        "delay": {"start": 0, "stop": 0.4, "num": 21},
        "proportional": {"ankle": 700},
        "derivative": {"ankle": 250},
    },
    "output": {"quantities": ["stable", "decay_rate", "sway_frequency"]},
}
SPREAD = {"distribution": "normal", "relative_to": "mgh", "mean": 1.2, "sd": 0.2}
ADULTS = {
    "population": {"builtin": "nhanes-2017-2018", "size": 4000, "seed": 1},
    "stiffness": {
        "ankle": SPREAD,
        "knee": {"distribution": "fixed", "value": math.inf},
        "hip": {"distribution": "fixed", "value": 600},
    },
}
FED_BACK = {
    **ADULTS,
    "population": {**ADULTS["population"], "size": 500},
    "stiffness": {
        joint: {"distribution": "fixed", "value": stiffness}
        for joint, stiffness in (("ankle", 400), ("knee", math.inf), ("hip", math.inf))
    },
    "feedback": {
        "delay": {"law": "young"},
        "proportional": {"ankle": {"distribution": "fixed", "relative_to": "mgh", "value": 0.9}},
        "derivative": {"ankle": {"distribution": "fixed", "relative_to": "mgh", "value": 0.4}},
    },
}

SWAYING = {
    **FED_BACK,
    "noise": {"ankle": 1.0},
    "output": {"quantities": ["cop_sway"]},
}


def make_files(folder: Path) -> None:
    """Write them into a folder."""
    (folder / "studies").symlink_to(ROOT / "studies")
    (folder / "study.toml").write_text(STUDY, "utf-8")
    (folder / "people.csv").write_text(PEOPLE, "utf-8")
    _, ap, ml = sway()
    text = table(["COP_AP", "COP_ML"], [1e3 * np.asarray(ap), 1e3 * np.asarray(ml)])
    (folder / "recording.csv").write_text(text, "utf-8")
    sf.sweep(LIMITS, folder / "atlas.h5")
    sf.sweep(LOCUS, folder / "root-locus.h5")
    sf.simulate(ADULTS, folder / "people.h5")
    sf.simulate(FED_BACK, folder / "people-feedback.h5")
    sf.simulate(SWAYING, folder / "people-sway.h5")
