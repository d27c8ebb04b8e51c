"""What a page is told: springs of a nominal adult, or a small atlas whose values are made up."""

import base64
import zlib
from typing import Any

import numpy as np

import standfast as sf
from standfast.explore.content import chosen_quantities, content_of
from standfast.explore.sliders import start_of

STARTS = {
    "gravity": 9.80665,
    "body_model": "edwards2007",
    "height": 1.753,
    "mass": 75.3,
    "ankle_stiffness": 1400.0,
    "knee_stiffness": 1200.0,
    "hip_stiffness": 600.0,
}
BODY = {"model": "edwards2007", "height": 1.753, "mass": 75.3}
SPRINGS: dict[str, Any] = {
    "title": "Standing of the nominal adult",
    "body": BODY,
    "stiffness": {
        "ankle": {"start": 0.0, "stop": 3000.0, "num": 61},
        "knee": 1200.0,
        "hip": {"start": 0.0, "stop": 3000.0, "num": 61},
    },
    "output": {"quantities": ["safety_factor"]},
}
SUBJECTS = [
    {"label": "Anna", "values": {"ankle_stiffness": 700.0, "hip_stiffness": 350.0}},
    {"label": "B <b>", "values": {"ankle_stiffness": 2200.0, "hip_stiffness": 900.0}},
]
ATLAS: dict[str, Any] = {
    "title": "A small atlas",
    "body": BODY,
    "stiffness": {
        "ankle": [200.0, 500.0, 900.0, 1500.0, 3000.0],
        "knee": [600.0, 1200.0, np.inf],
        "hip": [100.0, 200.0, 400.0, 800.0, 1600.0, 3200.0],
    },
}


def springs_content(**changes: Any) -> dict[str, Any]:
    """Springs and nerves of the nominal adult, computed in the page."""
    study = sf.Study.from_dict(SPRINGS)
    content = content_of(
        study,
        start=start_of(study, STARTS),
        quantities=chosen_quantities(study, (), live=True),
        subjects=SUBJECTS,
    )
    return {**content, **changes}


def embedded_content(**more: Any) -> dict[str, Any]:
    """An atlas of unequal axes, one of them by factors and one with a rigid joint.

    ``more`` are other values by quantity, each (5, 3, 6), and sections of the study.
    """
    sections = {name: more.pop(name) for name in [*more] if isinstance(more[name], dict)}
    names = ["safety_factor", "stable"] if not more else [*more]
    study = sf.Study.from_dict({**ATLAS, **sections, "output": {"quantities": names}})
    ankle, knee, hip = np.meshgrid(*study.axes.values(), indexing="ij")
    with np.errstate(all="ignore"):
        factor = np.minimum(np.minimum(ankle / 800.0, knee / 500.0), hip / 300.0)
    values = more or {"safety_factor": factor, "stable": (factor > 1.0).astype(np.uint8)}
    packed = {
        name: base64.b64encode(zlib.compress(np.ascontiguousarray(each).tobytes())).decode()
        for name, each in values.items()
    }
    start = start_of(study, {"ankle_stiffness": 500.0, "hip_stiffness": 200.0}, stops=study.axes)
    return content_of(study, start=start, quantities=names, stops=study.axes, embedded=packed)
