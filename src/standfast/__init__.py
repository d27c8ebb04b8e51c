"""How stiff ankle, knee and hip must be for a person to stand.

The model runs in NumPy float64 and answers at once; JAX and h5py are imported by what needs them.
"""

from typing import TYPE_CHECKING, Any

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
from standfast.study import Study
from standfast.sweep import sweep

if TYPE_CHECKING:
    from standfast.population import PopulationStudy, simulate
    from standfast.store import Atlas, open_atlas

__version__ = "0.1.0"

__all__ = [
    "BODY_MODELS",
    "Atlas",
    "Body",
    "InputError",
    "Modes",
    "PopulationStudy",
    "Stiffness",
    "Study",
    "critical_stiffness",
    "equal_rotation",
    "frequency",
    "growth_rate",
    "inertia_matrix",
    "is_stable",
    "joint_moments",
    "kinetic_energy",
    "modes",
    "open_atlas",
    "potential_energy",
    "safety_factor",
    "simulate",
    "stability_determinant",
    "stiffness_matrix",
    "stiffness_reserve",
    "sweep",
    "verdict_is_certain",
]


def __getattr__(name: str) -> Any:
    """Import what needs h5py or JAX when it is first asked for."""
    if name in ("Atlas", "open_atlas"):
        from standfast import store  # noqa: PLC0415

        return getattr(store, name)
    if name in ("PopulationStudy", "simulate"):
        from standfast import population  # noqa: PLC0415

        return getattr(population, name)
    raise AttributeError(f"module 'standfast' has no attribute {name!r}")


def __dir__() -> list[str]:
    """List the public names."""
    return sorted(__all__)
