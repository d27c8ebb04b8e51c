"""What all figures share: style, size, saving, words on a white ground."""

import re
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any, NamedTuple

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import to_hex
from matplotlib.figure import Figure
from matplotlib.text import Text

from standfast.errors import InputError, shortened
from standfast.files import whole_file

COLUMN, PAGE = 3.5, 7.0  # widths of a column and of a page of a journal, inches
BLUE, VERMILION, GREEN, GREY = "#0072B2", "#D55E00", "#009E73", "#595959"
LIMIT = VERMILION  # of standing, on a map
MARKUP = re.compile(r"\\[a-z]+|[${}_^\\]")  # of a formula: takes no room in print
LINE_STYLES = ("-", "--", "-.", ":", (0, (5, 1, 1, 1, 1, 1)), (0, (8, 2)))

STYLE: Any = {
    "font.size": 8,
    "axes.labelsize": 8,
    "axes.titlesize": 8,
    "xtick.labelsize": 7,
    "ytick.labelsize": 7,
    "legend.fontsize": 7,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.linewidth": 0.6,
    "lines.linewidth": 1.2,
    "xtick.direction": "out",
    "ytick.direction": "out",
    "mathtext.fontset": "dejavusans",
    "savefig.dpi": 300,
    # TrueType, in which text can be searched; journals refuse type 3
    "pdf.fonttype": 42,
    "ps.fonttype": 42,
    "svg.fonttype": "none",
    "svg.hashsalt": "standfast",
}


def graded(count: int) -> list[str]:
    """Return colours of some curves in order, from dark to light, apart in grey too."""
    if count == 1:
        return [BLUE]
    colors = mpl.colormaps["cividis"](np.linspace(0.0, 0.82, count))
    return [to_hex(color) for color in colors]


@contextmanager
def paper_figure(
    width: float = COLUMN,
    height: float = 2.8,
    panels: tuple[int, int] = (1, 1),
    *,
    shared: bool = False,
) -> Iterator[tuple[Figure, list[Axes]]]:
    """Give a figure in the style of this module, with rows and columns of axes, row by row."""
    with mpl.rc_context():
        mpl.rcdefaults()  # a user's own settings belong to their figures, not to these
        mpl.rcParams.update(STYLE)
        figure = Figure(figsize=(width, height), layout="constrained")
        axes = figure.subplots(*panels, sharex=shared, sharey=shared, squeeze=False)
        yield figure, list(axes.ravel())


# What would put a clock or a version into a file, by format.
NO_CLOCK: Any = {
    "png": {"Software": None},
    "svg": {"Date": None},
    "pdf": {"CreationDate": None, "Producer": None, "Creator": None},
}

# Half of the time for a tenth more bytes.
QUICKLY: Any = {"png": {"pil_kwargs": {"compress_level": 4}}, "svg": {}, "pdf": {}}


class Drawing(NamedTuple):
    """One figure: its files, none of a constant, and in words what is to be said of it."""

    paths: list[Path]
    remark: str


def save(figure: Figure, stem: Path, formats: Sequence[str] = ("png", "svg")) -> list[Path]:
    """Write ``stem``.png and so on, each whole or not at all and without a clock inside."""
    paths = [stem.with_name(f"{stem.name}.{suffix}") for suffix in formats]
    for suffix, path in zip(formats, paths, strict=True):
        with whole_file(path) as partial:
            figure.savefig(partial, format=suffix, metadata=NO_CLOCK[suffix], **QUICKLY[suffix])
    return paths


def axes_for(ax: Axes | None) -> Axes:
    """Return the axes that a figure is drawn into: those given, or of a new figure of pyplot."""
    if ax is None:
        return new_axes(1)[0]
    if not isinstance(ax, Axes):
        raise InputError(f"ax = {shortened(ax)}; give one axes of matplotlib, as figure.subplots()")
    return ax


def new_axes(count: int) -> list[Axes]:
    """Return axes side by side in a new figure of pyplot, which a notebook shows."""
    from matplotlib import pyplot as plt  # noqa: PLC0415 - only for whoever gives no axes

    figure, axes = plt.subplots(1, count, squeeze=False, layout="constrained")
    figure.set_figwidth(0.5 * (count + 1) * figure.get_figwidth())
    return list(axes[0])


def remark(
    ax: Axes,
    x: float,
    y: float,
    text: str,
    *,
    fontsize: float | None = None,
    color: str = "black",
    zorder: float = 3.0,
) -> None:
    """Write centred words on a white ground, so that no line runs through them."""
    ground = {"boxstyle": "square,pad=0.12", "facecolor": "white", "edgecolor": "none"}
    size = fontsize or mpl.rcParams["legend.fontsize"]
    look: Any = {"bbox": ground, "fontsize": size, "color": color, "zorder": zorder}
    ax.text(x, y, text, ha="center", va="center", **look)


def note(ax: Axes, text: str) -> None:
    """Write grey words into the upper right corner, below those that are there."""
    size = mpl.rcParams["legend.fontsize"]
    above = _notes(ax)
    words = "\n".join([*(each.get_text() for each in above), text])
    for each in above:
        each.remove()
    ground = {"boxstyle": "square,pad=0.12", "facecolor": "white", "edgecolor": "none"}
    place: Any = {"transform": ax.transAxes, "ha": "right", "va": "top", "bbox": ground}
    ax.text(0.98, 0.97, words, fontsize=size, color=GREY, gid=NOTE, **place)


def has_note(ax: Axes) -> bool:
    """Return whether there are words of :func:`note`."""
    return bool(_notes(ax))


def _notes(ax: Axes) -> list[Text]:
    return [each for each in ax.texts if each.get_gid() == NOTE]


NOTE = "note"
