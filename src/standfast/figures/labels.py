"""Words inside a figure: the names of curves on them, and of regions within them."""

from collections.abc import Iterable, Mapping, Sequence

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.font_manager import FontProperties

from standfast.figures.style import MARKUP, remark

Curve = tuple[np.ndarray, np.ndarray]  # horizontal and vertical coordinates, NaN between lines
NOWHERE = np.empty((0, 2))

# Half of the height of a word, and of the mean width of a letter, in sizes of its font.
HALF_HEIGHT, HALF_LETTER = 0.85, 0.3

# How many of their half sizes two names are apart at least.
APART = 1.1

# Places at which a region's word is tried, a side; and how near the frame it may come.
TRIED, MARGIN = 41, 0.06


def name_curves(
    ax: Axes,
    curves: Iterable[tuple[str, Curve]],
    *,
    crowded: bool = True,
    together: bool = False,
    colors: Sequence[str] = (),
    avoid: np.ndarray = NOWHERE,
) -> np.ndarray:
    """Write each curve's name on it, where other curves and names are farthest.

    The limits and scales of the axes are set before. Unless ``crowded``, a name for which there is
    no room is left away. ``together``: where one would cover another or the frame none is written,
    and ``avoid`` is returned. ``avoid`` are places (n, 2) of other words and marks, in widths and
    heights of the frame; returned are those with the places of the names.
    """
    named = [(name, _inside(ax, curve)) for name, curve in curves]
    mark = half_size(ax, "xx")
    taken = [(place, mark) for place in avoid]  # where, and how large
    written = []
    for number, (name, curve) in enumerate(named):
        if not name or len(curve) == 0:
            continue
        size = half_size(ax, name)
        others = [other for at, (_, other) in enumerate(named) if at != number and len(other)]
        inner = np.flatnonzero(((curve > size) & (curve < 1.0 - size)).all(axis=1))
        if together and not inner.size:
            return avoid.reshape(-1, 2)
        inner = inner if inner.size else np.arange(len(curve))
        steps = inner[:: max(1, inner.size // 80)]
        clear = _clearance(curve[steps], np.concatenate([*others, NOWHERE]), size)
        free = np.full(len(steps), np.inf)  # of other names
        for place, other in taken:
            free = np.minimum(free, _clearance(curve[steps], place[None], size + other))
        if together and free.max() < 1.0:
            return avoid.reshape(-1, 2)
        if min(clear.max(), free.max()) < 1.0 and not crowded:
            continue
        # a name may lie on another curve sooner than on another name
        clear = np.where(free >= min(free.max(), APART), np.minimum(clear, free), -1.0)
        # farther than two label sizes from its neighbours a name need not be: where all is open,
        # the middle of the curve
        best = np.flatnonzero(clear >= min(clear.max(), 2.0))
        at = curve[steps[best[best.size // 2]]]
        taken.append((at, size))
        written.append((at, name, colors[number] if colors else "black"))
    for at, name, color in written:
        remark(ax, *in_data(ax, at), name, color=color)
    return np.array([place for place, _ in taken]).reshape(-1, 2)


def name_regions(
    ax: Axes, regions: Mapping[str, np.ndarray], avoid: np.ndarray, curves: Sequence[np.ndarray]
) -> np.ndarray:
    """Write a word into each region, as far as may be from its edges and from other words.

    ``regions`` are True inside, at TRIED × TRIED places (x, y) of the frame; ``avoid`` are places
    (n, 2) of other words and ``curves`` lines, (n, 2) each, in widths and heights of the frame.
    Without room a word is left away. Returns ``avoid`` with the places of the words.
    """
    steps = (np.arange(TRIED) + 0.5) / TRIED
    places = np.stack(np.meshgrid(steps, steps, indexing="ij"), axis=-1).reshape(-1, 2)
    lines = np.concatenate([NOWHERE, *curves])
    lines = lines[:: max(1, len(lines) // 400)]
    taken = avoid.reshape(-1, 2)
    for word, inside in regions.items():
        within = places[inside.ravel()]
        size = half_size(ax, word)
        frame = np.minimum(within, 1.0 - within) / (size + MARGIN)
        clear = np.minimum(_clearance(within, lines, size), _clearance(within, taken, 2.5 * size))
        clear = np.minimum(clear, frame.min(axis=1) * 2.0)
        if within.size == 0 or clear.max() < 1.0:
            continue
        # in the middle of all places that are as good as any
        best = within[clear >= min(clear.max(), 3.0)]
        at = best[np.argmin(np.abs(best - best.mean(axis=0)).sum(axis=1))]
        taken = np.concatenate([taken, at[None, :]])
        remark(ax, *in_data(ax, at), word)
    return taken


def sampled(ax: Axes, x: np.ndarray, y: np.ndarray, field: np.ndarray) -> np.ndarray:
    """Return a field (x, y) at the places of :func:`name_regions`, each from the nearest point."""
    steps = (np.arange(TRIED) + 0.5) / TRIED
    inverse = (ax.transScale + ax.transLimits).inverted()
    across, up = inverse.transform(np.column_stack([steps, steps])).T
    nearest = [
        np.searchsorted((side[1:] + side[:-1]) / 2.0, wanted)
        for side, wanted in ((x, across), (y, up))
    ]
    found: np.ndarray = field[np.ix_(*nearest)]
    return found


def in_frame(ax: Axes, points: np.ndarray) -> np.ndarray:
    """Return points (n, 2) in widths and heights of the frame."""
    found: np.ndarray = (ax.transScale + ax.transLimits).transform(points)
    return found


def _inside(ax: Axes, curve: Curve) -> np.ndarray:
    points = np.column_stack(curve)
    points = in_frame(ax, points[np.isfinite(points).all(axis=1)]) if len(points) else points
    return points[((points > -0.01) & (points < 1.01)).all(axis=1)]


def in_data(ax: Axes, place: np.ndarray) -> tuple[float, float]:
    """Return a place in widths and heights of the frame as coordinates of the data."""
    across, up = (ax.transScale + ax.transLimits).inverted().transform(place)
    return float(across), float(up)


def half_size(ax: Axes, word: str) -> np.ndarray:
    """Return half of the size of a word, in widths and heights of the frame."""
    box = ax.get_window_extent()
    points = 72.0 / ax.figure.dpi * np.array([box.width, box.height])
    size = FontProperties(size=mpl.rcParams["legend.fontsize"]).get_size_in_points()
    letters = len(MARKUP.sub("", word)) + 1
    half: np.ndarray = size * np.array([HALF_LETTER * letters, HALF_HEIGHT]) / points
    return half


def _clearance(points: np.ndarray, obstacles: np.ndarray, size: np.ndarray) -> np.ndarray:
    """Return how many label sizes away the nearest obstacle of each point lies."""
    if len(obstacles) == 0:
        return np.full(len(points), np.inf)
    away = np.abs(points[:, None, :] - obstacles[None, :, :]) / size
    nearest: np.ndarray = away.max(axis=2).min(axis=1)
    return nearest
