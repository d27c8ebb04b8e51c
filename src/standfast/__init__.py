"""How stiff ankle, knee and hip must be for a person to stand.

Everything here runs in NumPy float64 and answers at once; JAX is imported by what needs it.
"""

from standfast.body import BODY_MODELS, Body, Stiffness
from standfast.dynamics import (
    inertia_matrix,
    joint_moments,
    kinetic_energy,
    potential_energy,
    stiffness_matrix,
)
from standfast.modes import Modes, frequency, growth_rate, modes
from standfast.quantities import InputError
from standfast.stability import (
    critical_stiffness,
    equal_rotation,
    is_stable,
    safety_factor,
    stability_determinant,
    stiffness_reserve,
    verdict_is_certain,
)

__version__ = "0.1.0"

__all__ = [
    "BODY_MODELS",
    "Body",
    "InputError",
    "Modes",
    "Stiffness",
    "critical_stiffness",
    "equal_rotation",
    "frequency",
    "growth_rate",
    "inertia_matrix",
    "is_stable",
    "joint_moments",
    "kinetic_energy",
    "modes",
    "potential_energy",
    "safety_factor",
    "stability_determinant",
    "stiffness_matrix",
    "stiffness_reserve",
    "verdict_is_certain",
]
