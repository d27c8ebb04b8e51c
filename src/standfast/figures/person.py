"""Figures of one person: how they sway or fall, and each joint's stiffness beside its threshold."""

import math
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes

from standfast.anthropometry.body import Body
from standfast.anthropometry.tables import ANKLE_HEIGHT
from standfast.figures.spectra import sway_spectrum
from standfast.figures.style import BLUE, PAGE, VERMILION, paper_figure, save
from standfast.mechanics.motion import segment_angles
from standfast.numerics.arrays import Vector
from standfast.parameters import JOINTS, STIFFNESS_UNIT
from standfast.stability.sway.person import Spectrum

TURN = math.radians(10.0)  # of the ankle, or of the joint that turns most
# Rows of joints from below: the bar of what is there, and beside it the mark of what is needed.
BAR, MARK = 0.44, 0.3


SWAYING, FALLING = ("one extreme", "the other"), ("falling one way", "the other way")


def sway_pattern(
    ax: Axes, lengths: Sequence[float], rotation: Vector, labels: tuple[str, str] = SWAYING
) -> None:
    """Draw a mode both ways, named by ``labels``: shank, thigh, upper body of some lengths (m).

    ``rotation`` are the turns of ankle, knee and hip one way (rad).
    """
    for sign, linestyle, label in ((1.0, "-", labels[0]), (-1.0, "--", labels[1])):
        angles = segment_angles(tuple(sign * turn for turn in rotation))
        steps = np.column_stack([np.sin(angles), np.cos(angles)]) * np.vstack(lengths)
        points = np.vstack([np.zeros(2), np.cumsum(steps, axis=0)])
        ax.plot(*points.T, color="black", linestyle=linestyle, linewidth=1.6, label=label)
        ax.plot(*points[:3].T, "o", color="black", markersize=3.5, markerfacecolor="white")
    ax.plot([-0.06, 0.18], [-0.07, -0.07], color="black", linewidth=2.5)
    ax.set(aspect="equal", xlabel="Forward (m)")


def stiffness_bars(
    ax: Axes, stiffness: Mapping[str, float], thresholds: Mapping[str, float]
) -> None:
    """Draw each joint's stiffness as a bar, and its threshold, the others as given, as a line."""
    finite = [k for k in (*stiffness.values(), *thresholds.values()) if math.isfinite(k)]
    # a threshold far away would flatten all bars
    ordinary = [k for k in stiffness.values() if math.isfinite(k)] or finite
    edge = min(1.25 * max([*finite, 1.0]), 3.0 * max([*ordinary, 1.0]))
    for row, joint in enumerate(JOINTS):
        own, needed = stiffness[joint], thresholds[joint]
        holds = own > needed
        length = min(own, edge)
        color, hatch = (BLUE, "") if holds else (VERMILION, "////")
        ax.barh(row, length, BAR, color=color, alpha=0.75, hatch=hatch, edgecolor="white")
        words = "rigid" if math.isinf(own) else f"{own:.4g}"
        if math.isfinite(needed):
            if needed < edge:
                ax.plot([needed, needed], [row - MARK, row + MARK], color="black", linewidth=2.0)
            else:
                ax.plot(edge, row, ">", color="black", markersize=6.0, clip_on=False)
            words += f", needs {needed:.4g}"
        else:
            words += ", no stiffness suffices"
        ax.text(0.0, row + 0.31, words, va="bottom", fontsize=7)
    ax.set(xlim=(0.0, edge), ylim=(-0.5, 2.7), yticks=range(3), yticklabels=JOINTS)
    ax.tick_params(axis="y", length=0)
    ax.set_xlabel(f"Stiffness ({STIFFNESS_UNIT}); line: threshold")


def draw_person(
    path: Path,
    body: Body,
    height: float | None,
    *,
    rotation: Vector,
    falls: bool,
    title: str,
    words: tuple[str, str],
    stiffness: Mapping[str, float],
    thresholds: Mapping[str, float],
    spectrum: Spectrum | None = None,
) -> list[Path]:
    """Draw one person into a file; ``words`` are titles of the mode and of the joints.

    Below them the ``spectrum`` of its sway is drawn, if any is given.

    ``title`` stands above both, if any is given. The mode is drawn as one that ``falls``, or sways.

    Without a ``height`` (m) the upper body is drawn to twice the height of its centre of mass.
    """
    legs = [float(length) for length in body.segment_length]
    upper = 2.0 * float(body.segment_com[2])
    if height is not None:
        upper = height * (1.0 - ANKLE_HEIGHT) - sum(legs)
    lengths = (*legs, upper)
    largest = max(abs(turn) for turn in rotation)
    turn = tuple(TURN * each / max(largest, 1.0) for each in rotation)
    rows = 1 if spectrum is None else 2
    with paper_figure(width=PAGE * 0.75, height=2.9 * rows, panels=(rows, 2)) as (figure, axes):
        left, right, *below = axes
        if title:
            figure.suptitle(title, fontsize=8)
        sway_pattern(left, lengths, turn, FALLING if falls else SWAYING)
        top = 1.05 * sum(lengths)
        left.set(xlim=(-0.4 * top, 0.4 * top), ylim=(-0.1, top), title=words[0])
        left.set_ylabel("Height above the ankle (m)")
        left.set(xlabel="Forward (m), amplitude arbitrary", xticks=[-0.5, 0.0, 0.5])
        stiffness_bars(right, stiffness, thresholds)
        right.set_title(words[1])
        if spectrum is not None:
            sway_spectrum(spectrum, axes=below)
            below[0].set_title("rotations under noise")
            below[1].set_title("centres of mass and pressure")
        left.legend(loc="upper center", bbox_to_anchor=(0.5, -0.2), ncols=2, frameon=False)
        return save(figure, path.with_suffix(""), (path.suffix[1:],))
