"""What the page is told: parameters with their sliders, quantities, people, subjects, the start.

Plain values for JSON, which has no infinity: it is the text "inf", and NaN is null.
"""

import json
import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from standfast.anthropometry.body import REFERENCE_PEOPLE
from standfast.anthropometry.tables import ANKLE_HEIGHT
from standfast.errors import InputError, nearest_name, shortened
from standfast.explore.sliders import OWN, span_of
from standfast.figures.choosing import CUT_AT, RUNNING_AWAY
from standfast.parameters import (
    NOISES,
    OWN_BODY,
    PARAMETERS,
    STANDARD_GRAVITY,
    STIFFNESSES,
    Parameter,
)
from standfast.quantities import QUANTITIES
from standfast.quantities.row import Quantity
from standfast.study.study import Study
from standfast.thresholds.planes import PLANE_AXES, axes_of_plane
from standfast.version import __version__

# The study of whom the page shows when it is given none.
NOMINAL: Mapping[str, Any] = {
    "title": "Nominal adult",
    "body": {"model": "edwards2007", "height": 1.753, "mass": 75.3},
    "stiffness": {
        "ankle": {"start": 0.0, "stop": 2000.0, "num": 401},
        "knee": 2000.0,
        "hip": {"start": 0.0, "stop": 1500.0, "num": 401},
    },
    "output": {"quantities": ["safety_factor"]},
}
# Where its point lies: an adult who just stands.
NOMINAL_START: Mapping[str, float | str] = {"ankle_stiffness": 1200.0, "hip_stiffness": 500.0}
THRESHOLDS = [f"critical_{name}" for name in STIFFNESSES]
# In which unit sway is read, by its SI unit, and how many of them that is.
SWAY_UNITS = {"rad": ("°", math.degrees(1.0)), "m": ("mm", 1e3), "m/s": ("mm/s", 1e3)}


def content_of(
    study: Study,
    *,
    start: Mapping[str, float | str],
    quantities: Sequence[str],
    stops: Mapping[str, np.ndarray] | None = None,
    embedded: Mapping[str, Any] | None = None,
    subjects: Sequence[Mapping[str, Any]] = (),
    notes: Sequence[str] = (),
    token: str | None = None,
) -> dict[str, Any]:
    """Return what the page is told.

    Parameters
    ----------
    study
        what is looked at: of an atlas, or computed as the reader asks.
    start
        value of each parameter that the page opens with (:func:`start_of`).
    quantities
        names of what the map can show, the first at the start (:func:`chosen_quantities`).
    stops
        of an atlas the values of each axis that the page has; None: formulas.
    embedded
        of an exported page the values of quantities by name, encoded.
    subjects
        each with ``label`` and ``values`` by name.
    notes
        sentences about what the page leaves out, which stand at its top.
    token
        what the page shows the server; None: an exported page.

    Returns
    -------
    dict, ready for :func:`content_text`.
    """
    source = "formulas" if stops is None else "embedded" if embedded is not None else "atlas"
    rows = [_parameter(study, row, start[row.name], stops) for row in _rows(study, stops, start)]
    x, y = plane_of(study, quantities[0], live=stops is None)
    encoded = None
    if stops is not None and embedded is not None:
        encoded = {"values": dict(embedded)}
    return {
        "title": study.title or "Standing",
        "notes": list(notes),
        "version": __version__,
        "served": token is not None,
        "token": token,
        "source": source,
        "parameters": rows,
        "people": _people(study, start),
        "constants": _constants(),
        "quantities": [_quantity(study, name, live=stops is None) for name in quantities],
        "embedded": encoded,
        "subjects": [for_json(dict(one)) for one in subjects],
        "start": {"x": x, "y": y, "quantity": quantities[0]},
    }


def content_text(content: Mapping[str, Any]) -> str:
    """Return content as JSON that may stand in a page: nothing in it ends or begins a tag."""
    text = json.dumps(content, ensure_ascii=False, allow_nan=False, separators=(",", ":"))
    return text.replace("<", "\\u003c").replace(">", "\\u003e").replace("&", "\\u0026")


def chosen_quantities(study: Study, wanted: Sequence[str], *, live: bool) -> tuple[str, ...]:
    """Return the quantities of a page: those that are wanted, else the study's.

    ``live``: a study's come first, and all others after them, as they cost nothing.

    Raises
    ------
    InputError
        for a name that is none of them.
    """
    builtin = [name for name, row in QUANTITIES.items() if not row.own]
    known = (*study.quantities, *(n for n in builtin if live and n not in study.quantities))
    for name in wanted:
        if name not in known:
            hint = nearest_name(name, known) or f" (quantities: {', '.join(known)})"
            raise InputError(f"--quantity: there is no {shortened(name)}{hint}")
    return tuple(dict.fromkeys(wanted)) or known


def plane_of(study: Study, quantity: str, *, live: bool) -> tuple[str, str]:
    """Return the axes that the map opens with, the horizontal one first: as the figures have it.

    Of short axes the two longest; a study that is computed live may lack them, and has all others,
    but of its own only those that matter to the quantity.

    Raises
    ------
    InputError
        if an atlas has not two axes of numbers.
    """
    if chosen := axes_of_plane(study, study.axes_of(quantity)):
        return chosen
    sizes = {
        name: int(np.isfinite(axis).sum())
        for name, axis in study.axes.items()
        if not PARAMETERS[name].choices and (not live or name in study.axes_of(quantity))
    }
    axes = sorted((name for name in sizes if sizes[name] > 1), key=lambda name: -sizes[name])
    if live:
        axes = list(dict.fromkeys([*axes, *PLANE_AXES]))
    if len(axes) < 2:
        raise InputError("the atlas has not two axes of numbers, and a map needs two")
    x, y = sorted(axes[:2], key=[*PARAMETERS].index)
    return x, y


def _rows(
    study: Study, stops: Mapping[str, np.ndarray] | None, start: Mapping[str, Any]
) -> list[Parameter]:
    """Return the parameters that the page has: of an atlas those of its study."""
    if stops is not None:
        return [row for name, row in PARAMETERS.items() if name in study.parameters]
    return [row for name, row in PARAMETERS.items() if name in start and name not in OWN_BODY]


def _parameter(
    study: Study,
    row: Parameter,
    start: float | str,
    stops: Mapping[str, np.ndarray] | None,
) -> dict[str, Any]:
    told = {
        "name": row.name,
        "words": row.words,
        "unit": row.unit,
        "meaning": row.meaning,
        "section": row.section,
        "lowest": row.lowest,
        "highest": row.highest,
        "or_rigid": row.or_rigid,
        "choices": list(row.choices),
        "start": start,
    }
    if stops is not None:
        values = stops.get(row.name)
        more = {"kind": "fixed"} if values is None else {"kind": "stops", "stops": values.tolist()}
    elif start == OWN:
        more = {"kind": "fixed"}
    elif row.choices:
        more = {"kind": "choice"}
    else:
        low, high, step = span_of(row, study.axes.get(row.name), float(start))
        more = {"kind": "range", "from": low, "to": high, "step": step}
    found: dict[str, Any] = for_json(told | more)
    return found


def _quantity(study: Study, name: str, *, live: bool) -> dict[str, Any]:
    row = QUANTITIES[name]
    return {
        "name": name,
        "words": row.words,
        "unit": row.unit,
        "meaning": row.meaning,
        "dtype": row.dtype,
        "flags": list(row.flags),
        # what a page computes has gains of its own, and with it the verdict
        "limit": row.limit_of_standing(study.has_gains and not live),
        "of_noise": is_sway(row),
        # who falls has no bounds of sway, and where no stiffness suffices all fall
        "infinite_falls": is_sway(row) or name in THRESHOLDS,
        "jumps": row.jumps,
        "axes": None if live else list(study.axes_of(name)),
    }


def is_sway(row: Quantity) -> bool:
    """Return whether a quantity is of the sway under noise."""
    return row.reference is None and any(map(row.depends_on, NOISES))


def _constants() -> dict[str, Any]:
    """Return the numbers that the page has in common with the package."""
    units = {name: SWAY_UNITS.get(row.unit) for name, row in QUANTITIES.items() if is_sway(row)}
    seen = {name: {"unit": unit[0], "factor": unit[1]} for name, unit in units.items() if unit}
    return {
        "gravity": STANDARD_GRAVITY,
        "ankle_height": ANKLE_HEIGHT,
        "running_away": RUNNING_AWAY,
        "cut_at": CUT_AT,
        "seen": seen,
    }


def _people(study: Study, start: Mapping[str, float | str]) -> dict[str, dict[str, float]]:
    """Return the reference people, and who is measured."""
    people = {}
    for model, person in REFERENCE_PEOPLE.items():
        segments = (float(number) for part in person.body for number in part)
        numbers = dict(zip(OWN_BODY, segments, strict=True))
        people[model] = {**numbers, "height": float(person.height), "mass": float(person.mass)}
    if not study.parameters.keys().isdisjoint(OWN_BODY):
        own = {name: float(start[name]) for name in OWN_BODY}
        people = {OWN: {**own, "height": 1.0, "mass": 1.0}, **people}
    return people


def for_json(value: Any) -> Any:
    """Return a value without what JSON does not have."""
    if isinstance(value, Mapping):
        return {key: for_json(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [for_json(item) for item in value]
    if isinstance(value, float) and not math.isfinite(value):
        return None if math.isnan(value) else "inf" if value > 0.0 else "-inf"
    return value
