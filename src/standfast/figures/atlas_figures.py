"""Which figures an atlas gets: chosen from its axes and quantities, one file each.

Reads planes of the atlas and takes limits of standing from ``thresholds``; what draws into axes is
in :mod:`.standing`.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from standfast.atlas.reader import Atlas
from standfast.errors import InputError
from standfast.figures import standing, style
from standfast.parameters import PARAMETERS
from standfast.quantities import QUANTITIES
from standfast.study.study import Study
from standfast.thresholds.contours import Contour, exact_contours
from standfast.thresholds.planes import ANKLE, HIP, KNEE, PLANE_AXES, has_plane

# More small multiples than these are thinned out evenly: a page holds no more that can be read.
MOST_PANELS = 9
MOST_CURVES = 6
# More points a side than a figure has dots are skipped.
MOST_POINTS = 800

PAGE = 7.0  # width of a page of a journal, inches


@dataclass(frozen=True, slots=True)
class Drawing:
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

    Raises
    ------
    InputError
        if a quantity is not in the atlas, or nothing in it can be drawn.
    """
    for name in quantities:
        atlas[name]
    wanted = tuple(quantities) or atlas.quantities
    stem = folder / atlas.path.name.removesuffix(".h5")
    drawn: list[Drawing] = []
    if has_plane(atlas.study) and (not quantities or "stable" in quantities):
        path = stem.with_name(f"{stem.name}-limits")
        drawn.append(limits_of_standing(atlas.study, path, formats))
    for name in wanted:
        variable = atlas[name]
        path = stem.with_name(f"{stem.name}-{name}")
        if set(PLANE_AXES) <= set(variable.dims) and has_plane(atlas.study):
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
    knees = _thinned(study, [KNEE] if KNEE in study.axes else [], MOST_CURVES)
    panels: dict[tuple[int, ...], tuple[str, dict[str, tuple[np.ndarray, np.ndarray]]]] = {}
    for contour in exact_contours(study, {**chosen, **knees}):
        panel = tuple(contour.plane.index[name] for name in others)
        _, curves = panels.setdefault(panel, (_title(study, contour, others), {}))
        full = not curves or bool(others)  # in a single panel the first name stands for all
        curves[_knee_name(study, contour.plane.knee, full=full)] = (
            contour.ankle,
            contour.hip,
        )
    limits = {name: _limits(study.axes[name]) for name in PLANE_AXES}
    rows, columns = _layout(len(panels), chosen)
    size = {"width": style.COLUMN, "height": 3.0} if len(panels) == 1 else _page(rows)
    with style.paper_figure(panels=(rows, columns), shared=True, **size) as (figure, axes):
        for ax in axes[len(panels) :]:
            ax.set_axis_off()
        for ax, (title, curves) in zip(axes, panels.values(), strict=False):
            standing.stability_contours(
                ax,
                curves,
                ankle_limits=limits[ANKLE],
                hip_limits=limits[HIP],
                inline=len(panels) == 1,
            )
            ax.set_title(title)
            ax.label_outer()
        style.label_together(figure, axes[: len(panels)])
        if len(panels) > 1:
            handles, labels = axes[0].get_legend_handles_labels()
            figure.legend(handles, labels, loc="outside upper center", ncols=6, frameon=False)
        left_out = _left_out(study, {**chosen, **knees})
        return Drawing(style.save(figure, stem, formats), left_out)


def _plane_figure(atlas: Atlas, name: str, stem: Path, formats: Sequence[str]) -> Drawing:
    """Draw a quantity on planes of ankle × hip, small multiples over the other axes."""
    study, variable = atlas.study, atlas[name]
    others = [axis for axis in variable.dims if axis not in PLANE_AXES]
    chosen = _thinned(study, others, MOST_PANELS)
    step = {axis: max(1, len(study.axes[axis]) // MOST_POINTS) for axis in PLANE_AXES}
    ankles, hips = (study.axes[axis][:: step[axis]] for axis in PLANE_AXES)
    shown = np.ix_(np.isfinite(hips), np.isfinite(ankles))
    # a critical knee stiffness holds for all knees, a limit of standing for one
    crossed = KNEE in variable.dims or KNEE not in study.axes
    planes = []
    # the axes on which this quantity does not depend are taken at their first value
    first = {axis: {0} for axis in study.axes if axis not in variable.dims}
    for contour in exact_contours(study, {**first, **chosen}):
        index = contour.plane.index
        piece = variable[
            tuple(
                slice(None, None, step[axis]) if axis in PLANE_AXES else index[axis]
                for axis in variable.dims
            )
        ]
        over_hip = piece.T if variable.dims.index(ANKLE) < variable.dims.index(HIP) else piece
        planes.append((_title(study, contour, others), contour, over_hip[shown]))
    ankles, hips = ankles[np.isfinite(ankles)], hips[np.isfinite(hips)]
    rows, columns = _layout(len(planes), chosen)
    size = {"width": style.COLUMN, "height": 2.9} if len(planes) == 1 else _page(rows)
    limits = _colour_limits([values for _, _, values in planes])
    with style.paper_figure(panels=(rows, columns), shared=True, **size) as (figure, axes):
        mesh = None
        for ax in axes[len(planes) :]:
            ax.set_axis_off()
        for ax, (title, contour, values) in zip(axes, planes, strict=False):
            above = hips[:, None] > contour.plane.critical_hips(ankles)[None, :]
            stable = above if crossed else None
            if name == "hip_ankle_ratio" and stable is not None:
                standing.strategy_regions(ax, ankles, hips, values, stable)
            else:
                mesh = standing.quantity_map(ax, ankles, hips, values, limits=limits, stable=stable)
                ax.set_xlabel(PARAMETERS[ANKLE].label)
                ax.set_ylabel(PARAMETERS[HIP].label)
            ax.set_title(title)
            ax.label_outer()
        style.label_together(figure, axes[: len(planes)])
        if mesh is not None:
            bar = figure.colorbar(mesh, ax=axes, shrink=0.8, extend="both")
            bar.set_label(QUANTITIES[name].label + (", hatched: falls" if crossed else ""))
        return Drawing(style.save(figure, stem, formats), _left_out(study, chosen))


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
    curves: dict[str, np.ndarray] = {}
    for at in sorted(kept[second]) if second else [0]:
        index = tuple(
            slice(None) if axis == along else at if axis == second else middle[axis]
            for axis in variable.dims
        )
        words = _words(study, second, study.axes[second][at]) if second else QUANTITIES[name].label
        curve = variable[index][finite].astype(float)
        curves[words] = np.where(np.isfinite(curve), curve, np.nan)
    with style.paper_figure(height=3.1) as (figure, (ax,)):
        standing.quantity_curves(
            ax, values[finite], curves, label=QUANTITIES[name].label, axis=along
        )
        rest = [axis for axis in others if axis != second]
        ax.set_title(
            ", ".join(_words(study, axis, study.axes[axis][middle[axis]]) for axis in rest)
        )
        if len(curves) > 1:
            handles, labels = ax.get_legend_handles_labels()
            figure.legend(handles, labels, loc="outside lower center", ncols=3, frameon=False)
        shown = {**kept, **{axis: {middle[axis]} for axis in rest}}
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


def _title(study: Study, contour: Contour, axes: Sequence[str]) -> str:
    return "\n".join(_words(study, axis, contour.plane.values[axis]) for axis in axes)


def _words(study: Study, axis: str, value: Any) -> str:
    if axis == "body_model":
        return str(value)
    row = PARAMETERS[axis]
    name = f"${row.symbol}$" if row.symbol else axis.upper()
    if np.isinf(value):
        return f"{name} rigid"
    return f"{name} = {_digits(study, axis, value)} {row.unit}"


def _digits(study: Study, axis: str, value: float) -> str:
    """Write a value with as few digits as tell it from all others of its axis."""
    values = study.axes.get(axis, np.array([value]))
    shown = next(
        (n for n in (4, 6, 8, 12) if len({f"{v:.{n}g}" for v in values}) == len(values)), 17
    )
    return f"{value:.{shown}g}"


def _knee_name(study: Study, knee: float, *, full: bool) -> str:
    if math.isinf(knee):
        return "$K_k$ rigid"
    digits = _digits(study, KNEE, knee)
    return f"$K_k$ = {digits}" if full else digits


def _limits(values: np.ndarray) -> tuple[float, float]:
    finite = values[np.isfinite(values)]
    return float(finite[0]), float(finite[-1])


def _colour_limits(planes: Sequence[np.ndarray]) -> tuple[float, float]:
    """Return the range of colours: all but the outermost hundredth on each side."""
    values = np.concatenate([plane[np.isfinite(plane)].ravel() for plane in planes])
    if values.size == 0:
        return 0.0, 1.0
    low, high = np.quantile(values, [0.01, 0.99])
    return (float(low), float(high)) if low < high else (float(low) - 0.5, float(high) + 0.5)


def _layout(panels: int, chosen: Mapping[str, set[int]]) -> tuple[int, int]:
    """Return rows and columns: the last axis from left to right if that fits the page."""
    last = len(list(chosen.values())[-1]) if chosen else 1
    columns = last if 2 <= last <= 3 else max(1, min(3, panels))
    return max(1, -(-panels // columns)), columns


def _page(rows: int) -> dict[str, float]:
    return {"width": PAGE, "height": 0.6 + 2.3 * rows}
