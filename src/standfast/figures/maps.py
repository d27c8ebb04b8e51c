"""Maps of a quantity on a plane of two axes, with its contours and the limit of standing."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable

from standfast.atlas.reader import Atlas
from standfast.errors import InputError
from standfast.figures import marking, painting
from standfast.figures.choosing import CUT_AT, MOST_CURVES, RUNNING_AWAY, middles
from standfast.figures.given import atlas_in
from standfast.figures.naming import given_words, set_title
from standfast.figures.scales import edges, set_frame
from standfast.figures.slicing import slice_of
from standfast.figures.style import axes_for
from standfast.parameters import PARAMETERS
from standfast.quantities import QUANTITIES
from standfast.study.study import Study
from standfast.thresholds import planes, regions
from standfast.thresholds.regions import CRITICAL, Region
from standfast.thresholds.steps import continued

# More points a side than a figure has dots are skipped.
MOST_POINTS = 800

COLOURS = "cividis"

LONG_LABEL = 32  # letters, with those of its formula

# Infinite is long, of a delay; of a stiffness it is none that suffices.
LONG_DELAYS = ("critical_delay", "delay_margin")

STRATEGIES = "hip_ankle_ratio"


@dataclass(frozen=True, slots=True)
class Layout:
    """How a quantity is laid out: the plane, and the axes of its panels."""

    axes: tuple[str, str]
    panels: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Panel:
    """What one panel of a map shows: values (y, x), and where the person stands, if that is one."""

    x: np.ndarray
    y: np.ndarray
    values: np.ndarray
    region: Region | None


@dataclass(frozen=True, slots=True)
class Colours:
    """The range of colours that panels share; ``shades`` is their number, of whole numbers.

    ``lined`` is the range of contours, without a steep end, which would take all of them.
    """

    low: float
    high: float
    shades: int | None
    lined: tuple[float, float] = (0.0, 0.0)


def map_of(
    atlas: Atlas | str | Path,
    quantity: str,
    *,
    ax: Axes | None = None,
    at: Mapping[str, Any] | None = None,
    mark: Any = None,
    colorbar: bool = True,
) -> Axes:
    """Draw a quantity as a map of two axes, with labelled contours and the limit of standing.

    Where the person falls it is hatched; the limit has a colour of its own. Of ``hip_ankle_ratio``
    the regions of ankle and hip strategy are drawn.

    Parameters
    ----------
    atlas, quantity
        what to draw, a quantity inside the atlas.
    ax
        where to draw (default: new axes of a figure of pyplot).
    at
        values of axes by name, as of :func:`.plot.limits`. Other axes are taken in their middle.
    mark
        subjects to mark, as of :func:`standfast.plot.limits`.
    colorbar
        whether the axes get a bar of colours.

    Returns
    -------
    The axes.

    Raises
    ------
    InputError
        for an unknown name, a value beyond its axis, a quantity without a plane of two axes, or a
        subject who names none of the two.

    Examples
    --------
    >>> import standfast as sf
    >>> sf.plot.map("atlas.h5", "safety_factor", at={"knee": 2000}).get_xlabel()
    'Ankle stiffness $K_a$ (N·m/rad)'
    """
    study = (atlas := atlas_in(atlas)).study
    cut = slice_of([study], at)
    layout = _layout_to_draw(atlas, quantity, cut.index)
    subjects = marking.subjects_on(layout.axes, mark)
    index = {**middles(study, layout.panels), **cut.index}
    index = {name: i for name, i in index.items() if name in atlas[quantity].dims}
    ax = axes_for(ax)
    panel = panel_of(atlas, quantity, layout, index)
    shown = draw_map(ax, study, quantity, layout, panel, colours_of(quantity, [panel]), subjects)
    marking.warn_of(ax, subjects, layout.axes)
    x, y = (PARAMETERS[name].label for name in layout.axes)
    ax.set(xlabel=x, ylabel=y)
    values = {name: study.axes[name][i] for name, i in index.items()}
    set_title(ax, given_words([study], values, [quantity]))
    if colorbar and shown is not None:
        add_bar([ax], shown, quantity, [panel])
    return ax


def _layout_to_draw(atlas: Atlas, quantity: str, index: Mapping[str, int]) -> Layout:
    layout = layout_of(atlas, quantity, index)
    if layout is None:
        raise InputError(
            f"{quantity} has no two axes of at least {planes.LEAST_SIDE} values to be mapped on; "
            "draw it with curves"
        )
    return layout


def layout_of(atlas: Atlas, quantity: str, index: Mapping[str, int]) -> Layout | None:
    """Lay out a map of a quantity, of which some axes are cut; None if it has no plane."""
    dims = [name for name in atlas[quantity].dims if name not in index]
    axes = planes.axes_of_plane(atlas.study, dims)
    return axes and Layout(axes, tuple(name for name in dims if name not in axes))


def panel_of(atlas: Atlas, quantity: str, layout: Layout, index: Mapping[str, int]) -> Panel:
    """Read what one panel of a map shows, at every few points of a large grid."""
    x, y = (planes.finite(atlas.study.axes[name]) for name in layout.axes)
    steps = (max(1, x.size // MOST_POINTS), max(1, y.size // MOST_POINTS))
    values = regions.piece_of(atlas, quantity, layout.axes, index, steps).T
    region = _region_on(atlas, quantity, layout.axes, index)
    return Panel(x[:: steps[0]], y[:: steps[1]], values, region)


def _region_on(
    atlas: Atlas, quantity: str, axes: tuple[str, str], index: Mapping[str, int]
) -> Region | None:
    """Return where a person stands on a plane of a quantity; None if it holds for several."""
    study = atlas.study
    if quantity == CRITICAL:
        return regions.at_some_delay(atlas, axes, index)
    needed = set(study.axes_of("stable")) - set(axes)
    if not needed <= index.keys() or not regions.has_limits(atlas):
        return None
    if not set(axes) <= set(study.axes_of("stable")):
        return None
    return regions.region(atlas, axes, {name: index[name] for name in index if name in needed})


def colours_of(quantity: str, panels: Sequence[Panel]) -> Colours:
    """Return the range of colours: all but the outermost hundredth on each side."""
    maps = [_finite_values(quantity, panel.values) for panel in panels]
    values = np.concatenate([*maps, np.empty(0)])
    if values.size == 0:
        return Colours(0.0, 1.0, None)
    if QUANTITIES[quantity].dtype == "uint8":
        least, most = int(values.min()), int(values.max())
        return Colours(least - 0.5, most + 0.5, most - least + 1)
    low, first, last, high = (float(v) for v in np.quantile(values, [0.01, 0.02, 0.95, 0.99]))
    middle = float(np.median(values))
    if low > 0.0 and high > RUNNING_AWAY * middle:
        high, last = CUT_AT * middle, min(last, CUT_AT * middle)
    wider = 0.0 if low < high else 0.5
    return Colours(low - wider, high + wider, None, (first, last))


def _finite_values(quantity: str, values: np.ndarray) -> np.ndarray:
    # a critical delay of 0 says that the person falls without any
    inside = np.isfinite(values) & ((values > 0.0) | (quantity != CRITICAL))
    kept: np.ndarray = values[inside]
    return kept


def is_constant(panels: Sequence[Panel]) -> bool:
    """Return whether a map would be of one value, but for rounding."""
    every = np.concatenate([panel.values.ravel() for panel in panels]).astype(float)
    values = every[np.isfinite(every)]
    if values.size == 0:
        return True
    spread = 1e-12 * float(np.abs(values).max())
    return bool(np.isfinite(every).all() and np.ptp(values) <= spread)


def add_bar(
    axes: Sequence[Axes], shown: ScalarMappable, quantity: str, panels: Sequence[Panel]
) -> None:
    """Add the bar of colours of some panels, which says what is hatched."""
    falls = any(panel.region is not None and not panel.region.stands.all() for panel in panels)
    row = QUANTITIES[quantity]
    # beside a panel there is no room for a long line
    comma = ",\n" if len(row.label) > LONG_LABEL else ", "
    label = row.label + (f"{comma}hatched: falls" if falls else "")
    painting.add_bar(axes, shown, label, whole=row.dtype == "uint8")


def draw_map(
    ax: Axes,
    study: Study,
    quantity: str,
    layout: Layout,
    panel: Panel,
    colours: Colours,
    subjects: Sequence[marking.Subject] = (),
) -> ScalarMappable | None:
    """Draw one panel with subjects, without labels of its axes; return what a bar explains."""
    x, y, region = panel.x, panel.y, panel.region
    set_frame(ax, study, layout.axes, [(side[0], side[-1]) for side in (x, y)])
    avoid = marking.draw_subjects(ax, subjects, layout.axes)
    if quantity == STRATEGIES and region is not None:
        painting.strategy_regions(ax, x, y, panel.values, region, avoid)
        return None
    inside = panel.values.astype(float)
    if quantity == CRITICAL:
        # beside those who fall, so that colours reach the limit, which lies between two points
        inside = continued(np.where(inside > 0.0, inside, np.nan))
    shown = inside
    if quantity in LONG_DELAYS:
        # who stands at every delay has the colour of the longest
        shown = np.where(np.isposinf(inside), colours.high + 1.0, inside)
    logarithmic = [planes.is_log(study, name) for name in layout.axes]
    mesh = _coloured(ax, panel, shown, colours, logarithmic)
    if region is not None:
        painting.draw_falls(ax, region, cover=quantity == CRITICAL)
    if QUANTITIES[quantity].dtype != "uint8" and not QUANTITIES[quantity].jumps:
        lined = panel.values.astype(float)
        if quantity == CRITICAL:
            lined[lined == 0.0] = np.nan
        limits = _limits_of(study, quantity, known=region is not None)
        painting.contour_lines(ax, x, y, lined, colours.lined, avoid=avoid, **limits)
    return mesh


def _coloured(
    ax: Axes, panel: Panel, values: np.ndarray, colours: Colours, logarithmic: Sequence[bool]
) -> ScalarMappable:
    x, y = (
        edges(side, by_factors=log)
        for side, log in zip((panel.x, panel.y), logarithmic, strict=True)
    )
    names = mpl.colormaps[COLOURS].resampled(colours.shades) if colours.shades else COLOURS
    # an image where the axes are even, which is drawn ten times as fast as a mesh
    draw = ax.pcolormesh if any(logarithmic) else ax.pcolorfast
    mesh: Any = draw(x, y, values, cmap=names)
    mesh.set_rasterized(True)
    mesh.set_clim(colours.low, colours.high)
    ax.set_facecolor("0.75")  # under what has no value
    ax.set(xlim=(panel.x[0], panel.x[-1]), ylim=(panel.y[0], panel.y[-1]))
    found: ScalarMappable = mesh
    return found


def _limits_of(study: Study, quantity: str, *, known: bool) -> dict[str, Any]:
    """Return which contours are thick (a critical delay at a delay), and the limit's."""
    marks: list[float] = []
    if quantity == CRITICAL:
        delays = study.axes.get(planes.DELAY, np.array([study.fixed.get(planes.DELAY, 0)]))
        count = len(delays)
        kept = {round(i) for i in np.linspace(0, count - 1, min(count, MOST_CURVES))}
        marks = [float(delays[i]) for i in sorted(kept) if delays[i] > 0.0]
    limit = QUANTITIES[quantity].limit_of_standing(study.has_gains)
    drawn = [limit] if known and limit is not None else []
    return {"marks": marks, "drawn": drawn}
