"""The ankle's threshold in exact arithmetic, for verdicts that rounding could decide.

Body and gravity loads are those of :mod:`standfast.anthropometry` and :mod:`standfast.mechanics`,
whose formulas take fractions too; every float is taken for exactly what it is.

notation: γs, γt, γb gravity loads; L1, L2, L3 loads carried by ankle, knee, hip.
"""

import math
from collections.abc import Mapping
from fractions import Fraction
from typing import Any

import numpy as np

from standfast.anthropometry.body import REFERENCE_PEOPLE, Body, ReferencePerson, body_of
from standfast.mechanics.matrices import gravity_loads
from standfast.numerics.arrays import ROUNDOFF

# Scaling a person rounds: mass ratio of BMI · height² over the reference (4 roundings), times the
# segment's mass (1); height ratio (2, if the division is done by a reciprocal), times the segment's
# length (1). Together 8; the product of the two is counted with the loads.
SCALING_ROUNDING = 9.0 * ROUNDOFF


def exact_threshold(parameters: Mapping[str, Any]) -> Fraction | None:
    """Return the ankle's exact threshold of one person (N·m/rad); None if none suffices.

    L3 = γb, L2 = γt + L3 Kh / (Kh − L3), L1 = γs + L2 Kk / (Kk − L2), of parameters by name.
    """
    names = {"height", "mass", "bmi", "gravity"} & parameters.keys()
    given: dict[str, Any] = {name: Fraction(parameters[name]) for name in names}
    person = REFERENCE_PEOPLE[str(parameters["body_model"])]
    parts = ([Fraction(float(value)) for value in part] for part in person.body)
    body = Body._make(np.array(part, object) for part in parts)
    given["body_model"] = ReferencePerson(body, Fraction(person.height), Fraction(person.mass))
    shank, thigh, upper = gravity_loads(body_of(given), given["gravity"])
    load: Fraction = upper
    for joint, segment in (("hip", thigh), ("knee", shank)):
        spring = float(parameters[f"{joint}_stiffness"])
        if spring <= load:
            return None
        if math.isfinite(spring):  # what it transmits; a rigid joint all that it carries
            load *= Fraction(spring) / (Fraction(spring) - load)
        load += segment
    return load
