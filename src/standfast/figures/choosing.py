"""Which values of a study a figure shows, what it leaves out, and how it names them."""

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from standfast.parameters import PARAMETERS
from standfast.study.study import Study

# More small multiples than these are thinned out evenly: a page holds no more that can be read.
MOST_PANELS = 9
MOST_CURVES = 6


def thinned(study: Study, axes: Sequence[str], most: int) -> dict[str, set[int]]:
    """Choose evenly which values of each axis to show, so that ``most`` are shown together."""
    counts = {axis: len(study.axes[axis]) for axis in axes}
    while math.prod(counts.values()) > most:
        longest = max(counts, key=lambda axis: counts[axis])
        counts[longest] -= 1
    return {
        axis: {round(i) for i in np.linspace(0, len(study.axes[axis]) - 1, count)}
        for axis, count in counts.items()
    }


def left_out(study: Study, shown: Mapping[str, set[int]]) -> str:
    """Say which axes are shown at fewer values than the study has."""
    words = [
        f"{axis} at {len(kept)} of {len(study.axes[axis])} values"
        for axis, kept in shown.items()
        if len(kept) < len(study.axes[axis])
    ]
    return f"shows {', '.join(words)}" if words else ""


def titled(study: Study, values: Mapping[str, Any], axes: Sequence[str]) -> str:
    """Name the values of some axes, one a line."""
    return "\n".join(named(study, axis, values[axis]) for axis in axes)


def named(study: Study, axis: str, value: Any) -> str:
    """Name a value, with as few digits as tell it from all others of its axis."""
    if axis == "body_model":
        return str(value)
    row = PARAMETERS[axis]
    name = f"${row.symbol}$" if row.symbol else axis.upper()
    if np.isinf(value):
        return f"{name} rigid"
    values = study.axes.get(axis, np.array([value]))
    enough = (n for n in (4, 6, 8, 12) if len({f"{v:.{n}g}" for v in values}) == len(values))
    return f"{name} = {value:.{next(enough, 17)}g} {row.unit}"
