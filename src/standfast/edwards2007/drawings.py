"""Figures 2, 3, 4 and 5 of the paper: the numbers behind them, handed to ``figures``."""

import math
from pathlib import Path

import numpy as np

from standfast.anthropometry.body import Body
from standfast.anthropometry.tables import ANKLE_HEIGHT
from standfast.edwards2007 import published as paper
from standfast.figures import person, standing, style
from standfast.mechanics.joints import Stiffness
from standfast.parameters import PARAMETERS
from standfast.stability.modes import modes
from standfast.stability.springs import equal_rotation
from standfast.thresholds.planes import ANKLE, HIP, Plane

# Where the drawn upper body ends: top of the head of a person of 1.753 m.
HEAD_ABOVE_ANKLE = 1.753 * (1.0 - ANKLE_HEIGHT)


def draw_all(folder: Path) -> list[Path]:
    """Draw every figure into ``folder`` as PNG and SVG; return what was written."""
    body = Body.edwards2007()
    drawings = (draw_figure_2, draw_figure_3, draw_figure_4, draw_figure_5)
    return [path for draw in drawings for path in draw(body, folder)]


def draw_figure_2(body: Body, folder: Path) -> list[Path]:
    """Root locus: the least stable pair of roots, s = ±√(−λ₁) in 1/s, as the hip softens."""
    ankle, knee, hips = paper.FIGURE_2_ANKLE, paper.FIGURE_2_KNEE, paper.FIGURE_2_HIPS
    omegas = [paper.angular_frequency(body, Stiffness(ankle, knee, hip)) for hip in hips]
    roots = np.array([[1j * w, -1j * w] if w >= 0.0 else [-w + 0j, w + 0j] for w in omegas])
    with style.paper_figure() as (figure, (ax,)):
        standing.root_locus(ax, hips, roots)
        return style.save(figure, folder / "figure2_root_locus")


def draw_figure_3(body: Body, folder: Path) -> list[Path]:
    """Stability contours over ankle and hip, asymptotes, line of equal rotation."""
    low, high = limits = paper.FIGURE_3_LIMITS
    steps = np.linspace(low, high, 401)
    contours = {}
    for knee in paper.FIGURE_3_KNEES:
        plane = Plane(body, paper.GRAVITY, knee)
        name = "$K_k$ rigid" if math.isinf(knee) else f"{knee:g}"
        contours[name] = plane.limit_of_standing(steps, steps)
    with style.paper_figure(height=3.7) as (figure, (ax,)):
        standing.stability_contours(ax, contours, xlim=limits, ylim=limits)
        ax.set(xlabel=PARAMETERS[ANKLE].label, ylabel=PARAMETERS[HIP].label, aspect="equal")
        ankle, hip = paper.ankle_alone(body), paper.hip_alone(body)
        ax.axvline(ankle, color=style.GREY, linewidth=0.6)
        ax.axhline(hip, color=style.GREY, linewidth=0.6)
        upright = ax.text(ankle - 25, 1980, f"ankle only: {ankle:.1f}", rotation=90, ha="right")
        upright.set(va="top", fontsize=7, color=style.GREY)
        ax.text(30, hip + 20, f"hip only: {hip:.1f}", fontsize=7, color=style.GREY)
        ends = np.array([equal_rotation(body, knee, paper.GRAVITY) for knee in (paper.RIGID, 690)])
        label = "equal rotation of ankle and hip (below: hip turns more)"
        ax.plot(*ends.T, color=style.VERMILION, linestyle=(0, (3, 2)), label=label)
        style.remark(ax, 360, 900, "falls", fontsize=8)
        style.remark(ax, 1870, 1400, "stands", fontsize=8)
        ax.plot(high, high, "s", color="black", clip_on=False, markersize=3.5)
        style.remark(ax, 1835, 1925, "$K_k$ = 600")
        figure.legend(loc="outside lower center", frameon=False)
        return style.save(figure, folder / "figure3_stability_contours")


def draw_figure_4(body: Body, folder: Path) -> list[Path]:
    """Sway patterns of the first two modes: extreme positions, the ankle turning by 10°."""
    result = modes(body, paper.FIGURE_4, paper.GRAVITY)
    lengths = (*body.segment_length, HEAD_ABOVE_ANKLE - float(np.sum(body.segment_length)))
    with style.paper_figure(height=3.0, panels=(1, 2)) as (figure, axes):
        for mode, (ax, letter) in enumerate(zip(axes, "ab", strict=True)):
            shape = result.shapes[:, mode]
            person.sway_pattern(ax, lengths, tuple(math.radians(10.0) * shape))
            hertz = paper.frequency_in_hertz(body, mode)
            ax.set_title(f"({letter}) {hertz:.3g} Hz\nhip/ankle {shape[2]:.2f}".replace("-", "−"))
            ax.set(xlim=(-0.62, 0.62), ylim=(-0.1, 1.75))
        axes[0].set_ylabel("Height above the ankle (m)")
        handles, labels = axes[0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=2, frameon=False)
        return style.save(figure, folder / "figure4_sway_patterns")


def draw_figure_5(body: Body, folder: Path) -> list[Path]:
    """Frequency of the least stable mode against body mass index for three heights."""
    bmi = np.linspace(18.0, 30.0, 121)
    names = [f"{height:.3f} m" for height in paper.FIGURE_5_HEIGHTS]
    curves = dict(zip(names, paper.figure_5(body, bmi), strict=True))
    with style.paper_figure() as (figure, (ax,)):
        standing.frequency_against_bmi(ax, bmi, curves)
        return style.save(figure, folder / "figure5_frequency_bmi")
