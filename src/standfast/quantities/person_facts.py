"""What damping and delayed feedback make of one person, in plain numbers."""

import math
from collections.abc import Callable, Mapping
from typing import Any

from standfast.anthropometry.body import REFERENCE_PEOPLE
from standfast.mechanics.feedback import Feedback, damping_rows, delay_of, gain_rows
from standfast.parameters import PARAMETERS
from standfast.quantities.row import Person
from standfast.stability import feedback as delayed

# An imaginary part below it, relative to the root, is that of a real one; and so much later than
# the critical delay, relative to it, its crossing is looked for.
REAL = 1e-9


def person_of(given: Mapping[str, Any]) -> Person:
    """Return the person that parameters by name describe, a body model by its name."""
    reference = {k: REFERENCE_PEOPLE[v] for k, v in given.items() if k == "body_model"}
    return Person.of({**given, **reference})


def facts_with_feedback(person: Person) -> dict[str, Any]:
    """Find verdict, delays and rightmost root of a person with damping and feedback.

    Returns
    -------
    dict of ``stands``, ``critical_delay`` and ``delay_margin`` (s), ``critical_frequency`` (Hz, of
    the sway that is lost at the critical delay; None if none is), ``unstable_roots``, and
    ``rightmost_root`` (real and imaginary part, 1/s). What rounding leaves open is None.
    """
    given = person.given
    damping = [list(row) for row in damping_rows(given)]
    proportional, derivative = (gain_rows(given, kind) for kind in ("proportional", "derivative"))
    late = Feedback(proportional, derivative, delay_of(given))
    of = (person.body, person.stiffness, person.gravity)

    def unless_open(function: Callable[..., Any]) -> Any:
        try:
            return function(*of, damping=damping, feedback=late)
        except ArithmeticError:  # rounding leaves it open, or a root is not proven
            return None

    critical = unless_open(delayed.critical_delay)
    lost = None
    longest = PARAMETERS["feedback_delay"].highest
    if critical and critical < longest:
        slightly_later = min(critical * (1.0 + REAL), longest)
        crossings = delayed.delay_crossings(
            *of, damping=damping, feedback=late, longest=slightly_later
        )
        lost = min(crossings, key=lambda crossing: abs(crossing[0] - critical))[1] / math.tau
    root = unless_open(delayed.rightmost_root)
    return {
        "stands": unless_open(delayed.is_stable),
        "critical_delay": critical,
        "delay_margin": None if critical is None else critical - late.delay,
        "critical_frequency": lost,
        "unstable_roots": unless_open(delayed.unstable_roots),
        "rightmost_root": None if root is None else [root.real, _unless_rounding(root)],
    }


def _unless_rounding(root: complex) -> float:
    """Return the imaginary part of a root, or 0 where it is rounding of a real one."""
    return root.imag if root.imag > REAL * abs(root) else 0.0
