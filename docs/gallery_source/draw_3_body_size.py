"""
Body size and ankles
====================

The ankle's threshold along the height, a curve for each body mass index: the taller and the
heavier, the stiffer an ankle must be.
"""

import standfast as sf

study = {
    "gravity": 9.81,
    "body": {"height": {"start": 1.5, "stop": 2.0, "num": 51}, "bmi": [20, 25, 30, 35]},
    "stiffness": {"ankle": 900, "knee": 2000, "hip": 800},
    "output": {"quantities": ["critical_ankle_stiffness"]},
}
atlas = sf.sweep(study, "body-size.h5")
sf.plot.curves(atlas, "critical_ankle_stiffness")
