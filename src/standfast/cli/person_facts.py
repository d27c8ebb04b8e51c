"""What ``standfast person`` finds about one person, in plain numbers."""

import math
from collections.abc import Callable
from typing import Any

from standfast.cli.person_text import fed_back
from standfast.parameters import JOINTS, PARAMETERS

# An imaginary part below it, relative to the root, is that of a real one; and so much later than
# the critical delay, relative to it, its crossing is looked for.
REAL = 1e-9


def facts_of(given: dict[str, Any]) -> dict[str, Any]:
    """Find everything about the person; what rounding leaves open is None."""
    from standfast.mechanics.matrices import joint_gravity
    from standfast.stability.feedback import is_stable
    from standfast.stability.margins import safety_factor, stiffness_reserve
    from standfast.stability.modes import frequency_of, growth_rate_of, modes
    from standfast.stability.springs import critical_stiffness

    person = who(given)
    of = (person.body, person.stiffness, person.gravity)
    alone = joint_gravity(person.body, person.gravity)[0]
    found = modes(*of)
    finite = [
        (float(v), s)
        for v, s in zip(found.eigenvalues, found.shapes.T, strict=True)
        if math.isfinite(v)
    ]
    return {
        "given": given,
        "body": {name: part.tolist() for name, part in person.body._asdict().items()},
        "stands_by_springs": is_stable(*of),
        "stiffness": dict(zip(JOINTS, map(float, person.stiffness.joints), strict=True)),
        "thresholds": dict(zip(JOINTS, critical_stiffness(*of).joints, strict=True)),
        "thresholds_alone": dict(zip(JOINTS, map(float, alone), strict=True)),
        "safety_factor": float(safety_factor(*of)),
        "stiffness_reserve": float(stiffness_reserve(*of)),
        "modes": [
            {
                "eigenvalue": value,
                "frequency": float(frequency_of(value)),
                "growth_rate": float(growth_rate_of(value)),
                "rotations": dict(zip(JOINTS, (shape + 0.0).tolist(), strict=True)),
            }
            for value, shape in finite
        ],
        **_fed_back(given),
    }


def who(given: dict[str, Any]) -> Any:
    """Return the person that parameters by name describe."""
    from standfast.anthropometry.body import REFERENCE_PEOPLE
    from standfast.quantities import Person

    reference = {k: REFERENCE_PEOPLE[v] for k, v in given.items() if k == "body_model"}
    return Person.of({**given, **reference})


def _fed_back(given: dict[str, Any]) -> dict[str, Any]:
    """Find what becomes of the person with damping and feedback, if any is given."""
    from standfast.mechanics.feedback import Feedback, damping_rows, delay_of, gain_rows
    from standfast.stability import feedback as delayed

    if not fed_back(given):
        return {}
    person = who(given)
    proportional, derivative = (gain_rows(given, kind) for kind in ("proportional", "derivative"))
    late = Feedback(proportional, derivative, delay_of(given))
    of = (person.body, person.stiffness, person.gravity)
    more = {"damping": [list(row) for row in damping_rows(given)], "feedback": late}

    def unless_open(function: Callable[..., Any]) -> Any:
        try:
            return function(*of, **more)
        except ArithmeticError:  # rounding leaves it open, or a root is not proven
            return None

    critical = unless_open(delayed.critical_delay)
    lost = None
    longest = PARAMETERS["feedback_delay"].highest
    if critical and critical < longest:
        slightly_later = min(critical * (1.0 + REAL), longest)
        crossings = delayed.delay_crossings(
            *of, damping=damping_rows(given), feedback=late, longest=slightly_later
        )
        lost = min(crossings, key=lambda crossing: abs(crossing[0] - critical))[1] / math.tau
    root = unless_open(delayed.rightmost_root)
    return {
        "stands_with_feedback": unless_open(delayed.is_stable),
        "critical_delay": critical,
        "delay_margin": None if critical is None else critical - late.delay,
        "critical_frequency": lost,
        "unstable_roots": unless_open(delayed.unstable_roots),
        "rightmost_root": None if root is None else [root.real, _unless_rounding(root)],
    }


def _unless_rounding(root: complex) -> float:
    """Return the imaginary part of a root, or 0 where it is rounding of a real one."""
    return root.imag if root.imag > REAL * abs(root) else 0.0
