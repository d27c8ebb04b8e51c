"""Figures of a population, from its file: who falls, what it would take, and what drives it."""

import itertools
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import PercentFormatter

from standfast.figures.style import BLUE, GREY, LINE_STYLES, VERMILION, paper_figure, save
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

GREEN = "#009E73"  # of the same colour-blind safe set (Okabe & Ito)

# A cell of the risk map with fewer persons says more of chance than of risk.
FEWEST = 50

# With feedback, and fewer falls than that, a map of them shows chance alone.
FEWEST_FALLS = 0.01

# The risk map shows cells of 5 cm by 1 kg/m², two of the stored ones each way.
TOGETHER = 2


def draw(population: Population, stem: Path, formats: Sequence[str] = ("png",)) -> list[Path]:
    """Draw all figures of a population as ``stem``-….png; return the files."""
    pictures: dict[str, tuple[float, Callable[[Axes, Population], object]]] = {
        "risk-map": (2.8, _risk_map),
    }
    if population.study.is_fed_back:
        pictures["standing-by-delay"] = 2.8, _standing_by_delay
        if population.summary["unstable_fraction"] < FEWEST_FALLS:
            del pictures["risk-map"]
    else:
        pictures["risk-by-multiple"] = 2.6, _risk_by_multiple
        pictures["safety-factor"] = 2.5, _survival
    for output, indices in population.summary["drivers"].items():
        if "remark" not in indices:
            height = 1.1 + 0.36 * len(indices)
            pictures[f"drivers-{output}"] = height, partial(_drivers, output=output)
    drawn = []
    for name, (height, picture) in pictures.items():
        with paper_figure(height=height) as (figure, (ax,)):
            picture(ax, population)
            drawn += save(figure, stem.with_name(f"{stem.name}-{name}"), formats)
    return drawn


def _risk_map(ax: Axes, population: Population) -> None:
    """Draw the fraction unstable over height and BMI; where there are few persons stays white."""
    persons = _coarser(population.array("persons"))
    with np.errstate(invalid="ignore", divide="ignore"):
        falls = np.nan_to_num(population.array("risk")) * population.array("persons")
        risk = np.where(persons >= FEWEST, _coarser(falls) / persons, np.nan)
    height, bmi = (
        population.array(name).reshape(-1, TOGETHER).mean(axis=1) for name in ("height", "bmi")
    )
    mesh = ax.pcolormesh(bmi, height, risk, cmap="cividis", vmin=0.0, vmax=1.0, rasterized=True)
    rows, columns = np.nonzero(np.isfinite(risk))
    if rows.size:
        ax.set_xlim(bmi[columns.min()] - 1.0, bmi[columns.max()] + 1.0)
        ax.set_ylim(height[rows.min()] - 0.05, height[rows.max()] + 0.05)
    ax.set(xlabel="Body mass index (kg/m²)", ylabel=PARAMETERS["height"].label)
    percent = PercentFormatter(1.0)
    bar = ax.figure.colorbar(mesh, ax=ax, label="Persons unstable", aspect=30, format=percent)
    bar.outline.set_linewidth(0.4)


def _risk_by_multiple(ax: Axes, population: Population) -> None:
    """Draw the fraction unstable against the multiple of the law, one curve a joint.

    A joint that is rigid in all persons has none.
    """
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
    ax.text(1.0, 1.01, "as drawn", ha="center", va="bottom", fontsize=6.5, color=GREY)
    changing = [
        multiple[(risk > risk.min() + 0.005) & (risk < risk.max() - 0.005)]
        for risk in curves.values()
    ]
    seen = np.concatenate([*changing, [0.8, 1.25]])
    ax.set_xlim(float(seen.min()), float(min(seen.max(), 4.0)))
    ax.set(xlabel="Stiffness, as a multiple of the law", ylabel="Persons unstable", ylim=(0.0, 1.0))
    ax.yaxis.set_major_formatter(PercentFormatter(1.0))
    ax.legend(title="Multiplied", loc="best", alignment="left", edgecolor="none")


def _survival(ax: Axes, population: Population) -> None:
    """Draw the share of persons whose safety factor is higher than each value."""
    safety_factor, share = population.array("safety_factor"), population.array("survival")
    ax.axvspan(safety_factor[0], 1.0, color="0.93", zorder=0)
    ax.plot(safety_factor, share, color=BLUE)
    changing = safety_factor[(share > 0.002) & (share < 0.998)]
    low, high = (changing.min(), changing.max()) if changing.size else (0.5, 2.0)
    ax.set_xlim(min(float(low), 0.95), max(float(high), 1.05))
    stand = float(np.interp(1.0, safety_factor, share))
    ax.plot([1.0], [stand], "o", color=BLUE, markersize=4.0)
    words, offset = f"{100.0 * stand:.3g} % stand", (6, 6) if stand < 0.9 else (6, -10)
    ax.annotate(words, (1.0, stand), offset, textcoords="offset points", fontsize=7)
    ax.text(0.02, 0.04, "fall", transform=ax.transAxes, fontsize=7, color=GREY)
    ax.yaxis.set_major_formatter(PercentFormatter(1.0))
    ax.set(xlabel=QUANTITIES["safety_factor"].label, ylabel="Persons above it", ylim=(0.0, 1.0))


def _standing_by_delay(ax: Axes, population: Population) -> None:
    """Draw the share of persons who stand up to each delay: of all, and by sex and age."""
    delay, everybody = population.array("delay"), population.array("standing")
    by_both = population.array("standing_by_sex_and_age")
    seen = np.isfinite(by_both[..., 0])
    classes = ages_of(population.study)
    several = seen.sum() > 1
    ages = [number for number in range(len(classes)) if seen[:, number].any()]
    colors = dict(zip(SEXES, (BLUE, VERMILION, GREEN, GREY), strict=True))
    for (sex, color), curves in zip(colors.items(), by_both, strict=True):
        for style, age in zip(itertools.cycle(LINE_STYLES[1:]), ages):
            if several and np.isfinite(curves[age, 0]):
                label = f"{sex} {classes[age]}".replace("unknown unknown", "unknown")
                ax.plot(delay, curves[age], linestyle=style, color=color, label=label)
    ax.plot(delay, everybody, color="black", label="all")
    changing = delay[(everybody > 0.002) & (everybody < everybody.max() - 0.002)]
    if changing.size:
        ax.set_xlim(max(float(changing[0]) - 0.05, 0.0), float(changing[-1]) + 0.02)
    ax.yaxis.set_major_formatter(PercentFormatter(1.0))
    ax.set(xlabel="Delay of the feedback (s)", ylabel="Persons who stand up to it", ylim=(0, 1))
    ax.legend(loc="best", edgecolor="none")


def _drivers(ax: Axes, population: Population, output: str) -> None:
    """Draw first-order and total Sobol indices with their intervals, a pair of bars a factor."""
    indices = population.summary["drivers"][output]
    places = np.arange(len(indices))[::-1]
    for kind, offset, face, edge, hatch, label in (
        ("first", 0.19, BLUE, BLUE, "", "alone (first order)"),
        ("total", -0.19, "white", VERMILION, "////", "with all others (total)"),
    ):
        values = np.array([each[kind] for each in indices.values()])
        low, high = np.array([each[f"{kind}_interval"] for each in indices.values()]).T
        ax.barh(
            places + offset,
            values,
            0.36,
            color=face,
            edgecolor=edge,
            hatch=hatch,
            label=label,
            xerr=[np.maximum(values - low, 0.0), np.maximum(high - values, 0.0)],
            error_kw={"elinewidth": 0.8, "ecolor": "black"},
        )
    ax.set_yticks(places, [name.replace("$", r"\$") for name in indices])
    ax.set_xlim(0.0, max(1.0, float(high.max())))  # those of the totals, drawn last
    ax.set_xlabel("Share of the variance (Sobol index)")
    ax.figure.legend(frameon=False, loc="outside lower center", ncols=2)
    ax.set_title(f"What drives {DRIVEN[output]}")


def _coarser(cells: np.ndarray) -> np.ndarray:
    """Add up TOGETHER × TOGETHER cells."""
    rows, columns = cells.shape
    blocks = cells.reshape(rows // TOGETHER, TOGETHER, columns // TOGETHER, TOGETHER)
    total: np.ndarray = blocks.sum(axis=(1, 3))
    return total
