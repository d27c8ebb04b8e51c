"""What damping, delayed feedback and noise make of one person, in plain numbers."""

import contextlib
import math
from collections.abc import Callable, Mapping
from typing import Any

from standfast.anthropometry.body import REFERENCE_PEOPLE
from standfast.mechanics.feedback import Feedback, damping_rows, delay_of, gain_rows
from standfast.numerics.arrays import TURN
from standfast.parameters import JOINTS, NOISES, PARAMETERS
from standfast.quantities.row import Person
from standfast.stability import feedback as delayed
from standfast.stability.sway.density import COM, COP, COP_TIMES_OMEGA, COP_VELOCITY
from standfast.stability.sway.person import sway_covariance, sway_integrals

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
    damping, late = nerves_of(person)
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


def facts_of_sway(person: Person) -> dict[str, Any] | None:
    """Find how much a person sways whose joints' torques are noisy.

    Returns
    -------
    dict of ``covariance`` (of the rotations of ankle, knee and hip, rad²), and under the names of
    the quantities the standard deviations ``ankle_sway``, ``knee_sway``, ``hip_sway`` (rad),
    ``com_sway``, ``cop_sway`` (m) and ``cop_velocity`` (m/s), and ``cop_frequency`` (Hz). They are
    infinite, and the frequency None, where the person falls or nothing damps it; what rounding
    leaves open is None. The whole is None where no joint that turns is noisy.
    """
    noise = [float(person.given[name]) for name in NOISES]
    turns = [math.isfinite(float(stiffness)) for stiffness in person.stiffness.joints]
    if not any(one and there for one, there in zip(noise, turns, strict=True)):
        return None
    damping, late = nerves_of(person)
    of = (person.body, person.stiffness, person.gravity)
    given: dict[str, Any] = {"damping": damping, "feedback": late, "noise": noise}
    covariance: list[list[float | None]] = [[None] * len(JOINTS) for _ in JOINTS]
    rows = (COM, COP, COP_VELOCITY, COP_TIMES_OMEGA)
    found: list[float | None] = [None] * len(rows)
    with contextlib.suppress(ArithmeticError):
        found = sway_integrals(*of, **given, rows=rows)
        covariance = sway_covariance(*of, **given).tolist()
    *variances, times_omega = found
    pressure = variances[1]
    frequency = None
    if pressure and times_omega is not None and math.isfinite(pressure):
        frequency = times_omega / (TURN * pressure)
    variances = [covariance[joint][joint] for joint in range(len(JOINTS))] + variances
    names = (*(f"{joint}_sway" for joint in JOINTS), "com_sway", "cop_sway", "cop_velocity")
    sizes = [None if size is None else math.sqrt(size) for size in variances]
    return {
        **dict(zip(names, sizes, strict=True)),
        "cop_frequency": frequency,
        "covariance": covariance,
    }


def nerves_of(person: Person) -> tuple[list[list[Any]], Feedback]:
    """Return the damping matrix and the feedback of a person."""
    given = person.given
    damping = [list(row) for row in damping_rows(given)]
    proportional, derivative = (gain_rows(given, kind) for kind in ("proportional", "derivative"))
    return damping, Feedback(proportional, derivative, delay_of(given))


def _unless_rounding(root: complex) -> float:
    """Return the imaginary part of a root, or 0 where it is rounding of a real one."""
    return root.imag if root.imag > REAL * abs(root) else 0.0
