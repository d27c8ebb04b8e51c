"""What a caller of ``standfast.plot`` gives: atlases and populations, open or by their files."""

from collections.abc import Iterable
from pathlib import Path
from typing import Any

from standfast.atlas.opening import open_atlas
from standfast.atlas.reader import Atlas
from standfast.errors import InputError, shortened
from standfast.population.summary.file import Population, open_population


def atlas_in(given: Any) -> Atlas:
    """Return an atlas, opened if its file is given; refuse anything else."""
    if isinstance(given, Atlas):
        return given
    if isinstance(given, str | Path):
        return open_atlas(given)
    raise InputError(f"{_called(given)} is no atlas; give what open_atlas returns, or its file")


def atlases_in(given: Iterable[Any]) -> list[Atlas]:
    """Return the atlases among some arguments, each an atlas, a file, or a list of both."""
    found = []
    for each in given:
        several = each if isinstance(each, list | tuple) else [each]
        found += [atlas_in(one) for one in several]
    return found


def population_in(given: Any) -> Population:
    """Return a population, opened if its file is given; refuse anything else."""
    if isinstance(given, Population):
        return given
    if isinstance(given, str | Path):
        return open_population(given)
    raise InputError(
        f"{_called(given)} is no population; give what open_population returns, or its file"
    )


def _called(given: Any) -> str:
    if isinstance(given, Atlas | Population):
        return str(given.path)
    return shortened(given)
