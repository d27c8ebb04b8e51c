"""Figures of the paper: roots, limits of standing and frequencies of one person."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from standfast.figures.labels import Curve, name_curves
from standfast.figures.style import BLUE, GREY, LINE_STYLES, VERMILION
from standfast.parameters import PARAMETERS

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
    ax: Axes, contours: Mapping[str, Curve], *, xlim: Limits, ylim: Limits
) -> None:
    """Draw curves of neutral stability (horizontal, vertical), one a knee stiffness, with names."""
    for number, (name, (ankle, hip)) in enumerate(contours.items()):
        style = LINE_STYLES[number % len(LINE_STYLES)]
        color = "black" if "rigid" in name else BLUE
        ax.plot(ankle, hip, linestyle=style, color=color)
    ax.set(xlim=xlim, ylim=ylim)
    name_curves(ax, contours.items())


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
