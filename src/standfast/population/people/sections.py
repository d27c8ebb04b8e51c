"""The tables of a population's study that say how persons are, from [stiffness] to [noise].

Damping, delay, gains and noise are optional, distribution by distribution. A plain number is the
same in everybody; as a stiffness inf is a rigid joint.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np

from standfast.errors import InputError
from standfast.mechanics.feedback import likely_per_degree
from standfast.parameters import (
    DAMPINGS,
    GAINS,
    JOINTS,
    NOISES,
    PARAMETERS,
    STIFFNESSES,
    Parameter,
    checked_number,
)
from standfast.population.people.distributions import (
    DISTRIBUTIONS,
    Distributions,
    ParameterDistribution,
    checked_distribution,
    measured_of,
)
from standfast.study.values import known_keys

# Below it a gain of the ankle (N·m/rad) holds nobody, and looks like a multiple of mgh.
LEAST_GAIN = 5.0
# The same of any joint's stiffness: the hip of a light child takes more than ten times that.
LEAST_STIFFNESS = 5.0
# What a person may have beside springs, in the order in which it is drawn.
NERVES = (*DAMPINGS, "feedback_delay", *GAINS, *NOISES)
SECTIONS = ("damping", "feedback", "noise")
KINDS = ("proportional", "derivative")

Correlation = tuple[tuple[float, ...], ...]
UNCORRELATED: Correlation = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
# What rounding may take from the smallest eigenvalue of a correlation matrix that is just possible.
SINGULAR = -1e-10


def checked_stiffness(given: Any) -> tuple[dict[str, ParameterDistribution], Correlation]:
    """Check the distributions of the three joints' stiffness and their correlation."""
    known_keys("[stiffness]", given, (*JOINTS, "correlation"))
    for joint in JOINTS:
        if joint not in given:
            raise InputError(
                f"[stiffness.{joint}] is missing; for a rigid {joint} write {joint} = inf in "
                "[stiffness]"
            )
    distributions = {
        joint: checked_distribution(name, _as_table(given[joint]))
        for joint, name in zip(JOINTS, STIFFNESSES, strict=True)
    }
    correlation = given.get("correlation", UNCORRELATED)
    return distributions, checked_correlation(correlation, distributions)


def checked_correlation(
    given: Any, distributions: Mapping[str, ParameterDistribution]
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


def checked_nerves(content: Mapping[str, Any]) -> Distributions:
    """Check the distributions of damping, delay, gains and noise that a study gives."""
    for section in ("damping", "noise"):
        if section in content:
            known_keys(f"[{section}]", content[section], JOINTS)
    feedback = content.get("feedback", {})
    known_keys("[feedback]", feedback, ("delay", *KINDS))
    for kind in KINDS:
        keys = [row.key for row in PARAMETERS.values() if row.section == f"feedback.{kind}"]
        known_keys(f"[feedback.{kind}]", feedback.get(kind, {}), keys)
    given = [(PARAMETERS[name], _at(content, PARAMETERS[name])) for name in NERVES]
    return tuple(
        (row.name, checked_distribution(row.name, _as_table(value)))
        for row, value in given
        if value is not None
    )


def is_noisy(nerves: Distributions) -> bool:
    """Return whether anybody's torques are noisy."""
    return not all(each.is_nothing for name, each in nerves if name in NOISES)


def refuse_measured(distributions: Distributions) -> None:
    """Refuse what is to be measured where nobody was."""
    for name in measured_of(distributions):
        raise InputError(
            f"{PARAMETERS[name].place}: measured needs people with a column {name}, "
            "and a built-in population has none"
        )


def likely_slips(distributions: Distributions) -> list[str]:
    """Return notes on numbers in N·m/rad that look like another unit, which cannot be refused."""
    notes = []
    for name, each in distributions:
        place = PARAMETERS[name].place
        first = each.numbers[0] if each.numbers and each.relative_to == "absolute" else 0.0
        if name in STIFFNESSES:
            key = DISTRIBUTIONS[each.kind][0] if each.numbers else ""
            if 0.0 < first < LEAST_STIFFNESS:
                notes.append(
                    f"{place}.{key} = {first:g} N·m/rad holds nobody; did you mean a multiple: "
                    'relative_to = "mgh" or "single_joint_critical"?'
                )
        elif note := likely_per_degree({name: first}):
            notes.append(note)
        elif name == "ankle_proportional_gain" and 0.0 < first < LEAST_GAIN:
            notes.append(
                f"{name} = {first:g} N·m/rad is next to nothing; if it is meant as a multiple of "
                'the toppling load, write relative_to = "mgh"'
            )
    return notes


def canonical_nerves(distributions: Distributions) -> dict[str, Any]:
    """Return the tables of a study that say these distributions; none for none."""
    tables: dict[str, Any] = {}
    for name, distribution in distributions:
        table = tables
        for key in PARAMETERS[name].section.split("."):
            table = table.setdefault(key, {})
        table[PARAMETERS[name].key] = distribution.canonical()
    return tables


def without_choice(table: Any) -> Any:
    """Return tables of canonical distributions as a study gives them: measured is not relative."""
    if not isinstance(table, Mapping):
        return table
    measured = table.get("distribution") == "measured"
    return {
        key: without_choice(item)
        for key, item in table.items()
        if not (measured and key == "relative_to")
    }


def _at(content: Mapping[str, Any], row: Parameter) -> Any:
    """Return what a study says in the place of a parameter; None for nothing."""
    table: Any = content
    for key in row.section.split("."):
        table = table.get(key, {})
    return table.get(row.key)


def _as_table(value: Any) -> Any:
    """Return a plain number as a fixed distribution."""
    if isinstance(value, int | float) and not isinstance(value, bool):
        return {"distribution": "fixed", "value": value}
    return value
