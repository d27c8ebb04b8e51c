"""Figures of delayed feedback: regions of standing, contours on maps, root loci over the delay."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib import patheffects
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import MaxNLocator

from standfast.figures.standing import name_curves
from standfast.figures.style import BLUE, GREY, LINE_STYLES, VERMILION

Limits = tuple[float, float]

FEWEST_LEVELS = 6

SHADES = (0.25, 0.11)  # of a region that stands: alone, or one on another

CROSSES: Any = {"marker": "o", "linestyle": "", "markersize": 4.0}
CROSSES |= {"markerfacecolor": "white", "markeredgecolor": VERMILION}
STARTS: Any = {"marker": "s", "linestyle": "", "markersize": 3.0, "color": BLUE}

# Of the frame of a locus: a root that moves farther between two delays is another root.
JUMP = 0.08


def standing_regions(ax: Axes, fields: Sequence[tuple[np.ndarray, np.ndarray, np.ndarray]]) -> None:
    """Shade where a person stands: (x, y, field), field > 0 there; where several do, darker."""
    alpha = SHADES[len(fields) > 1]
    for x, y, field in fields:
        if (field > 0.0).any():
            largest = max(float(np.nanmax(field[np.isfinite(field)], initial=1.0)), 1.0)
            inside = np.nan_to_num(field.T, posinf=largest, neginf=-largest)
            ax.contourf(x, y, inside, levels=[0.0, 2.0 * largest], colors=[BLUE], alpha=alpha)


def standing_patch(several: str) -> Patch:
    """Return what explains the shade of :func:`standing_regions` in a legend.

    ``several`` names what the regions that lie one on another differ in; empty for a single one.
    """
    words = f"stands; darker: with more of the {several}" if several else "stands"
    return Patch(facecolor=BLUE, alpha=SHADES[0], label=words)


def note(ax: Axes, text: str) -> None:
    """Write grey words into the upper right corner."""
    ax.text(
        0.98, 0.97, text, transform=ax.transAxes, ha="right", va="top", fontsize=6.5, color=GREY
    )


def contour_lines(
    ax: Axes, x: np.ndarray, y: np.ndarray, values: np.ndarray, *, marks: Sequence[float]
) -> None:
    """Draw labelled contours of values (len(y), len(x)): thin at round ones, thick at ``marks``."""
    inside = np.where(np.isfinite(values), values, np.nan)
    if not np.isfinite(inside).any():
        return
    # most of the range: a steep end would take all levels
    low, high = np.nanquantile(inside, [0.02, 0.95])
    levels = MaxNLocator(FEWEST_LEVELS, steps=[1, 2, 2.5, 5, 10]).tick_values(low, high)
    apart = 0.2 * float(np.diff(levels).min()) if len(levels) > 1 else 0.0
    thin = [v for v in levels if low < v < high and all(abs(v - m) > apart for m in marks)]
    thick = [v for v in sorted(marks) if np.nanmin(inside) < v < np.nanmax(inside)]
    named = {}
    for chosen, width in ((thick, 1.4), (thin, 0.6)):
        if not chosen:
            continue
        drawn = ax.contour(x, y, inside, levels=chosen, colors="black", linewidths=width)
        drawn.set(path_effects=[patheffects.withStroke(linewidth=width + 0.8, foreground="white")])
        for level, lines in zip(chosen, drawn.allsegs, strict=True):
            pieces = [piece for line in lines for piece in (np.full((1, 2), np.nan), line)]
            points = np.concatenate([np.empty((0, 2)), *pieces]).T
            named[f"{level:.3g}".replace("-", "−")] = (points[0], points[1])
    frame = np.array([[x[0], x[-1]], [y[0], y[-1]]])
    name_curves(ax, named, frame, crowded=False, fontsize=6.5)


def locus_marks() -> list[Line2D]:
    """Return what explains the marks of :func:`root_locus_over_delay` in a legend."""
    start = Line2D([], [], label="without delay", **STARTS)
    return [Line2D([], [], label="stability changes", **CROSSES), start]


def root_locus_over_delay(
    axes: Sequence[Axes],
    delay: np.ndarray,
    roots: Mapping[str, np.ndarray],
    crossings: Mapping[str, np.ndarray],
) -> None:
    """Draw the rightmost root (1/s) over the delay (s): real part, imaginary part, complex plane.

    ``crossings`` are the points (delay, real = 0, imaginary part) at which it crosses the imaginary
    axis, (n, 3), as open circles.
    """
    real_part, imaginary_part, plane = axes
    every = np.concatenate(list(roots.values()))
    height = max(float(every.imag.max()), 1e-9)
    for number, (name, root) in enumerate(roots.items()):
        style: Any = {"linestyle": LINE_STYLES[number % len(LINE_STYLES)], "color": BLUE}
        gaps = np.flatnonzero(jumps(root)) + 1
        broken, at = np.insert(root, gaps, np.nan), np.insert(delay, gaps, np.nan)
        real_part.plot(delay, root.real, label=name, **style)
        imaginary_part.plot(at, broken.imag, **style)
        plane.plot(broken.real, broken.imag, **style)
        tau, real, imaginary = crossings[name].T
        mark: Any = {
            "marker": "o",
            "linestyle": "",
            "markersize": 4.0,
            "zorder": 3,
            "clip_on": False,
        }
        mark |= {"markerfacecolor": "white", "markeredgecolor": VERMILION}
        if tau.size:
            real_part.plot(tau, real, **mark)
            imaginary_part.plot(tau, imaginary, **mark)
            plane.plot(real, imaginary, **mark)
        plane.plot(root.real[:1], root.imag[:1], marker="s", color=BLUE, markersize=3.0)
    low, high = float(every.real.min()), float(every.real.max())
    margin = 0.08 * max(high - low, 1e-9)
    low, high = min(low - margin, -margin), max(high + margin, margin)
    real_part.axhspan(0.0, high, color="0.93", zorder=0)
    plane.axvspan(0.0, high, color="0.93", zorder=0)
    real_part.text(0.03, 0.97, "falls", transform=real_part.transAxes, va="top", color=GREY)
    real_part.set(ylim=(low, high), ylabel="Rightmost root: real part (1/s)")
    imaginary_part.set(ylim=(-0.03 * height, 1.08 * height), ylabel="Imaginary part (rad/s)")
    plane.set(xlim=(low, high), ylim=(-0.03 * height, 1.08 * height))
    plane.set(xlabel="Real part (1/s)", ylabel="Imaginary part (rad/s)")
    for ax in (real_part, imaginary_part):
        ax.set(xlim=(delay[0], delay[-1]), xlabel=r"Feedback delay $\tau$ (s)")


def jumps(root: np.ndarray) -> np.ndarray:
    """Return between which neighbouring delays another root becomes the rightmost one."""
    step = np.abs(np.diff(root.imag)) / max(float(np.nanmax(root.imag)), 1e-9)
    # a pair that leaves the real axis, or meets on it, moves fast but stays the same
    real = (root.imag[1:] == 0.0) | (root.imag[:-1] == 0.0)
    turned: np.ndarray = step > np.where(real, 2.0 * JUMP, JUMP)
    return turned
