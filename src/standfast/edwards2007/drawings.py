"""Figures 2, 3, 4 and 5 of the paper: the numbers behind them, handed to ``figures``."""

import math
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from standfast.anthropometry.body import Body
from standfast.edwards2007.published import (
    FIGURE_2_ANKLE,
    FIGURE_2_HIPS,
    FIGURE_2_KNEE,
    FIGURE_3_KNEES,
    FIGURE_3_LIMITS,
    FIGURE_4,
    FIGURE_4_ANKLE_ROTATION,
    FIGURE_5_HEIGHTS,
    GRAVITY,
    RIGID,
    angular_frequency,
    figure_5,
)
from standfast.figures import standing, style
from standfast.mechanics.joints import Stiffness
from standfast.mechanics.motion import segment_angles
from standfast.stability.modes import modes
from standfast.stability.springs import (
    critical_ankle_stiffness,
    critical_hip_stiffness,
    equal_rotation,
)

# Where the drawn upper body ends: top of the head of a person of 1.753 m whose ankle is 0.039 of
# stature above the floor (Winter, figure 4.1).
HEAD_ABOVE_ANKLE = 1.753 * (1.0 - 0.039)


def draw_all(folder: Path) -> list[Path]:
    """Draw every figure into ``folder`` as PNG and SVG; return what was written."""
    body = Body.edwards2007()
    return [
        path
        for draw in (draw_figure_2, draw_figure_3, draw_figure_4, draw_figure_5)
        for path in draw(body, folder)
    ]


def draw_figure_2(body: Body, folder: Path) -> list[Path]:
    """Root locus: the least stable pair of roots as the hip softens."""
    with style.paper_figure() as (figure, (ax,)):
        standing.root_locus(ax, FIGURE_2_HIPS, least_stable_roots(body))
        return style.save(figure, folder / "figure2_root_locus")


def least_stable_roots(body: Body) -> np.ndarray:
    """Return s = ±√(−λ₁) in 1/s, (n, 2) complex, for the hip stiffnesses of figure 2."""
    omegas = [
        angular_frequency(body, Stiffness(FIGURE_2_ANKLE, FIGURE_2_KNEE, hip))
        for hip in FIGURE_2_HIPS
    ]
    return np.array([[1j * w, -1j * w] if w >= 0.0 else [-w + 0j, w + 0j] for w in omegas])


def draw_figure_3(body: Body, folder: Path) -> list[Path]:
    """Stability contours over ankle and hip, asymptotes, line of equal rotation."""
    low, high = FIGURE_3_LIMITS
    contours = {curve_name(knee): neutral_contour(body, knee, high) for knee in FIGURE_3_KNEES}
    with style.paper_figure(height=3.7) as (figure, (ax,)):
        standing.stability_contours(ax, contours, ankle_limits=(low, high), hip_limits=(low, high))
        ax.set_aspect("equal")
        ankle_only = critical_ankle_stiffness(body, RIGID, RIGID, GRAVITY)
        hip_only = critical_hip_stiffness(body, RIGID, RIGID, GRAVITY)
        ax.axvline(ankle_only, color=style.GREY, linewidth=0.6)
        ax.axhline(hip_only, color=style.GREY, linewidth=0.6)
        ax.text(
            ankle_only - 25,
            1980,
            f"ankle only: {ankle_only:.1f}",
            rotation=90,
            ha="right",
            va="top",
            fontsize=7,
            color=style.GREY,
        )
        ax.text(30, hip_only + 20, f"hip only: {hip_only:.1f}", fontsize=7, color=style.GREY)
        ends = np.array([equal_rotation(body, knee, GRAVITY) for knee in (RIGID, 690.0)])
        ax.plot(
            *ends.T,
            color=style.VERMILION,
            linestyle=(0, (3, 2)),
            label="equal rotation of ankle and hip (below: hip turns more)",
        )
        style.remark(ax, 360, 900, "falls", fontsize=8)
        style.remark(ax, 1870, 1400, "stands", fontsize=8)
        ax.plot(high, high, "s", color="black", clip_on=False, markersize=3.5)
        style.remark(ax, 1835, 1925, "$K_k$ = 600")
        figure.legend(loc="outside lower center", frameon=False)
        return style.save(figure, folder / "figure3_stability_contours")


def curve_name(knee: float) -> str:
    """Return the label of a contour: its knee stiffness, or rigid."""
    return "$K_k$ rigid" if math.isinf(knee) else f"{knee:g}"


def neutral_contour(body: Body, knee: float, limit: float) -> tuple[np.ndarray, np.ndarray]:
    """Return ankle and hip stiffness along the neutral contour within 0 to ``limit``.

    Points are taken at even steps of both stiffnesses, so that both steep ends are smooth.
    """
    steps = np.linspace(0.0, limit, 401)
    ankle = np.concatenate([steps, critical_ankle_stiffness(body, knee, steps, GRAVITY)])
    hip = np.concatenate([critical_hip_stiffness(body, steps, knee, GRAVITY), steps])
    inside = np.maximum(ankle, hip) <= limit
    order = np.lexsort((hip[inside], ankle[inside]))
    return ankle[inside][order], hip[inside][order]


def draw_figure_4(body: Body, folder: Path) -> list[Path]:
    """Sway patterns of the first two modes: extreme positions, the ankle turning by 10°."""
    result = modes(body, FIGURE_4, GRAVITY)
    lengths = (*body.segment_length, HEAD_ABOVE_ANKLE - float(np.sum(body.segment_length)))
    with style.paper_figure(height=3.0, panels=(1, 2)) as (figure, axes):
        for mode, (ax, letter) in enumerate(zip(axes, "ab", strict=True)):
            shape = result.shapes[:, mode]
            for sign, linestyle, label in ((1.0, "-", "one extreme"), (-1.0, "--", "the other")):
                turns = sign * FIGURE_4_ANKLE_ROTATION * shape
                points = points_of(lengths, segment_angles(tuple(turns)))
                standing.stick_figure(ax, points, linestyle=linestyle, label=label)
            hertz = angular_frequency(body, FIGURE_4, mode) / math.tau
            ax.set_title(f"({letter}) {hertz:.3g} Hz\nhip/ankle {shape[2]:.2f}".replace("-", "−"))
            ax.plot([-0.06, 0.18], [-0.07, -0.07], color="black", linewidth=2.5)
            ax.set_xlim(-0.62, 0.62)
            ax.set_ylim(-0.1, 1.75)
        axes[1].set_ylabel("")
        handles, labels = axes[0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=2, frameon=False)
        return style.save(figure, folder / "figure4_sway_patterns")


def draw_figure_5(body: Body, folder: Path) -> list[Path]:
    """Frequency of the least stable mode against body mass index for three heights."""
    bmi = np.linspace(18.0, 30.0, 121)
    curves = {
        f"{height:.3f} m": curve
        for height, curve in zip(FIGURE_5_HEIGHTS, figure_5(body, bmi), strict=True)
    }
    with style.paper_figure() as (figure, (ax,)):
        standing.frequency_against_bmi(ax, bmi, curves)
        return style.save(figure, folder / "figure5_frequency_bmi")


def points_of(lengths: Sequence[float], angles: Sequence[float]) -> np.ndarray:
    """Return the ends (4, 2) of three segments stacked at the given angles from the vertical."""
    steps = np.column_stack([np.sin(angles), np.cos(angles)]) * np.asarray(lengths)[:, None]
    return np.vstack([np.zeros(2), np.cumsum(steps, axis=0)])
