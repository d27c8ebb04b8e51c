"""Figures of a population: who falls, what it would take, and what drives it."""

from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Patch
from matplotlib.ticker import PercentFormatter

from standfast.errors import InputError, nearest_name
from standfast.figures.given import population_in
from standfast.figures.labels import name_curves
from standfast.figures.style import (
    BLUE,
    GREEN,
    GREY,
    LINE_STYLES,
    VERMILION,
    axes_for,
)
from standfast.parameters import JOINTS, PARAMETERS
from standfast.population.people.words import SEXES
from standfast.population.summary.arrays import ages_of
from standfast.population.summary.file import Population
from standfast.quantities import QUANTITIES

DRIVEN = {
    "unstable": "falling",
    "safety_factor": "the safety factor",
    "delay_margin": "the delay margin",
}

# A cell of the risk map with fewer persons says more of chance than of risk.
FEWEST = 50

# More curves are not told apart; as many ages of one sex have a dash pattern each.
MOST_CLASSES = 8
CLASS_STYLES = (
    *LINE_STYLES[1:], (0, (1, 3)), (0, (12, 2, 2, 2)), (0, (3, 3)),
)  # fmt: skip

# The risk map shows cells of 5 cm by 1 kg/m², two of the stored ones each way.
TOGETHER = 2


def risk_map(population: Population | str | Path, *, ax: Axes | None = None) -> Axes:
    """Draw the fraction unstable over height and BMI, the highest dark; return the axes.

    Cells of fewer than ``FEWEST`` persons are hatched, those of nobody white.

    Examples
    --------
    >>> import standfast as sf
    >>> ax = sf.plot.risk_map("people.h5")
    >>> ax.get_xlabel()
    'Body mass index (kg/m²)'
    """
    population = population_in(population)
    ax = axes_for(ax)
    persons = _coarser(population.array("persons"))
    with np.errstate(invalid="ignore", divide="ignore"):
        falls = np.nan_to_num(population.array("risk")) * population.array("persons")
        risk = np.where(persons >= FEWEST, _coarser(falls) / persons, np.nan)
    height, bmi = (
        population.array(name).reshape(-1, TOGETHER).mean(axis=1) for name in ("height", "bmi")
    )
    few = np.where((persons > 0) & (persons < FEWEST), 1.0, np.nan)
    ax.pcolor(bmi, height, few, cmap="gray", vmin=0.0, vmax=1.05, hatch="//////", edgecolor="0.6",
              linewidth=0.0)  # fmt: skip
    colors: Any = {"cmap": "cividis_r", "vmin": 0.0, "vmax": 1.0}
    mesh = ax.pcolormesh(bmi, height, risk, rasterized=True, **colors)
    rows, columns = np.nonzero(persons > 0)
    if rows.size:
        ax.set_xlim(bmi[columns.min()] - 1.0, bmi[columns.max()] + 1.0)
        ax.set_ylim(height[rows.min()] - 0.05, height[rows.max()] + 0.05)
    ax.set(xlabel="Body mass index (kg/m²)", ylabel=PARAMETERS["height"].label)
    percent = PercentFormatter(1.0)
    bar = ax.figure.colorbar(mesh, ax=ax, label="Persons unstable", aspect=30, format=percent)
    bar.outline.set_linewidth(0.4)
    marks = [
        Patch(
            facecolor="0.95", edgecolor="0.6", hatch="//////", label=f"1 to {FEWEST - 1} persons"
        ),
        Patch(facecolor="white", edgecolor="0.6", linewidth=0.5, label="no persons"),
    ]
    below: Any = {"loc": "lower center", "bbox_to_anchor": (0.5, 1.0), "ncols": 2}
    ax.legend(handles=marks, frameon=False, handlelength=1.2, **below)
    return ax


def risk_by_multiple(population: Population | str | Path, *, ax: Axes | None = None) -> Axes:
    """Draw the fraction unstable against the multiple of the law, one curve a joint.

    A joint that is rigid in all persons has none. Returns the axes.

    Examples
    --------
    >>> import standfast as sf
    >>> ax = sf.plot.risk_by_multiple("people.h5")
    >>> ax.get_ylabel()
    'Persons unstable'
    """
    population = population_in(population)
    ax = axes_for(ax)
    curves = {}
    for joint in ("all", *JOINTS):
        shares = population.summary["required_stiffness"][joint]
        if any(each["multiple_interval"] is not None for each in shares.values()):
            name = f"{joint} alone" if joint != "all" else "all joints"
            curves[name] = population.array(f"risk_by_{joint}_multiple")
    multiple = population.array("multiple")
    colors = ("black", BLUE, VERMILION, GREY)
    for (name, risk), style, color in zip(curves.items(), LINE_STYLES, colors, strict=False):
        ax.plot(multiple, risk, linestyle=style, color=color, label=name)
    ax.axvline(1.0, color=GREY, linewidth=0.6)
    ax.text(1.0, 1.01, "as drawn", ha="center", va="bottom", fontsize="small", color=GREY)
    changing = [
        multiple[(risk > risk.min() + 0.005) & (risk < risk.max() - 0.005)]
        for risk in curves.values()
    ]
    seen = np.concatenate([*changing, [0.8, 1.25]])
    ax.set_xlim(float(seen.min()), float(min(seen.max(), 4.0)))
    ax.set(xlabel="Stiffness, as a multiple of the law", ylabel="Persons unstable", ylim=(0.0, 1.0))
    ax.yaxis.set_major_formatter(PercentFormatter(1.0))
    named = ((name, (multiple, risk)) for name, risk in curves.items())
    name_curves(ax, named, colors=colors)
    return ax


def survival(population: Population | str | Path, *, ax: Axes | None = None) -> Axes:
    """Draw the share of persons whose safety factor is higher than each value; return the axes.

    Examples
    --------
    >>> import standfast as sf
    >>> ax = sf.plot.survival("people.h5")
    >>> ax.get_xlabel()
    'Safety factor $s$'
    """
    population = population_in(population)
    ax = axes_for(ax)
    safety_factor, share = population.array("safety_factor"), population.array("survival")
    ax.axvspan(safety_factor[0], 1.0, color="0.93", zorder=0)
    ax.plot(safety_factor, share, color=BLUE)
    changing = safety_factor[(share > 0.002) & (share < 0.998)]
    low, high = (changing.min(), changing.max()) if changing.size else (0.5, 2.0)
    ax.set_xlim(min(float(low), 0.95), max(float(high), 1.05))
    stand = float(np.interp(1.0, safety_factor, share))
    ax.plot([1.0], [stand], "o", color=BLUE, markersize=4.0)
    words, offset = f"{100.0 * stand:.3g} % stand", (6, 6) if stand < 0.9 else (6, -10)
    ax.annotate(words, (1.0, stand), offset, textcoords="offset points", fontsize="small")
    ax.text(0.02, 0.04, "fall", transform=ax.transAxes, fontsize="small", color=GREY)
    ax.yaxis.set_major_formatter(PercentFormatter(1.0))
    ax.set(xlabel=QUANTITIES["safety_factor"].label, ylabel="Persons above it", ylim=(0.0, 1.0))
    return ax


def standing_by_delay(population: Population | str | Path, *, ax: Axes | None = None) -> Axes:
    """Draw the share of persons who stand up to each delay: of all, and by sex and age.

    Of many classes the ``MOST_CLASSES`` of most persons are drawn, which the legend says. Returns
    the axes.

    Examples
    --------
    >>> import standfast as sf
    >>> ax = sf.plot.standing_by_delay("people-feedback.h5")
    >>> ax.get_xlabel()
    'Delay of the feedback (s)'
    """
    population = population_in(population)
    ax = axes_for(ax)
    delay, everybody = population.array("delay"), population.array("standing")
    by_both = population.array("standing_by_sex_and_age")
    shown, count = classes_shown(population)
    ages = list(dict.fromkeys(age for _, age in shown))
    colors = (BLUE, VERMILION, GREEN, GREY)
    for sex, age in shown if count > 1 else []:
        style = CLASS_STYLES[ages.index(age) % len(CLASS_STYLES)]
        label = _class_name(population, sex, age).replace("unknown unknown", "unknown")
        ax.plot(delay, by_both[sex, age], linestyle=style, color=colors[sex], label=label)
    ax.plot(delay, everybody, color="black", label="all")
    changing = delay[(everybody > 0.002) & (everybody < everybody.max() - 0.002)]
    if changing.size:
        ax.set_xlim(max(float(changing[0]) - 0.05, 0.0), float(changing[-1]) + 0.02)
    ax.yaxis.set_major_formatter(PercentFormatter(1.0))
    ax.set(xlabel="Delay of the feedback (s)", ylabel="Persons who stand up to it", ylim=(0, 1))
    above: Any = {"loc": "lower center", "bbox_to_anchor": (0.5, 1.0), "frameon": False}
    words = f"the {len(shown)} largest of {count} classes" if len(shown) < count else None
    ax.legend(ncols=3, title=words, title_fontsize="small", columnspacing=1.0, **above)
    return ax


def classes_shown(population: Population) -> tuple[list[tuple[int, int]], int]:
    """Return the classes that are drawn, by numbers of sex and age, and how many there are."""
    seen = np.isfinite(population.array("standing_by_sex_and_age")[..., 0])
    classes = [(int(sex), int(age)) for sex, age in zip(*np.nonzero(seen), strict=True)]
    strata = population.summary["strata"]["sex_and_age"]
    persons = {each: strata[_class_name(population, *each)]["persons"] for each in classes}
    largest = sorted(classes, key=lambda each: -persons[each])[:MOST_CLASSES]
    return sorted(largest), len(classes)


def _class_name(population: Population, sex: int, age: int) -> str:
    return f"{SEXES[sex]} {ages_of(population.study)[age]}"


def drivers(population: Population | str | Path, output: str, *, ax: Axes | None = None) -> Axes:
    """Draw first-order and total Sobol indices, dots with 95 % intervals, a row a factor.

    ``output`` is ``unstable``, ``safety_factor`` or ``delay_margin``. Returns the axes.

    Raises
    ------
    InputError
        if the population has no such indices.

    Examples
    --------
    >>> import standfast as sf
    >>> ax = sf.plot.drivers("people.h5", "safety_factor")
    >>> len(ax.get_yticks()) > 0
    True
    """
    population = population_in(population)
    known = population.summary["drivers"]
    indices = known.get(output)
    if indices is None:
        raise InputError(
            f"{population.path} has no drivers of {output!r}{nearest_name(output, known)} "
            f"(inside: {', '.join(known)})"
        )
    if "remark" in indices:
        raise InputError(f"{population.path}: drivers of {output}: {indices['remark']}")
    ax = axes_for(ax)
    places = np.arange(len(indices))[::-1]
    for kind, offset, color, face, marker, label in (
        ("first", 0.14, BLUE, BLUE, "o", "alone (first order)"),
        ("total", -0.14, VERMILION, "white", "s", "with all others (total)"),
    ):
        values = np.array([each[kind] for each in indices.values()])
        low, high = np.array([each[f"{kind}_interval"] for each in indices.values()]).T
        errors = [np.maximum(values - low, 0.0), np.maximum(high - values, 0.0)]
        look: Any = {"fmt": marker, "color": color, "markerfacecolor": face, "markersize": 4.0}
        ax.errorbar(
            values, places + offset, xerr=errors, elinewidth=0.9, capsize=1.5, label=label, **look
        )
    for place in places[:-1]:
        ax.axhline(place - 0.5, color="0.9", linewidth=0.5, zorder=0)
    ax.set_yticks(places, [name.replace("$", r"\$") for name in indices])
    ax.set_ylim(-0.5, len(indices) - 0.5)
    ax.set_xlim(min(-0.02, ax.get_xlim()[0]), max(1.0, ax.get_xlim()[1]))
    ax.set_xlabel("Share of the variance (Sobol index)")
    ax.legend(loc="best", frameon=False)
    ax.set_title(f"What drives {DRIVEN.get(output, output)}")
    return ax


def _coarser(cells: np.ndarray) -> np.ndarray:
    """Add up TOGETHER × TOGETHER cells."""
    rows, columns = cells.shape
    blocks = cells.reshape(rows // TOGETHER, TOGETHER, columns // TOGETHER, TOGETHER)
    total: np.ndarray = blocks.sum(axis=(1, 3))
    return total
