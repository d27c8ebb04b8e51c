"""What the answers of a population look like, so that whoever prints or draws them may trust them.

A pattern is a type; a list of patterns, one an item, or of one for any number of them; a tuple of
alternatives; or a dictionary by key, with ``str`` for all keys that it does not name.
"""

import math
from typing import Any

from standfast.parameters import JOINTS
from standfast.population.people.classes import STRATA
from standfast.population.people.study import PopulationStudy
from standfast.population.summary.arrays import STANDING_SHARES as SHARES

MOST_KEYS = 1000  # classes by sex and age of one-year bands are 528
LARGEST_INTEGER = 2**63
LARGEST_INDEX = 1e6  # Sobol indices are about 0 to 1, and none is infinite

INTERVAL = [float, float]
MAYBE = (float, None)
QUANTILE = {"value": MAYBE, "interval": [MAYBE, MAYBE]}
QUANTILES = (None, {"0.05": QUANTILE, "0.5": QUANTILE, "0.95": QUANTILE, str: QUANTILE})
STRATUM = {str: {"persons": int, "share": float, "unstable_fraction": float, "interval": INTERVAL}}
MULTIPLE = {"multiple": MAYBE, "multiple_interval": (None, [MAYBE, MAYBE])}
REQUIRED = {"stiffness": MAYBE, "stiffness_interval": [MAYBE, MAYBE], **MULTIPLE}
INDEX = {"first": abs, "first_interval": [abs, abs], "total": abs, "total_interval": [abs, abs]}
LAW = {"distribution": str, "relative_to": str, str: (float, str)}
DRIVERS = ({"remark": str}, {str: INDEX})
# Of every population, but for "laws" and "drivers".
COMMON = {
    "title": str,
    "gravity": float,
    "laws": {**dict.fromkeys(JOINTS, LAW), "correlation": [[float]]},
    "unstable_fraction": float,
    "unstable_fraction_interval": INTERVAL,
    "confidence": float,
    "interval_method": str,
    "settled_exactly": int,
    "same_for_everybody": {str: float},
    "units": {str: str},
    "size": int,
    "seed": int,
    "method": str,
    "effective_sample_size": float,
    "persons_with_details": int,
    "people": (
        {"source": str, "groups": [str]},
        {
            "source": str,
            "used": int,
            "effective_sample_size": float,
            "survey_interval": (None, INTERVAL),
            "not_selected": int,
            "rejected": [{"file": str, "line": int, "reason": str}],
            "remarks": [str],
        },
    ),
    "strata": dict.fromkeys(STRATA, STRATUM),
    "single_joint_critical_stiffness": {
        joint: {"mean": float, "mean_interval": INTERVAL, "sd": float} for joint in JOINTS
    },
}
ANSWERS = {
    **COMMON,
    "safety_factor": QUANTILES,
    "growth_rate_of_the_unstable": QUANTILES,
    "required_stiffness": {
        **{joint: {f"{share:g}": REQUIRED for share in SHARES} for joint in JOINTS},
        "all": {f"{share:g}": MULTIPLE for share in SHARES},
    },
    "drivers": {"unstable": DRIVERS, "safety_factor": DRIVERS},
}
DELAYS = {f"{share:g}": {"delay": MAYBE, "delay_interval": [MAYBE, MAYBE]} for share in SHARES}
FED_BACK_ANSWERS = {
    **COMMON,
    "nerves": {str: LAW},
    "unstable_by_springs_alone": float,
    "unstable_by_springs_alone_interval": INTERVAL,
    "left_open_by_rounding": int,
    "critical_delay": QUANTILES,
    "delay_margin": QUANTILES,
    "delay_borne": {"all": DELAYS, "sex": {str: DELAYS}, "age": {str: DELAYS}, str: {str: DELAYS}},
    "drivers": {"unstable": DRIVERS, "delay_margin": DRIVERS},
}
# Of who has a sway: how many they are of all whose sway was asked, of how many it is open, and
# quantiles in SI.
OF_SWAY = {
    "persons": int,
    "swaying": int,
    "left_open": int,
    "quantiles": (None, {str: QUANTILE}),
}
SWAY_ANSWERS = {
    **FED_BACK_ANSWERS,
    "sway": {
        str: {
            "unit": str,
            "all": OF_SWAY,
            "sex": {str: OF_SWAY},
            "age": {str: OF_SWAY},
            "sex_and_age": {str: OF_SWAY},
        }
    },
}


def answers_of(study: PopulationStudy) -> dict[str, Any]:
    """Return the pattern of the answers to a study."""
    if study.sway:
        return SWAY_ANSWERS
    return FED_BACK_ANSWERS if study.is_fed_back else ANSWERS


def fits(value: Any, pattern: Any) -> bool:
    """Return whether a value read from JSON is as a pattern says; ``abs`` is a number of size."""
    if isinstance(pattern, tuple):
        return any(fits(value, each) for each in pattern)
    if isinstance(pattern, dict):
        rest = pattern.get(str, ())
        return (
            isinstance(value, dict)
            and len(value) <= MOST_KEYS
            and pattern.keys() - {str} <= value.keys()
            and all(fits(item, pattern.get(key, rest)) for key, item in value.items())
        )
    if isinstance(pattern, list):
        if not isinstance(value, list):
            return False
        each = pattern if len(pattern) > 1 else pattern * len(value)
        return len(value) == len(each) and all(map(fits, value, each))
    if pattern in (float, abs, int):
        most = LARGEST_INDEX if pattern is abs else math.inf
        real = pattern is not int and type(value) is float and not abs(value) > most
        return real or (type(value) is int and abs(value) < LARGEST_INTEGER)
    return value is None if pattern is None else isinstance(value, pattern)
