"""
Root locus over the delay
=========================

The rightmost root as the feedback comes later: where its real part passes 0, standing is lost.
"""

import standfast as sf

study = {
    "gravity": 9.81,
    "body": {"model": "winter", "height": 1.75, "mass": 75},
    "stiffness": {"ankle": 450, "knee": float("inf"), "hip": float("inf")},
    "damping": {"ankle": 5},
    "feedback": {
        "delay": {"start": 0, "stop": 0.5, "num": 126},
        "proportional": {"ankle": [500, 800]},
        "derivative": {"ankle": 250},
    },
    "output": {"quantities": ["stable", "decay_rate", "sway_frequency"]},
}
atlas = sf.sweep(study, "root-locus.h5")
sf.plot.locus(atlas)
