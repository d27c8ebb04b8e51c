"""With what the page opens, and what it says of what it leaves out."""

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from standfast.explore.planes import Planes
from standfast.explore.sliders import OWN, SCALED
from standfast.parameters import GAINS, PARAMETERS, STIFFNESSES
from standfast.quantities import QUANTITIES
from standfast.quantities.person_facts import person_of, stands
from standfast.study.study import Study

VERDICT_LIMIT = 0.5  # between falling, 0, and standing, 1
# Values of each axis of a study that are tried: one with feedback takes some milliseconds.
TRIED = 9
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
    standing = planes.plane(name, x, y, at) > limit
    if standing[at[y], at[x]]:
        return found
    rows, columns = (
        np.flatnonzero(np.isin(axes[each], stops[each]) & np.isfinite(axes[each]))
        for each in (y, x)
    )
    if place := _middle_of(standing[np.ix_(rows, columns)]):
        found |= {y: axes[y][rows[place[0]]].item(), x: axes[x][columns[place[1]]].item()}
    return found


def standing_start_of_study(
    study: Study, start: Mapping[str, Any], plane: tuple[str, str], *, by_springs: bool
) -> dict[str, Any]:
    """Return the values that a study opens with, as :func:`standing_start` those of an atlas.

    Some values are tried of each axis of the map that varies in the study; ``by_springs``: who
    stands by springs alone, which is all that the page knows.
    """
    found = dict(start)
    given = {n: v for n, v in start.items() if start.get("body_model") != OWN or n not in SCALED}
    if by_springs:
        given |= dict.fromkeys(GAINS, 0.0)
    x, y = plane
    if stands(person_of(given)):
        return found
    xs, ys = (_tried(study, start, name) for name in plane)
    standing = [[stands(person_of({**given, x: one, y: other})) for one in xs] for other in ys]
    if place := _middle_of(np.array(standing, bool)):
        found |= {y: ys[place[0]], x: xs[place[1]]}
    return found


def _tried(study: Study, start: Mapping[str, Any], name: str) -> list[float]:
    """Return values of an axis, spread evenly; that of the start where the study does not vary."""
    axis = study.axes.get(name, np.array([start[name]]))
    finite = axis[np.isfinite(axis)]
    places = np.unique(np.linspace(0, len(finite) - 1, TRIED).astype(int))
    return [float(value) for value in finite[places]]


def _middle_of(standing: np.ndarray) -> tuple[int, int] | None:
    """Return the place, row and column, that is nearest to the mean of all that stand."""
    places = np.argwhere(standing)
    if not len(places):
        return None
    away = np.sum((places - places.mean(axis=0)) ** 2, axis=1)
    row, column = places[int(np.argmin(away))]
    return int(row), int(column)


def _judging(study: Study) -> tuple[str, float] | None:
    """Return a quantity that tells who stands, and the value above which they do."""
    if "stable" in study.quantities:
        return "stable", VERDICT_LIMIT
    gains = study.has_gains
    limits = ((name, QUANTITIES[name].limit_of_standing(gains)) for name in study.quantities)
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
