"""Curves of an atlas along one axis: any quantity, and the rightmost root over the delay.

The longest of the other axes gives a few curves; the rest are taken in their middle and named in
the title.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from standfast.atlas.reader import Atlas
from standfast.figures import charts, standing, style
from standfast.figures.choosing import MOST_CURVES, left_out, named, thinned
from standfast.quantities import QUANTITIES
from standfast.study.study import Study
from standfast.thresholds.planes import DELAY, LEAST_SIDE

ROOT = ("decay_rate", "sway_frequency")  # minus the real part; the imaginary part over 2π

LONG_NAME = 16  # characters, of which three do not fit a column side by side


def curves_of(
    atlas: Atlas, name: str, stem: Path, formats: Sequence[str]
) -> tuple[list[Path], str]:
    """Draw a quantity along its longest numeric axis; return the files and what is left out."""
    study, variable = atlas.study, atlas[name]
    numeric = [axis for axis in variable.dims if axis != "body_model"]
    along = max(numeric, key=lambda axis: len(study.axes[axis]))
    cut = _Cut.of(study, variable.dims, along)
    values, label = study.axes[along], QUANTITIES[name].label
    finite = np.isfinite(values)
    curves: dict[str, np.ndarray] = {}
    for words, place in cut.places.items():
        curve = variable[place][finite].astype(float)
        curves[words or label] = np.where(np.isfinite(curve), curve, np.nan)
    with style.paper_figure(height=3.1) as (figure, (ax,)):
        standing.quantity_curves(ax, values[finite], curves, label=label, axis=along)
        ax.set_title(cut.title)
        if len(curves) > 1:
            handles, labels = ax.get_legend_handles_labels()
            columns = 2 if max(map(len, labels)) > LONG_NAME else 3
            figure.legend(handles, labels, loc="outside lower center", ncols=columns, frameon=False)
        return style.save(figure, stem, formats), left_out(study, cut.shown)


def has_loci(atlas: Atlas) -> bool:
    """Return whether an atlas holds the rightmost root along the delay."""
    return set(ROOT) <= set(atlas.quantities) and (
        DELAY in atlas.study.axes and len(atlas.study.axes[DELAY]) >= LEAST_SIDE
    )


def root_loci(atlas: Atlas, stem: Path, formats: Sequence[str]) -> tuple[list[Path], str]:
    """Draw the rightmost root over the delay; return the files and what is left out."""
    study, delay = atlas.study, atlas.study.axes[DELAY]
    cut = _Cut.of(study, atlas[ROOT[0]].dims, DELAY)
    roots: dict[str, np.ndarray] = {}
    for words, place in cut.places.items():
        decay, frequency = (atlas[quantity][place] for quantity in ROOT)
        roots[words] = np.where(np.isfinite(decay), -decay + 2j * np.pi * frequency, np.nan)
    with style.paper_figure(style.PAGE, 2.9, (1, 3)) as (figure, axes):
        found = {words: crossings_of(delay, root) for words, root in roots.items()}
        charts.root_locus_over_delay(axes, delay, roots, found)
        if cut.title:
            figure.suptitle(cut.title, fontsize=style.STYLE["axes.titlesize"])
        handles = axes[0].get_legend_handles_labels()[0] if len(roots) > 1 else []
        handles += charts.locus_marks()
        figure.legend(handles=handles, loc="outside lower center", ncols=4, frameon=False)
        return style.save(figure, stem, formats), left_out(study, cut.shown)


def crossings_of(delay: np.ndarray, root: np.ndarray) -> np.ndarray:
    """Return (delay, 0, imaginary part) where the rightmost root crosses the imaginary axis.

    Between two delays, by the straight line through both.
    """
    real = root.real
    at = np.flatnonzero((real[:-1] < 0.0) != (real[1:] < 0.0))
    share = real[at] / (real[at] - real[at + 1])
    tau = delay[at] + share * (delay[at + 1] - delay[at])
    # where another pair takes over in between, of the root that is nearer to the axis
    share = np.where(charts.jumps(root)[at], np.rint(share), share)
    imaginary = root.imag[at] + share * (root.imag[at + 1] - root.imag[at])
    return np.column_stack([tau, np.zeros(at.size), imaginary])


@dataclass(frozen=True, slots=True)
class _Cut:
    """Which curves along one axis are drawn: places in the grid by name, and what is shown."""

    places: Mapping[str, tuple[Any, ...]]
    shown: Mapping[str, set[int]]
    title: str

    @classmethod
    def of(cls, study: Study, dims: Sequence[str], along: str) -> "_Cut":
        others = [axis for axis in dims if axis != along]
        second = max(others, key=lambda axis: len(study.axes[axis]), default=None)
        kept = thinned(study, [second] if second else [], MOST_CURVES)
        middle = {axis: len(study.axes[axis]) // 2 for axis in others}
        places: dict[str, tuple[Any, ...]] = {}
        for at in sorted(kept[second]) if second else [0]:
            index: dict[str, Any] = {**middle, along: slice(None)}
            words = ""
            if second:
                index[second], words = at, named(study, second, study.axes[second][at])
            places[words] = tuple(index[axis] for axis in dims)
        rest = {axis: middle[axis] for axis in others if axis != second}
        title = ", ".join(named(study, axis, study.axes[axis][at]) for axis, at in rest.items())
        return cls(places, {**kept, **{axis: {at} for axis, at in rest.items()}}, title)
