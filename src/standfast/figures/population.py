"""Figures of a population: who falls, what it would take, and what drives it."""

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import QuadMesh
from matplotlib.ticker import PercentFormatter

from standfast.figures.style import BLUE, GREY, LINE_STYLES, VERMILION
from standfast.parameters import PARAMETERS
from standfast.quantities import QUANTITIES

Interval = tuple[float, float, float]  # value, low, high


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
