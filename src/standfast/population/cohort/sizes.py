"""How tall, heavy and proportioned one person is, of a table of subpopulations."""

import math
from collections.abc import Mapping, Sequence
from itertools import accumulate
from typing import Any, NamedTuple

from standfast.anthropometry.body import Body
from standfast.anthropometry.tables import ANKLE_HEIGHT
from standfast.numerics.arrays import Scalar, namespace
from standfast.population.people.builtin import PROPORTIONS, Subpopulation


class Group(NamedTuple):
    """A subpopulation by its numbers alone: H = mean + sd z; BMI = shift + exp(m + a z + c z').

    With s of ln(BMI − shift) and r its correlation with height a = s r and c = s √(1−r²).
    """

    bound: float  # below it lie the uniform numbers of this group and of those before
    height_mean: float
    height_sd: float
    bmi_shift: float
    log_mean: float
    along: float
    across: float


def groups_of(subpopulations: Sequence[Subpopulation]) -> tuple[Group, ...]:
    """Return the numbers of subpopulations."""
    total = sum(each.share for each in subpopulations)
    ends = accumulate(each.share for each in subpopulations)
    return tuple(
        Group(
            end / total,
            each.height_mean,
            each.height_sd,
            each.bmi_shift,
            each.log_mean,
            each.log_sd * each.correlation,
            each.log_sd * math.sqrt(1.0 - each.correlation**2),
        )
        for end, each in zip(ends, subpopulations, strict=True)
    )


def sampled_size(
    groups: tuple[Group, ...], given: Mapping[str, Scalar]
) -> tuple[Scalar, Scalar, Scalar]:
    """Return height (m), mass (kg) and number of the subpopulation."""
    z, other = given["height"], given["bmi"]
    xp = namespace(z, other)
    in_group = [given["group"] < group.bound for group in groups[:-1]]
    number = _first_that_holds(xp, in_group, [float(i) for i in range(len(groups))])
    _, mean, sd, shift, log_mean, along, across = (
        _first_that_holds(xp, in_group, values) for values in zip(*groups, strict=True)
    )
    height = mean + sd * z
    bmi = shift + xp.exp(log_mean + along * z + across * other)
    return height, bmi * height**2, number


def _first_that_holds(xp: Any, conditions: Sequence[Scalar], values: Sequence[Scalar]) -> Scalar:
    """Return the value whose condition is the first that holds; the last one has none."""
    chosen = xp.asarray(values[-1])
    for condition, value in zip(conditions[::-1], values[-2::-1], strict=True):
        chosen = xp.where(condition, value, chosen)
    return chosen


def scattered(
    body: Body,
    height: Scalar,
    stratum: Scalar,
    sexes: Sequence[str],
    given: Mapping[str, Scalar],
) -> Body:
    """Give a body its own proportions: shank and thigh longer or shorter, stature kept.

    ``sexes`` are those of the strata. Centres of mass move in proportion and inertias with the
    square of the length; the upper body makes up for both legs' segments.
    """
    xp = namespace(*body, given["shank"], given["thigh"])
    scatter = [PROPORTIONS[sex] for sex in sexes]
    is_stratum = [stratum == number for number in range(len(scatter) - 1)]
    shank_sd, thigh_sd, r = (
        _first_that_holds(xp, is_stratum, column) for column in zip(*scatter, strict=True)
    )
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
