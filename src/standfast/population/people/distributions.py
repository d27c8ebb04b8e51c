"""Distributions of parameters over persons, as a study gives them.

A distribution turns a *standard variate* into a stiffness, a gain, a delay (:mod:`.draws`): a
standard normal or uniform number, whichever it asks for, so that sampling and correlation are the
business of :mod:`.sampling` alone. A study calls a ready one, from a measurement, a law.

notation: G the load it is relative to, z a standard normal and u a uniform variate.
"""

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from typing import Any

from standfast.errors import InputError, nearest_name
from standfast.parameters import (
    JOINTS,
    LOOPS,
    PARAMETERS,
    Parameter,
    checked_number,
    gain_name,
)
from standfast.population.people.builtin import READY_DISTRIBUTIONS
from standfast.population.people.draws import Draw, Draws
from standfast.study.values import known_keys

RELATIVE_TO = ("absolute", "single_joint_critical", "mgh")
# The numbers that each distribution is given by.
DISTRIBUTIONS: Mapping[str, tuple[str, ...]] = {
    "fixed": ("value",),
    "normal": ("mean", "sd"),
    "lognormal": ("mean", "sd"),
    "uniform": ("low", "high"),
    "measured": (),
}
MULTIPLE = Parameter("multiple", "", "1", "stiffness per load", 0.0, 1e6, or_rigid=True)
# Of gains and damping, as multiples of a load; what is given in N·m/rad lies beyond.
LARGEST_MULTIPLE = 50.0
# What a multiple of a load (N·m/rad) is in, by the unit of what it makes.
MULTIPLE_UNITS = {
    PARAMETERS["ankle_stiffness"].unit: "1",
    PARAMETERS["ankle_damping"].unit: "s",
    PARAMETERS["ankle_noise"].unit: "√s",
}
# Gains from one joint to another may be of either sign.
CROSS_GAINS = frozenset(
    gain_name(kind, *loop)
    for kind in ("proportional", "derivative")
    for loop in LOOPS
    if loop[0] != loop[1]
)


@dataclass(frozen=True, slots=True)
class ParameterDistribution:
    """What a parameter is in a person: x G, or x itself, with x of a distribution.

    normal: x = mean + sd z, cut off at 0 (mean and sd are those before the cut); lognormal: x =
    exp(μ + σ z) with σ² = ln(1 + sd²/mean²), μ = ln mean − σ²/2, so that mean and sd are those of
    x itself; uniform: x = low + (high − low) u. G is 1 (absolute), the joint's own threshold with
    the other two rigid (single_joint_critical), or the toppling load of the whole body about the
    ankle (mgh), which for the ankle is the same. The joint is the one that makes the moment.

    ``signed``: it may be negative, and a normal one is not cut off.
    """

    kind: str
    relative_to: str
    numbers: tuple[float, ...]
    signed: bool = False

    @property
    def is_random(self) -> bool:
        """Whether it takes a variate at all."""
        if self.kind in ("fixed", "measured"):
            return False
        first, second = self.numbers
        return first != second if self.kind == "uniform" else second > 0.0

    @property
    def is_nothing(self) -> bool:
        """Whether it is 0 in everybody."""
        return self.kind != "measured" and not any(self.numbers)

    @property
    def draw(self) -> Draw:
        """How a person draws it."""
        numbers, kind = self.numbers, self.kind
        if not self.is_random:
            kind = "measured" if kind == "measured" else "fixed"
            numbers = numbers[:1]
        elif kind == "uniform":
            low, high = numbers
            numbers = (low, high - low)
        elif kind == "lognormal":
            mean, sd = numbers
            variance = math.log1p((sd / mean) ** 2)
            numbers = (math.log(mean) - 0.5 * variance, math.sqrt(variance))
        return Draw(kind, self.relative_to, numbers, self.signed)

    def canonical(self) -> dict[str, Any]:
        """Return it as a study says it."""
        numbers = dict(zip(DISTRIBUTIONS[self.kind], self.numbers, strict=True))
        return {"distribution": self.kind, "relative_to": self.relative_to, **numbers}


# Distributions by the names of their parameters.
Distributions = tuple[tuple[str, ParameterDistribution], ...]


def measured_of(distributions: Distributions | Draws) -> list[str]:
    """Return which parameters are measured in each person of a file."""
    return [name for name, distribution in distributions if distribution.kind == "measured"]


def checked_word(where: str, given: Any, known: Iterable[str], called: str = "known") -> str:
    """Return a word that is among those that are known, or refuse it."""
    if not isinstance(given, str) or given not in known:
        raise InputError(
            f"{where} = {given!r} is not known{nearest_name(given, known)} "
            f"({called}: {', '.join(known)})"
        )
    return given


def checked_distribution(name: str, given: Any) -> ParameterDistribution:
    """Check the table of one parameter."""
    row = PARAMETERS[name]
    where = row.place
    if not isinstance(given, Mapping):
        raise InputError(
            f'{where} = {given!r} is not a law; write [{where}] with distribution = "fixed" and '
            "value = …, which is the same in everybody"
        )
    if "law" in given:
        return checked_distribution(name, _ready(row, given))
    if "distribution" not in given:
        raise InputError(
            f"[{where}] has no distribution; write distribution = one of {', '.join(DISTRIBUTIONS)}"
            f"{_or_law(row)}"
        )
    distribution = checked_word(
        f"{where}.distribution", given["distribution"], DISTRIBUTIONS, "distributions"
    )
    names = DISTRIBUTIONS[distribution]
    choice = () if distribution == "measured" else ("relative_to",)
    keys = ("distribution", *choice, *names)
    known_keys(f"[{where}] with distribution {distribution}", given, keys)
    relative_to = given.get("relative_to", "absolute")
    words = RELATIVE_TO[:1] if name == "feedback_delay" else RELATIVE_TO
    checked_word(f"{where}.relative_to", relative_to, words)
    for key in names:
        if key not in given:
            raise InputError(f"{where}.{key} is missing; {distribution} takes {', '.join(names)}")
    if distribution != "fixed" and any(given[key] == math.inf for key in names):
        raise InputError(
            f'{where}: only distribution = "fixed" may be inf (rigid), not {distribution}'
        )
    numbers = tuple(_number(row, relative_to, key, given[key]) + 0.0 for key in names)
    _check_numbers(where, distribution, numbers)
    return ParameterDistribution(distribution, relative_to, numbers, signed=name in CROSS_GAINS)


def _or_law(row: Parameter) -> str:
    ready = READY_DISTRIBUTIONS.get(row.place.removeprefix("stiffness."), {})
    return f", or law = one of {', '.join(ready)}" if ready else ""


def _ready(row: Parameter, given: Mapping[str, Any]) -> Mapping[str, Any]:
    """Return what a ready law stands for."""
    where, word = row.place, given["law"]
    known_keys(f"[{where}] with a ready law", given, ("law",))
    ready = READY_DISTRIBUTIONS.get(where.removeprefix("stiffness."), {})
    if isinstance(word, str) and word in ready:
        return ready[word]
    if not ready:
        raise InputError(f"{where}.law = {word!r} is not known; there are no ready laws of it")
    others = [joint for joint in JOINTS if word in list(READY_DISTRIBUTIONS[joint])]
    why = f"is a law of the {others[0]}" if others else "is not known"
    raise InputError(
        f"{where}.law = {word!r} {why}{nearest_name(word, ready)} "
        f"(laws of the {row.key}: {', '.join(ready)})"
    )


def _number(row: Parameter, relative_to: str, key: str, given: Any) -> float:
    """Check one number of a distribution: in the parameter's unit, or as a multiple of a load."""
    where = f"{row.place}.{key}"
    of_springs = row.section == "stiffness"
    # what is drawn is never rigid
    row = replace(row, or_rigid=row.or_rigid and key == "value")
    lowest = row.lowest if row.name in CROSS_GAINS and key != "sd" else 0.0
    if relative_to == "absolute":
        return _not_negative(where, given, row if of_springs else replace(row, lowest=lowest))
    if of_springs:
        return checked_number(where, given, row=replace(MULTIPLE, or_rigid=row.or_rigid))
    unit = MULTIPLE_UNITS[row.unit]
    lowest = max(lowest, -LARGEST_MULTIPLE)
    multiple = replace(row, unit=unit, lowest=lowest, highest=LARGEST_MULTIPLE)
    number = _not_negative(where, given, replace(multiple, highest=math.inf))
    if number > LARGEST_MULTIPLE:
        raise InputError(
            f"{where} = {number:g} is outside the allowed range, {multiple.allowed}: a multiple of "
            f'{relative_to}; if it is in {row.unit}, write relative_to = "absolute"'
        )
    return checked_number(where, number, row=multiple)


def _not_negative(where: str, given: Any, row: Parameter) -> float:
    """Check a number, and say of a negative gain of a joint's own rotation what its sign means."""
    try:
        return checked_number(where, given, row=row)
    except InputError as error:
        if row.section.startswith("feedback.") and row.lowest == 0.0 and _is_negative(given):
            why = "a gain acts against the rotation, so a negative one topples"
            raise InputError(f"{error}; {why}") from None
        raise


def _is_negative(given: Any) -> bool:
    return isinstance(given, int | float) and given < 0.0


def _check_numbers(where: str, distribution: str, numbers: tuple[float, ...]) -> None:
    """Refuse numbers that no such distribution has."""
    if distribution in ("fixed", "measured"):
        return
    first, second = numbers
    if distribution == "lognormal" and first <= 0.0:
        raise InputError(f"{where}.mean = {first:g} has no lognormal; give a mean above 0")
    if distribution == "lognormal" and second > 1e3 * first:
        raise InputError(
            f"{where}.sd = {second:g} is more than a thousand times the mean, {first:g}"
        )
    if distribution == "uniform" and first > second:
        raise InputError(
            f"{where} goes from low = {first:g} to high = {second:g}; high must not be below low"
        )
