"""
One person by four body models
==============================

Tables of segments differ, and so do the limits. The body model is an axis like any other;
``overlay`` makes its values curves.
"""

import standfast as sf

study = {
    "gravity": 9.81,
    "body": {"model": list(sf.BODY_MODELS), "height": 1.75, "mass": 75},
    "stiffness": {
        "ankle": {"start": 600, "stop": 2000, "num": 141},
        "knee": 2000,
        "hip": {"start": 100, "stop": 2000, "num": 191},
    },
    "output": {"quantities": ["stable"]},
}
atlas = sf.sweep(study, "body-models.h5")
sf.plot.limits(atlas, overlay="body_model")
