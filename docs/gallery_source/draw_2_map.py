"""
A margin as a map
=================

How much is to spare: the factor by which all stiffnesses could be divided. Where it is below 1
the person falls, and the map is hatched.
"""

import standfast as sf

study = {
    "gravity": 9.81,
    "body": {"model": "winter", "height": 1.75, "mass": 75},
    "stiffness": {
        "ankle": {"start": 500, "stop": 2000, "num": 151},
        "knee": 2000,
        "hip": {"start": 100, "stop": 2000, "num": 191},
    },
    "output": {"quantities": ["stable", "safety_factor"]},
}
atlas = sf.sweep(study, "map.h5")
sf.plot.map(atlas, "safety_factor")
