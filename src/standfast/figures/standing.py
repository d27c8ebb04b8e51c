"""Figures of one person or one grid: limits of standing, maps, modes."""

from collections.abc import Mapping
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import QuadMesh
from matplotlib.image import AxesImage, PcolorImage

from standfast.figures.style import BLUE, GREY, LINE_STYLES, VERMILION, remark
from standfast.parameters import PARAMETERS

Curves = Mapping[str, tuple[np.ndarray, np.ndarray]]  # by name
Limits = tuple[float, float]


def root_locus(ax: Axes, hip_stiffness: np.ndarray, roots: np.ndarray) -> None:
    """Draw the least stable pair of roots (1/s, complex, shape (n, 2)) for each hip stiffness."""
    swaying = np.abs(roots.real).max(axis=1) == 0.0
    ax.axhline(0.0, color=GREY, linewidth=0.5)
    ax.axvline(0.0, color=GREY, linewidth=0.5)
    sway, fall = roots[swaying], roots[~swaying]
    growing, decaying = fall.real.max(axis=1), fall.real.min(axis=1)
    sways: Any = {"color": BLUE, "markersize": 4.5, "label": "sways (stable)"}
    falls: Any = {"color": VERMILION, "markersize": 6}
    ax.plot(sway.real.ravel(), sway.imag.ravel(), "o", **sways)
    ax.plot(growing, 0.0 * growing, "^", label="growing root (falls)", **falls)
    ax.plot(decaying, 0.0 * decaying, "v", label="its decaying partner", mfc="none", **falls)
    labelled = np.inf
    for k, pair, stable in zip(hip_stiffness, roots, swaying, strict=True):
        at = (0.0, pair.imag.max()) if stable else (pair.real.max(), 0.0)
        if stable and abs(at[1] - labelled) < 0.09:  # rad/s; closer labels would crowd
            continue
        labelled = at[1] if stable else labelled
        offset = (5, -2.5) if stable else (-5, 6)
        ax.annotate(f"{k:g}", at, offset, textcoords="offset points", fontsize=6.5)
    ax.set(xlabel="Real part of the root (1/s)", ylabel="Imaginary part of the root (rad/s)")
    words = "numbers: hip stiffness\n$K_h$ (N·m/rad)"
    ax.text(0.02, 0.98, words, transform=ax.transAxes, va="top", fontsize=7)
    ax.legend(loc="lower left", frameon=False, handletextpad=0.3, borderaxespad=0.0)


def stability_contours(
    ax: Axes, contours: Curves, *, xlim: Limits, ylim: Limits, inline: bool = True
) -> None:
    """Draw curves of neutral stability (horizontal, vertical), one a knee stiffness or a delay.

    NaN separates the lines of one curve. Named where they run, or with ``inline=False`` for a
    legend.
    """
    for number, (name, (ankle, hip)) in enumerate(contours.items()):
        style = LINE_STYLES[number % len(LINE_STYLES)]
        color = "black" if "rigid" in name else BLUE
        ax.plot(ankle, hip, linestyle=style, color=color, label=None if inline else name)
    if inline:
        name_curves(ax, contours, np.array([xlim, ylim]))
    ax.set(xlim=xlim, ylim=ylim)


def name_curves(
    ax: Axes, contours: Curves, frame: np.ndarray, *, crowded: bool = True, fontsize: float = 7
) -> None:
    """Write each curve's name on it, where other curves and names are farthest.

    ``frame`` are the ends of both axes; unless ``crowded``, a name for which there is no room is
    left away.
    """
    low, scale = frame[:, 0], np.ptp(frame, axis=1)
    points = {name: np.column_stack(curve) for name, curve in contours.items() if name}
    curves = {
        name: (each[np.isfinite(each).all(axis=1)] - low) / scale for name, each in points.items()
    }
    names: list[np.ndarray] = []
    for name, curve in curves.items():
        if len(curve) == 0:
            continue
        others = [other for key, other in curves.items() if key != name and len(other)]
        obstacles = np.concatenate([*others, np.empty((0, 2))])
        inner = np.flatnonzero(((curve > 0.1) & (curve < 0.9)).all(axis=1))
        inner = inner if inner.size else np.arange(len(curve))
        steps = inner[:: max(1, inner.size // 80)]
        clear = np.minimum(
            _clearance(curve[steps], obstacles, LABEL_SIZE),
            _clearance(curve[steps], np.array(names).reshape(-1, 2), 2.0 * LABEL_SIZE),
        )
        if clear.max() < 1.0 and not crowded:
            continue
        # farther than two label sizes from its neighbours a name need not be: where all is open,
        # the middle of the curve
        best = np.flatnonzero(clear >= min(clear.max(), 2.0))
        at = steps[best[best.size // 2]]
        names.append(curve[at])
        across, up = low + curve[at] * scale
        remark(ax, across, up, name, fontsize=fontsize)


def _clearance(points: np.ndarray, obstacles: np.ndarray, size: np.ndarray) -> np.ndarray:
    """Return how many label sizes away the nearest obstacle of each point lies."""
    if len(obstacles) == 0:
        return np.full(len(points), np.inf)
    away = np.abs(points[:, None, :] - obstacles[None, :, :]) / size
    nearest: np.ndarray = away.max(axis=2).min(axis=1)
    return nearest


LABEL_SIZE = np.array([0.09, 0.03])  # half of a curve's label, in widths and heights of its frame


def quantity_map(
    ax: Axes,
    x: np.ndarray,
    y: np.ndarray,
    values: np.ndarray,
    *,
    limits: Limits,
    stable: np.ndarray | None = None,
    shades: int | None = None,
    outlined: bool = True,
) -> AxesImage | PcolorImage | QuadMesh:
    """Draw values (len(y), len(x)) as a map; where ``stable`` is False, it is hatched.

    ``outlined``: with a line around it. ``shades`` is the number of colours, for whole numbers;
    None: as many as there are.
    """
    # an image where the axes are even, which is drawn ten times as fast as a mesh
    colours = mpl.colormaps["cividis"].resampled(shades) if shades else "cividis"
    drawn = ax.pcolorfast(_edges(x), _edges(y), values, cmap=colours)
    drawn.set_rasterized(True)
    drawn.set_clim(*limits)
    if stable is not None and stable.any() and not stable.all():
        ax.set_facecolor("0.75")  # under what has no value
        with mpl.rc_context({"hatch.color": "white", "hatch.linewidth": 0.4}):
            ax.contourf(x, y, ~stable, levels=[0.5, 1.5], colors="none", hatches=["////"])
        if outlined:
            ax.contour(x, y, stable, levels=[0.5], colors="black", linewidths=1.2)
    return drawn


def _edges(middles: np.ndarray) -> np.ndarray:
    """Return the edges of cells around the values of an axis."""
    between = (middles[1:] + middles[:-1]) / 2.0
    first, last = 2.0 * middles[0] - between[0], 2.0 * middles[-1] - between[-1]
    return np.concatenate([[first], between, [last]])


def strategy_regions(
    ax: Axes, ankle: np.ndarray, hip: np.ndarray, ratio: np.ndarray, stable: np.ndarray
) -> None:
    """Draw where the person falls, sways from the ankle (ratio below 1) or from the hip.

    ``ratio`` and ``stable`` are (len(hip), len(ankle)).
    """
    regions = np.where(stable, np.where(np.abs(ratio) > 1.0, 2.0, 1.0), 0.0)
    colors, hatches = ["0.92", "#56B4E9", "#E69F00"], ["", "//", ""]
    levels = [-0.5, 0.5, 1.5, 2.5]
    ax.contourf(ankle, hip, regions, levels=levels, colors=colors, hatches=hatches)
    for region, words in enumerate(("falls", "ankle strategy", "hip strategy")):
        rows, columns = np.nonzero(regions == region)
        if rows.size and np.ptp(columns) > 0.45 * ankle.size and np.ptp(rows) > 0.08 * hip.size:
            middle = np.argsort(columns)[columns.size // 2]
            inside = np.flatnonzero(columns == columns[middle])
            remark(ax, ankle[columns[middle]], hip[rows[inside[inside.size // 2]]], words)


def quantity_curves(
    ax: Axes, x: np.ndarray, curves: Mapping[str, np.ndarray], *, label: str, axis: str
) -> None:
    """Draw a quantity along one axis, one labelled curve each."""
    for number, (name, values) in enumerate(curves.items()):
        style = LINE_STYLES[number % len(LINE_STYLES)]
        ax.plot(x, values, linestyle=style, color=BLUE, label=name)
    # a curve that runs away towards an asymptote would flatten all the rest
    finite = np.concatenate([values[np.isfinite(values)] for values in curves.values()])
    if finite.size and finite.min() > 0.0 and finite.max() > 8.0 * np.median(finite):
        ax.set_ylim(0.0, 4.0 * np.median(finite))
    if finite.size and finite.min() < 0.0 < finite.max():
        ax.axhline(0.0, color=GREY, linewidth=0.5)
    ax.set(xlabel=PARAMETERS[axis].label, ylabel=label)


def frequency_against_bmi(ax: Axes, bmi: np.ndarray, curves: Mapping[str, np.ndarray]) -> None:
    """Draw the signed angular frequency of the least stable mode (rad/s), one curve a height."""
    ax.axhline(0.0, color=GREY, linewidth=0.8)
    low = min(curve.min() for curve in curves.values())
    ax.axhspan(1.15 * low, 0.0, color="0.93", zorder=0)
    for style, (name, curve) in zip(LINE_STYLES, curves.items(), strict=False):
        ax.plot(bmi, curve, linestyle=style, color=BLUE, label=name)
    ax.set(xlim=(bmi[0], bmi[-1]), ylim=(1.15 * low, None))
    ax.text(bmi[0] + 0.3, 0.9 * low, "falls: minus the growth rate (1/s)", fontsize=7, color=GREY)
    ax.set_xlabel(PARAMETERS["bmi"].label.replace("BMI", "Body mass index"))
    ax.set_ylabel(r"Least stable mode, $\omega$ (rad/s)")
    ax.legend(title="Height", frameon=False, loc="upper right", alignment="left")
