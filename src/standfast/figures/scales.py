"""Axes of figures: their ends, and logarithmic ones where a grid rises by factors."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.ticker import FuncFormatter, LogLocator, MaxNLocator, NullFormatter, NullLocator

from standfast.study.study import Study
from standfast.thresholds.planes import is_log

# An axis whose ends are nearer than this factor has ticks at even steps.
DECADE = 10.0


def set_frame(
    ax: Axes, study: Study, axes: tuple[str, str], ends: Sequence[tuple[float, float]]
) -> None:
    """Set the ends of both axes, and their scales as the grid's spacing is."""
    set_scale(ax, "x", study, axes[0], ends[0])
    set_scale(ax, "y", study, axes[1], ends[1])


def set_scale(
    ax: Axes, which: str, study: Study, name: str, ends: tuple[float, float] | None = None
) -> None:
    """Give one axis, "x" or "y", the scale of a study's axis."""
    low, high = ends or tuple(study.axes[name][np.isfinite(study.axes[name])][[0, -1]])
    if is_log(study, name) and low > 0.0:
        ax.set(**{f"{which}scale": "log"})
        _ticks(ax.xaxis if which == "x" else ax.yaxis, high / low)
    ax.set(**{f"{which}lim": (low, high)})


def edges(middles: np.ndarray, *, by_factors: bool = False) -> np.ndarray:
    """Return the edges of cells around the values of an axis."""
    if by_factors:
        inside: np.ndarray = np.exp(edges(np.log(middles)))
        return inside
    between = (middles[1:] + middles[:-1]) / 2.0
    first, last = 2.0 * middles[0] - between[0], 2.0 * middles[-1] - between[-1]
    return np.concatenate([[first], between, [last]])


def _ticks(axis: Axis, factor: float) -> None:
    """Set plain numbers at few places of a decade, or at even steps along a short axis."""
    subs = [1.0, 2.0, 5.0] if factor < 3.0 * DECADE else [1.0, 3.0]
    subs = subs if factor < DECADE**3 else [1.0]
    axis.set_major_locator(LogLocator(subs=subs) if factor >= DECADE else MaxNLocator(5))
    axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axis.set_minor_formatter(NullFormatter())
    if factor < DECADE:
        axis.set_minor_locator(NullLocator())
