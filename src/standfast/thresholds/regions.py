"""Regions of standing with delayed feedback, plane by plane, out of a stored atlas.

With feedback there is no single threshold along an axis: a gain may be too small and too large, and
a delay may be too long while a longer one stands again. So the limit is all lines around all
regions, as the atlas shows them: each line runs between neighbours of different verdict, half way,
or nearer the truth where the atlas holds the decay rate or the critical delay too. Where a root
passes through 0, which has a closed form, they lie on it.

With springs alone all lines are exact (:func:`exact_region`), on a plane of any two axes.
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
from standfast.thresholds import fields, planes
from standfast.thresholds.contours import level_lines
from standfast.thresholds.steps import FINE, continued, divided, spread

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
    the person stands; ``finer`` is the same, (x, y, field), at more points, among them those of
    ``field``.  ``exact`` is the limit in closed form, where it is one curve.
    """

    axes: tuple[str, str]
    x: np.ndarray
    y: np.ndarray
    field: np.ndarray
    values: Mapping[str, Any]
    index: Mapping[str, int]
    finer: tuple[np.ndarray, np.ndarray, np.ndarray]
    exact: tuple[np.ndarray, np.ndarray] | None = None

    @cached_property
    def lines(self) -> list[np.ndarray]:
        """The limit, as arrays (n, 2); a line around a region ends where it begins."""
        return level_lines(*self.finer, 0.0)

    @property
    def curve(self) -> tuple[np.ndarray, np.ndarray]:
        """All lines of the limit as horizontal and vertical coordinates, NaN between them."""
        if self.exact is not None:
            return self.exact
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
    plane_of(atlas.study)
    if DECAY in atlas.quantities:
        return DECAY
    if VERDICT not in atlas.quantities:
        raise InputError(
            f"{atlas.path} holds neither {VERDICT} nor {DECAY}, so it shows no limit of standing "
            "with feedback"
        )
    return CRITICAL if CRITICAL in atlas.quantities else VERDICT


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


def regions(atlas: Atlas) -> Iterator[Region]:
    """Go through the planes of an atlas in the study's order, one in memory at a time."""
    study = atlas.study
    source_of(atlas)
    axes = plane_of(study)
    others = [name for name in study.axes_of(VERDICT) if name not in axes]
    for place in product(*(range(len(study.axes[name])) for name in others)):
        yield region(atlas, axes, dict(zip(others, place, strict=True)))


def has_limits(atlas: Atlas) -> bool:
    """Return whether an atlas shows where a person stands: by a closed form, or what it holds."""
    return not atlas.study.has_gains or bool({VERDICT, DECAY} & set(atlas.quantities))


def region(atlas: Atlas, axes: tuple[str, str], index: Mapping[str, int]) -> Region:
    """Return where a person stands on one plane: exactly, or as an atlas with feedback shows it."""
    study = atlas.study
    if not study.has_gains:
        return exact_region(study, axes, index)
    x, y = (planes.finite(study.axes[name]) for name in axes)
    values = {name: study.axes[name][i] for name, i in index.items()}
    field = _field(atlas, axes, index)
    finer = _finer(study, axes, values, field)
    return Region(axes, x, y, field, values, index, finer)


def at_some_delay(atlas: Atlas, axes: tuple[str, str], index: Mapping[str, int]) -> Region:
    """Return where a person stands at some delay, as the critical delay of an atlas shows it."""
    study = atlas.study
    x, y = (planes.finite(study.axes[name]) for name in axes)
    values = {name: study.axes[name][i] for name, i in index.items()}
    field = np.where(piece_of(atlas, CRITICAL, axes, index) > 0.0, 0.5, -0.5)
    return Region(axes, x, y, field, values, index, _finer(study, axes, values, field))


def exact_region(study: Study, axes: tuple[str, str], index: Mapping[str, int]) -> Region:
    """Return where a person stands by springs alone, on one plane of any two axes."""
    x, y = (spread(study.axes[name], by_factors=planes.is_log(study, name)) for name in axes)
    values = {name: study.axes[name][i] for name, i in index.items()}
    on_plane = {**values, axes[0]: x[:, None], axes[1]: y[None, :]}
    margin = fields.margin_of_springs(study, on_plane)
    field = np.array(np.broadcast_to(margin, (x.size, y.size)))
    exact = None
    if axes == planes.PLANE_AXES:
        exact = planes.plane_at(study, index).limit_of_standing(x, y)
    return Region(axes, x, y, field, values, index, (x, y, field), exact)


def _finer(
    study: Study, axes: tuple[str, str], values: Mapping[str, Any], field: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return a field at more points, with the closed form of where a root passes through 0.

    Beyond that line the field, which jumps there, is taken to go on as it is before it.
    """
    grid = [planes.finite(study.axes[name]) for name in axes]
    parts = [max(1, -(-FINE // (side.size - 1))) for side in grid]
    x, y = (divided(side, n) for side, n in zip(grid, parts, strict=True))
    on_plane = {**values, axes[0]: x[:, None], axes[1]: y[None, :]}
    static = fields.static_determinant(study, on_plane)
    static = np.array(np.broadcast_to(static, (x.size, y.size)))
    if (static > 0.0).all() or not static.any():
        return grid[0], grid[1], field
    static /= np.abs(static).max()
    nodes = static[:: parts[0], :: parts[1]]
    nodes[:] = np.where(field > 0.0, np.maximum(nodes, LEAST_MARGIN), nodes)
    going_on = continued(np.where(nodes > 0.0, field, np.nan))
    for axis, n in enumerate(parts):
        going_on = np.moveaxis(divided(np.moveaxis(going_on, axis, 0), n), 0, axis)
    return x, y, np.minimum(going_on, static)


def _field(atlas: Atlas, axes: tuple[str, str], index: Mapping[str, int]) -> np.ndarray:
    """Return what is positive where the person stands: a margin with the sign of the verdict."""
    if VERDICT not in atlas.quantities:
        return piece_of(atlas, DECAY, axes, index)
    stands = piece_of(atlas, VERDICT, axes, index) == 1
    margin = np.where(stands, 0.5, -0.5)
    if DECAY in atlas.quantities:
        margin = piece_of(atlas, DECAY, axes, index)
    elif CRITICAL in atlas.quantities and planes.DELAY in axes:
        margin = _first_loss(atlas, axes, index, margin)
    elif CRITICAL in atlas.quantities:
        delays = atlas.study.axes.get(planes.DELAY)
        at = atlas.study.fixed.get(planes.DELAY, 0.0)
        delay = float(at if delays is None else delays[index[planes.DELAY]])
        if delay > 0.0:
            # by what part of itself the delay could grow, at most by all: so far it could shrink
            margin = np.minimum(piece_of(atlas, CRITICAL, axes, index) / delay, 2.0) - 1.0
    return np.where(stands, np.fmax(margin, LEAST_MARGIN), np.fmin(margin, -LEAST_MARGIN))


def _first_loss(
    atlas: Atlas, axes: tuple[str, str], index: Mapping[str, int], verdict: np.ndarray
) -> np.ndarray:
    """Return, over delays, how many steps of the axis are left to the critical delay, at most ½.

    Later windows of standing, and their ends, are as the verdicts (±½) say.
    """
    delays, variable = atlas.study.axes[planes.DELAY], atlas[CRITICAL]
    other = axes[1 - axes.index(planes.DELAY)]
    at = {**index, other: slice(0, planes.finite(atlas.study.axes[other]).size)}
    critical = variable[tuple(at[axis] for axis in variable.dims)]
    if axes[0] == planes.DELAY:
        left = (critical[None, :] - delays[:, None]) / np.gradient(delays)[:, None]
    else:
        left = (critical[:, None] - delays[None, :]) / np.gradient(delays)[None, :]
    left = np.clip(left, -0.5, 0.5)
    return np.where((left > 0.0) == (verdict > 0.0), left, verdict)


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
