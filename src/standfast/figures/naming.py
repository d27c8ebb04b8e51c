"""How figures name values: of an axis, and all that is fixed, in one or two lines of a title."""

import itertools
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.font_manager import FontProperties

from standfast.figures.style import MARKUP
from standfast.parameters import OWN_BODY, PARAMETERS, SEGMENT_NUMBERS
from standfast.quantities import QUANTITIES
from standfast.study.study import Study

LETTER = 0.58  # mean width of a letter, in font sizes


def titled(study: Study, values: Mapping[str, Any], axes: Sequence[str]) -> str:
    """Name the values of some axes, one a line."""
    return "\n".join(named(study, axis, values[axis]) for axis in axes)


def named(study: Study, axis: str, value: Any, *, unit: bool = True, symbol: bool = True) -> str:
    """Name a value, with as few digits as tell it from all others of its axis."""
    row = PARAMETERS[axis]
    if row.choices:
        return str(value)
    name = f"${row.symbol}$" if row.symbol else axis.upper()
    if np.isinf(value):
        return f"{name} rigid" if symbol else "rigid"
    values = study.axes.get(axis, np.array([value]))
    enough = (n for n in (4, 6, 8, 12) if len({f"{v:.{n}g}" for v in values}) == len(values))
    number = f"{value:.{next(enough, 17)}g}".replace("-", "−")
    head = f"{name} = {number}" if symbol else number
    return f"{head} {row.unit}" if unit and row.unit != "1" else head


def curve_words(study: Study, axis: str, place: int, units: Iterable[str], *, full: bool) -> str:
    """Name a curve by its value on an axis: ``full`` with the symbol; no unit of the figure's."""
    own = PARAMETERS[axis].unit not in units
    return named(study, axis, study.axes[axis][place], unit=own, symbol=full)


def given_words(
    studies: Sequence[Study], values: Mapping[str, Any], quantities: Iterable[str] = ("stable",)
) -> list[str]:
    """Name what a figure holds fixed: some values of axes, then what studies have in common.

    What is 0 unless given, and what the quantities do not depend on, is left out. Neighbours of one
    unit share it: ``$K_a$ = 468, $K_k$ = 2000 N·m/rad``. Segments of a person's own, if all are
    fixed, are named together by what they weigh.
    """
    first = studies[0]
    common = {
        name: value
        for name, value in first.fixed.items()
        if name not in values and all(study.fixed.get(name) == value for study in studies)
    }
    words: list[str] = []
    if all(name in common for name in OWN_BODY):
        mass = sum(float(common.pop(name)) for name in SEGMENT_NUMBERS["segment_mass"])
        words.append(f"own segments of {mass:.4g} kg")
        common = {name: value for name, value in common.items() if name not in OWN_BODY}
    order = list(PARAMETERS)
    order.sort(key=lambda name: name == "gravity")  # the person comes first
    shown = [
        (name, {**values, **common}[name])
        for name in order
        if name in values or (name in common and _matters(first, name, common[name], quantities))
    ]
    for (name, value), (after, _) in itertools.pairwise([*shown, ("", None)]):
        row = PARAMETERS[name]
        shared = after and PARAMETERS[after].unit == row.unit and not row.choices
        words.append(named(first, name, value, unit=not shared))
    return words


def _matters(study: Study, name: str, value: Any, quantities: Iterable[str]) -> bool:
    row = PARAMETERS[name]
    if row.unwritten and value == row.default:
        return False
    gains = study.has_gains
    return any(QUANTITIES[each].depends_on(name, study_has_gains=gains) for each in quantities)


def in_lines(words: Sequence[str], width: float, size: float) -> str:
    """Set words in lines of a width, in points, for letters of a size."""
    room = width / (LETTER * size)
    lines: list[str] = []
    for word in words:
        longer = f"{lines[-1]}, {word}" if lines else word
        if lines and len(MARKUP.sub("", longer)) <= room:
            lines[-1] = longer
        elif lines:
            lines[-1] += ","
            lines.append(word)
        else:
            lines.append(word)
    return "\n".join(lines)


def set_title(ax: Axes, words: Sequence[str]) -> None:
    """Set words as the title of axes, small, in lines of their width."""
    size = mpl.rcParams["legend.fontsize"]
    points = FontProperties(size=size).get_size_in_points()
    box = ax.get_position()
    width = 72.0 * ax.figure.get_figure(root=True).get_figwidth() * box.width
    ax.set_title(in_lines(words, width, points), fontsize=size)
