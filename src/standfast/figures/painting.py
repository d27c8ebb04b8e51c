"""What is painted on a plane: hatching of who falls, contours, regions of strategies, colours."""

from collections.abc import Sequence

import matplotlib as mpl
import numpy as np
from matplotlib import patheffects
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.ticker import MaxNLocator

from standfast.figures import labels
from standfast.figures.style import LIMIT
from standfast.thresholds.regions import Region

FEWEST_LEVELS = 6


def draw_falls(ax: Axes, region: Region, *, cover: bool = False) -> None:
    """Hatch where a person falls, or ``cover`` it, and draw the limit in its own colour."""
    x, y, field = region.finer
    finite = np.nan_to_num(field.T, posinf=1.0, neginf=-1.0)
    lowest = 2.0 * min(float(finite.min()), -1.0)
    with mpl.rc_context({"hatch.color": "white", "hatch.linewidth": 0.4}):
        colors = ["0.75"] if cover else "none"
        if (finite < 0.0).any():
            ax.contourf(x, y, finite, levels=[lowest, 0.0], colors=colors, hatches=["////"])
    across, up = region.curve
    if len(across):
        white = [patheffects.withStroke(linewidth=2.8, foreground="white")]
        ax.plot(
            across, up, color=LIMIT, linewidth=1.6, path_effects=white, label="limit of standing"
        )


def contour_lines(
    ax: Axes,
    x: np.ndarray,
    y: np.ndarray,
    values: np.ndarray,
    ends: tuple[float, float],
    *,
    marks: Sequence[float] = (),
    drawn: Sequence[float] = (),
    avoid: np.ndarray = labels.NOWHERE,
) -> None:
    """Draw labelled contours of values (len(y), len(x)): thin at round ones, thick at ``marks``.

    Thin ones lie between two ``ends``, so that panels may have the same.
    None is drawn near a value of ``drawn``, which the limit of standing is; ``avoid`` are places of
    marks, which no label may cover.
    """
    inside = np.where(np.isfinite(values), values, np.nan)
    if not np.isfinite(inside).any():
        return
    low, high = ends
    levels = MaxNLocator(FEWEST_LEVELS, steps=[1, 2, 2.5, 5, 10]).tick_values(low, high)
    apart = 0.2 * float(np.diff(levels).min()) if len(levels) > 1 else 0.0
    taken = (*marks, *drawn)
    least, most = np.nanmin(inside), np.nanmax(inside)
    low, high = max(low, least), min(high, most)
    thin = [v for v in levels if low < v < high and all(abs(v - m) > apart for m in taken)]
    thick = [v for v in sorted(marks) if least < v < most]
    named = {}
    for chosen, width in ((thick, 1.4), (thin, 0.6)):
        if not chosen:
            continue
        lines = ax.contour(x, y, inside, levels=chosen, colors="black", linewidths=width)
        lines.set(path_effects=[patheffects.withStroke(linewidth=width + 0.8, foreground="white")])
        for level, segments in zip(chosen, lines.allsegs, strict=True):
            pieces = [piece for line in segments for piece in (np.full((1, 2), np.nan), line)]
            points = np.concatenate([labels.NOWHERE, *pieces]).T
            named[f"{level:.4g}".replace("-", "−")] = (points[0], points[1])
    labels.name_curves(ax, named.items(), crowded=False, avoid=avoid)


def strategy_regions(
    ax: Axes,
    x: np.ndarray,
    y: np.ndarray,
    values: np.ndarray,
    region: Region,
    avoid: np.ndarray = labels.NOWHERE,
) -> None:
    """Draw where the person falls, sways from the ankle (ratio below 1) or from the hip."""
    ratio = np.nan_to_num(np.abs(values), posinf=1e9)
    colors, hatches = ["#56B4E9", "#E69F00"], ["//", ""]
    with mpl.rc_context({"hatch.linewidth": 0.4}):
        levels = [-1.0, 1.0, 2e9]
        ax.contourf(x, y, ratio, levels=levels, colors=colors, hatches=hatches)
    across, up, field = region.finer
    finite = np.nan_to_num(field.T, posinf=1.0, neginf=-1.0)
    if (finite < 0.0).any():
        lowest = 2.0 * min(float(finite.min()), -1.0)
        ax.contourf(across, up, finite, levels=[lowest, 0.0], colors=["0.92"])
    ax.plot(*region.curve, color="black", label="limit of standing")
    stands = labels.sampled(ax, across, up, field) > 0.0
    by_hip = labels.sampled(ax, x, y, ratio.T) > 1.0
    words = {"falls": ~stands, "ankle strategy": stands & ~by_hip, "hip strategy": stands & by_hip}
    labels.name_regions(ax, words, avoid, [])


def add_bar(axes: Sequence[Axes], shown: ScalarMappable, label: str, *, whole: bool) -> None:
    """Add the bar of colours of some axes; ``whole``: of whole numbers."""
    bar = axes[0].figure.colorbar(
        shown, ax=list(axes), shrink=0.8, aspect=25, extend="neither" if whole else "both"
    )
    bar.set_label(label)
    if whole:
        low, high = shown.get_clim()
        bar.set_ticks(range(round(low + 0.5), round(high + 0.5)))
