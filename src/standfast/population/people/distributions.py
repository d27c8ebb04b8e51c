"""Distributions of stiffness: how stiff one joint is in one person, given a random variate.

A distribution turns a *standard variate* into a stiffness: a standard normal or uniform number,
whichever it asks for, so that sampling and correlation are the business of :mod:`.sampling` alone.
A study calls a ready one, from a measurement, a law.

notation: K stiffness, G the load it is relative to, z a standard normal and u a uniform variate.
"""

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from standfast.errors import InputError, nearest_name
from standfast.numerics.arrays import Scalar, namespace
from standfast.parameters import JOINTS, PARAMETERS, STIFFNESSES, Parameter, checked_number
from standfast.population.people.builtin import READY_DISTRIBUTIONS
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


@dataclass(frozen=True, slots=True)
class Coordinate:
    """One random number a person: uniform in (0, 1), or normal and not below ``lowest``."""

    name: str
    kind: str  # "uniform" or "normal"
    lowest: float = -math.inf


@dataclass(frozen=True, slots=True)
class StiffnessDistribution:
    """How stiff a joint is: K = x G, or K = x, with x of a distribution.

    normal: x = mean + sd z, cut off at 0 (mean and sd are those before the cut); lognormal: x =
    exp(μ + σ z) with σ² = ln(1 + sd²/mean²), μ = ln mean − σ²/2, so that mean and sd are those of
    x itself; uniform: x = low + (high − low) u. G is 1 (absolute), the joint's own threshold with
    the other two rigid (single_joint_critical), or the toppling load of the whole body about the
    ankle (mgh), which for the ankle is the same.
    """

    kind: str
    relative_to: str
    numbers: tuple[float, ...]

    @property
    def is_random(self) -> bool:
        """Whether it takes a variate at all."""
        if self.kind in ("fixed", "measured"):
            return False
        first, second = self.numbers
        return first != second if self.kind == "uniform" else second > 0.0

    def coordinate(self, joint: str) -> Coordinate:
        """Return the variate that it takes."""
        if self.kind == "normal":
            mean, sd = self.numbers
            return Coordinate(joint, "normal", lowest=-mean / sd)
        return Coordinate(joint, "uniform" if self.kind == "uniform" else "normal")

    def stiffness(self, variate: Scalar, measured: Scalar, load: Scalar) -> Scalar:
        """Return K of one person: from the variate, or measured, times the load G."""
        if self.kind == "measured":
            return measured
        xp = namespace(variate, load)
        if not self.is_random:
            value = xp.asarray(self.numbers[0])
        elif self.kind == "uniform":
            low, high = self.numbers
            value = low + (high - low) * variate
        elif self.kind == "normal":
            mean, sd = self.numbers
            # at the cut itself rounding may fall below 0
            value = xp.maximum(mean + sd * variate, 0.0)
        else:
            mean, sd = self.numbers
            variance = math.log1p((sd / mean) ** 2)
            mu, sigma = math.log(mean) - 0.5 * variance, math.sqrt(variance)
            value = xp.exp(mu + sigma * variate)
        return value * load

    def canonical(self) -> dict[str, Any]:
        """Return it as a study says it."""
        numbers = dict(zip(DISTRIBUTIONS[self.kind], self.numbers, strict=True))
        return {"distribution": self.kind, "relative_to": self.relative_to, **numbers}


def measured_stiffnesses(distributions: Iterable[StiffnessDistribution]) -> list[str]:
    """Return which stiffnesses are measured, given the distributions of ankle, knee and hip."""
    pairs = zip(STIFFNESSES, distributions, strict=True)
    return [name for name, distribution in pairs if distribution.kind == "measured"]


def checked_word(where: str, given: Any, known: Iterable[str], called: str = "known") -> str:
    """Return a word that is among those that are known, or refuse it."""
    if not isinstance(given, str) or given not in known:
        raise InputError(
            f"{where} = {given!r} is not known{nearest_name(given, known)} "
            f"({called}: {', '.join(known)})"
        )
    return given


def checked_distribution(joint: str, given: Any) -> StiffnessDistribution:
    """Check the table of one joint."""
    where = f"stiffness.{joint}"
    if not isinstance(given, Mapping):
        raise InputError(
            f'{where} = {given!r} is not a law; write [{where}] with distribution = "fixed" and '
            "value = …, for example"
        )
    if "law" in given:
        known_keys(f"[{where}] with a ready law", given, ("law",))
        ready = READY_DISTRIBUTIONS[joint]
        if not isinstance(given["law"], str) or given["law"] not in ready:
            others = [other for other in JOINTS if given["law"] in list(READY_DISTRIBUTIONS[other])]
            why = f"is a law of the {others[0]}" if others else "is not known"
            raise InputError(
                f"{where}.law = {given['law']!r} {why}{nearest_name(given['law'], ready)} "
                f"(laws of the {joint}: {', '.join(ready)})"
            )
        return checked_distribution(joint, ready[given["law"]])
    distribution = checked_word(
        f"{where}.distribution", given.get("distribution"), DISTRIBUTIONS, "distributions"
    )
    names = DISTRIBUTIONS[distribution]
    choice = () if distribution == "measured" else ("relative_to",)
    keys = ("distribution", *choice, *names)
    known_keys(f"[{where}] with distribution {distribution}", given, keys)
    relative_to = given.get("relative_to", "absolute")
    checked_word(f"{where}.relative_to", relative_to, RELATIVE_TO)
    row = PARAMETERS[f"{joint}_stiffness"] if relative_to == "absolute" else MULTIPLE
    for name in names:
        if name not in given:
            raise InputError(f"{where}.{name} is missing; {distribution} takes {', '.join(names)}")
    numbers = tuple(checked_number(f"{where}.{n}", given[n], row=row) + 0.0 for n in names)
    _check_numbers(where, distribution, numbers)
    return StiffnessDistribution(distribution, relative_to, numbers)


def _check_numbers(where: str, distribution: str, numbers: tuple[float, ...]) -> None:
    """Refuse numbers that no such distribution has."""
    if distribution in ("fixed", "measured"):
        return
    if any(math.isinf(number) for number in numbers):
        raise InputError(
            f'{where}: only distribution = "fixed" may be inf (rigid), not {distribution}'
        )
    first, second = numbers
    if distribution == "lognormal" and first == 0.0:
        raise InputError(f"{where}.mean = 0 has no lognormal; give a mean above 0")
    if distribution == "lognormal" and second > 1e3 * first:
        raise InputError(
            f"{where}.sd = {second:g} is more than a thousand times the mean, {first:g}"
        )
    if distribution == "uniform" and first > second:
        raise InputError(
            f"{where} goes from low = {first:g} to high = {second:g}; high must not be below low"
        )


Correlation = tuple[tuple[float, ...], ...]
UNCORRELATED: Correlation = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
# What rounding may take from the smallest eigenvalue of a correlation matrix that is just possible.
SINGULAR = -1e-10


def checked_correlation(
    given: Any, distributions: Mapping[str, StiffnessDistribution]
) -> Correlation:
    """Check the correlation of the joints' normal variates: rows of ankle, knee and hip."""
    where = "stiffness.correlation"
    if not _has_three(given) or not all(_has_three(row) for row in given):
        raise InputError(
            f"{where} = {given!r} is not a 3 × 3 matrix; give rows for ankle, knee and hip, "
            "for example [[1, 0.5, 0], [0.5, 1, 0], [0, 0, 1]]"
        )
    entry = Parameter("correlation", "", "1", "correlation", -1.0, 1.0)
    matrix = tuple(
        tuple(
            checked_number(f"{where}[{i}][{j}]", value, row=entry) + 0.0
            for j, value in enumerate(row)
        )
        for i, row in enumerate(given)
    )
    for i, joint in enumerate(JOINTS):
        if matrix[i][i] != 1.0:
            raise InputError(f"{where}: {joint} with itself is {matrix[i][i]:g}; it must be 1")
        for j in range(i):
            other = JOINTS[j]
            if matrix[i][j] != matrix[j][i]:
                raise InputError(
                    f"{where}: {other} with {joint} is {matrix[j][i]:g}, but {joint} with "
                    f"{other} {matrix[i][j]:g}; the matrix must be symmetric"
                )
            still = [name for name in (joint, other) if not distributions[name].is_random]
            if matrix[i][j] != 0.0 and still:
                raise InputError(
                    f"{where}: {other} with {joint} is {matrix[i][j]:g}, but the stiffness of the "
                    f"{still[0]} is not random; put 0 there"
                )
    smallest = float(np.linalg.eigvalsh(np.array(matrix))[0])
    if smallest < SINGULAR:
        raise InputError(
            f"{where} is impossible: no three numbers are correlated like that (its smallest "
            f"eigenvalue is {smallest:.3g}, it must not be negative); take smaller correlations"
        )
    return matrix


def _has_three(given: Any) -> bool:
    return isinstance(given, list | tuple) and len(given) == 3


def checked_stiffness(given: Any) -> tuple[dict[str, StiffnessDistribution], Correlation]:
    """Check the distributions of the three joints' stiffness and their correlation."""
    known_keys("[stiffness]", given, (*JOINTS, "correlation"))
    for joint in JOINTS:
        if joint not in given:
            raise InputError(
                f"[stiffness.{joint}] is missing; for a rigid {joint} write "
                'distribution = "fixed" and value = inf'
            )
    distributions = {joint: checked_distribution(joint, given[joint]) for joint in JOINTS}
    correlation = given.get("correlation", UNCORRELATED)
    return distributions, checked_correlation(correlation, distributions)
