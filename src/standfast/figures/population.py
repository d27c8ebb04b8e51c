"""Which figures a population gets, one file each."""

from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes

from standfast.errors import InputError, nearest_name
from standfast.figures import population_charts, style
from standfast.figures.population_sway import sway_by_class
from standfast.population.summary.file import Population

# With feedback, and fewer falls than that, a map of them shows chance alone.
FEWEST_FALLS = 0.01

# What differs by less, relative, is the same but for rounding.
ROUNDING = 1e-9


class Picture(NamedTuple):
    """How a figure is drawn, how high, and why it is not, if it would show a constant.

    ``remark`` says what is left out of it.
    """

    height: float
    draw: Callable[..., Axes]
    constant: str = ""
    remark: str = ""


def draw(
    population: Population,
    stem: Path,
    formats: Sequence[str] = ("png",),
    *,
    wanted: Sequence[str] = (),
    progress: Callable[[int, int], None] | None = None,
) -> list[style.Drawing]:
    """Draw figures of a population as ``stem``-….png: all, or those ``wanted`` by name."""
    pictures = _pictures(population)
    chosen = {name: each for name, each in pictures.items() if not wanted or name in wanted}
    drawn = []
    for done, (name, picture) in enumerate(chosen.items(), start=1):
        if picture.constant:
            drawn.append(style.Drawing([], f"{picture.constant}: no figure {name}"))
            continue
        with style.paper_figure(height=picture.height) as (figure, (ax,)):
            picture.draw(population, ax=ax)
            paths = style.save(figure, stem.with_name(f"{stem.name}-{name}"), formats)
            drawn.append(style.Drawing(paths, picture.remark))
        if progress is not None:
            progress(done, len(chosen))
    return drawn


def names_of(population: Population, asked: Sequence[str]) -> list[str]:
    """Return the figures that a user asks for by their names, with - or _.

    Raises
    ------
    InputError
        for a figure that this population does not have.
    """
    known = list(_pictures(population))
    found = []
    for each in asked:
        name = each.replace("_", "-")
        match = next((one for one in known if one.replace("_", "-") == name), None)
        if match is None:
            raise InputError(
                f"{population.path} has no figure {each!r}{nearest_name(name, known)} "
                f"(figures: {', '.join(known)})"
            )
        found.append(match)
    return found


def _pictures(population: Population) -> dict[str, Picture]:
    """Return the figures that a population gets, by name."""
    summary = population.summary
    falls = summary["unstable_fraction"]
    alike = {0.0: "everybody stands", 1.0: "everybody falls"}.get(falls, "")
    pictures = {"risk-map": Picture(2.9, population_charts.risk_map, alike)}
    if population.study.is_fed_back:
        pictures["standing-by-delay"] = Picture(
            3.2,
            population_charts.standing_by_delay,
            _never_changes(population),
            _classes_left_out(population),
        )
        for name in population.study.sway:
            height = 0.9 + 0.2 * (1 + len(population_charts.classes_shown(population)[0]))
            nobody = "" if np.isfinite(population.array(name)).any() else "nobody sways"
            pictures[f"sway-{name}"] = Picture(
                height, partial(sway_by_class, quantity=name), nobody
            )
        if 0.0 < falls < FEWEST_FALLS:
            few = f"{100.0 * falls:.2g} % fall, too few for a map"
            pictures["risk-map"] = Picture(2.9, population_charts.risk_map, few)
    else:
        pictures["risk-by-multiple"] = Picture(2.6, population_charts.risk_by_multiple)
        pictures["safety-factor"] = Picture(
            2.5, population_charts.survival, _one_factor(population)
        )
    for output, indices in summary["drivers"].items():
        if "remark" not in indices:
            height = 1.1 + 0.3 * len(indices)
            pictures[f"drivers-{output}"] = Picture(
                height, partial(population_charts.drivers, output=output)
            )
    return pictures


def _classes_left_out(population: Population) -> str:
    shown, count = population_charts.classes_shown(population)
    if len(shown) == count:
        return ""
    return f"standing-by-delay shows the {len(shown)} largest of {count} classes by sex and age"


def _never_changes(population: Population) -> str:
    standing = population.array("standing")
    if np.ptp(standing) > ROUNDING:
        return ""
    return f"{100.0 * standing[0]:.3g} % stand at every delay"


def _one_factor(population: Population) -> str:
    """Say that all safety factors lie between two neighbouring values of the file's axis."""
    factor, above = population.array("safety_factor"), population.array("survival")
    some = np.flatnonzero((above > ROUNDING) & (above < 1.0 - ROUNDING))
    everybody = np.flatnonzero(above >= 1.0 - ROUNDING)
    if len(some) > 1 or not everybody.size or everybody[-1] + 1 == factor.size:
        return ""
    low, high = factor[everybody[-1]], factor[everybody[-1] + 1 + len(some)]
    return f"the safety factor is {low:.3g} to {high:.3g} in everybody"
