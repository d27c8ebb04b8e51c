"""What a quantity is: a row of the one table carries all that is known of one."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, NamedTuple

import numpy as np

from standfast.anthropometry.body import Body, body_of
from standfast.mechanics.joints import Stiffness
from standfast.numerics.arrays import Scalar, Vector
from standfast.parameters import COUPLINGS, PARAMETERS, STIFFNESSES, label
from standfast.stability.delay.answers import FedBack
from standfast.stability.delay.problem import Whom


class Person(NamedTuple):
    """One person, as the functions of the table are given them.

    ``given`` holds all parameters by name, those that a study leaves out as plain numbers; of
    ``stiffness`` a joint on which a quantity does not depend is None.

    Examples
    --------
    >>> import standfast as sf
    >>> def weight(person):
    ...     return person.gravity * person.body.segment_mass.sum()
    >>> person = sf.Person(sf.Body.edwards2007(), sf.Stiffness(950, 2000, 738), 9.81, {})
    >>> print(f"{weight(person):.1f} N")
    717.9 N
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

    ``fed_back`` answers it for persons with delayed feedback (``FedBack``), in
    studies that have gains; a quantity without ``reference`` is found that way in every study. It
    needs the crossings of persons ``crossings_of``, and the ``variances`` of rows of the densities
    of sway: what quantities that are asked together need is found together.
    ``of_one_joint`` finds it in closed form where two joints are rigid throughout a study. ``own``
    is one that a user added. ``limit`` is its value at the limit of standing, if there is such a
    value; of what springs alone decide only without gains (``limit_of_standing``). Below it the
    person falls, but for ``delay_margin``: beyond the critical delay there can be windows of delays
    at which they stand again, so that the verdict alone says it.
    ``jumps`` says that it does so between neighbours, from one root or mode to another, so that
    contours of it are none.
    """

    name: str
    symbol: str
    unit: str
    meaning: str
    reference: Callable[[Person], Any] | None
    pick: Callable[[Person, Any], Scalar] = lambda _, found: found
    dtype: str = "float64"
    without: tuple[str, ...] = ()
    fast: Callable[[Person], tuple[Any, Scalar]] | None = None
    step: Step | None = None
    flags: tuple[str, ...] = ()
    fed_back: Callable[[FedBack], np.ndarray] | None = None
    crossings_of: Whom = "everybody"
    variances: tuple[int, ...] = ()
    of_one_joint: Callable[[Person], Scalar] | None = None
    own: bool = False
    limit: float | None = None
    jumps: bool = False

    @property
    def label(self) -> str:
        """Axis label of a figure: words, symbol and unit."""
        return label(self.words, self.symbol, self.unit)

    @property
    def words(self) -> str:
        """What it is called."""
        return " ".join(CENTRES.get(word, word) for word in self.name.split("_"))

    @property
    def at_point(self) -> Callable[[Person], Any]:
        """The function that finds it at one point."""
        found = self.reference or self.of_one_joint
        if found is None:
            raise ValueError(f"{self.name} is not found point by point")
        return found

    def way(self, study_has_gains: bool, *, one_joint: bool = False) -> str:
        """Return how it is computed: by steps along an axis, fed back, or as numbers a point."""
        if self.fed_back is not None and (study_has_gains or self.reference is None):
            return "numbers" if one_joint and self.of_one_joint is not None else "fed back"
        return "steps" if self.step is not None else "numbers"

    def limit_of_standing(self, study_has_gains: bool) -> float | None:
        """Return ``limit``, or None where feedback decides who stands, and this is of springs."""
        of_springs = self.reference is not None and self.fed_back is None
        return None if study_has_gains and of_springs else self.limit

    def depends_on(self, parameter: str, *, study_has_gains: bool = False) -> bool:
        """Return whether a parameter, by its name, can change it.

        What springs decide without gains depends with them on all that is of nerves but noise.
        """
        fed_back = study_has_gains and self.fed_back is not None and self.reference is not None
        section = PARAMETERS[parameter].section
        without = (NOISE,) if fed_back else self.without
        return not {parameter, section, section.partition(".")[0]} & set(without)


# How centres of mass and pressure are written.
CENTRES = {"com": "CoM", "cop": "CoP"}
# The section of parameters that make a person sway, and what is not of springs and gravity.
NOISE = "noise"
NERVES = ("damping", "feedback", NOISE)
