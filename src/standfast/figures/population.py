"""Figures of a population: who falls, what it would take, and what drives it.

:func:`draw` draws all of them from a population's file; the others draw arrays into given axes.
"""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import QuadMesh
from matplotlib.ticker import PercentFormatter

from standfast.figures.style import BLUE, GREY, LINE_STYLES, VERMILION, paper_figure, save
from standfast.parameters import JOINTS, PARAMETERS
from standfast.population.summary.file import Population
from standfast.quantities import QUANTITIES

Interval = tuple[float, float, float]  # value, low, high

# A cell of the risk map with fewer persons says more of chance than of risk.
FEWEST = 50

# The risk map shows cells of 5 cm by 1 kg/m², two of the stored ones each way.
TOGETHER = 2


def draw(population: Population, stem: Path, formats: Sequence[str] = ("png",)) -> list[Path]:
    """Draw all figures of a population as ``stem``-….png; return the files."""
    drawn = [
        *_risk_map(population, stem, formats),
        *_risk_by_multiple(population, stem, formats),
        *_survival(population, stem, formats),
    ]
    for output, words in (("unstable", "falling"), ("safety_factor", "the safety factor")):
        indices = population.summary["drivers"][output]
        if "remark" not in indices:
            drawn += _drivers(
                indices, words, stem.with_name(f"{stem.name}-drivers-{output}"), formats
            )
    return drawn


def _risk_map(population: Population, stem: Path, formats: Sequence[str]) -> list[Path]:
    persons = _coarser(population.array("persons"))
    with np.errstate(invalid="ignore", divide="ignore"):
        falls = np.nan_to_num(population.array("risk")) * population.array("persons")
        risk = np.where(persons >= FEWEST, _coarser(falls) / persons, np.nan)
    height, bmi = population.array("height"), population.array("bmi")
    with paper_figure(height=2.8) as (figure, (ax,)):
        mesh = risk_map(ax, _middles(height), _middles(bmi), risk)
        bar = figure.colorbar(
            mesh, ax=ax, label="Persons unstable", aspect=30, format=PercentFormatter(1.0)
        )
        bar.outline.set_linewidth(0.4)
        return save(figure, stem.with_name(f"{stem.name}-risk-map"), formats)


def _risk_by_multiple(population: Population, stem: Path, formats: Sequence[str]) -> list[Path]:
    rigid = [
        joint
        for joint, shares in population.summary["required_stiffness"].items()
        if all(each["multiple_interval"] is None for each in shares.values())
    ]
    curves = {
        f"{joint} alone" if joint != "all" else "all joints": population.array(
            f"risk_by_{joint}_multiple"
        )
        for joint in ("all", *JOINTS)
        if joint not in rigid
    }
    with paper_figure(height=2.6) as (figure, (ax,)):
        risk_by_multiple(ax, population.array("multiple"), curves)
        return save(figure, stem.with_name(f"{stem.name}-risk-by-multiple"), formats)


def _survival(population: Population, stem: Path, formats: Sequence[str]) -> list[Path]:
    with paper_figure(height=2.5) as (figure, (ax,)):
        survival_curve(ax, population.array("safety_factor"), population.array("survival"))
        return save(figure, stem.with_name(f"{stem.name}-safety-factor"), formats)


def _drivers(indices: dict[str, Any], words: str, stem: Path, formats: Sequence[str]) -> list[Path]:
    pairs = {
        kind: [(each[kind], *each[f"{kind}_interval"]) for each in indices.values()]
        for kind in ("first", "total")
    }
    with paper_figure(height=1.1 + 0.36 * len(indices)) as (figure, (ax,)):
        sobol_bars(ax, list(indices), pairs["first"], pairs["total"])
        ax.set_title(f"What drives {words}")
        return save(figure, stem, formats)


def _coarser(cells: np.ndarray) -> np.ndarray:
    """Add up TOGETHER × TOGETHER cells."""
    rows, columns = cells.shape
    blocks = cells.reshape(rows // TOGETHER, TOGETHER, columns // TOGETHER, TOGETHER)
    total: np.ndarray = blocks.sum(axis=(1, 3))
    return total


def _middles(values: np.ndarray) -> np.ndarray:
    middles: np.ndarray = values.reshape(-1, TOGETHER).mean(axis=1)
    return middles


def risk_map(ax: Axes, height: np.ndarray, bmi: np.ndarray, risk: np.ndarray) -> QuadMesh:
    """Draw the fraction unstable (len(height), len(bmi)) over height and BMI; NaN stays white."""
    mesh = ax.pcolormesh(bmi, height, risk, cmap="cividis", vmin=0.0, vmax=1.0, rasterized=True)
    rows, columns = np.nonzero(np.isfinite(risk))
    if rows.size:
        ax.set_xlim(bmi[columns.min()] - 1.0, bmi[columns.max()] + 1.0)
        ax.set_ylim(height[rows.min()] - 0.05, height[rows.max()] + 0.05)
    ax.set_xlabel("Body mass index (kg/m²)")
    ax.set_ylabel(PARAMETERS["height"].label)
    return mesh


def risk_by_multiple(ax: Axes, multiple: np.ndarray, curves: Mapping[str, np.ndarray]) -> Axes:
    """Draw the fraction unstable against the multiple of the law, one curve a joint."""
    colors = ("black", BLUE, VERMILION, GREY)
    for number, (name, risk) in enumerate(curves.items()):
        ax.plot(multiple, risk, linestyle=LINE_STYLES[number], color=colors[number], label=name)
    ax.axvline(1.0, color=GREY, linewidth=0.6)
    ax.text(1.0, 1.01, "as drawn", ha="center", va="bottom", fontsize=6.5, color=GREY)
    changing = [
        multiple[(risk > risk.min() + 0.005) & (risk < risk.max() - 0.005)]
        for risk in curves.values()
    ]
    seen = np.concatenate([*changing, [0.8, 1.25]])
    ax.set_xlim(float(seen.min()), float(min(seen.max(), 4.0)))
    ax.set_ylim(0.0, 1.0)
    ax.yaxis.set_major_formatter(PercentFormatter(1.0))
    ax.set_xlabel("Stiffness, as a multiple of the law")
    ax.set_ylabel("Persons unstable")
    ax.legend(title="Multiplied", loc="best", alignment="left", edgecolor="none")
    return ax


def survival_curve(ax: Axes, safety_factor: np.ndarray, share: np.ndarray) -> Axes:
    """Draw the share of persons whose safety factor is higher than each value."""
    ax.axvspan(safety_factor[0], 1.0, color="0.93", zorder=0)
    ax.plot(safety_factor, share, color=BLUE)
    changing = safety_factor[(share > 0.002) & (share < 0.998)]
    low, high = (changing.min(), changing.max()) if changing.size else (0.5, 2.0)
    ax.set_xlim(min(float(low), 0.95), max(float(high), 1.05))
    ax.set_ylim(0.0, 1.0)
    standing = float(np.interp(1.0, safety_factor, share))
    ax.plot([1.0], [standing], "o", color=BLUE, markersize=4.0)
    ax.annotate(
        f"{100.0 * standing:.3g} % stand",
        (1.0, standing),
        (6, 6) if standing < 0.9 else (6, -10),
        textcoords="offset points",
        fontsize=7,
    )
    ax.text(0.02, 0.04, "fall", transform=ax.transAxes, fontsize=7, color=GREY)
    ax.yaxis.set_major_formatter(PercentFormatter(1.0))
    ax.set_xlabel(QUANTITIES["safety_factor"].label)
    ax.set_ylabel("Persons above it")
    return ax


def sobol_bars(
    ax: Axes, factors: Sequence[str], first: Sequence[Interval], total: Sequence[Interval]
) -> Axes:
    """Draw first-order and total Sobol indices with their intervals, one pair of bars a factor."""
    places = np.arange(len(factors))[::-1]
    for offset, indices, face, edge, hatch, label in (
        (0.19, first, BLUE, BLUE, "", "alone (first order)"),
        (-0.19, total, "white", VERMILION, "////", "with all others (total)"),
    ):
        values, low, high = np.array(indices).T
        ax.barh(
            places + offset,
            values,
            height=0.36,
            xerr=[np.maximum(values - low, 0.0), np.maximum(high - values, 0.0)],
            error_kw={"elinewidth": 0.8, "ecolor": "black"},
            color=face,
            edgecolor=edge,
            hatch=hatch,
            label=label,
        )
    ax.set_yticks(places, factors)
    ax.set_xlim(0.0, max(1.0, float(np.max([high for _, _, high in total]))))
    ax.set_xlabel("Share of the variance (Sobol index)")
    if (figure := ax.get_figure(root=True)) is not None:
        figure.legend(frameon=False, loc="outside lower center", ncols=2)
    return ax
