"""Which values of a study a figure shows, and what it leaves out."""

import itertools
import math
from collections.abc import Mapping, Sequence

import numpy as np

from standfast.study.study import Study

# More small multiples than these are thinned out evenly: a page holds no more that can be read.
MOST_PANELS = 9
MOST_CURVES = 6

# Values that run away to infinity are cut at so many times their median: colours, curves and the
# page of explore.
RUNNING_AWAY, CUT_AT = 8.0, 4.0


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


def middles(study: Study, axes: Sequence[str]) -> dict[str, int]:
    """Return the middle of some axes."""
    return {axis: len(study.axes[axis]) // 2 for axis in axes}


def left_out(study: Study, shown: Mapping[str, set[int]]) -> str:
    """Say which axes are shown at fewer values than the study has."""
    words = [
        f"{axis} at {len(kept)} of {len(study.axes[axis])} values"
        for axis, kept in shown.items()
        if len(kept) < len(study.axes[axis])
    ]
    return f"shows {', '.join(words)}" if words else ""


def places_of(shown: Mapping[str, set[int]]) -> list[dict[str, int]]:
    """Return the index of each panel, in the study's order."""
    every = itertools.product(*(sorted(kept) for kept in shown.values()))
    return [dict(zip(shown, place, strict=True)) for place in every]
