"""How stiff ankle, knee and hip must be for a person to stand.

The model runs in NumPy float64 and answers at once; JAX and h5py are imported by what needs them.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from standfast.anthropometry.body import Body
from standfast.errors import InputError
from standfast.mechanics.feedback import Feedback
from standfast.mechanics.joints import Stiffness
from standfast.mechanics.matrices import inertia_matrix, stiffness_matrix
from standfast.mechanics.motion import joint_moments, kinetic_energy, potential_energy
from standfast.parameters import BODY_MODELS
from standfast.quantities import Person, add_quantity
from standfast.stability.feedback import (
    critical_delay,
    delay_crossings,
    is_stable,
    rightmost_root,
    unstable_roots,
)
from standfast.stability.margins import safety_factor, stability_determinant, stiffness_reserve
from standfast.stability.modes import Modes, frequency, growth_rate, modes
from standfast.stability.rounding import verdict_is_certain
from standfast.stability.springs import critical_stiffness, equal_rotation
from standfast.stability.sway.person import Spectrum, sway_covariance, sway_spectrum
from standfast.study.study import Study
from standfast.version import __version__

if TYPE_CHECKING:
    from standfast import plot
    from standfast.atlas.memory import compute
    from standfast.atlas.opening import open_atlas
    from standfast.atlas.reader import Atlas
    from standfast.atlas.sweeping import sweep
    from standfast.fitting.fit import fit_sway
    from standfast.fitting.result import SwayFit
    from standfast.mechanics.laws import LAWS
    from standfast.population.assess import assess
    from standfast.population.people.records import read_people
    from standfast.population.people.study import PopulationStudy
    from standfast.population.simulation import simulate
    from standfast.population.summary.file import open_population
    from standfast.recordings.expected import ExpectedSway, expected_sway
    from standfast.recordings.measures import SwayMeasures, sway_measures
    from standfast.recordings.reading import read_recording
    from standfast.recordings.recording import Recording
    from standfast.run.lock import BusyError

# Where the names lie that need h5py or JAX, or are read once in a while; imported when they are
# first asked for.
LAZY = {
    "LAWS": "standfast.mechanics.laws",
    "Atlas": "standfast.atlas.reader",
    "BusyError": "standfast.run.lock",
    "open_atlas": "standfast.atlas.opening",
    "compute": "standfast.atlas.memory",
    "sweep": "standfast.atlas.sweeping",
    "PopulationStudy": "standfast.population.people.study",
    "assess": "standfast.population.assess",
    "open_population": "standfast.population.summary.file",
    "read_people": "standfast.population.people.records",
    "simulate": "standfast.population.simulation",
    "ExpectedSway": "standfast.recordings.expected",
    "expected_sway": "standfast.recordings.expected",
    "Recording": "standfast.recordings.recording",
    "SwayMeasures": "standfast.recordings.measures",
    "read_recording": "standfast.recordings.reading",
    "sway_measures": "standfast.recordings.measures",
    "SwayFit": "standfast.fitting.result",
    "fit_sway": "standfast.fitting.fit",
}

__all__ = [
    "BODY_MODELS",
    "LAWS",
    "Atlas",
    "Body",
    "BusyError",
    "ExpectedSway",
    "Feedback",
    "InputError",
    "Modes",
    "Person",
    "PopulationStudy",
    "Recording",
    "Spectrum",
    "Stiffness",
    "Study",
    "SwayFit",
    "SwayMeasures",
    "__version__",
    "add_quantity",
    "assess",
    "compute",
    "critical_delay",
    "critical_stiffness",
    "delay_crossings",
    "equal_rotation",
    "expected_sway",
    "fit_sway",
    "frequency",
    "growth_rate",
    "inertia_matrix",
    "is_stable",
    "joint_moments",
    "kinetic_energy",
    "modes",
    "open_atlas",
    "open_population",
    "plot",
    "potential_energy",
    "read_people",
    "read_recording",
    "rightmost_root",
    "safety_factor",
    "simulate",
    "stability_determinant",
    "stiffness_matrix",
    "stiffness_reserve",
    "sway_covariance",
    "sway_measures",
    "sway_spectrum",
    "sweep",
    "unstable_roots",
    "verdict_is_certain",
]


def __getattr__(name: str) -> Any:
    """Import what is lazy when it is first asked for."""
    if name == "plot":
        return import_module("standfast.plot")
    if name in LAZY:
        return getattr(import_module(LAZY[name]), name)
    raise AttributeError(f"module 'standfast' has no attribute {name!r}")


def __dir__() -> list[str]:
    """List the public names."""
    return sorted(__all__)
