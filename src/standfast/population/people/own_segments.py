"""The body of a person in a file: size, and own segments, all of a person or none."""

import math
from collections.abc import Mapping

import numpy as np

from standfast.anthropometry.body import implausible
from standfast.errors import InputError
from standfast.parameters import OWN_BODY, SEGMENT_NUMBERS, check_bmi

# Of body mass, what shank, thigh and upper body may weigh: all but the feet, 3 % in the tables,
# with what two scales may differ by.
SHARE = (0.90, 1.02)


def without_some_segments(columns: set[str]) -> tuple[set[str], tuple[str, ...]]:
    """Return the columns, without segments unless all are there, and a remark on that."""
    missing = [name for name in OWN_BODY if name not in columns]
    if not missing or len(missing) == len(OWN_BODY):
        return columns, ()
    there = ", ".join(name for name in OWN_BODY if name in columns)
    remark = (
        f"{there} not used: bodies of own segments need the columns {', '.join(missing)} too; "
        "all are scaled from height and mass"
    )
    return columns - set(OWN_BODY), (remark,)


def whose_segments(shank_mass: np.ndarray) -> list[str]:
    """Say how many have segments of their own; NaN: not measured."""
    own = int((~np.isnan(shank_mass)).sum())
    return [f"{own:,} of {len(shank_mass):,} have segments of their own, the others are scaled"]


def check_body(person: Mapping[str, object]) -> None:
    """Refuse a mass that nobody of the height has, some segments alone, or ones nobody has."""
    mass = float(str(person["mass"]))
    check_bmi("mass", float(str(person["height"])), mass)
    given = {name: float(str(person[name])) for name in OWN_BODY if name in person}
    missing = [name for name, value in given.items() if math.isnan(value)]
    if len(missing) == len(given):
        return
    if missing:
        raise InputError(f"no {missing[0]}, but other segments; give all of them, or none")
    if reason := implausible(given):
        raise InputError(reason)
    weigh = math.fsum(given[name] for name in SEGMENT_NUMBERS["segment_mass"])
    if not SHARE[0] * mass <= weigh <= SHARE[1] * mass:
        raise InputError(
            f"the segments weigh {weigh:.4g} kg together and the person {mass:.4g}; shank, thigh "
            f"and upper body of both sides weigh {SHARE[0]:.0%} to {SHARE[1]:.0%} of a person"
        )
