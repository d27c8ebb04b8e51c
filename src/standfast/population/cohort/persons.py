"""One person of a population: from random variates to body, stiffness, and what becomes of them.

Everything here is for one person and pure; :mod:`standfast.engine` maps it over many. A *source*
is either a table of subpopulations, whose people are sampled, or a file of people, whose rows are.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

from standfast.anthropometry.body import Body
from standfast.mechanics.joints import Stiffness
from standfast.mechanics.matrices import joint_gravity
from standfast.numerics.arrays import ROUNDOFF, Scalar, Vector, namespace
from standfast.parameters import JOINTS, OWN_BODY, STIFFNESSES
from standfast.population.cohort.bodies import Models, scaled_body, with_own_segments
from standfast.population.cohort.sizes import Group, sampled_size, scattered
from standfast.population.people.distributions import measured_of
from standfast.population.people.draws import Coordinate, Draw, Draws
from standfast.stability.margins import safety_factor
from standfast.stability.modes import growth_rate_of, modes
from standfast.stability.rounding import near_threshold, rounding_decides
from standfast.stability.springs import critical_stiffness, verdict

# Of a stiffness that is a multiple of a load: 5 roundings of the load and one of the product.
OF_MULTIPLES = 6.0 * ROUNDOFF


class CohortModel(NamedTuple):
    """What makes a population's persons, without seed or size.

    Words and ``inf`` are compiled into programs, numbers are not (:func:`.map_over_batch`).
    """

    gravity: float
    body_models: Models  # of each stratum, or one of all
    groups: tuple[Group, ...]  # none for people of a file
    scattered: tuple[str, ...]  # sex of each stratum; none where proportions are fixed
    stiffness: tuple[Draw, Draw, Draw]  # of ankle, knee and hip
    nerves: Draws = ()  # of damping, delay, gains, noise; none where nothing is fed back
    own_segments: bool = False  # people of the file have them, some or all
    sway: tuple[str, ...] = ()  # quantities that are asked under noise

    @property
    def coordinates(self) -> tuple[Coordinate, ...]:
        """What each person draws."""
        person = [Coordinate("group", "uniform")] if len(self.groups) > 1 else []
        if self.groups:
            person += [Coordinate("height", "normal"), Coordinate("bmi", "normal")]
        else:
            person = [Coordinate("person", "uniform")]
        if self.scattered:
            person += [Coordinate("shank", "normal"), Coordinate("thigh", "normal")]
        drawn = (*zip(JOINTS, self.stiffness, strict=True), *self.nerves)
        person += [each.coordinate(name) for name, each in drawn if each.is_random]
        return tuple(person)

    @property
    def free_joints(self) -> int:
        """How many joints are not rigid in everybody."""
        return sum(not each.is_rigid for each in self.stiffness)

    @property
    def measured(self) -> list[str]:
        """Which parameters are those of the person in the file."""
        springs = tuple(zip(STIFFNESSES, self.stiffness, strict=True))
        return [*measured_of(springs + self.nerves), *(OWN_BODY if self.own_segments else ())]

    @property
    def kept(self) -> tuple[str, ...]:
        """What is kept of every person when asked."""
        return kept_of(dict(self.nerves), bool(self.nerves), self.sway)


def kept_of(nerves: Iterable[str], fed_back: bool, sway: tuple[str, ...]) -> tuple[str, ...]:
    """Return what is kept of every person when asked."""
    springs = ("height", "mass", *STIFFNESSES)
    if not fed_back:
        return (*springs, "safety_factor", "stable")
    # a delay that is not given is 0
    given = dict.fromkeys([*nerves, "feedback_delay"])
    return (*springs, *given, "critical_delay", "stable", *sway)


@dataclass(frozen=True, slots=True)
class Person:
    """One person of the population, as far as the model knows them."""

    height: Scalar
    mass: Scalar
    stratum: Scalar
    body: Body
    stiffness: Stiffness
    nerves: Mapping[str, Scalar]  # damping, delay and gains by parameter


def person_of(model: CohortModel, given: Mapping[str, Scalar]) -> Person:
    """Make one person.

    ``given`` holds the variates by the names of :attr:`CohortModel.coordinates`; for people of a
    file also ``height``, ``mass``, ``stratum`` and what is measured.
    """
    if model.groups:
        height, mass, stratum = sampled_size(model.groups, given)
    else:
        height, mass, stratum = given["height"], given["mass"], given["stratum"]
    body = scaled_body(model.body_models, stratum, height, mass)
    if model.scattered:
        body = scattered(body, height, stratum, model.scattered, given)
    body = with_own_segments(body, given)
    loads, _, _ = joint_gravity(body, model.gravity)
    stiffness = [
        each.value(given.get(joint), given.get(name), load_of(name, each.relative_to, loads))
        for joint, name, each in zip(JOINTS, STIFFNESSES, model.stiffness, strict=True)
    ]
    nerves = {
        name: each.value(given.get(name), given.get(name), load_of(name, each.relative_to, loads))
        for name, each in model.nerves
    }
    return Person(height, mass, stratum, body, Stiffness._make(stiffness), nerves)


def load_of(name: str, relative_to: str, loads: Vector) -> Scalar:
    """Return the load that a parameter is relative to, of the loads of ankle, knee and hip."""
    if relative_to == "absolute":
        return 1.0
    joint, _, _ = name.partition("_")  # which makes the moment
    return loads[0] if relative_to == "mgh" else loads[JOINTS.index(joint)]


def in_doubt(model: CohortModel, person: Person) -> Scalar:
    """Return whether rounding may decide if a person stands by springs alone."""
    return rounding_decides(person.body, person.stiffness, model.gravity, scaling=OF_MULTIPLES)


def near(model: CohortModel, person: Person) -> Scalar:
    """Return whether a person may be :func:`in_doubt`, much more cheaply."""
    return near_threshold(person.body, person.stiffness, model.gravity)


def outcome(model: CohortModel, given: Mapping[str, Scalar]) -> dict[str, Scalar]:
    """Return everything that is asked of one person.

    ``stable``, and whether that may be in doubt (``near``); ``safety_factor``; of each joint its
    own load with the other two rigid, its threshold with the others as sampled (N·m/rad), and the
    multiple of its distribution there.
    """
    person = person_of(model, given)
    body, stiffness = person.body, person.stiffness
    critical = critical_stiffness(body, stiffness, model.gravity)
    loads, _, _ = joint_gravity(body, model.gravity)
    found: dict[str, Any] = {
        "height": person.height,
        "mass": person.mass,
        "stratum": person.stratum,
        "stable": verdict(body, stiffness, model.gravity),
        "near": near(model, person),
        "safety_factor": safety_factor(body, stiffness, model.gravity),
    }
    for joint, own, load, threshold in zip(
        JOINTS, stiffness.joints, loads, critical.joints, strict=True
    ):
        xp = namespace(own, threshold)
        found[f"{joint}_stiffness"] = own
        found[f"{joint}_load"] = load
        found[f"critical_{joint}_stiffness"] = threshold
        found[f"{joint}_multiple"] = xp.where(threshold == xp.inf, xp.inf, threshold / own)
    return found


def margins(model: CohortModel, given: Mapping[str, Scalar]) -> dict[str, Scalar]:
    """Return what sensitivity is asked of: falling (1 or 0) and the safety factor.

    And whether the first may be in doubt (``near``).
    """
    person = person_of(model, given)
    stands = verdict(person.body, person.stiffness, model.gravity)
    xp = namespace(*person.body)
    return {
        "unstable": xp.where(stands, 0.0, 1.0),
        "near": near(model, person),
        "safety_factor": safety_factor(person.body, person.stiffness, model.gravity),
    }


def growth(model: CohortModel, given: Mapping[str, Scalar]) -> dict[str, Scalar]:
    """Return the growth rate of one person's fall (1/s), 0 where they stand."""
    person = person_of(model, given)
    found = modes(person.body, person.stiffness, model.gravity)
    return {"growth_rate": growth_rate_of(found.eigenvalues[0])}
