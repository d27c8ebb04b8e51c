"""Which figures an atlas gets: chosen from its axes and quantities by rule, one file each.

A quantity with two long axes is drawn on the plane of both, others along its longest axis. The
values of other axes are curves or small multiples, named where they are. Reads planes of the atlas
and takes limits of standing from ``thresholds``; what draws into axes is in :mod:`.standing`.
"""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from itertools import product
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from standfast.atlas.reader import Atlas
from standfast.errors import InputError
from standfast.figures import charts, standing, style
from standfast.figures.along import ROOT, curves_of, has_loci, root_loci
from standfast.figures.choosing import MOST_CURVES, MOST_PANELS, left_out, named, thinned, titled
from standfast.parameters import PARAMETERS
from standfast.quantities import QUANTITIES
from standfast.study.study import Study
from standfast.thresholds import contours, planes, regions
from standfast.thresholds.planes import KNEE
from standfast.thresholds.regions import CRITICAL

# More points a side than a figure has dots are skipped.
MOST_POINTS = 800

# Contours are drawn of what has no jumps but at a limit.
CONTOURED = ("critical_delay", "delay_margin", "decay_rate")
SEVERAL = {planes.DELAY: "delays", KNEE: "knees"}  # what curves on a plane differ in


class Drawing(NamedTuple):
    """One figure: its files, and in words which values of the study it leaves out."""

    paths: list[Path]
    left_out: str


def plot(
    atlas: Atlas, folder: Path, *, quantities: Sequence[str] = (), formats: Sequence[str] = ("png",)
) -> list[Drawing]:
    """Draw an atlas into ``folder``; return the figures.

    On a plane: the limits of standing (one curve a delay or a knee, small multiples over the
    rest), a map of each quantity with the limit of standing, and for ``hip_ankle_ratio`` the
    regions of ankle and hip strategy. Without a plane each quantity along its longest axis; the
    rightmost root as its locus over the delay.
    """
    for name in quantities:
        atlas[name]  # refuses what is not in it, before anything is drawn
    wanted = tuple(quantities) or atlas.quantities
    stem = folder / atlas.path.name.removesuffix(".h5")
    drawn: list[Drawing] = []
    limits = _shows_limits(atlas)
    if limits and (not quantities or "stable" in quantities):
        drawn.append(limits_of_standing(atlas, stem.with_name(f"{stem.name}-limits"), formats))
    loci = not quantities and has_loci(atlas)
    if loci:
        path = stem.with_name(f"{stem.name}-locus")
        drawn.append(Drawing(*root_loci(atlas, path, formats)))
    for name in wanted:
        variable = atlas[name]
        path = stem.with_name(f"{stem.name}-{name}")
        plane = planes.axes_of_plane(atlas.study, variable.dims)
        if (name == "stable" and limits) or (name in ROOT and loci and plane is None):
            continue  # the limits show it, or the loci
        if plane is not None:
            drawn.append(_plane_figure(atlas, name, plane, path, formats))
        elif variable.dims and variable.dims != ("body_model",):
            drawn.append(Drawing(*curves_of(atlas, name, path, formats)))
    if not drawn:
        raise InputError(f"{atlas.path} has no axis to draw {' or '.join(wanted)} along")
    return drawn


def _shows_limits(atlas: Atlas) -> bool:
    """Return whether an atlas has limits of standing on a plane: in closed form, or inside it."""
    study = atlas.study
    if planes.has_closed_form(study):
        return True
    plane = planes.axes_of_plane(study, study.axes_of("stable"))
    return plane is not None and "stable" in atlas.quantities


def limits_of_standing(atlas: Atlas, stem: Path, formats: Sequence[str]) -> Drawing:
    """Draw the limits of standing, one curve a delay or a knee, small multiples over the rest."""
    study = atlas.study
    dims = study.axes_of("stable")
    axes = planes.axes_of_plane(study, dims) or planes.PLANE_AXES
    along = planes.axis_of_curves(dims, axes)
    others = [name for name in dims if name not in (*axes, along)]
    chosen = thinned(study, others, MOST_PANELS)
    shown = {**chosen, **thinned(study, [along] if along else [], MOST_CURVES)}
    closed = planes.has_closed_form(study)
    found: Iterator[Any]
    found = contours.exact_contours(study, shown) if closed else regions.regions(atlas, shown)
    panels: dict[tuple[int, ...], dict[str, Any]] = {}
    titles: dict[tuple[int, ...], str] = {}
    for each in found:
        at = tuple(each.index[name] for name in others)
        titles[at] = titled(study, each.values, others)
        curves = panels.setdefault(at, {})
        full = not curves or bool(others)  # in a single panel the first name stands for all
        curves[_name_of_curve(study, along, each.values, axes, full=full)] = each
    frame = [planes.finite(study.axes[name]) for name in axes]
    limits = {"xlim": (frame[0][0], frame[0][-1]), "ylim": (frame[1][0], frame[1][-1])}
    single = len(panels) == 1
    with _small_multiples(axes, list(titles.values()), chosen, 3.0) as (figure, panes):
        for ax, curves in zip(panes, panels.values(), strict=False):
            lines = {name: each.curve for name, each in curves.items()}
            if not closed:
                charts.standing_regions(
                    ax, [(each.x, each.y, each.field) for each in curves.values()]
                )
                nowhere = [name for name, each in curves.items() if not each.stands.any()]
                if any(nowhere):
                    charts.note(ax, f"stands nowhere: {', '.join(nowhere)}")
            standing.stability_contours(ax, lines, inline=single, **limits)
        handles = [] if single or not along else panes[0].get_legend_handles_labels()[0]
        if not closed:
            handles.append(charts.standing_patch(SEVERAL[along] if along else ""))
        if handles:
            figure.legend(handles=handles, loc="outside upper center", ncols=6, frameon=False)
        return Drawing(style.save(figure, stem, formats), left_out(study, shown))


def _name_of_curve(
    study: Study, along: str | None, values: Mapping[str, Any], axes: tuple[str, str], *, full: bool
) -> str:
    """Name a limit by its delay or knee; without a unit that the axes have, or the symbol."""
    given = {**study.fixed, **values}
    # a knee that does not vary names the curve of springs all the same
    along = along or (KNEE if KNEE in given and not study.has_gains else None)
    if along is None:
        return ""
    words, unit = named(study, along, given[along]), PARAMETERS[along].unit
    if any(PARAMETERS[name].unit == unit for name in axes):
        words = words.removesuffix(f" {unit}")
    return words if full else words.removeprefix(f"${PARAMETERS[along].symbol}$ = ")


def _plane_figure(
    atlas: Atlas, name: str, axes: tuple[str, str], stem: Path, formats: Sequence[str]
) -> Drawing:
    """Draw a quantity on planes of two axes, small multiples over the other axes."""
    study, variable = atlas.study, atlas[name]
    others = [axis for axis in variable.dims if axis not in axes]
    chosen = thinned(study, others, MOST_PANELS)
    x, y = (planes.finite(study.axes[axis]) for axis in axes)
    steps = (max(1, x.size // MOST_POINTS), max(1, y.size // MOST_POINTS))
    x, y = x[:: steps[0]], y[:: steps[1]]
    places = [
        dict(zip(others, place, strict=True))
        for place in product(*(sorted(chosen[axis]) for axis in others))
    ]
    maps = [regions.piece_of(atlas, name, axes, at, steps).T for at in places]
    stands = [_standing_on(atlas, name, axes, at, (x, y), steps) for at in places]
    crossed = stands[0] is not None
    values = [{axis: study.axes[axis][i] for axis, i in at.items()} for at in places]
    titles = [titled(study, each, others) for each in values]
    row, marks = QUANTITIES[name], _marked(study, name)
    # a critical delay of 0 says that the person falls without any
    coloured = [np.where(each > 0.0, each, np.nan) for each in maps] if name == CRITICAL else maps
    limits, shades = _colour_limits(coloured), None
    if row.dtype == "uint8":
        low, high = int(min(each.min() for each in maps)), int(max(each.max() for each in maps))
        limits, shades = (low - 0.5, high + 0.5), high - low + 1
    mesh = None
    with _small_multiples(axes, titles, chosen, 2.9) as (figure, panes):
        # a person who stands at every delay has the colour of the longest
        ends = limits[1] + 1.0 if name in CONTOURED else np.inf
        for ax, inside, stable in zip(panes, coloured, stands, strict=False):
            if name == "hip_ankle_ratio" and stable is not None:
                standing.strategy_regions(ax, x, y, inside, stable)
            else:
                mesh = standing.quantity_map(
                    ax,
                    x,
                    y,
                    np.where(np.isposinf(inside), ends, inside),
                    limits=limits,
                    stable=stable,
                    shades=shades,
                    outlined=0.0 not in marks,  # else by its own contour, which is finer
                )
                if name in CONTOURED:
                    charts.contour_lines(ax, x, y, inside, marks=marks)
        if mesh is not None:
            extend = "neither" if shades else "both"
            bar = figure.colorbar(mesh, ax=panes, shrink=0.8, extend=extend)
            bar.set_label(row.label + (", hatched: falls" if crossed else ""))
            if shades:
                bar.set_ticks(range(low, high + 1))
        return Drawing(style.save(figure, stem, formats), left_out(study, chosen))


def _colour_limits(maps: Sequence[np.ndarray]) -> tuple[float, float]:
    """Return the range of colours: all but the outermost hundredth on each side."""
    values = np.concatenate([each[np.isfinite(each)].ravel() for each in maps])
    if values.size == 0:
        return 0.0, 1.0
    low, high = np.quantile(values, [0.01, 0.99])
    return (float(low), float(high)) if low < high else (float(low) - 0.5, float(high) + 0.5)


def _marked(study: Study, name: str) -> list[float]:
    """Return the values of a quantity that are limits: a critical delay at the study's delays."""
    if name == CRITICAL:
        delays = study.axes.get("feedback_delay", np.array([study.fixed.get("feedback_delay", 0)]))
        return [float(delays[i]) for i in _evenly(len(delays)) if delays[i] > 0.0]
    return [0.0] if name in CONTOURED else []


def _evenly(count: int) -> list[int]:
    return sorted({round(i) for i in np.linspace(0, count - 1, min(count, MOST_CURVES))})


def _standing_on(
    atlas: Atlas,
    name: str,
    axes: tuple[str, str],
    index: Mapping[str, int],
    grid: tuple[np.ndarray, np.ndarray],
    steps: tuple[int, int],
) -> np.ndarray | None:
    """Return the verdicts (y, x) on a plane of a quantity; None if it holds for several of them."""
    study, dims = atlas.study, atlas[name].dims
    x, y = grid
    if axes == planes.PLANE_AXES and planes.has_closed_form(study):
        # a critical knee stiffness holds for all knees, a limit of standing for one
        if KNEE in study.axes and KNEE not in dims:
            return None
        # the axes on which this quantity does not depend are taken at their first value
        first = {axis: 0 for axis in study.axes if axis not in dims and axis not in axes}
        critical = planes.plane_at(study, {**first, **index}).critical_hips(x)
        above: np.ndarray = y[:, None] > critical[None, :]
        return above
    if name == CRITICAL:
        at_some_delay: np.ndarray = regions.piece_of(atlas, name, axes, index, steps).T > 0.0
        return at_some_delay
    if "stable" not in atlas.quantities or set(atlas["stable"].dims) - set(dims):
        return None
    own = {axis: i for axis, i in index.items() if axis in atlas["stable"].dims}
    stands: np.ndarray = regions.piece_of(atlas, "stable", axes, own, steps).T == 1
    return stands


@contextmanager
def _small_multiples(
    plane: tuple[str, str], titles: Sequence[str], chosen: Mapping[str, set[int]], height: float
) -> Iterator[tuple[Figure, list[Axes]]]:
    """Give a panel of a plane for each title, ``height`` inches high if it is a single one.

    The last axis of ``chosen`` runs from left to right if that fits the page.
    """
    last = len(list(chosen.values())[-1]) if chosen else 1
    columns = last if 2 <= last <= 3 else min(3, len(titles))
    rows = -(-len(titles) // columns)
    width = style.COLUMN if len(titles) == 1 else style.PAGE
    height = height if len(titles) == 1 else 0.6 + 2.3 * rows
    panels = (rows, columns)
    labels = [PARAMETERS[name].label for name in plane]
    with style.paper_figure(width, height, panels, shared=True) as (figure, axes):
        for ax, title in zip(axes, titles, strict=False):
            ax.set_title(title)
        for ax in axes[len(titles) :]:
            ax.set_axis_off()
        if len(titles) == 1:
            axes[0].set(xlabel=labels[0], ylabel=labels[1])
        else:
            figure.supxlabel(labels[0], fontsize=style.STYLE["axes.labelsize"])
            figure.supylabel(labels[1], fontsize=style.STYLE["axes.labelsize"])
        yield figure, axes
