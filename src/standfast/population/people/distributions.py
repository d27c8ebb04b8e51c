"""Distributions of stiffness: how stiff one joint is in one person, given a random variate.

A distribution turns a *standard variate* into a stiffness: a standard normal or uniform number,
whichever it asks for, so that sampling and correlation are the business of :mod:`.sampling` alone.
A study calls a ready one, from a measurement, a law.

notation: K stiffness, G the load it is relative to, z a standard normal and u a uniform variate.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from standfast.errors import InputError, nearest_name
from standfast.numerics.arrays import Scalar, namespace
from standfast.parameters import JOINTS, PARAMETERS, Parameter, checked_number
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
        if self.kind == "uniform":
            return Coordinate(joint, "uniform")
        if self.kind == "normal":
            mean, sd = self.numbers
            return Coordinate(joint, "normal", lowest=-mean / sd)
        return Coordinate(joint, "normal")

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
            mu, sigma = self.log_numbers
            value = xp.exp(mu + sigma * variate)
        return value * load

    @property
    def log_numbers(self) -> tuple[float, float]:
        """μ and σ of a lognormal distribution."""
        mean, sd = self.numbers
        variance = math.log1p((sd / mean) ** 2)
        return math.log(mean) - 0.5 * variance, math.sqrt(variance)

    def canonical(self) -> dict[str, Any]:
        """Return it as a study says it."""
        names = DISTRIBUTIONS[self.kind]
        numbers = dict(zip(names, self.numbers, strict=True))
        return {"distribution": self.kind, "relative_to": self.relative_to, **numbers}


def checked_distribution(joint: str, given: Any) -> StiffnessDistribution:
    """Check the table of one joint.

    Raises
    ------
    InputError
        naming the key, what was given and what would be right.
    """
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
    distribution = given.get("distribution")
    if not isinstance(distribution, str) or distribution not in DISTRIBUTIONS:
        raise InputError(
            f"{where}.distribution = {distribution!r} is not known"
            f"{nearest_name(distribution, DISTRIBUTIONS)} "
            f"(distributions: {', '.join(DISTRIBUTIONS)})"
        )
    names = DISTRIBUTIONS[distribution]
    choice = () if distribution == "measured" else ("relative_to",)
    known_keys(
        f"[{where}] with distribution {distribution}", given, ("distribution", *choice, *names)
    )
    relative_to = given.get("relative_to", "absolute")
    if relative_to not in RELATIVE_TO:
        raise InputError(
            f"{where}.relative_to = {relative_to!r} is not known"
            f"{nearest_name(relative_to, RELATIVE_TO)} (known: {', '.join(RELATIVE_TO)})"
        )
    row = PARAMETERS[f"{joint}_stiffness"] if relative_to == "absolute" else MULTIPLE
    for name in names:
        if name not in given:
            raise InputError(f"{where}.{name} is missing; {distribution} takes {', '.join(names)}")
    numbers = tuple(checked_number(f"{where}.{n}", given[n], row=row) + 0.0 for n in names)
    _check_numbers(where, distribution, numbers)
    return StiffnessDistribution(distribution, relative_to, numbers)


def _check_numbers(where: str, distribution: str, numbers: tuple[float, ...]) -> None:
    """Refuse numbers that no such distribution has."""
    if distribution == "fixed":
        return
    if any(math.isinf(number) for number in numbers):
        raise InputError(
            f'{where}: only distribution = "fixed" may be inf (rigid), not {distribution}'
        )
    if distribution == "lognormal" and numbers[0] == 0.0:
        raise InputError(f"{where}.mean = 0 has no lognormal; give a mean above 0")
    if distribution == "lognormal" and numbers[1] > 1e3 * numbers[0]:
        raise InputError(
            f"{where}.sd = {numbers[1]:g} is more than a thousand times the mean, {numbers[0]:g}"
        )
    if distribution == "uniform" and numbers[0] > numbers[1]:
        raise InputError(
            f"{where} goes from low = {numbers[0]:g} to high = {numbers[1]:g}; "
            "high must not be below low"
        )


Correlation = tuple[tuple[float, ...], ...]
UNCORRELATED: Correlation = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))

# What rounding may take from the smallest eigenvalue of a correlation matrix that is just possible.
SINGULAR = -1e-10


def checked_correlation(
    given: Any, distributions: Mapping[str, StiffnessDistribution]
) -> Correlation:
    """Check the correlation of the joints' normal variates: rows of ankle, knee and hip.

    Raises
    ------
    InputError
        if it is no correlation matrix, or correlates a joint that is not random.
    """
    where = "stiffness.correlation"
    rows = given if isinstance(given, list | tuple) else None
    if (
        rows is None
        or len(rows) != 3
        or not all(isinstance(row, list | tuple) and len(row) == 3 for row in rows)
    ):
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
        for i, row in enumerate(rows)
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
