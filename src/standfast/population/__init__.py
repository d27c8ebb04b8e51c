"""Populations: who would not stand, how sure that is, and what it would take.

``people`` says who, ``cohort`` what becomes of them, ``summary`` what is answered; ``simulation``
is the way through all three.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from standfast.population.people.records import People, read_people
from standfast.population.people.study import PopulationStudy

if TYPE_CHECKING:
    from standfast.population.assess import assess
    from standfast.population.simulation import simulate
    from standfast.population.summary.file import Population, open_population

# Where the names lie that need h5py or JAX, imported when they are first asked for.
LAZY = {
    "Population": "standfast.population.summary.file",
    "assess": "standfast.population.assess",
    "open_population": "standfast.population.summary.file",
    "simulate": "standfast.population.simulation",
}

__all__ = [
    "People",
    "Population",
    "PopulationStudy",
    "assess",
    "open_population",
    "read_people",
    "simulate",
]


def __getattr__(name: str) -> Any:
    """Import what needs h5py or JAX when it is first asked for."""
    if name in LAZY:
        return getattr(import_module(LAZY[name]), name)
    raise AttributeError(f"module 'standfast.population' has no attribute {name!r}")
