"""Numbers that are positive where a person stands, in closed form, on a plane of any two axes.

With springs alone the sign of one such number is the whole verdict. With feedback the determinant
of C + P is what a root at 0 passes through: where it is not positive the person falls at every
delay. Both are continuous, so lines between their values lie on the limit itself, whatever the
steps of a grid.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np

from standfast.anthropometry.body import REFERENCE_PEOPLE, Body, ReferencePerson
from standfast.mechanics.feedback import equation_of
from standfast.parameters import OWN_BODY
from standfast.quantities import Person
from standfast.stability.springs import carried_loads
from standfast.study.study import Study


def person_on(study: Study, values: Mapping[str, Any]) -> Person:
    """Return the person of a study at some values of its axes, which may be arrays (x, y)."""
    given = {**study.fixed, **values}
    if "body_model" not in given:
        own = np.broadcast_arrays(*(np.atleast_2d(given[name]) for name in OWN_BODY))
        return Person.of({**given, **dict(zip(OWN_BODY, own, strict=True))})
    reference = REFERENCE_PEOPLE[str(given["body_model"])]
    # a body's parts come first, before the plane
    spread = Body._make(np.asarray(part)[:, None, None] for part in reference.body)
    spread_person = ReferencePerson(spread, reference.height, reference.mass)
    return Person.of({**given, "body_model": spread_person})


def margin_of_springs(study: Study, values: Mapping[str, Any]) -> np.ndarray:
    """Return K/L − 1 of the lowest joint that is not rigid: positive where the person stands.

    L is the load that the joint carries (:func:`.springs.carried_loads`), infinite where a joint
    above fails, and −1 there. With all joints rigid nothing fails: infinite.
    """
    person = person_on(study, values)
    loads = carried_loads(person.body, person.stiffness, person.gravity)
    for stiffness, load in zip(person.stiffness.joints, loads, strict=True):
        if not np.isinf(stiffness).all():
            margin: np.ndarray = stiffness / load - 1.0
            return margin
    return np.asarray(np.inf)


def static_determinant(study: Study, values: Mapping[str, Any]) -> np.ndarray:
    """Return det(C + P) of the joints that are not rigid, positive where no root is at 0 or beyond.

    In (N·m/rad)ⁿ for n joints; 1 with all rigid.
    """
    person = person_on(study, values)
    _, _, c, p, _ = equation_of(person.body, person.stiffness, person.gravity, person.given)
    free = [i for i, k in enumerate(person.stiffness.joints) if not np.isinf(k).all()]
    rows = [[np.asarray(c[i][j]) + p[i][j] for j in free] for i in free]
    return _determinant(rows)


def _determinant(rows: list[list[np.ndarray]]) -> np.ndarray:
    """Return the determinant of a small matrix of arrays, by its first row."""
    total = np.asarray(0.0 if rows else 1.0)
    for column, entry in enumerate(rows[0] if rows else []):
        rest = [row[:column] + row[column + 1 :] for row in rows[1:]]
        total = total + (-1.0) ** column * entry * _determinant(rest)
    return total
