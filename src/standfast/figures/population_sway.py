"""Figures of how much a population sways."""

from pathlib import Path

import numpy as np
from matplotlib.axes import Axes

from standfast.errors import InputError, nearest_name
from standfast.figures.given import population_in
from standfast.figures.population_charts import classes_shown
from standfast.figures.style import BLUE, GREEN, GREY, VERMILION, axes_for
from standfast.parameters import label
from standfast.population.people.words import SEXES
from standfast.population.summary.arrays import ages_of
from standfast.population.summary.file import Population
from standfast.quantities import QUANTITIES

# How sway is drawn, by its unit: in which unit, and how many of that are one of SI.
DRAWN = {
    "m": ("mm", 1e3),
    "m/s": ("mm/s", 1e3),
    "rad": ("degrees", float(np.degrees(1.0))),
    "Hz": ("Hz", 1.0),
}
WHOLE, MIDDLE, MEDIAN = (0.025, 0.975), (0.25, 0.75), 0.5


def sway_by_class(
    population: Population | str | Path, quantity: str = "cop_sway", *, ax: Axes | None = None
) -> Axes:
    """Draw how much people sway, a row of all and of each class by sex and age; return the axes.

    A dot at the median, a thick line over the middle half, a thin one over the middle 95 % of who
    stands. Of many classes the largest are drawn.

    Raises
    ------
    InputError
        if the population has no noise, or was not asked for this quantity.

    Examples
    --------
    >>> import standfast as sf
    >>> ax = sf.plot.sway_by_class("people-sway.h5")
    >>> len(ax.get_yticks()) > 1
    True
    """
    population = population_in(population)
    known = population.study.sway
    if quantity not in known:
        inside = f"inside: {', '.join(known)}" if known else "its study has no [noise]"
        raise InputError(
            f"{population.path} has no sway {quantity!r}{nearest_name(quantity, known)} ({inside})"
        )
    ax = axes_for(ax)
    row = QUANTITIES[quantity]
    unit, factor = DRAWN[row.unit]
    shares = population.array("quantile")
    by_both = population.array(f"{quantity}_by_sex_and_age")
    ages, colors = ages_of(population.study), (BLUE, VERMILION, GREEN, GREY)
    rows = [("all", "black", population.array(quantity))]
    shown, count = classes_shown(population)
    for sex, age in shown if count > 1 else []:
        name = f"{SEXES[sex]} {ages[age]}".replace("unknown unknown", "unknown")
        rows.append((name, colors[sex], by_both[sex, age]))
    for place, (_, color, values) in enumerate(rows):
        ends = [np.interp(pair, shares, factor * values) for pair in (WHOLE, MIDDLE)]
        for pair, width in zip(ends, (1.0, 4.0), strict=True):
            ax.plot(pair, [place, place], color=color, linewidth=width, solid_capstyle="butt")
        middle = float(np.interp(MEDIAN, shares, factor * values))
        ax.plot([middle], [place], "o", color=color, markerfacecolor="white", markersize=5.0)
    ax.axhline(0.5, color="0.85", linewidth=0.6)
    ax.set_yticks(range(len(rows)), [name for name, *_ in rows])
    ax.set(ylim=(len(rows) - 0.5, -0.5), xlabel=label(row.words, row.symbol, unit))
    ax.set_xlim(left=0.0)
    ax.tick_params(axis="y", length=0)
    ax.set_title("median, middle half, middle 95 % of persons")
    return ax
