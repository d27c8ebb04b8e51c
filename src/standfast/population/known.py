"""What is known of persons: measured, else as it is asked, a number or a multiple of their load."""

import contextlib
import math
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from standfast.errors import InputError
from standfast.parameters import JOINTS, PARAMETERS, checked_number, number_in
from standfast.population.people.distributions import Distributions, ParameterDistribution
from standfast.population.people.records import People
from standfast.population.people.sections import LEAST_STIFFNESS, checked_nerves
from standfast.study.values import known_keys

MULTIPLE = "mgh"  # after a number: as many times the load that topples the body about the ankle


def stiffness_of_each(
    people: People,
    otherwise: Mapping[str, float | str],
    toppling_load: Callable[[], np.ndarray],
) -> dict[str, np.ndarray]:
    """Return the stiffness of each joint, measured or otherwise; NaN where it is not known.

    ``otherwise`` has numbers in N·m/rad, or texts as ``"0.67mgh"``, multiples of the load (N·m/rad)
    that ``toppling_load`` returns of each person.
    """
    known_keys("otherwise", otherwise, JOINTS)
    known = {}
    for joint in JOINTS:
        name = f"{joint}_stiffness"
        measured = people.measured.get(name, np.full(len(people), math.nan))
        instead = np.full(len(people), math.nan)
        if joint in otherwise:
            number, of_load = checked_stiffness(f"otherwise[{joint!r}]", otherwise[joint], joint)
            instead = number * (toppling_load() if of_load else np.ones(len(people)))
        known[joint] = np.where(np.isnan(measured), instead, measured)
    return known


def checked_stiffness(where: str, given: float | str, joint: str) -> tuple[float, bool]:
    """Return a stiffness (N·m/rad) and False, or a multiple of the toppling load and True."""
    row = PARAMETERS[f"{joint}_stiffness"]
    if not isinstance(given, str):
        return checked_number(where, given, row=row), False
    text = given.strip()
    of_load = text.endswith(MULTIPLE)
    number: float | str = given
    with contextlib.suppress(ValueError):
        number = number_in(text.removesuffix(MULTIPLE))
    if isinstance(number, str):
        raise InputError(
            f"{where} = {given!r} is text; give a number, {row.allowed}, or a multiple of the "
            "body's load, as 0.67mgh"
        )
    return checked_number(where, number, row=row), of_load


def fixed_nerves(
    given: Distributions | Mapping[str, Any],
) -> dict[str, ParameterDistribution]:
    """Return damping, delay and gains by parameter, each the same number in everybody."""
    nerves = dict(checked_nerves(given) if isinstance(given, Mapping) else given)
    for name, each in nerves.items():
        if each.kind != "fixed":
            raise InputError(
                f"{name} is {each.kind}; of single persons it is a number, or "
                'distribution = "fixed" with relative_to = "mgh"'
            )
    return nerves


def remarks_on_stiffness(known: Mapping[str, np.ndarray]) -> list[str]:
    """Return notes on stiffness that is next to nothing, and looks like a multiple of a load."""
    notes = []
    for joint, values in known.items():
        weak = values[(values > 0.0) & (values < LEAST_STIFFNESS)]
        if weak.size:
            of = f"{weak.size:,} of {len(values):,} persons"
            notes.append(
                f"stiffness of the {joint} below {LEAST_STIFFNESS:g} N·m/rad holds nobody ({of}, "
                f"as {weak[0]:g}); if a multiple is meant, write --{joint} {weak[0]:g}{MULTIPLE}"
            )
    return notes
