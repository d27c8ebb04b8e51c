"""The rows of quantities that springs and gravity decide, and of the verdict."""

from collections.abc import Callable
from typing import Any

from standfast.anthropometry.body import Body
from standfast.mechanics.joints import Stiffness
from standfast.numerics.arrays import Scalar
from standfast.parameters import STIFFNESS_UNIT
from standfast.quantities.row import NERVES, Person, Quantity, Step
from standfast.stability import fast, springs
from standfast.stability.delay import answers
from standfast.stability.exact import SCALING_ROUNDING, exact_threshold
from standfast.stability.margins import safety_factor, stability_determinant, stiffness_reserve
from standfast.stability.modes import frequency_of, growth_rate_of, modes, ratio_to_ankle
from standfast.stability.rounding import threshold_interval


def of_springs(function: Callable[[Body, Stiffness, Scalar], Any]) -> Callable[[Person], Any]:
    """Turn a function of body, stiffness and gravity into one of a person."""
    return lambda person: function(person.body, person.stiffness, person.gravity)


def _threshold(joint: str, function: Callable[..., Scalar], *others: str) -> Quantity:
    """Return the threshold of a joint, a function of body, stiffness of the others and gravity."""

    def found(person: Person) -> Scalar:
        given = (getattr(person.stiffness, other) for other in others)
        return function(person.body, *given, person.gravity, person.stiffness.couplings)

    return Quantity(
        f"critical_{joint}_stiffness",
        "K_{" + joint[0] + r",\mathrm{crit}}",
        STIFFNESS_UNIT,
        f"{joint} stiffness at which the person just stands, {' and '.join(others)} as given",
        found,
        without=(f"{joint}_stiffness", *NERVES),
    )


def _eigenvalue(number: int, mode: str) -> Quantity:
    return Quantity(
        f"eigenvalue_{number}",
        rf"\lambda_{number}",
        "rad²/s²",
        f"eigenvalue of the {mode} mode",
        modes_of,
        lambda _, found: found.eigenvalues[number - 1],
        without=NERVES,
        fast=eigenvalues_of,
        limit=0.0 if number == 1 else None,
    )


def _rotation(joint: str) -> Quantity:
    return Quantity(
        f"{joint}_ankle_ratio",
        rf"\theta_{joint[0]}/\theta_a",
        "1",
        f"{joint} rotation per ankle rotation in the least stable mode",
        modes_of,
        lambda one, found: ratio_to_ankle(joint, one.stiffness, found),
        without=NERVES,
        jumps=True,
    )


modes_of = of_springs(modes)
eigenvalues_of = of_springs(fast.fast_eigenvalues)

STANDING = Step(
    along="ankle_stiffness",
    interval=lambda one: threshold_interval(
        one.body,
        one.stiffness.knee,
        one.stiffness.hip,
        one.gravity,
        one.stiffness.couplings,
        scaling=SCALING_ROUNDING,
    ),
    exact=exact_threshold,
)

OF_SPRINGS = (
    Quantity(
        "stable",
        "",
        "1",
        "verdict: the person stands",
        of_springs(springs.verdict),
        without=NERVES,
        dtype="uint8",
        step=STANDING,
        flags=("unstable", "stable"),
        fed_back=answers.stands,
        crossings_of="who may stand",
    ),
    Quantity(
        "stability_determinant",
        r"\det C",
        "(N·m/rad)³",
        "determinant of the stiffness matrix",
        of_springs(stability_determinant),
        without=NERVES,
    ),
    _threshold("ankle", springs.critical_ankle_stiffness, "knee", "hip"),
    _threshold("knee", springs.critical_knee_stiffness, "ankle", "hip"),
    _threshold("hip", springs.critical_hip_stiffness, "ankle", "knee"),
    Quantity(
        "stiffness_reserve",
        r"\lambda_{\min}(C)",
        STIFFNESS_UNIT,
        "what every joint could lose at once before the person falls",
        of_springs(stiffness_reserve),
        without=NERVES,
        fast=of_springs(fast.fast_reserve),
        limit=0.0,
    ),
    Quantity(
        "safety_factor",
        "s",
        "1",
        "factor by which all stiffnesses could be divided and the person just stand",
        of_springs(safety_factor),
        without=NERVES,
        limit=1.0,
    ),
    _eigenvalue(1, "least stable"),
    _eigenvalue(2, "second"),
    _eigenvalue(3, "third"),
    Quantity(
        "frequency",
        "f",
        "Hz",
        "frequency of the least stable mode, negative where the person falls",
        modes_of,
        lambda _, found: frequency_of(found.eigenvalues[0]),
        without=NERVES,
        fast=eigenvalues_of,
        limit=0.0,
    ),
    Quantity(
        "growth_rate",
        r"\sigma",
        "1/s",
        "growth rate of the fall, 0 where stable",
        modes_of,
        lambda _, found: growth_rate_of(found.eigenvalues[0]),
        without=NERVES,
        fast=eigenvalues_of,
    ),
    _rotation("hip"),
    _rotation("knee"),
)
