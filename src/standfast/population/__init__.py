"""Populations: who would not stand, how sure that is, and what it would take."""

from standfast.population.people import People, read_people
from standfast.population.simulation import simulate
from standfast.population.study import PopulationStudy

__all__ = ["People", "PopulationStudy", "read_people", "simulate"]
