"""Does the person stand, and by what margin: by springs alone, with proofs."""

from standfast.stability.margins import safety_factor, stability_determinant, stiffness_reserve
from standfast.stability.modes import Modes, frequency, growth_rate, modes, ratio_to_ankle
from standfast.stability.rounding import load_rounding, threshold_interval, verdict_is_certain
from standfast.stability.springs import (
    carried_loads,
    critical_ankle_stiffness,
    critical_hip_stiffness,
    critical_knee_stiffness,
    critical_stiffness,
    equal_rotation,
    is_stable,
    verdict,
)

__all__ = [
    "Modes",
    "carried_loads",
    "critical_ankle_stiffness",
    "critical_hip_stiffness",
    "critical_knee_stiffness",
    "critical_stiffness",
    "equal_rotation",
    "frequency",
    "growth_rate",
    "is_stable",
    "load_rounding",
    "modes",
    "ratio_to_ankle",
    "safety_factor",
    "stability_determinant",
    "stiffness_reserve",
    "threshold_interval",
    "verdict",
    "verdict_is_certain",
]
