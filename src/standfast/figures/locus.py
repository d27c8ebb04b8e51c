"""The root locus over the delay."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D

from standfast.figures.style import BLUE, GREY, VERMILION, graded

CROSSES: Any = {"marker": "o", "linestyle": "", "markersize": 4.0}
CROSSES |= {"markerfacecolor": "white", "markeredgecolor": VERMILION}
STARTS: Any = {"marker": "s", "linestyle": "", "markersize": 3.0, "color": BLUE}

# Of the frame of a locus: a root that moves farther between two delays is another root.
JUMP = 0.08


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
    for color, (name, root) in zip(graded(len(roots)), roots.items(), strict=True):
        style: Any = {"color": color}
        gaps = np.flatnonzero(jumps(root)) + 1
        broken, at = np.insert(root, gaps, np.nan), np.insert(delay, gaps, np.nan)
        real_part.plot(delay, root.real, label=name, **style)
        imaginary_part.plot(at, broken.imag, **style)
        plane.plot(broken.real, broken.imag, **style)
        tau, real, imaginary = crossings[name].T
        if tau.size:
            for ax, across, up in (
                (real_part, tau, real), (imaginary_part, tau, imaginary), (plane, real, imaginary)
            ):  # fmt: skip
                ax.plot(across, up, zorder=3, clip_on=False, **CROSSES)
        plane.plot(root.real[:1], root.imag[:1], **{**STARTS, "color": color})
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
