"""
Gains with which a person stands
================================

One link with the passive stiffness of a calf, and feedback of the ankle that comes late: a
region for each delay. Too little gain does not hold, too much drives an oscillation.
"""

import standfast as sf

study = {
    "gravity": 9.81,
    "body": {"model": "winter", "height": 1.75, "mass": 75},
    "stiffness": {"ankle": 450, "knee": float("inf"), "hip": float("inf")},
    "damping": {"ankle": 5},
    "feedback": {
        "delay": [0.1, 0.15, 0.2],
        "proportional": {"ankle": {"start": 0, "stop": 2500, "num": 126}},
        "derivative": {"ankle": {"start": 0, "stop": 900, "num": 91}},
    },
    "output": {"quantities": ["stable", "decay_rate"]},
}
atlas = sf.sweep(study, "gains.h5")
sf.plot.limits(atlas)
