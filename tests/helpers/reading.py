"""What a reader sees of a figure: its words, whether they are legible, and nothing on another."""

import itertools

from matplotlib.backends.backend_agg import FigureCanvasAgg

from standfast.figures import style

SMALLEST_TEXT = 6.0  # points, at the size in which the figure is printed


def keep_figures(patch):
    """Return the list of figures that would be saved, laid out as for saving; none is written."""
    seen = []

    def keep(figure, stem, formats=("png",)):
        figure.draw_without_rendering()
        figure.set_layout_engine("none")  # what is saved is laid out once, as Matplotlib does it
        seen.append(figure)
        return [stem.with_name(f"{stem.name}.{suffix}") for suffix in formats]

    patch.setattr(style, "save", keep)
    return seen


def texts(figure):
    """Every text that is drawn, with its box; ticks beyond the axes exist but are not drawn."""
    canvas = FigureCanvasAgg(figure)
    figure.draw_without_rendering()
    found = [text for legend in figure.legends for text in legend.get_texts()]
    for ax in figure.axes:
        if not ax.axison:
            continue
        found += [*ax.texts, ax.title, ax.xaxis.label, ax.yaxis.label]
        found += ax.get_legend().get_texts() if ax.get_legend() else []
        for axis in (ax.xaxis, ax.yaxis):
            low, high = sorted(axis.get_view_interval())
            found += [
                tick.label1 for tick in axis.get_major_ticks() if low <= tick.get_loc() <= high
            ]
    found += [text for text in (figure._supxlabel, figure._supylabel) if text is not None]
    for text in found:
        if text.get_visible() and text.get_text().strip():
            yield text, text.get_window_extent(canvas.get_renderer())


def check_legible(figures):
    """Every text is large enough, inside its figure, and on no other."""
    for figure in figures:
        width, height = figure.canvas.get_width_height()
        boxes = []
        for text, box in texts(figure):
            assert text.get_fontsize() >= SMALLEST_TEXT
            assert box.x0 >= -1 and box.y0 >= -1, text.get_text()  # noqa: PT018
            assert box.x1 <= width + 1 and box.y1 <= height + 1, text.get_text()  # noqa: PT018
            boxes.append((text.get_text(), box.shrunk(0.9, 0.8)))
        for (one, a), (other, b) in itertools.combinations(boxes, 2):
            assert not a.overlaps(b), f"{one!r} lies on {other!r}"
