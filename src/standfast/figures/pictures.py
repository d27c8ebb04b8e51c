"""The kinds of figures of an atlas: panels side by side, what they hold fixed, subjects, a file.

What draws a panel is what Python offers as ``standfast.plot``.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from standfast.atlas.reader import Atlas
from standfast.figures import along, limits, locus, maps, marking, style
from standfast.figures.choosing import MOST_PANELS, left_out, places_of, thinned
from standfast.figures.marking import Subject
from standfast.figures.naming import given_words, in_lines, titled
from standfast.figures.slicing import Slice, in_a_file_name
from standfast.parameters import PARAMETERS
from standfast.quantities import QUANTITIES
from standfast.thresholds.planes import finite

Tick = Callable[[], None]  # called when a panel is drawn
Shown = Mapping[str, set[int]]


@dataclass(frozen=True, slots=True)
class Request:
    """What all figures of a call share: atlases, slice, subjects, where to, formats."""

    atlases: Sequence[Atlas]
    cut: Slice
    subjects: Sequence[Subject]
    stem: Path
    formats: Sequence[str]

    @property
    def atlas(self) -> Atlas:
        """The atlas, the first of several."""
        return self.atlases[0]

    def heading(self, quantities: Sequence[str] = ("stable",)) -> list[str]:
        """Name what a figure of some quantities holds fixed."""
        axes = self.atlas.study.axes
        dims = {dim for name in quantities for dim in self.atlas.study.axes_of(name)}
        cut = self.cut.index.items()
        values = {name: axes[name][place] for name, place in cut if name in dims}
        return given_words([atlas.study for atlas in self.atlases], values, quantities)

    def path(self, name: str, overlay: str | None = None) -> Path:
        """Return the stem of a figure's files, which names the slice: none hides another."""
        axes = {**self.atlas.study.axes}
        for atlas in self.atlases[1:]:
            axes |= atlas.study.axes
        places = self.cut.index.items()
        slices = [in_a_file_name(axis, axes[axis][place]) for axis, place in places]
        over = [f"over-{overlay}"] if overlay else []
        return self.stem.with_name("-".join([self.stem.name, name, *over, *slices]))


@dataclass(frozen=True, slots=True)
class Picture:
    """A figure to be drawn: its name, its plane if it has one, its panels, and how."""

    name: str
    plane: tuple[str, str] | None
    panels: int
    draw: Callable[[Tick], style.Drawing]


def limits_picture(request: Request, plan: limits.Plan, overlay: str | None) -> Picture:
    """Lay out the limits of standing, small multiples over axes that give no curves.

    ``overlay`` is the axis of the curves if it was asked for.
    """
    study = request.atlas.study
    shown = thinned(study, plan.panels, MOST_PANELS)
    places = places_of(shown)

    def draw(tick: Tick) -> style.Drawing:
        words, heading = _titles(request, plan.panels, places), request.heading()
        lines = limits.values_of_curves(request.atlases, plan)
        marked, said = _placed(request, plan.axes, shown, lines)
        with _small_multiples(plan.axes, words, shown, heading, 3.1) as (figure, panes):
            for ax, place, subjects in zip(panes, places, marked, strict=False):
                index = {**request.cut.index, **place}
                limits.draw_limits(ax, request.atlases, plan, index, subjects)
                tick()
            paths = style.save(figure, request.path("limits", overlay), request.formats)
        drawn = limits.curves_shown(request.atlas, plan, len(request.atlases))
        return style.Drawing(paths, _sentence([left_out(study, {**shown, **drawn}), *said]))

    return Picture("limits", plan.axes, len(places), draw)


def map_picture(request: Request, name: str, layout: maps.Layout) -> Picture:
    """Lay out a map of a quantity, small multiples over its other axes."""
    atlas, study = request.atlas, request.atlas.study
    shown = thinned(study, layout.panels, MOST_PANELS)
    places = places_of(shown)
    own = {axis: i for axis, i in request.cut.index.items() if axis in atlas[name].dims}

    def draw(tick: Tick) -> style.Drawing:
        panels = []
        for place in places:
            panels.append(maps.panel_of(atlas, name, layout, {**own, **place}))
            tick()
        if maps.is_constant(panels):
            return style.Drawing([], _constant(name, panels[0].values.ravel()))
        colours, heading = maps.colours_of(name, panels), request.heading([name])
        words = _titles(request, layout.panels, places)
        marked, said = _placed(request, layout.axes, shown)
        with _small_multiples(layout.axes, words, shown, heading, 3.0) as (figure, panes):
            found = [
                maps.draw_map(ax, study, name, layout, panel, colours, subjects)
                for ax, panel, subjects in zip(panes, panels, marked, strict=False)
            ]
            if (mesh := found[0]) is not None:
                maps.add_bar(panes, mesh, name, panels)
            paths = style.save(figure, request.path(name), request.formats)
        return style.Drawing(paths, _sentence([left_out(study, shown), *said]))

    return Picture(name, layout.axes, len(places), draw)


def curves_picture(request: Request, name: str, cut: along.Cut) -> Picture:
    """Lay out a quantity along one axis."""
    atlas, study = request.atlas, request.atlas.study

    def draw(tick: Tick) -> style.Drawing:
        if name == "stable":  # ramps between 0 and 1
            tick()
            words = (
                f"stable is 0 or 1 along {cut.along}: no figure; a critical stiffness shows where"
            )
            return style.Drawing([], words)
        values = np.concatenate([np.ravel(atlas[name][place]) for place in cut.places.values()])
        if np.isfinite(values).all() and np.ptp(values) <= 1e-12 * np.abs(values).max():
            tick()
            return style.Drawing([], _constant(name, values))
        with style.paper_figure(height=3.1) as (figure, (ax,)):
            along.draw_curves(ax, atlas, name, cut)
            _head(figure, along.title_of(study, cut, [name]))
            paths = style.save(figure, request.path(name), request.formats)
        tick()
        return style.Drawing(paths, left_out(study, cut.shown))

    return Picture(name, None, 1, draw)


def locus_picture(request: Request, cut: along.Cut) -> Picture:
    """Lay out the rightmost root over the delay."""
    atlas, study = request.atlas, request.atlas.study

    def draw(tick: Tick) -> style.Drawing:
        with style.paper_figure(style.PAGE, 2.9, (1, 3)) as (figure, axes):
            along.draw_loci(axes, atlas, cut)
            _head(figure, along.title_of(study, cut, along.ROOT))
            lines = axes[0].get_legend_handles_labels()[0] if cut.several else []
            handles = [*lines, *locus.locus_marks()]
            figure.legend(handles=handles, loc="outside lower center", ncols=4, frameon=False)
            paths = style.save(figure, request.path("locus"), request.formats)
        tick()
        return style.Drawing(paths, left_out(study, cut.shown))

    return Picture("locus", None, 1, draw)


def _sentence(said: Sequence[str]) -> str:
    return "; ".join(filter(None, said))


def _constant(name: str, values: np.ndarray) -> str:
    """Say that a quantity has no spread."""
    row = QUANTITIES[name]
    finite = values[np.isfinite(values)]
    unit = "" if row.unit == "1" else f" {row.unit}"
    value = f"{finite[0]:.6g}{unit}" if finite.size else "nowhere finite"
    return f"{name} is {value} throughout what would be drawn: no figure"


def _titles(
    request: Request, panels: Sequence[str], places: Sequence[Mapping[str, int]]
) -> list[str]:
    study = request.atlas.study
    values = [{axis: study.axes[axis][i] for axis, i in place.items()} for place in places]
    return [titled(study, each, panels) for each in values]


def _placed(
    request: Request,
    axes: tuple[str, str],
    shown: Shown,
    curves: Mapping[str, Sequence[Any]] | None = None,
) -> tuple[list[list[Subject]], list[str]]:
    """Return the subjects of each panel, and what is to be said of them."""
    study, said = request.atlas.study, []
    studies = [atlas.study for atlas in request.atlases]
    held = {k: v for k, v in study.fixed.items() if all(each.fixed.get(k) == v for each in studies)}
    known = {name for each in studies for name in (*each.fixed, *each.axes)}
    held |= {name: study.axes[name][i] for name, i in request.cut.index.items()}
    sides = {axis: [finite(each.axes[axis]) for each in studies] for axis in axes}
    frame = {axis: (min(s[0] for s in v), max(s[-1] for s in v)) for axis, v in sides.items()}
    places = places_of(shown)
    panels: list[list[Subject]] = [[] for _ in places]
    for one in request.subjects:
        if lacking := marking.missing_axes(one, axes):
            said.append(f"{one.called} does not name {' and '.join(lacking)}: not marked")
            continue
        own = marking.nearest_panel(one, study, shown)
        if own is None:
            said.append(f"{one.called} is of a model that is not drawn: not marked")
            continue
        there = {name: study.axes[name][i] for name, i in own.items()}
        said.append(marking.is_outside(one, frame))
        said.append(marking.contradictions(one, {**held, **there}, curves, known))
        for subjects, place in zip(panels, places, strict=True):
            if all(place[axis] == i for axis, i in own.items()):
                subjects.append(one)
    return panels, said


def _head(figure: Figure, words: Sequence[str]) -> None:
    """Write what a figure holds fixed above it, in lines of its width."""
    size = style.STYLE["legend.fontsize"]
    lines = in_lines(words, 72.0 * figure.get_figwidth() - size, size)
    figure.suptitle(lines, fontsize=size)


@contextmanager
def _small_multiples(
    plane: tuple[str, str],
    titles: Sequence[str],
    shown: Shown,
    heading: Sequence[str],
    height: float,
) -> Iterator[tuple[Figure, list[Axes]]]:
    """Give a panel of a plane for each title, ``height`` inches high if it is a single one.

    The last axis of ``shown`` runs from left to right if that fits the page.
    """
    last = len(list(shown.values())[-1]) if shown else 1
    columns = last if 2 <= last <= 3 else min(3, len(titles))
    rows = -(-len(titles) // columns)
    width = style.COLUMN if len(titles) == 1 else style.PAGE
    height = height if len(titles) == 1 else 0.7 + 2.3 * rows
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
        _head(figure, heading)
        yield figure, axes
