"""Regions of standing with delayed feedback, plane by plane, out of a stored atlas.

With feedback there is no single threshold along an axis: a gain may be too small and too large, and
a delay may be too long while a longer one stands again. So the limit is all lines around all
regions, as the atlas shows them: each line runs between neighbours of different verdict, half way,
or nearer the truth where the atlas holds the decay rate or the critical delay too.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from itertools import product
from typing import Any

import numpy as np

from standfast.atlas.reader import Atlas
from standfast.errors import InputError
from standfast.study.study import Study
from standfast.thresholds import planes
from standfast.thresholds.contours import level_lines

VERDICT, DECAY, CRITICAL = "stable", "decay_rate", "critical_delay"

# What a margin is at least where the verdict says that the person stands, and at most less than 0
# where not: at the limit itself rounding could say otherwise, and beyond the critical delay a
# person may stand again (1/s, or 1).
LEAST_MARGIN = 1e-12


@dataclass(frozen=True)
class Region:
    """Where a person stands on one plane.

    ``axes`` are the horizontal and the vertical axis, ``x`` and ``y`` their finite values;
    ``values`` and ``index`` those of the other axes by name. ``field``, (x, y), is positive where
    the person stands.
    """

    axes: tuple[str, str]
    x: np.ndarray
    y: np.ndarray
    field: np.ndarray
    values: Mapping[str, Any]
    index: Mapping[str, int]

    @cached_property
    def lines(self) -> list[np.ndarray]:
        """The limit, as arrays (n, 2); a line around a region ends where it begins."""
        return level_lines(self.x, self.y, self.field, 0.0)

    @property
    def curve(self) -> tuple[np.ndarray, np.ndarray]:
        """All lines of the limit as horizontal and vertical coordinates, NaN between them."""
        gap = np.full((1, 2), np.nan)
        pieces = [piece for line in self.lines for piece in (gap, line)]
        x, y = np.concatenate(pieces[1:]).T if pieces else np.empty((2, 0))
        return x, y

    @property
    def stands(self) -> np.ndarray:
        """The verdicts, (x, y)."""
        above: np.ndarray = self.field > 0.0
        return above


def source_of(atlas: Atlas) -> str:
    """Return the quantity that shows the limit best.

    Raises
    ------
    InputError
        if the atlas holds none that does, or has no plane.
    """
    axes = plane_of(atlas.study)
    if DECAY in atlas.quantities:
        return DECAY
    if VERDICT not in atlas.quantities:
        raise InputError(
            f"{atlas.path} holds neither {VERDICT} nor {DECAY}, so it shows no limit of standing "
            "with feedback"
        )
    return CRITICAL if CRITICAL in atlas.quantities and planes.DELAY not in axes else VERDICT


def plane_of(study: Study) -> tuple[str, str]:
    """Return the two axes on which a study shows regions; refuse one without."""
    axes = planes.axes_of_plane(study, study.axes_of(VERDICT))
    if axes is None:
        raise InputError(
            "with feedback the limits are lines on a plane of two axes, each of at least "
            f"{planes.LEAST_SIDE} finite values, which this study does not have; along the delay "
            "alone, ask for the quantity critical_delay"
        )
    return axes


def regions(atlas: Atlas, only: Mapping[str, set[int]] | None = None) -> Iterator[Region]:
    """Go through the planes of an atlas in the study's order, one in memory at a time.

    ``only`` keeps those whose index along an axis is in a set.
    """
    study = atlas.study
    source_of(atlas)
    axes = plane_of(study)
    others = [name for name in study.axes_of(VERDICT) if name not in axes]
    kept = {name: range(len(study.axes[name])) for name in others} | dict(only or {})
    x, y = (planes.finite(study.axes[name]) for name in axes)
    for place in product(*(sorted(kept[name]) for name in others)):
        index = dict(zip(others, place, strict=True))
        values = {name: study.axes[name][i] for name, i in index.items()}
        yield Region(axes, x, y, _field(atlas, axes, index), values, index)


def _field(atlas: Atlas, axes: tuple[str, str], index: Mapping[str, int]) -> np.ndarray:
    """Return what is positive where the person stands: a margin with the sign of the verdict."""
    if VERDICT not in atlas.quantities:
        return piece_of(atlas, DECAY, axes, index)
    stands = piece_of(atlas, VERDICT, axes, index) == 1
    margin, delay = np.where(stands, 0.5, -0.5), 0.0
    if planes.DELAY not in axes:
        delays = atlas.study.axes.get(planes.DELAY)
        at = atlas.study.fixed.get(planes.DELAY, 0.0)
        delay = float(at if delays is None else delays[index[planes.DELAY]])
    if DECAY in atlas.quantities:
        margin = piece_of(atlas, DECAY, axes, index)
    elif CRITICAL in atlas.quantities and delay > 0.0:
        # by what part of itself the delay could grow, at most by all: so far it could shrink
        margin = np.minimum(piece_of(atlas, CRITICAL, axes, index) / delay, 2.0) - 1.0
    return np.where(stands, np.fmax(margin, LEAST_MARGIN), np.fmin(margin, -LEAST_MARGIN))


def piece_of(
    atlas: Atlas,
    name: str,
    axes: tuple[str, str],
    index: Mapping[str, int],
    steps: tuple[int, int] = (1, 1),
) -> np.ndarray:
    """Read a quantity on a plane at finite values of its axes, every few, as (x, y)."""
    variable, study = atlas[name], atlas.study
    sides = [
        slice(0, planes.finite(study.axes[axis]).size, step)
        for axis, step in zip(axes, steps, strict=True)
    ]
    at: dict[str, Any] = {**index, **dict(zip(axes, sides, strict=True))}
    piece = variable[tuple(at[axis] for axis in variable.dims)]
    return piece if variable.dims.index(axes[0]) < variable.dims.index(axes[1]) else piece.T
