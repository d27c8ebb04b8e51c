"""
Who of a population would fall
==============================

US adults whose ankles do not grow stiffer with the weight they carry: the fraction unstable
over height and body mass index.
"""

import standfast as sf

joint = {"distribution": "lognormal", "relative_to": "single_joint_critical", "mean": 4, "sd": 1}
study = {
    "population": {"builtin": "nhanes-2017-2018", "size": 200_000, "seed": 2018},
    "stiffness": {
        "ankle": {"distribution": "lognormal", "mean": 1124, "sd": 284},
        "knee": joint,
        "hip": joint,
    },
}
population = sf.simulate(study, "adults.h5")
sf.plot.risk_map(population)
