"""The ankle's threshold in exact arithmetic, for verdicts that rounding could decide.

Body and gravity loads are those of :mod:`standfast.anthropometry` and :mod:`standfast.mechanics`,
whose formulas take fractions too; every float is taken for exactly what it is.

notation: γs, γt, γb gravity loads.
"""

import math
from collections.abc import Mapping
from fractions import Fraction
from typing import Any

import numpy as np

from standfast.anthropometry.body import REFERENCE_PEOPLE, Body, ReferencePerson, body_of
from standfast.mechanics.matrices import gravity_loads
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
