"""
What drives the risk
====================

Sobol indices of the safety factor with their 95 % intervals: the share of its variance that
each cause explains, alone and with all others.
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
population = sf.simulate(study, "drivers.h5")
sf.plot.drivers(population, "safety_factor")
