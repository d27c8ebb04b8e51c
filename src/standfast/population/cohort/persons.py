"""One person of a population: from random variates to body, stiffness, and what becomes of them.

Everything here is for one person and pure; :mod:`standfast.engine` maps it over many. A *source*
is either a table of subpopulations, whose people are sampled, or a file of people, whose rows are.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from standfast.anthropometry.body import Body
from standfast.anthropometry.tables import ANKLE_HEIGHT
from standfast.mechanics.joints import Stiffness
from standfast.mechanics.matrices import joint_gravity
from standfast.numerics.arrays import ROUNDOFF, Scalar, Vector, namespace
from standfast.parameters import JOINTS, OWN_BODY, STIFFNESSES
from standfast.population.cohort.bodies import Models, scaled_body, with_own_segments
from standfast.population.people.builtin import PROPORTIONS, Subpopulation
from standfast.population.people.distributions import (
    Coordinate,
    Distributions,
    ParameterDistribution,
    measured_of,
)
from standfast.stability.margins import safety_factor
from standfast.stability.modes import growth_rate_of, modes
from standfast.stability.rounding import near_threshold, rounding_decides
from standfast.stability.springs import critical_stiffness, verdict

# Of a stiffness that is a multiple of a load: 5 roundings of the load and one of the product.
OF_MULTIPLES = 6.0 * ROUNDOFF


@dataclass(frozen=True, slots=True)
class CohortModel:
    """What makes a population's persons, without seed or size; hashable, so compiled once."""

    gravity: float
    body_models: Models  # of each stratum
    subpopulations: tuple[Subpopulation, ...]  # none for people of a file
    strata_sexes: tuple[str, ...]
    scattered: bool
    distributions: tuple[ParameterDistribution, ParameterDistribution, ParameterDistribution]
    nerves: Distributions = ()  # of damping, delay and gains; none where nothing is fed back
    own_segments: bool = False  # people of the file have them, some or all

    @property
    def coordinates(self) -> tuple[Coordinate, ...]:
        """What each person draws."""
        person = [Coordinate("group", "uniform")] if len(self.subpopulations) > 1 else []
        if self.subpopulations:
            person += [Coordinate("height", "normal"), Coordinate("bmi", "normal")]
        else:
            person = [Coordinate("person", "uniform")]
        if self.scattered:
            person += [Coordinate("shank", "normal"), Coordinate("thigh", "normal")]
        for joint, distribution in zip(JOINTS, self.distributions, strict=True):
            if distribution.is_random:
                person.append(distribution.coordinate(joint))
        person += [each.coordinate(name) for name, each in self.nerves if each.is_random]
        return tuple(person)

    @property
    def free_joints(self) -> int:
        """How many joints are not rigid in everybody."""
        rigid = [
            each.kind == "fixed" and each.numbers == (math.inf,) for each in self.distributions
        ]
        return len(rigid) - sum(rigid)

    @property
    def measured(self) -> list[str]:
        """Which parameters are those of the person in the file."""
        springs = tuple(zip(STIFFNESSES, self.distributions, strict=True))
        return [*measured_of(springs + self.nerves), *(OWN_BODY if self.own_segments else ())]

    @property
    def kept(self) -> tuple[str, ...]:
        """What is kept of every person when asked."""
        return kept_of(self.nerves, bool(self.nerves))


def kept_of(nerves: Distributions, fed_back: bool) -> tuple[str, ...]:
    """Return what is kept of every person when asked."""
    springs = ("height", "mass", *STIFFNESSES)
    if not fed_back:
        return (*springs, "safety_factor", "stable")
    # a delay that is not given is 0
    given = dict.fromkeys([*(name for name, _ in nerves), "feedback_delay"])
    return (*springs, *given, "critical_delay", "stable")


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
    if model.subpopulations:
        height, mass, stratum = _sampled(model.subpopulations, given)
    else:
        height, mass, stratum = given["height"], given["mass"], given["stratum"]
    body = scaled_body(model.body_models, stratum, height, mass)
    if model.scattered:
        body = _scattered(body, height, _scatter(model, stratum), given)
    body = with_own_segments(body, given)
    loads, _, _ = joint_gravity(body, model.gravity)
    stiffness = [
        each.value(given.get(joint), given.get(name), load_of(name, each.relative_to, loads))
        for joint, name, each in zip(JOINTS, STIFFNESSES, model.distributions, strict=True)
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


def _sampled(
    groups: tuple[Subpopulation, ...], given: Mapping[str, Scalar]
) -> tuple[Scalar, Scalar, Scalar]:
    """Return height, mass and number of the subpopulation.

    H = mean + sd z; BMI = shift + exp(m + s (r z + √(1−r²) z')).
    """
    z, other = given["height"], given["bmi"]
    xp = namespace(z, other)
    total = sum(group.share for group in groups)
    bounds = [sum(group.share for group in groups[:end]) / total for end in range(1, len(groups))]

    def of_group(values: Sequence[float]) -> Scalar:
        return _first_that_holds(xp, [given["group"] < bound for bound in bounds], values)

    height = of_group([g.height_mean for g in groups]) + of_group([g.height_sd for g in groups]) * z
    along = of_group([g.log_sd * g.correlation for g in groups])
    across = of_group([g.log_sd * math.sqrt(1.0 - g.correlation**2) for g in groups])
    log = of_group([g.log_mean for g in groups]) + along * z + across * other
    bmi = of_group([g.bmi_shift for g in groups]) + xp.exp(log)
    return height, bmi * height**2, of_group([float(i) for i in range(len(groups))])


def _scatter(model: CohortModel, stratum: Scalar) -> list[Scalar]:
    """Return the scatter of proportions of a stratum's sex."""
    xp = namespace(stratum)
    rows = [PROPORTIONS[sex] for sex in model.strata_sexes]
    is_stratum = [stratum == number for number in range(len(rows) - 1)]
    return [_first_that_holds(xp, is_stratum, column) for column in zip(*rows, strict=True)]


def _first_that_holds(xp: Any, conditions: Sequence[Scalar], values: Sequence[float]) -> Scalar:
    """Return the value whose condition is the first that holds; the last one has none."""
    chosen = xp.asarray(values[-1])
    for condition, value in zip(conditions[::-1], values[-2::-1], strict=True):
        chosen = xp.where(condition, value, chosen)
    return chosen


def _scattered(
    body: Body, height: Scalar, scatter: Sequence[Scalar], given: Mapping[str, Scalar]
) -> Body:
    """Give a body its own proportions: shank and thigh longer or shorter, stature kept.

    Centres of mass move in proportion and inertias with the square of the length; the upper body
    makes up for both legs' segments.
    """
    xp = namespace(*body, given["shank"], given["thigh"])
    shank_sd, thigh_sd, r = scatter
    shank = 1.0 + shank_sd * given["shank"]
    thigh = 1.0 + thigh_sd * (r * given["shank"] + xp.sqrt(1.0 - r**2) * given["thigh"])
    legs = body.segment_length
    longer = legs[0] * (shank - 1.0) + legs[1] * (thigh - 1.0)
    upper = 1.0 - longer / (height * (1.0 - ANKLE_HEIGHT) - legs[0] - legs[1])
    stretch = xp.stack([shank, thigh, upper])
    return body._replace(
        segment_inertia=body.segment_inertia * stretch**2,
        segment_length=legs * stretch[:2],
        segment_com=body.segment_com * stretch,
    )


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
