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
from standfast.parameters import COUPLINGS, PARAMETERS, STIFFNESS_UNIT, STIFFNESSES, label
from standfast.stability import fast, springs
from standfast.stability.exact import SCALING_ROUNDING, exact_threshold
from standfast.stability.margins import safety_factor, stability_determinant, stiffness_reserve
from standfast.stability.modes import frequency, growth_rate, modes, ratio_to_ankle
from standfast.stability.rounding import threshold_interval


class Person(NamedTuple):
    """One person, as the functions of the table are given them.

    ``given`` holds all parameters by name, those that a study leaves out as plain numbers; of
    ``stiffness`` a joint on which a quantity does not depend is None.
    """

    body: Body
    stiffness: Stiffness
    gravity: Scalar
    given: Mapping[str, Any]

    @classmethod
    def of(cls, given: Mapping[str, Any]) -> "Person":
        """Make a person from parameters by name, with a reference person as ``body_model``."""
        unwritten = {row.name: row.default for row in PARAMETERS.values() if row.unwritten}
        given = {**unwritten, **given}
        stiffness = Stiffness._make(given.get(name) for name in (*STIFFNESSES, *COUPLINGS))
        return cls(body_of(given), stiffness, given["gravity"], given)


@dataclass(frozen=True, slots=True)
class Step:
    """Where along an axis a quantity that is 0 or 1 changes from 0 to 1.

    The value is 1 where the parameter ``along`` lies above the place of the step. ``interval``
    finds one person's place, and the ends between which the exact place lies; ``exact`` the exact
    place, of parameters by name, or None if there is none.
    """

    along: str
    interval: Callable[[Person], Vector]
    exact: Callable[[Mapping[str, Any]], Fraction | None]


@dataclass(frozen=True, slots=True)
class Quantity:
    """A number that standfast computes for one person.

    ``reference`` finds it for one person, or something of which ``pick`` takes it; quantities of
    one ``reference`` share what it finds. ``fast`` is a fast way to what ``reference`` finds: it
    returns (found, uncertain), and what is uncertain is asked of the reference; always so with a
    rigid joint or coupled ones. Quantities of one way share it. ``without`` are the parameters, and
    the sections of parameters, on which it does not depend; ``flags`` the meanings of 0, 1 and so
    on of a quantity of whole numbers.
    """

    name: str
    symbol: str
    unit: str
    meaning: str
    reference: Callable[[Person], Any]
    pick: Callable[[Person, Any], Scalar] = lambda _, found: found
    dtype: str = "float64"
    without: tuple[str, ...] = ()
    fast: Callable[[Person], tuple[Any, Scalar]] | None = None
    step: Step | None = None
    flags: tuple[str, ...] = ()

    @property
    def label(self) -> str:
        """Axis label of a figure: words, symbol and unit."""
        return label(self.name.replace("_", " "), self.symbol, self.unit)

    def depends_on(self, parameter: str) -> bool:
        """Return whether a parameter, by its name, can change it."""
        section = PARAMETERS[parameter].section
        return not {parameter, section, section.partition(".")[0]} & set(self.without)


# What is not of springs and gravity, in sections of parameters.
NERVES = ("damping", "feedback")


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

_TABLE = (
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
    ),
    Quantity(
        "safety_factor",
        "s",
        "1",
        "factor by which all stiffnesses could be divided and the person just stand",
        of_springs(safety_factor),
        without=NERVES,
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
        lambda _, found: frequency(found.eigenvalues[0]),
        without=NERVES,
        fast=eigenvalues_of,
    ),
    Quantity(
        "growth_rate",
        r"\sigma",
        "1/s",
        "growth rate of the fall, 0 where stable",
        modes_of,
        lambda _, found: growth_rate(found.eigenvalues[0]),
        without=NERVES,
        fast=eigenvalues_of,
    ),
    _rotation("hip"),
    _rotation("knee"),
)
QUANTITIES = {row.name: row for row in _TABLE}
