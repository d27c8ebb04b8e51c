"""The standing person as a mechanism: joints, energies, A and C, equations of motion."""

from standfast.mechanics.joints import Stiffness, checked_person
from standfast.mechanics.matrices import (
    gravity_load_pairs,
    gravity_loads,
    inertia_matrix,
    joint_gravity,
    joint_inertia,
    second_variation,
    stiffness_matrix,
    stiffness_rows,
)
from standfast.mechanics.motion import (
    joint_moments,
    kinetic_energy,
    potential_energy,
    segment_angles,
)

__all__ = [
    "Stiffness",
    "checked_person",
    "gravity_load_pairs",
    "gravity_loads",
    "inertia_matrix",
    "joint_gravity",
    "joint_inertia",
    "joint_moments",
    "kinetic_energy",
    "potential_energy",
    "second_variation",
    "segment_angles",
    "stiffness_matrix",
    "stiffness_rows",
]
