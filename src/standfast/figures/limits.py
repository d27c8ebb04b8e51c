"""Limits of standing on a plane of two axes: one curve a knee, a delay, a model or a file."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes

from standfast.atlas.reader import Atlas
from standfast.errors import InputError
from standfast.figures import labels, marking
from standfast.figures.choosing import MOST_CURVES, middles, thinned
from standfast.figures.given import atlases_in
from standfast.figures.naming import curve_words, given_words, named, set_title
from standfast.figures.scales import set_frame
from standfast.figures.slicing import full_name, slice_of
from standfast.figures.style import BLUE, GREY, VERMILION, axes_for, has_note, note
from standfast.parameters import PARAMETERS
from standfast.thresholds import planes, regions
from standfast.thresholds.regions import Region

# Files, or models, side by side: apart by colour, and by dashes in grey.
APART = (
    {"color": BLUE, "linestyle": "-"},
    {"color": VERMILION, "linestyle": "--"},
    {"color": "black", "linestyle": "-."},
    {"color": GREY, "linestyle": ":"},
)
NOTED = np.array([[x, 0.95] for x in (0.55, 0.7, 0.85, 1.0)])  # where a note lies in the frame
SHADES = (0.25, 0.11)  # of a region that stands: alone, or one on another


@dataclass(frozen=True, slots=True)
class Plan:
    """How limits are laid out: the plane, the axis of its curves, and the axes of its panels."""

    axes: tuple[str, str]
    along: str | None
    panels: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Curve:
    """One limit to be drawn: its name, the region that it bounds, and the style of its line."""

    name: str
    region: Region
    style: Mapping[str, Any]


def limits(
    *atlases: Atlas | str | Path | Sequence[Atlas | str | Path],
    ax: Axes | None = None,
    at: Mapping[str, Any] | None = None,
    overlay: str | None = None,
    mark: Any = None,
) -> Axes:
    """Draw the limits of standing of an atlas, or of several, into one pair of axes.

    A curve is drawn for each value of one axis: the delay, the knee's stiffness, the body model, or
    ``overlay``. The person stands in what is shaded, darker with more of the curves. With springs
    alone the limit is exact; with feedback it lies as near as the atlas shows.

    Parameters
    ----------
    atlases
        up to four, or their files, whose limits lie on the same two axes.
    ax
        where to draw (default: new axes of a figure of pyplot).
    at
        values of axes by name, ``{"gravity": 1.62}``; the nearest on the grid is drawn, and named
        in the title. Other axes that are neither drawn nor curves are taken in their middle.
    overlay
        the axis whose values become curves.
    mark
        subjects to mark: parameters by name with an optional ``id``, several of them, or the name
        of a CSV file.

    Returns
    -------
    The axes.

    Raises
    ------
    InputError
        for an unknown name, a value beyond its axis, atlases that share no plane, or a subject who
        names none of the two axes.

    Examples
    --------
    >>> import standfast as sf
    >>> sf.plot.limits("atlas.h5", mark={"ankle": 900, "hip": 400, "id": "S1"}).get_xlabel()
    'Ankle stiffness $K_a$ (N·m/rad)'
    """
    opened = atlases_in(atlases)
    studies = [atlas.study for atlas in opened]
    cut = slice_of(studies, at)
    plan = plan_of(opened, cut.index, overlay)
    index = {**middles(studies[0], plan.panels), **cut.index}
    subjects = marking.subjects_on(plan.axes, mark)
    ax = axes_for(ax)
    draw_limits(ax, opened, plan, index, subjects)
    marking.warn_of(ax, subjects, plan.axes)
    x, y = (PARAMETERS[name].label for name in plan.axes)
    ax.set(xlabel=x, ylabel=y)
    axes = studies[0].axes
    values = {name: axes[name][i] for name, i in index.items() if name in axes}
    set_title(ax, given_words(studies, values))
    return ax


def plan_of(atlases: Sequence[Atlas], index: Mapping[str, int], overlay: str | None = None) -> Plan:
    """Lay out the limits of some atlases, of which some axes are cut; refuse where there are none.

    Raises
    ------
    InputError
        if an atlas shows no limits on a plane, or they do not lie on one plane.
    """
    if not 0 < len(atlases) <= len(APART):
        raise InputError(f"limits of {len(atlases)} files; give one to {len(APART)}")
    over = full_name("overlay", overlay) if overlay is not None else None
    found = [_plan_of_one(atlas, index, over) for atlas in atlases]
    if over is not None and all(plan.along != over for plan in found):
        axes = ", ".join(atlases[0].study.axes_of("stable"))
        raise InputError(f"overlay: {over} is no axis that is left to be drawn (axes: {axes})")
    if len(atlases) > 1 and over is None:
        # curves of each file at each value of a further axis nobody tells apart
        found = [Plan(p.axes, None, (*p.panels, p.along) if p.along else p.panels) for p in found]
    first = found[0]
    for atlas, plan in zip(atlases[1:], found[1:], strict=True):
        if plan.axes != first.axes:
            one, other = (" and ".join(each.axes) for each in (first, plan))
            raise InputError(
                f"{atlases[0].path} has limits over {one}, {atlas.path} over {other}; "
                "one figure needs the same axes"
            )
        here, there = atlases[0].study.axes, atlas.study.axes
        if plan.panels != first.panels or any(
            not np.array_equal(here[name], there[name]) for name in first.panels
        ):
            names = dict.fromkeys([*first.panels, *plan.panels])
            raise InputError(
                f"{atlases[0].path} and {atlas.path} differ in {', '.join(names)}; choose one "
                f"value each with at, as {next(iter(names))}=…"
            )
    return Plan(first.axes, next((p.along for p in found if p.along), None), first.panels)


def _plan_of_one(atlas: Atlas, index: Mapping[str, int], overlay: str | None) -> Plan:
    study = atlas.study
    dims = [name for name in study.axes_of("stable") if name not in index]
    axes = planes.axes_of_plane(study, [name for name in dims if name != overlay])
    if axes is None or not regions.has_limits(atlas):
        raise InputError(
            f"{atlas.path} shows no limits of standing: they need two axes of at least "
            f"{planes.LEAST_SIDE} values, and with feedback one of the quantities stable and "
            "decay_rate"
        )
    along = overlay if overlay in dims else planes.axis_of_curves(dims, axes)
    return Plan(axes, along, tuple(name for name in dims if name not in (*axes, along)))


def draw_limits(
    ax: Axes,
    atlases: Sequence[Atlas],
    plan: Plan,
    index: Mapping[str, int],
    subjects: Sequence[marking.Subject] = (),
) -> None:
    """Draw one panel of limits with subjects, without labels of its axes."""
    curves = list(_curves_of(atlases, plan, index))
    ends = np.array([[(v[0], v[-1]) for v in (c.region.x, c.region.y)] for c in curves])
    frame = [(float(side[:, 0].min()), float(side[:, 1].max())) for side in ends.swapaxes(0, 1)]
    set_frame(ax, atlases[0].study, plan.axes, frame)
    for curve in curves:
        _shade(ax, curve.region, SHADES[len(curves) > 1])
    for curve in curves:
        ax.plot(*curve.region.curve, label=curve.name or "limit of standing", **curve.style)
    nowhere = [curve.name for curve in curves if not curve.region.stands.any()]
    if nowhere:
        note(ax, "stands nowhere" + (f": {', '.join(nowhere)}" if any(nowhere) else ""))
    apart = len({curve.style["linestyle"] for curve in curves}) > 1
    avoid = marking.draw_subjects(ax, subjects, plan.axes)
    avoid = np.concatenate([avoid, NOTED]) if has_note(ax) else avoid
    names = labels.name_curves(
        ax,
        [(curve.name, curve.region.curve) for curve in curves],
        colors=[curve.style["color"] for curve in curves] if apart else (),
        avoid=avoid,
        together=True,
    )
    called = [curve.name for curve in curves if curve.name and len(curve.region.curve[0])]
    if called and len(names) == len(avoid):
        names = np.concatenate([avoid, _name_aside(ax, called, legend=apart)])
    _name_sides(ax, [curve.region for curve in curves], names)


def _name_aside(ax: Axes, names: Sequence[str], *, legend: bool) -> np.ndarray:
    """Name curves beside which there is no room; return where in the frame."""
    if legend:
        ax.legend(loc="upper right", fontsize=mpl.rcParams["legend.fontsize"])
        return np.array([[x, y] for x, _ in NOTED for y in (0.75, 0.85, 0.95)])
    note(ax, f"limits: {', '.join(names)}")
    return NOTED


def _curves_of(atlases: Sequence[Atlas], plan: Plan, index: Mapping[str, int]) -> Iterator[Curve]:
    """Go through the limits of one panel; the first that lies in it has its full name."""
    files = _names_of_files(atlases)
    units = [PARAMETERS[name].unit for name in plan.axes]
    for atlas, file, style in zip(atlases, files, APART, strict=False):
        study = atlas.study
        own = {name: i for name, i in index.items() if name in study.axes_of("stable")}
        along = plan.along if plan.along in study.axes and plan.along not in own else None
        places = sorted(curves_shown(atlas, plan, len(atlases))[along]) if along else [-1]
        one_by_one = along is not None and bool(PARAMETERS[along].choices) and len(atlases) == 1
        first = True
        for number, place in enumerate(places):
            region = regions.region(atlas, plan.axes, {**own, along: place} if along else own)
            words = curve_words(study, along, place, units, full=first) if along else ""
            name = ", ".join(word for word in (file if first else "", words) if word)
            look = dict(APART[number % len(APART)] if one_by_one else style)
            if len(atlases) == 1 and words.endswith("rigid"):
                look["color"] = "black"
            first = first and not region.stands.any()
            yield Curve(name, region, look)


def curves_shown(atlas: Atlas, plan: Plan, files: int) -> dict[str, set[int]]:
    """Return which values of the axis of curves are drawn of one of some atlases."""
    along = [plan.along] if plan.along in atlas.study.axes else []
    return thinned(atlas.study, along, max(2, MOST_CURVES // files))


def values_of_curves(atlases: Sequence[Atlas], plan: Plan) -> dict[str, list[Any]]:
    """Return the values of the axis of curves at which some are drawn."""
    return {
        axis: [atlases[0].study.axes[axis][i] for i in sorted(places)]
        for axis, places in curves_shown(atlases[0], plan, len(atlases)).items()
    }


def _names_of_files(atlases: Sequence[Atlas]) -> list[str]:
    """Name files by the one parameter in which they differ, else by their own names."""
    if len(atlases) == 1:
        return [""]
    given = [atlas.study.fixed for atlas in atlases]
    differing = [
        name
        for name in PARAMETERS
        if all(name in each for each in given) and len({each[name] for each in given}) > 1
    ]
    if len(differing) == 1 and len({each[differing[0]] for each in given}) == len(given):
        (name,) = differing
        return [named(atlas.study, name, atlas.study.fixed[name]) for atlas in atlases]
    return [atlas.path.name.removesuffix(".h5").replace("$", r"\$") for atlas in atlases]


def _shade(ax: Axes, region: Region, alpha: float) -> None:
    """Shade where a person stands."""
    x, y, field = region.finer
    if (field > 0.0).any():
        largest = max(float(np.nanmax(field[np.isfinite(field)], initial=1.0)), 1.0)
        inside = np.nan_to_num(field.T, posinf=largest, neginf=-largest)
        levels = [0.0, 2.0 * largest]
        ax.contourf(x, y, inside, levels=levels, colors=[BLUE], alpha=alpha, zorder=0.5)


def _name_sides(ax: Axes, drawn: Sequence[Region], names: np.ndarray) -> None:
    """Write "stands" where most of the regions are, "falls" where none is."""
    count = np.sum([labels.sampled(ax, *region.finer) > 0.0 for region in drawn], axis=0)
    curves = [
        labels.in_frame(ax, points[np.isfinite(points).all(axis=1)])
        for points in (np.column_stack(region.curve) for region in drawn)
        if len(points)
    ]
    places = labels.name_regions(ax, {"falls": count == 0}, names, curves)
    # where most of them stand, if the word has room there, else where fewer do
    for least in sorted({count.max(), -(-count.max() // 2), 1} - {0}, reverse=True):
        inside = {"stands": count >= least}
        if len(labels.name_regions(ax, inside, places, curves)) > len(places):
            break
