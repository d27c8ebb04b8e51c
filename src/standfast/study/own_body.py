"""A body that a study gives segment by segment, instead of by height and mass.

Each number is a parameter (``shank_mass``), so it may vary like any other. A study may give the
segments of a part together, in the order of :class:`standfast.Body`, or a whole ``Body``.
"""

import itertools
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from standfast.anthropometry.body import Body, implausible
from standfast.errors import InputError, shortened
from standfast.parameters import OWN_BODY, PARAMETERS, SEGMENT_NUMBERS, SEGMENT_PARAMETERS
from standfast.study.canonical import Value

FEW = 2  # numbers of segments that are told one by one
SCALED = ("height", "mass", "bmi", "body_model")


def laid_out(body: Any) -> Any:
    """Return the table of a body with each part of its own segments as a table by segment."""
    if isinstance(body, Body):
        body = body._asdict()
    if not isinstance(body, Mapping):
        return body
    return {
        key: _by_segment(key, value) if key in SEGMENT_NUMBERS else value
        for key, value in body.items()
    }


def _by_segment(part: str, given: Any) -> Any:
    if isinstance(given, Mapping):
        return given
    segments = [PARAMETERS[name].key for name in SEGMENT_NUMBERS[part]]
    many = isinstance(given, list | tuple) or (isinstance(given, np.ndarray) and given.ndim == 1)
    if not many or len(given) != len(segments):
        words = ", ".join(segments).replace("_", " ")
        raise InputError(
            f"body.{part} = {shortened(given)} is not {len(segments)} numbers; give {words} "
            f"in {SEGMENT_PARAMETERS[part].unit}"
        )
    return dict(zip(segments, given, strict=True))


def is_own(parameters: Mapping[str, Value]) -> bool:
    """Return whether a body is given by its own segments."""
    return not parameters.keys().isdisjoint(OWN_BODY)


def other_body(there: Mapping[str, Value], here: Mapping[str, Value]) -> str:
    """Say in short how bodies differ of which one has own segments; empty if key by key is."""
    if is_own(there) != is_own(here):
        kinds = ("own segments", "scaled from height and mass")
        first, second = kinds if is_own(there) else reversed(kinds)
        return f"{first} there, {second} here"
    differ = [name for name in OWN_BODY if there.get(name) != here.get(name)]
    if len(differ) <= FEW:
        return ""
    return f"other segments there ({', '.join(differ[:FEW])}, … of {len(differ)} numbers)"


def check_own_body(
    parameters: Mapping[str, Value], ends: Callable[[Value], tuple[float, ...]]
) -> None:
    """Refuse own segments that are not whole, beside a height or mass, or that no body has.

    ``ends`` returns the ends of a value that may be an axis; every combination of them must hold.
    """
    beside = [PARAMETERS[name].key for name in SCALED if name in parameters]
    if beside:
        raise InputError(
            f"[body] has own segments and {' and '.join(beside)}; give all segments of the person, "
            "or height, mass and model, from which they are scaled"
        )
    missing = [PARAMETERS[name].place for name in OWN_BODY if name not in parameters]
    if missing:
        raise InputError(
            f"{missing[0]} is missing; a body of its own segments needs all of them: "
            f"{', '.join(SEGMENT_NUMBERS)} (standfast.Body.from_height_mass fills in what is "
            "not measured)"
        )
    for numbers in itertools.product(*(ends(parameters[name]) for name in OWN_BODY)):
        if reason := implausible(dict(zip(OWN_BODY, numbers, strict=True))):
            raise InputError(f"[body]: {reason}")
