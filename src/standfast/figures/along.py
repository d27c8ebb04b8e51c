"""Curves of an atlas along one axis: any quantity, and the rightmost root over the delay.

The longest of the other axes gives a few curves; the rest are taken in their middle and named in
the title.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from standfast.atlas.reader import Atlas
from standfast.errors import InputError, shortened
from standfast.figures import labels, locus
from standfast.figures.choosing import CUT_AT, MOST_CURVES, RUNNING_AWAY, middles, thinned
from standfast.figures.given import atlas_in
from standfast.figures.naming import curve_words, given_words, set_title
from standfast.figures.scales import set_scale
from standfast.figures.slicing import full_name, slice_of
from standfast.figures.style import GREY, axes_for, graded, new_axes
from standfast.parameters import PARAMETERS
from standfast.quantities import QUANTITIES
from standfast.study.study import Study
from standfast.thresholds.planes import DELAY, LEAST_SIDE

ROOT = ("decay_rate", "sway_frequency")  # minus the real part; the imaginary part over 2π


@dataclass(frozen=True, slots=True)
class Cut:
    """Which curves along one axis are drawn: places in the grid by name, and what is shown."""

    along: str
    places: Mapping[str, tuple[Any, ...]]
    shown: Mapping[str, set[int]]
    held: Mapping[str, int]

    @property
    def several(self) -> bool:
        """Whether there is more than one curve."""
        return len(self.places) > 1


def curves_of(
    atlas: Atlas | str | Path,
    quantity: str,
    *,
    ax: Axes | None = None,
    at: Mapping[str, Any] | None = None,
    along: str | None = None,
) -> Axes:
    """Draw a quantity along one axis, one labelled curve for each value of another.

    Parameters
    ----------
    atlas, quantity
        what to draw, a quantity inside the atlas.
    ax
        where to draw (default: new axes of a figure of pyplot).
    at
        values of axes by name; the nearest on the grid is drawn, and named in the title. Other axes
        are taken in their middle.
    along
        the horizontal axis (default: the longest).

    Returns
    -------
    The axes.

    Raises
    ------
    InputError
        for an unknown name, a value beyond its axis, or a quantity without an axis.

    Examples
    --------
    >>> import standfast as sf
    >>> ax = sf.plot.curves("atlas.h5", "critical_ankle_stiffness", at={"knee": 2000})
    >>> ax.get_xlabel()
    'Hip stiffness $K_h$ (N·m/rad)'
    """
    atlas = atlas_in(atlas)
    index = slice_of([atlas.study], at).index
    along = full_name("along", along) if along is not None else None
    cut = cut_of(atlas, quantity, index, along)
    if cut is None:
        raise InputError(f"{atlas.path} has no axis to draw {quantity} along")
    ax = axes_for(ax)
    draw_curves(ax, atlas, quantity, cut)
    set_title(ax, title_of(atlas.study, cut, [quantity]))
    return ax


def locus_of(
    atlas: Atlas | str | Path,
    *,
    axes: Sequence[Axes] | None = None,
    at: Mapping[str, Any] | None = None,
) -> Sequence[Axes]:
    """Draw the rightmost root over the delay: real part, imaginary part, complex plane.

    Parameters
    ----------
    atlas
        one that holds ``decay_rate`` and ``sway_frequency`` on an axis of the delay.
    axes
        three axes to draw into (default: those of a new figure of pyplot).
    at
        values of axes by name, as of :func:`standfast.plot.curves`.

    Returns
    -------
    The three axes.

    Raises
    ------
    InputError
        if the atlas holds no rightmost root along the delay, or for a wrong name or value.

    Examples
    --------
    >>> import standfast as sf
    >>> real, imaginary, plane = sf.plot.locus("root-locus.h5")
    >>> plane.get_xlabel()
    'Real part (1/s)'
    """
    atlas = atlas_in(atlas)
    index = slice_of([atlas.study], at).index
    cut = locus_cut(atlas, index)
    if axes is None:
        axes = new_axes(3)
    elif len(given := np.ravel(np.array(axes, dtype=object))) != 3 or not all(
        isinstance(ax, Axes) for ax in given
    ):
        raise InputError(f"axes = {shortened(axes)}; give three axes, as figure.subplots(1, 3)")
    draw_loci(axes, atlas, cut)
    if cut.several:
        axes[0].legend(frameon=False, fontsize="small")
    set_title(axes[1], title_of(atlas.study, cut, ROOT))
    return axes


def cut_of(
    atlas: Atlas, quantity: str, index: Mapping[str, int], along: str | None = None
) -> Cut | None:
    """Choose the curves of a quantity, of which some axes are cut; None if no axis is left."""
    study, dims = atlas.study, atlas[quantity].dims
    left = [name for name in dims if name not in index]
    numeric = [name for name in left if not PARAMETERS[name].choices]
    if along is not None and along not in numeric:
        raise InputError(
            f"{quantity} has no axis {along!r} to be drawn along (axes: {', '.join(left)})"
        )
    if not numeric:
        return None
    along = along or max(numeric, key=lambda name: len(study.axes[name]))
    others = [name for name in left if name != along]
    second = max(others, key=lambda name: len(study.axes[name]), default=None)
    kept = thinned(study, [second] if second else [], MOST_CURVES)
    held = {name: i for name, i in index.items() if name in dims}
    held |= {name: i for name, i in middles(study, others).items() if name != second}
    places: dict[str, tuple[Any, ...]] = {}
    units = (PARAMETERS[along].unit, QUANTITIES[quantity].unit)
    for at in sorted(kept[second]) if second else [0]:
        place: dict[str, Any] = {**held, along: slice(None)}
        words = ""
        if second:
            place[second] = at
            words = curve_words(study, second, at, units, full=not places)
        places[words] = tuple(place[name] for name in dims)
    shown = {**kept, **{name: {i} for name, i in held.items() if name not in index}}
    return Cut(along, places, shown, held)


def title_of(study: Study, cut: Cut, quantities: Sequence[str]) -> list[str]:
    """Name what curves hold fixed."""
    return given_words([study], {n: study.axes[n][i] for n, i in cut.held.items()}, quantities)


def draw_curves(ax: Axes, atlas: Atlas, quantity: str, cut: Cut) -> None:
    """Draw the curves of a cut, each with its name on it."""
    study, variable = atlas.study, atlas[quantity]
    values = study.axes[cut.along]
    finite = np.isfinite(values)
    x, curves = values[finite], {}
    for words, place in cut.places.items():
        curve = variable[place][finite].astype(float)
        curves[words] = np.where(np.isfinite(curve), curve, np.nan)
    for color, (name, curve) in zip(graded(len(curves)), curves.items(), strict=True):
        ax.plot(x, curve, color=color, label=name or quantity.replace("_", " "))
    set_scale(ax, "x", study, cut.along)
    limit = QUANTITIES[quantity].limit_of_standing(study.has_gains)
    _set_height(ax, quantity, list(curves.values()), limit)
    ax.set(xlabel=PARAMETERS[cut.along].label, ylabel=QUANTITIES[quantity].label)
    labels.name_curves(ax, ((name, (x, curve)) for name, curve in curves.items()))


def _set_height(ax: Axes, quantity: str, curves: Sequence[np.ndarray], limit: float | None) -> None:
    """Set the vertical ends, and say on which side of the limit the person falls."""
    values = np.concatenate([curve[np.isfinite(curve)] for curve in curves])
    # a curve that runs away towards an asymptote would flatten all the rest
    middle = np.median(values) if values.size else 0.0
    if values.size and values.min() > 0.0 and values.max() > RUNNING_AWAY * middle:
        ax.set_ylim(0.0, CUT_AT * middle)
    low, high = ax.get_ylim()
    ax.set_ylim(low, high)
    if limit is not None and low < limit < high:
        ax.axhspan(low, limit, color="0.93", zorder=0)
        # beyond the critical delay there may be delays at which the person stands again
        words = "beyond the critical delay" if quantity == "delay_margin" else "falls"
        if (limit - low) / (high - low) > 0.08:
            _say_left(ax, words)
    elif values.size and values.min() < 0.0 < values.max():
        ax.axhline(0.0, color=GREY, linewidth=0.5)
    if quantity.startswith("critical_") and quantity.endswith("_stiffness"):
        # thresholds fall with another joint's stiffness and rise with a body's size
        steps = np.concatenate([np.diff(curve[np.isfinite(curve)]) for curve in curves])
        _say_left(ax, "above its curve a person stands", at_top=bool(np.sign(steps).sum() > 0))


def _say_left(ax: Axes, words: str, *, at_top: bool = False) -> None:
    """Write grey words into a corner at the left."""
    y, side = (0.97, "top") if at_top else (0.03, "baseline")
    ax.text(0.02, y, words, transform=ax.transAxes, va=side, fontsize="small", color=GREY)


def has_locus(atlas: Atlas, index: Mapping[str, int]) -> bool:
    """Return whether an atlas holds the rightmost root along the delay."""
    long = len(atlas.study.axes.get(DELAY, ())) >= LEAST_SIDE
    return long and set(ROOT) <= set(atlas.quantities) and DELAY not in index


def locus_cut(atlas: Atlas, index: Mapping[str, int]) -> Cut:
    """Choose the loci of an atlas; refuse one that holds no rightmost root along the delay."""
    cut = cut_of(atlas, ROOT[0], index, DELAY) if has_locus(atlas, index) else None
    if cut is None:
        raise InputError(f"{atlas.path} does not hold {' and '.join(ROOT)} along {DELAY}")
    return cut


def draw_loci(axes: Sequence[Axes], atlas: Atlas, cut: Cut) -> None:
    """Draw the rightmost root over the delay into three axes."""
    delay = atlas.study.axes[DELAY]
    roots: dict[str, np.ndarray] = {}
    for words, place in cut.places.items():
        decay, frequency = (atlas[quantity][place] for quantity in ROOT)
        roots[words] = np.where(np.isfinite(decay), -decay + 2j * np.pi * frequency, np.nan)
    found = {words: crossings_of(delay, root) for words, root in roots.items()}
    locus.root_locus_over_delay(axes, delay, roots, found)


def crossings_of(delay: np.ndarray, root: np.ndarray) -> np.ndarray:
    """Return (delay, 0, imaginary part) where the rightmost root crosses the imaginary axis.

    Between two delays, by the straight line through both.
    """
    real = root.real
    at = np.flatnonzero((real[:-1] < 0.0) != (real[1:] < 0.0))
    share = real[at] / (real[at] - real[at + 1])
    tau = delay[at] + share * (delay[at + 1] - delay[at])
    # where another pair takes over in between, of the root that is nearer to the axis
    share = np.where(locus.jumps(root)[at], np.rint(share), share)
    imaginary = root.imag[at] + share * (root.imag[at + 1] - root.imag[at])
    return np.column_stack([tau, np.zeros(at.size), imaginary])
