"""Verdicts beyond doubt: where rounding could decide, exact rational arithmetic does.

A verdict of a sweep is one comparison, Ka > L1. The threshold L1 comes with a proven bound of its
rounding error; only where an ankle stiffness of the study lies within that bound is the comparison
in doubt. There the threshold is computed again in fractions, from the study's own numbers, and how
many stiffnesses of the axis fall is counted anew, so that every comparison is the exact one.

notation: γs, γt, γb gravity loads; L1, L2, L3 loads carried by ankle, knee, hip.
"""

import math
from bisect import bisect_right
from collections.abc import Mapping, Sequence
from fractions import Fraction

import numpy as np

from standfast.body import REFERENCE_PEOPLE
from standfast.stability import ROUNDOFF

# Scaling a person rounds: mass ratio of BMI · height² over the reference (4 roundings), times the
# segment's mass (1); height ratio (2, if the division is done by a reciprocal), times the segment's
# length (1). Together 8; the product of the two is counted with the loads.
SCALING_ROUNDING = 9.0 * ROUNDOFF


def exact_threshold(parameters: Mapping[str, float | str]) -> Fraction | None:
    """Return the ankle's exact threshold of one person (N·m/rad); None if none suffices.

    ``parameters`` are those of a study by name; each float is taken for exactly what it is.
    L3 = γb, L2 = γt + L3 Kh / (Kh − L3), L1 = γs + L2 Kk / (Kk − L2).
    """
    reference = REFERENCE_PEOPLE[str(parameters["body_model"])]
    height = Fraction(parameters["height"])
    mass = (
        Fraction(parameters["mass"])
        if "mass" in parameters
        else Fraction(parameters["bmi"]) * height**2
    )
    # masses and lengths of the reference person, and one factor for all loads
    shank, thigh, upper = (Fraction(float(m)) for m in reference.body.segment_mass)
    shank_length, thigh_length = (Fraction(float(h)) for h in reference.body.segment_length)
    centres = [Fraction(float(e)) for e in reference.body.segment_com]
    factor = Fraction(parameters["gravity"]) * mass * height
    factor /= Fraction(reference.mass) * Fraction(reference.height)
    at_hip = factor * upper * centres[2]
    handed = _handed_on(at_hip, float(parameters["hip_stiffness"]))
    if handed is None:
        return None
    at_knee = factor * (thigh * centres[1] + upper * thigh_length) + handed
    handed = _handed_on(at_knee, float(parameters["knee_stiffness"]))
    if handed is None:
        return None
    return factor * (shank * centres[0] + (thigh + upper) * shank_length) + handed


def _handed_on(load: Fraction, stiffness: float) -> Fraction | None:
    """Return L K / (K − L), what a joint hands on; None if it fails."""
    if math.isinf(stiffness):
        return load
    spring = Fraction(stiffness)
    return load * spring / (spring - load) if spring > load else None


def near(ankle: np.ndarray, falling: np.ndarray, low: np.ndarray, high: np.ndarray) -> np.ndarray:
    """Return where a stiffness of a rising axis lies in the interval [low, high].

    ``falling`` is how many of them lie at or below a number inside the interval, so only its
    neighbours need be looked at. An interval at infinity stands for a certain fall.
    """
    below = ankle[np.maximum(falling - 1, 0)]
    above = ankle[np.minimum(falling, len(ankle) - 1)]
    inside: np.ndarray = ((low <= below) & (below <= high)) | ((low <= above) & (above <= high))
    return inside & (low < np.inf)


def falling_below(ankle: Sequence[float], threshold: Fraction | None) -> int:
    """Return how many stiffnesses of a rising axis are not above an exact threshold."""
    return len(ankle) if threshold is None else bisect_right(ankle, threshold)
