"""What a page is told, made by hand: springs of the nominal adult, or a small atlas embedded."""

import base64
import zlib

import numpy as np

from standfast.anthropometry.body import REFERENCE_PEOPLE
from standfast.parameters import OWN_BODY, PARAMETERS, STIFFNESSES
from standfast.quantities import QUANTITIES

STARTS = {
    "gravity": 9.80665,
    "body_model": "edwards2007",
    "height": 1.753,
    "mass": 75.3,
    "ankle_stiffness": 1400.0,
    "knee_stiffness": 1200.0,
    "hip_stiffness": 600.0,
}
SPANS = {
    "gravity": (1.0, 15.0, 0.01),
    "height": (1.2, 2.1, 0.001),
    "mass": (30.0, 150.0, 0.1),
    "feedback_delay": (0.0, 0.5, 0.001),
}
SHOWN = ("ankle_stiffness", "hip_stiffness")


def people() -> dict:
    """Reference people, with the numbers of each segment by name."""
    found = {}
    for name, person in REFERENCE_PEOPLE.items():
        numbers = [float(number) for part in person.body for number in part]
        size = {"height": float(person.height), "mass": float(person.mass)}
        found[name] = {**dict(zip(OWN_BODY, numbers, strict=True)), **size}
    return found


def _parameter(name: str) -> dict:
    row = PARAMETERS[name]
    base = {
        "name": name,
        "words": row.words,
        "symbol": row.symbol,
        "unit": row.unit,
        "meaning": row.meaning,
        "section": row.section,
        "lowest": row.lowest if np.isfinite(row.lowest) else "-inf",
        "highest": row.highest if np.isfinite(row.highest) else "inf",
        "or_rigid": row.or_rigid,
        "choices": list(row.choices),
        "start": STARTS.get(name, row.default),
    }
    if row.choices:
        return {**base, "kind": "choice"}
    low, high, step = SPANS.get(name, _span(name))
    return {**base, "kind": "range", "from": low, "to": high, "step": step}


def _span(name: str) -> tuple[float, float, float]:
    if name in STIFFNESSES:
        return 0.0, 3000.0, 1.0
    return (0.0, 100.0, 0.5) if name.endswith("damping") else (-500.0, 2000.0, 1.0)


def _quantity(row, axes=None) -> dict:
    return {
        "name": row.name,
        "words": row.words,
        "symbol": row.symbol,
        "unit": row.unit,
        "meaning": row.meaning,
        "dtype": row.dtype,
        "flags": list(row.flags),
        "limit": row.limit,
        "of_nerves": row.reference is None,
        "axes": axes,
    }


def springs_content(**changes) -> dict:
    """Springs and nerves of the nominal adult, computed in the page."""
    names = [name for name in PARAMETERS if name not in (*OWN_BODY, "bmi")]
    content = {
        "title": "Standing of the nominal adult",
        "version": "0.0",
        "served": False,
        "token": None,
        "source": "formulas",
        "parameters": [_parameter(name) for name in names],
        "people": people(),
        "quantities": [_quantity(row) for row in QUANTITIES.values() if not row.own],
        "has_nerves": True,
        "embedded": None,
        "subjects": [
            {"label": "Anna", "values": {"ankle_stiffness": 700, "hip_stiffness": 350}},
            {"label": "B <b>", "values": {"ankle_stiffness": 2200, "hip_stiffness": 900}},
        ],
        "start": {"x": "ankle_stiffness", "y": "hip_stiffness", "quantity": "safety_factor"},
    }
    return {**content, **changes}


def embedded_content() -> dict:
    """A small atlas of unequal axes, one of them by factors and one with a rigid joint."""
    stops = {
        "ankle_stiffness": [200.0, 500.0, 900.0, 1500.0, 3000.0],
        "knee_stiffness": [600.0, 1200.0, np.inf],
        "hip_stiffness": [100.0, 200.0, 400.0, 800.0, 1600.0, 3200.0],
    }
    ankle, knee, hip = np.meshgrid(*stops.values(), indexing="ij")
    with np.errstate(all="ignore"):
        factor = np.minimum(np.minimum(ankle / 800.0, knee / 500.0), hip / 300.0)
    values = {"safety_factor": factor, "stable": (factor > 1.0).astype(np.uint8)}
    plain = springs_content()
    parameters = []
    for row in plain["parameters"]:
        if row["name"] in stops:
            said = ["inf" if np.isinf(stop) else stop for stop in stops[row["name"]]]
            parameters.append({**row, "kind": "stops", "stops": said, "start": said[1]})
        elif row["name"] in STARTS:
            parameters.append({**row, "kind": "fixed"})
    packed = {
        name: base64.b64encode(zlib.compress(np.ascontiguousarray(each).tobytes())).decode()
        for name, each in values.items()
    }
    return springs_content(
        title="A small atlas",
        source="embedded",
        parameters=parameters,
        quantities=[_quantity(QUANTITIES[name], list(stops)) for name in values],
        has_nerves=False,
        embedded={
            "axes": {row["name"]: row["stops"] for row in parameters if row["kind"] == "stops"},
            "values": packed,
        },
    )
