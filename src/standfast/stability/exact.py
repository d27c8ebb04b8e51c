"""The ankle's threshold in exact arithmetic, for verdicts that rounding could decide.

Body and gravity loads are those of :mod:`standfast.anthropometry` and :mod:`standfast.mechanics`,
whose formulas take fractions too; every float is taken for exactly what it is.

notation: γs, γt, γb gravity loads.
"""

import math
from collections.abc import Mapping, Sequence
from fractions import Fraction
from typing import Any

import numpy as np

from standfast.anthropometry.body import REFERENCE_PEOPLE, Body, ReferencePerson, body_of
from standfast.mechanics.matrices import gravity_loads, joint_gravity
from standfast.numerics.arrays import ROUNDOFF
from standfast.parameters import COUPLINGS, OWN_BODY
from standfast.stability.springs import off_diagonal

# Scaling a person rounds: mass ratio of BMI · height² over the reference (4 roundings), times the
# segment's mass (1); height ratio (2, if the division is done by a reciprocal), times the segment's
# length (1). Together 8; the product of the two is counted with the loads.
SCALING_ROUNDING = 9.0 * ROUNDOFF


def exact_threshold(parameters: Mapping[str, Any]) -> Fraction | None:
    """Return the ankle's exact threshold of one person (N·m/rad); None if none suffices.

    The loads of :func:`standfast.stability.springs.eliminated`, of parameters by name; without
    coupling these are the carried loads, written another way.
    """
    names = {"height", "mass", "bmi", "gravity", *OWN_BODY} & parameters.keys()
    given: dict[str, Any] = {name: Fraction(parameters[name]) for name in names}
    if "body_model" in parameters:
        person = REFERENCE_PEOPLE[str(parameters["body_model"])]
        parts = ([Fraction(float(value)) for value in part] for part in person.body)
        body = Body._make(np.array(part, object) for part in parts)
        given["body_model"] = ReferencePerson(body, Fraction(person.height), Fraction(person.mass))
    shank, thigh, upper = gravity_loads(body_of(given), given["gravity"])
    at_ankle, at_knee, at_hip = shank + thigh + upper, thigh + upper, upper
    one, two, three = (Fraction(parameters.get(name, 0.0)) for name in COUPLINGS)
    ankle_knee, knee_hip, ankle_hip = off_diagonal((at_ankle, at_knee, at_hip), (one, two, three))
    hip, knee = float(parameters["hip_stiffness"]), float(parameters["knee_stiffness"])
    # a rigid joint takes its row and column out of C
    if math.isfinite(hip):
        rest = Fraction(hip) - at_hip
        if rest <= 0:
            return None
        ankle_knee -= ankle_hip * knee_hip / rest
        at_knee += knee_hip**2 / rest
        at_ankle += ankle_hip**2 / rest
    if math.isfinite(knee):
        rest = Fraction(knee) - at_knee
        if rest <= 0:
            return None
        at_ankle += ankle_knee**2 / rest
    return Fraction(at_ankle)


def stands_exactly(
    body: Body, gravity: float, numbers: np.ndarray, loads: Sequence[int | None]
) -> np.ndarray:
    """Return the exact verdicts (persons,) of persons who may stand right at their thresholds.

    ``body`` holds arrays (segments, persons); ``numbers`` (3, persons) are the stiffnesses of
    ankle, knee and hip (N·m/rad, ``inf`` is rigid), or multiples of the joint's load that ``loads``
    names: 0, 1, 2 for G1, G2, G3, None for none. A person stands if the minors of C, less the rows
    and columns of rigid joints, are positive from the hip up; with integers that is exact, and so a
    stiffness of once the load is neither above nor below it.
    """
    if not numbers.size:
        return np.zeros(0, bool)
    lengths, length_unit = _integers(np.concatenate([body.segment_length, body.segment_com]))
    masses, mass_unit = _integers(np.asarray(body.segment_mass))
    g, gravity_unit = _integers(np.array([gravity]))
    whole = Body._make((masses, masses, lengths[:2], lengths[2:]))
    rows = joint_gravity(whole, g[0])
    unit = length_unit + mass_unit + gravity_unit
    rigid = np.isinf(numbers)
    given, number_unit = _integers(np.where(rigid, 0.0, numbers))
    # all in the smaller of the two units: that of multiples of loads, and that of N·m/rad
    smallest = min(unit + number_unit, number_unit, unit)
    # who is rigid in everybody is left out of C altogether
    free = [joint for joint in range(3) if not rigid[joint].all()]
    matrix = []
    for i in free:
        load, each = loads[i], given[i]
        spring = each if load is None else each * rows[load][load]
        power = number_unit if load is None else unit + number_unit
        row = [-rows[i][j] * 2 ** (unit - smallest) for j in free]
        row[free.index(i)] = row[free.index(i)] + spring * 2 ** (power - smallest)
        taken_out = [rigid[i] | rigid[j] for j in free]
        matrix.append(
            [np.where(o, int(i == j), e) for o, j, e in zip(taken_out, free, row, strict=True)]
        )
    stands = np.ones(numbers.shape[1], bool)
    for first in reversed(range(len(free))):
        stands &= _determinant([row[first:] for row in matrix[first:]]) > 0
    return stands


def _determinant(rows: Sequence[Sequence[Any]]) -> Any:
    """Return a determinant by its first row."""
    if len(rows) == 1:
        return rows[0][0]
    minors = [
        _determinant([[*row[:n], *row[n + 1 :]] for row in rows[1:]]) for n in range(len(rows))
    ]
    return sum(
        (-1) ** n * entry * minor
        for n, (entry, minor) in enumerate(zip(rows[0], minors, strict=True))
    )


def _integers(numbers: np.ndarray) -> tuple[np.ndarray, int]:
    """Return whole numbers of Python, and the exponent of the power of two that they count."""
    mantissa, exponent = np.frexp(numbers)
    used = exponent[numbers != 0.0]
    lowest = int(used.min()) if used.size else 0
    whole = (mantissa * 2.0**53).astype(np.int64).astype(object)
    more = np.where(numbers != 0.0, exponent - lowest, 0).astype(object)
    return whole * 2**more, lowest - 53
