"""The one table of quantities: a row carries all that is known of one.

Labels of figures, attributes of files, help texts, the axes of its grid and how the engine computes
it come from the row. A new quantity is one function of a :class:`Person` and one row.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, NamedTuple

from standfast.anthropometry.body import Body, body_of
from standfast.mechanics.joints import Stiffness
from standfast.numerics.arrays import Scalar, Vector
from standfast.parameters import PARAMETERS, STIFFNESS_UNIT, STIFFNESSES, label
from standfast.stability import fast
from standfast.stability.exact import SCALING_ROUNDING, exact_threshold
from standfast.stability.margins import safety_factor, stability_determinant, stiffness_reserve
from standfast.stability.modes import frequency, growth_rate, modes, ratio_to_ankle
from standfast.stability.rounding import threshold_interval
from standfast.stability.springs import (
    critical_ankle_stiffness,
    critical_hip_stiffness,
    critical_knee_stiffness,
    verdict,
)


class Person(NamedTuple):
    """One person, as the functions of the table are given them.

    ``given`` holds all parameters by name; of ``stiffness`` a joint on which a quantity does not
    depend is None.
    """

    body: Body
    stiffness: Stiffness
    gravity: Scalar
    given: Mapping[str, Any]

    @classmethod
    def of(cls, given: Mapping[str, Any]) -> "Person":
        """Make a person from parameters by name, with a reference person as ``body_model``."""
        stiffness = Stiffness._make(given.get(name) for name in STIFFNESSES)
        return cls(body_of(given), stiffness, given["gravity"], given)


@dataclass(frozen=True, slots=True)
class Step:
    """Where along an axis a quantity that is 0 or 1 changes from 0 to 1.

    Attributes
    ----------
    along
        the parameter of that axis; the value is 1 where it lies above the place of the step.
    interval
        one person's place, and the ends between which the exact place lies.
    exact
        the exact place, of parameters by name; None if there is none.
    """

    along: str
    interval: Callable[[Person], Vector]
    exact: Callable[[Mapping[str, Any]], Fraction | None]


def as_found(person: Person, found: Any) -> Scalar:
    """Return what was found: the number itself."""
    del person
    return found


@dataclass(frozen=True, slots=True)
class Quantity:
    """A number that standfast computes for one person.

    Attributes
    ----------
    reference
        finds it for one person, or something of which ``pick`` takes it; quantities of one
        ``reference`` share what it finds.
    fast
        a fast way to what ``reference`` finds: returns (found, uncertain), and what is uncertain is
        asked of the reference; always so with a rigid joint. Quantities of one way share it.
    without
        parameters on which it does not depend.
    flags
        of a quantity of whole numbers: the meanings of 0, 1 and so on.
    """

    name: str
    symbol: str
    unit: str
    meaning: str
    reference: Callable[[Person], Any]
    pick: Callable[[Person, Any], Scalar] = as_found
    dtype: str = "float64"
    without: tuple[str, ...] = ()
    fast: Callable[[Person], tuple[Any, Scalar]] | None = None
    step: Step | None = None
    flags: tuple[str, ...] = ()

    @property
    def label(self) -> str:
        """Axis label of a figure: words, symbol and unit."""
        return label(self.name.replace("_", " "), self.symbol, self.unit)

    @property
    def depends_on(self) -> tuple[str, ...]:
        """Names of the parameters on which it depends."""
        return tuple(name for name in PARAMETERS if name not in self.without)


def of_springs(
    function: Callable[[Body, Stiffness, Scalar], Any],
) -> Callable[[Person], Any]:
    """Turn a function of body, stiffness and gravity into one of a person."""
    return lambda person: function(person.body, person.stiffness, person.gravity)


modes_of = of_springs(modes)
eigenvalues_of = of_springs(fast.fast_eigenvalues)

STANDING = Step(
    along="ankle_stiffness",
    interval=lambda person: threshold_interval(
        person.body,
        person.stiffness.knee,
        person.stiffness.hip,
        person.gravity,
        scaling=SCALING_ROUNDING,
    ),
    exact=exact_threshold,
)

QUANTITIES = {
    row.name: row
    for row in (
        Quantity(
            "stable",
            "",
            "1",
            "verdict: the person stands",
            of_springs(verdict),
            dtype="uint8",
            step=STANDING,
            flags=("unstable", "stable"),
        ),
        Quantity(
            "stability_determinant",
            r"\det C",
            "(N·m/rad)³",
            "determinant of the stiffness matrix",
            of_springs(stability_determinant),
        ),
        Quantity(
            "critical_ankle_stiffness",
            r"K_{a,\mathrm{crit}}",
            STIFFNESS_UNIT,
            "ankle stiffness at which the person just stands, knee and hip as given",
            lambda one: critical_ankle_stiffness(
                one.body, one.stiffness.knee, one.stiffness.hip, one.gravity
            ),
            without=("ankle_stiffness",),
        ),
        Quantity(
            "critical_knee_stiffness",
            r"K_{k,\mathrm{crit}}",
            STIFFNESS_UNIT,
            "knee stiffness at which the person just stands, ankle and hip as given",
            lambda one: critical_knee_stiffness(
                one.body, one.stiffness.ankle, one.stiffness.hip, one.gravity
            ),
            without=("knee_stiffness",),
        ),
        Quantity(
            "critical_hip_stiffness",
            r"K_{h,\mathrm{crit}}",
            STIFFNESS_UNIT,
            "hip stiffness at which the person just stands, ankle and knee as given",
            lambda one: critical_hip_stiffness(
                one.body, one.stiffness.ankle, one.stiffness.knee, one.gravity
            ),
            without=("hip_stiffness",),
        ),
        Quantity(
            "stiffness_reserve",
            r"\lambda_{\min}(C)",
            STIFFNESS_UNIT,
            "what every joint could lose at once before the person falls",
            of_springs(stiffness_reserve),
            fast=of_springs(fast.fast_reserve),
        ),
        Quantity(
            "safety_factor",
            "s",
            "1",
            "factor by which all stiffnesses could be divided and the person just stand",
            of_springs(safety_factor),
        ),
        Quantity(
            "eigenvalue_1",
            r"\lambda_1",
            "rad²/s²",
            "eigenvalue of the least stable mode",
            modes_of,
            lambda _, found: found.eigenvalues[0],
            fast=eigenvalues_of,
        ),
        Quantity(
            "eigenvalue_2",
            r"\lambda_2",
            "rad²/s²",
            "eigenvalue of the second mode",
            modes_of,
            lambda _, found: found.eigenvalues[1],
            fast=eigenvalues_of,
        ),
        Quantity(
            "eigenvalue_3",
            r"\lambda_3",
            "rad²/s²",
            "eigenvalue of the third mode",
            modes_of,
            lambda _, found: found.eigenvalues[2],
            fast=eigenvalues_of,
        ),
        Quantity(
            "frequency",
            "f",
            "Hz",
            "frequency of the least stable mode, negative where the person falls",
            modes_of,
            lambda _, found: frequency(found.eigenvalues[0]),
            fast=eigenvalues_of,
        ),
        Quantity(
            "growth_rate",
            r"\sigma",
            "1/s",
            "growth rate of the fall, 0 where stable",
            modes_of,
            lambda _, found: growth_rate(found.eigenvalues[0]),
            fast=eigenvalues_of,
        ),
        Quantity(
            "hip_ankle_ratio",
            r"\theta_h/\theta_a",
            "1",
            "hip rotation per ankle rotation in the least stable mode",
            modes_of,
            lambda one, found: ratio_to_ankle("hip", one.stiffness, found),
        ),
        Quantity(
            "knee_ankle_ratio",
            r"\theta_k/\theta_a",
            "1",
            "knee rotation per ankle rotation in the least stable mode",
            modes_of,
            lambda one, found: ratio_to_ankle("knee", one.stiffness, found),
        ),
    )
}
