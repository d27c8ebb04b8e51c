"""With what the page opens, and what it says of what it leaves out."""

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from standfast.explore.planes import Planes
from standfast.parameters import GAINS, PARAMETERS, STIFFNESSES
from standfast.quantities import QUANTITIES
from standfast.study.study import Study

VERDICT_LIMIT = 0.5  # between falling, 0, and standing, 1
SPRINGS_ALONE = (
    "Feedback of several joints is not in this page, which shows what the springs alone do; sweep "
    "the study and export the atlas to keep it."
)


def standing_start(
    planes: Planes,
    stops: Mapping[str, np.ndarray],
    start: Mapping[str, Any],
    plane: tuple[str, str],
) -> dict[str, Any]:
    """Return the values that an atlas opens with, moved on its map to a person who stands.

    Who stands at the start stays there. Else it is the standing place nearest to the middle of all
    that stand on the map, well away from the limit; where nobody does, or no quantity of the atlas
    tells, the start stays as it is.

    Parameters
    ----------
    planes
        of the atlas.
    stops
        the values of each axis that the page has, all of the atlas or some.
    start
        a value of each parameter, of axes one of their stops.
    plane
        the axes of the map.
    """
    found = dict(start)
    judged = _judging(planes.atlas.study)
    if judged is None:
        return found
    (x, y), axes = plane, planes.atlas.axes
    at = {name: int(np.flatnonzero(axis == start[name])[0]) for name, axis in axes.items()}
    name, limit = judged
    stands = planes.plane(name, x, y, at) > limit
    if stands[at[y], at[x]]:
        return found
    rows, columns = (
        np.flatnonzero(np.isin(axes[each], stops[each]) & np.isfinite(axes[each]))
        for each in (y, x)
    )
    standing = np.argwhere(stands[np.ix_(rows, columns)])
    if len(standing):
        away = standing - standing.mean(axis=0)
        row, column = standing[int(np.argmin(np.sum(away**2, axis=1)))]
        found |= {y: axes[y][rows[row]].item(), x: axes[x][columns[column]].item()}
    return found


def _judging(study: Study) -> tuple[str, float] | None:
    """Return a quantity that tells who stands, and the value above which they do."""
    if "stable" in study.quantities:
        return "stable", VERDICT_LIMIT
    limits = ((name, QUANTITIES[name].limit) for name in study.quantities)
    return next(((name, limit) for name, limit in limits if limit is not None), None)


def is_of_springs_alone(study: Study) -> bool:
    """Return whether an exported page of a study lacks its feedback: that of several joints."""
    free = [name for name in STIFFNESSES if study.fixed.get(name) != math.inf]
    return study.has_gains and len(free) > 1


def springs_first(quantities: Sequence[str]) -> tuple[str, ...]:
    """Return quantities, those first that springs alone decide."""

    def is_fed_back(name: str) -> bool:
        return any(QUANTITIES[name].depends_on(gain, study_has_gains=True) for gain in GAINS)

    return tuple(sorted(quantities, key=lambda name: (is_fed_back(name), name != "safety_factor")))


def thinned_words(study: Study, places: Mapping[str, np.ndarray], most: str) -> str:
    """Say which axes a page holds at fewer values than the atlas; empty if it holds all."""
    words = [
        f"{PARAMETERS[name].words} at {len(places[name])} of {len(axis)} values"
        for name, axis in study.axes.items()
        if len(places[name]) < len(axis)
    ]
    return f"To fit into {most} this page holds {', '.join(words)}." if words else ""
