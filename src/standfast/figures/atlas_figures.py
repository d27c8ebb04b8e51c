"""Which figures an atlas gets: chosen from its axes and quantities, one file each.

Reads planes of the atlas and takes limits of standing from ``thresholds``; what draws into axes is
in :mod:`.standing`.
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from standfast.atlas.reader import Atlas
from standfast.errors import InputError
from standfast.figures import standing, style
from standfast.parameters import PARAMETERS, STIFFNESS_UNIT
from standfast.quantities import QUANTITIES
from standfast.study.study import Study
from standfast.thresholds import planes
from standfast.thresholds.contours import exact_contours
from standfast.thresholds.planes import ANKLE, HIP, KNEE, PLANE_AXES, Plane

# More small multiples than these are thinned out evenly: a page holds no more that can be read.
MOST_PANELS = 9
MOST_CURVES = 6
# More points a side than a figure has dots are skipped.
MOST_POINTS = 800


class Drawing(NamedTuple):
    """One figure: its files, and in words which values of the study it leaves out."""

    paths: list[Path]
    left_out: str


def plot(
    atlas: Atlas, folder: Path, *, quantities: Sequence[str] = (), formats: Sequence[str] = ("png",)
) -> list[Drawing]:
    """Draw an atlas into ``folder``; return the figures.

    With ankle and hip as axes: the limits of standing (one curve a knee, small multiples over body
    size), a map of each quantity on that plane with the limit of standing, and for
    ``hip_ankle_ratio`` the regions of ankle and hip strategy. Otherwise each quantity along its
    first axes.
    """
    for name in quantities:
        atlas[name]  # refuses what is not in it, before anything is drawn
    wanted = tuple(quantities) or atlas.quantities
    stem = folder / atlas.path.name.removesuffix(".h5")
    drawn: list[Drawing] = []
    if planes.has_plane(atlas.study) and (not quantities or "stable" in quantities):
        path = stem.with_name(f"{stem.name}-limits")
        drawn.append(limits_of_standing(atlas.study, path, formats))
    for name in wanted:
        variable = atlas[name]
        path = stem.with_name(f"{stem.name}-{name}")
        if set(PLANE_AXES) <= set(variable.dims) and planes.has_plane(atlas.study):
            if name != "stable":  # the limits show it
                drawn.append(_plane_figure(atlas, name, path, formats))
        elif variable.dims and variable.dims != ("body_model",):
            drawn.append(_curve_figure(atlas, name, path, formats))
    if not drawn:
        raise InputError(f"{atlas.path} has no axis to draw {' or '.join(wanted)} along")
    return drawn


def limits_of_standing(study: Study, stem: Path, formats: Sequence[str]) -> Drawing:
    """Draw the limits of standing in closed form: ankle × hip, one curve a knee stiffness."""
    others = [name for name in study.axes if name not in (*PLANE_AXES, KNEE)]
    chosen = _thinned(study, others, MOST_PANELS)
    shown = {**chosen, **_thinned(study, [KNEE] if KNEE in study.axes else [], MOST_CURVES)}
    titles: dict[tuple[int, ...], str] = {}
    panels: dict[tuple[int, ...], dict[str, tuple[np.ndarray, np.ndarray]]] = {}
    for contour in exact_contours(study, shown):
        plane = contour.plane
        place = tuple(plane.index[name] for name in others)
        titles[place] = _title(study, plane, others)
        curves = panels.setdefault(place, {})
        name = _words(study, KNEE, plane.knee).removesuffix(f" {STIFFNESS_UNIT}")
        full = not curves or others  # in a single panel the first name stands for all
        curves[name if full else name.removeprefix("$K_k$ = ")] = (contour.ankle, contour.hip)
    ankles, hips = (planes.finite(study.axes[name]) for name in PLANE_AXES)
    limits = {"ankle_limits": (ankles[0], ankles[-1]), "hip_limits": (hips[0], hips[-1])}
    single = len(panels) == 1
    with _small_multiples(list(titles.values()), chosen, 3.0) as (figure, axes):
        for ax, curves in zip(axes, panels.values(), strict=False):
            standing.stability_contours(ax, curves, inline=single, **limits)
        if not single:
            handles, labels = axes[0].get_legend_handles_labels()
            figure.legend(handles, labels, loc="outside upper center", ncols=6, frameon=False)
        return Drawing(style.save(figure, stem, formats), _left_out(study, shown))


def _plane_figure(atlas: Atlas, name: str, stem: Path, formats: Sequence[str]) -> Drawing:
    """Draw a quantity on planes of ankle × hip, small multiples over the other axes."""
    study, variable = atlas.study, atlas[name]
    others = [axis for axis in variable.dims if axis not in PLANE_AXES]
    chosen = _thinned(study, others, MOST_PANELS)
    steps = {axis: max(1, len(study.axes[axis]) // MOST_POINTS) for axis in PLANE_AXES}
    ankles, hips = (study.axes[axis][::step] for axis, step in steps.items())
    shown = np.ix_(np.isfinite(hips), np.isfinite(ankles))
    ankles, hips = planes.finite(ankles), planes.finite(hips)
    # a critical knee stiffness holds for all knees, a limit of standing for one
    crossed = KNEE in variable.dims or KNEE not in study.axes
    # the axes on which this quantity does not depend are taken at their first value
    first = {axis: {0} for axis in study.axes if axis not in variable.dims}
    drawn = list(planes.planes_of(study, {**first, **chosen}))
    maps = []
    for plane in drawn:
        index = {**plane.index, **{axis: slice(None, None, steps[axis]) for axis in PLANE_AXES}}
        piece = variable[tuple(index[axis] for axis in variable.dims)]
        over_hip = piece.T if variable.dims.index(ANKLE) < variable.dims.index(HIP) else piece
        maps.append(over_hip[shown])
    limits = _colour_limits(maps)
    mesh = None
    titles = [_title(study, plane, others) for plane in drawn]
    with _small_multiples(titles, chosen, 2.9) as (figure, axes):
        for ax, plane, values in zip(axes, drawn, maps, strict=False):
            above = hips[:, None] > plane.critical_hips(ankles)[None, :]
            if name == "hip_ankle_ratio" and crossed:
                standing.strategy_regions(ax, ankles, hips, values, above)
            else:
                stable = above if crossed else None
                mesh = standing.quantity_map(ax, ankles, hips, values, limits=limits, stable=stable)
        if mesh is not None:
            bar = figure.colorbar(mesh, ax=axes, shrink=0.8, extend="both")
            bar.set_label(QUANTITIES[name].label + (", hatched: falls" if crossed else ""))
        return Drawing(style.save(figure, stem, formats), _left_out(study, chosen))


@contextmanager
def _small_multiples(
    titles: Sequence[str], chosen: Mapping[str, set[int]], height: float
) -> Iterator[tuple[Figure, list[Axes]]]:
    """Give a panel of ankle × hip for each title, ``height`` inches high if it is a single one.

    The last axis of ``chosen`` runs from left to right if that fits the page.
    """
    last = len(list(chosen.values())[-1]) if chosen else 1
    columns = last if 2 <= last <= 3 else min(3, len(titles))
    rows = -(-len(titles) // columns)
    width = style.COLUMN if len(titles) == 1 else style.PAGE
    height = height if len(titles) == 1 else 0.6 + 2.3 * rows
    panels = (rows, columns)
    with style.paper_figure(width, height, panels, shared=True) as (figure, axes):
        for ax, title in zip(axes, titles, strict=False):
            ax.set_title(title)
        for ax in axes[len(titles) :]:
            ax.set_axis_off()
        if len(titles) == 1:
            axes[0].set(xlabel=PARAMETERS[ANKLE].label, ylabel=PARAMETERS[HIP].label)
        else:
            figure.supxlabel(PARAMETERS[ANKLE].label, fontsize=style.STYLE["axes.labelsize"])
            figure.supylabel(PARAMETERS[HIP].label, fontsize=style.STYLE["axes.labelsize"])
        yield figure, axes


def _curve_figure(atlas: Atlas, name: str, stem: Path, formats: Sequence[str]) -> Drawing:
    """Draw a quantity along its longest numeric axis, a few curves over the second."""
    study, variable = atlas.study, atlas[name]
    numeric = [axis for axis in variable.dims if axis != "body_model"]
    along = max(numeric, key=lambda axis: len(study.axes[axis]))
    others = [axis for axis in variable.dims if axis != along]
    second = max(others, key=lambda axis: len(study.axes[axis]), default=None)
    kept = _thinned(study, [second] if second else [], MOST_CURVES)
    middle = {axis: len(study.axes[axis]) // 2 for axis in others}
    values = study.axes[along]
    finite = np.isfinite(values)
    label = QUANTITIES[name].label
    curves: dict[str, np.ndarray] = {}
    for at in sorted(kept[second]) if second else [0]:
        index: dict[str, Any] = {**middle, along: slice(None)}
        if second:
            index[second] = at
        words = _words(study, second, study.axes[second][at]) if second else label
        curve = variable[tuple(index[axis] for axis in variable.dims)][finite].astype(float)
        curves[words] = np.where(np.isfinite(curve), curve, np.nan)
    rest = {axis: middle[axis] for axis in others if axis != second}
    title = ", ".join(_words(study, axis, study.axes[axis][at]) for axis, at in rest.items())
    with style.paper_figure(height=3.1) as (figure, (ax,)):
        standing.quantity_curves(ax, values[finite], curves, label=label, axis=along)
        ax.set_title(title)
        if len(curves) > 1:
            handles, labels = ax.get_legend_handles_labels()
            figure.legend(handles, labels, loc="outside lower center", ncols=3, frameon=False)
        shown = {**kept, **{axis: {at} for axis, at in rest.items()}}
        return Drawing(style.save(figure, stem, formats), _left_out(study, shown))


def _thinned(study: Study, axes: Sequence[str], most: int) -> dict[str, set[int]]:
    """Choose evenly which values of each axis to show, so that ``most`` are shown together."""
    counts = {axis: len(study.axes[axis]) for axis in axes}
    while math.prod(counts.values()) > most:
        longest = max(counts, key=lambda axis: counts[axis])
        counts[longest] -= 1
    return {
        axis: {round(i) for i in np.linspace(0, len(study.axes[axis]) - 1, count)}
        for axis, count in counts.items()
    }


def _left_out(study: Study, shown: Mapping[str, set[int]]) -> str:
    """Say which axes are shown at fewer values than the study has."""
    words = [
        f"{axis} at {len(kept)} of {len(study.axes[axis])} values"
        for axis, kept in shown.items()
        if len(kept) < len(study.axes[axis])
    ]
    return f"shows {', '.join(words)}" if words else ""


def _title(study: Study, plane: Plane, axes: Sequence[str]) -> str:
    return "\n".join(_words(study, axis, plane.values[axis]) for axis in axes)


def _words(study: Study, axis: str, value: Any) -> str:
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


def _colour_limits(planes: Sequence[np.ndarray]) -> tuple[float, float]:
    """Return the range of colours: all but the outermost hundredth on each side."""
    values = np.concatenate([plane[np.isfinite(plane)].ravel() for plane in planes])
    if values.size == 0:
        return 0.0, 1.0
    low, high = np.quantile(values, [0.01, 0.99])
    return (float(low), float(high)) if low < high else (float(low) - 0.5, float(high) + 0.5)
