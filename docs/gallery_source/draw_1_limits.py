"""
Limits of standing
==================

Above and right of the curve of their knee a person stands. One study, one line to draw it;
one's own subject is marked.
"""

import standfast as sf

study = {
    "gravity": 9.81,
    "body": {"model": "winter", "height": 1.75, "mass": 75},
    "stiffness": {
        "ankle": {"start": 500, "stop": 2000, "num": 151},
        "knee": [1000, 1500, 2000, float("inf")],
        "hip": {"start": 100, "stop": 2000, "num": 191},
    },
    "output": {"quantities": ["stable"]},
}
atlas = sf.sweep(study, "limits.h5")
sf.plot.limits(atlas, mark={"ankle": 1000, "hip": 500, "knee": 2000, "id": "S1"})
