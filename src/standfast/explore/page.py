"""The page as one file: template, style and scripts, the figures of Bokeh, and BokehJS itself."""

import base64
import hashlib
import html
import re
from collections.abc import Mapping, Sequence
from importlib.resources import files
from typing import Any

import numpy as np
from bokeh.core.properties import value
from bokeh.embed import json_item
from bokeh.models import ColumnDataSource, FixedTicker, Range1d
from bokeh.models.annotations import BoxAnnotation, Span
from bokeh.plotting import figure
from bokeh.resources import Resources

from standfast.explore.content import content_text
from standfast.explore.formulas import formulas_module

FONT = "system-ui, sans-serif"
BLACK, WHITE = "#111111", "#ffffff"
LIMIT, STABLE = "#d55e00", "#0072b2"  # as in the figures of the package
LABEL: dict[str, Any] = {
    "text_baseline": "middle",
    "text_color": BLACK,
    "text_font": value(FONT),
    "text_font_size": "12px",
    "background_fill_color": WHITE,
    "background_fill_alpha": 0.85,
    "padding": 2,
}
FOLDER = files("standfast.explore") / "page"
START = "main.js"
IMPORT = re.compile(r'^import\s*\{[^}]*\}\s*from\s*"\./([\w-]+\.js)";\n', re.MULTILINE)
EXPORT = re.compile(r"^export (?=(async |function|class|const|let))", re.MULTILINE)
PLACE = re.compile(r"\{(policy|title|version|style|bokeh|content|figures|script)\}")


# How a page begins, by which one is told from a file of somebody else's.
BEGINNING = "<!doctype html><!-- a page of standfast explore -->"


def page_html(content: Mapping[str, Any]) -> str:
    """Return the page that shows some content, whole: it needs no other file and no network.

    ``content`` is what :func:`.content_of` returns. Its texts are escaped: nothing in them can be
    markup or a script.
    """
    figures = {"map": json_item(_map()), "roots": json_item(_roots())}
    bokeh = "\n".join(Resources("inline", components=["bokeh"], log_level="error").js_raw)
    own = script(scripts())
    parts = {
        "policy": policy((bokeh, own), served=content["served"]),
        "title": html.escape(str(content["title"])),
        "version": html.escape(str(content["version"])),
        "style": _text("page.css"),
        "bokeh": bokeh,
        "content": content_text(content),
        "figures": content_text(figures),
        "script": own,
    }
    return PLACE.sub(lambda place: parts[place[1]], _text("page.html"))


def policy(run: Sequence[str], *, served: bool) -> str:
    """Return what a page may do: run these scripts and no other, and ask its program if it has one.

    It stands in the page itself, so that it holds for a file too.
    """
    hashes = (hashlib.sha256(text.encode()).digest() for text in run)
    allowed = " ".join(f"'sha256-{base64.b64encode(each).decode()}'" for each in hashes)
    asked = "'self'" if served else "'none'"
    return (
        f"default-src 'none'; script-src {allowed}; style-src 'unsafe-inline'; "
        f"img-src data: blob:; connect-src {asked}; base-uri 'none'; form-action 'none'"
    )


def scripts() -> dict[str, str]:
    """Return the modules of the page by name; that of the formulas is printed now."""
    found = {
        file.name: file.read_text(encoding="utf-8")
        for file in FOLDER.iterdir()
        if file.name.endswith(".js")
    }
    return {**found, "formulas.js": formulas_module()}


def script(modules: Mapping[str, str]) -> str:
    """Return one module of all that ``main.js`` imports, each after what it imports itself.

    Top-level names of the modules must differ. ``import {a} from "./x.js";`` and the word
    ``export`` are left out.
    """
    order: list[str] = []

    def take(name: str, way: tuple[str, ...]) -> None:
        if name in way:
            raise ValueError(f"{' imports '.join((*way, name))}")
        if name not in order:
            for other in IMPORT.findall(modules[name]):
                take(other, (*way, name))
            order.append(name)

    take(START, ())
    return "\n".join(EXPORT.sub("", IMPORT.sub("", modules[name])) for name in order)


def _text(name: str) -> str:
    return (FOLDER / name).read_text(encoding="utf-8")


def _plot(name: str, **more: Any) -> figure:
    """Return an empty figure that fills its place, whose ticks the page sets."""
    plot = figure(
        name=name,
        sizing_mode="stretch_both",
        toolbar_location=None,
        x_range=Range1d(start=0.0, end=1.0),
        y_range=Range1d(start=0.0, end=1.0),
        min_border=8,
        min_border_right=20,  # half of the last mark's number
        **more,
    )
    for axis in (plot.xaxis[0], plot.yaxis[0]):
        axis.ticker = FixedTicker(ticks=[])
        axis.minor_tick_line_color = None
        axis.level = "overlay"  # which is drawn anew in a new frame alone
        axis.major_tick_in = 0
        axis.axis_label_text_font_style = "normal"
        axis.axis_label_text_font = axis.major_label_text_font = FONT
        axis.axis_label_text_font_size = "13px"
        axis.major_label_text_font_size = "12px"
    plot.grid.visible = False
    plot.border_fill_color = None
    return plot


def _source(name: str, *columns: str) -> ColumnDataSource:
    return ColumnDataSource({column: [] for column in columns}, name=name)


def _map() -> figure:
    """Return the figure of the map: image, contours, limit, subjects and the reader's point."""
    plot = _plot("map", tools="pan,wheel_zoom,tap", active_drag="pan", active_scroll="wheel_zoom")
    pixel = {"image": [np.zeros((1, 1), dtype=np.uint32)], "x": [0], "y": [0], "dw": [1], "dh": [1]}
    image = ColumnDataSource(pixel, name="image")
    plot.image_rgba("image", "x", "y", "dw", "dh", source=image, level="image")
    contours, limit = (_source(name, "xs", "ys") for name in ("contours", "limit"))
    for source, widths, color in ((contours, (2.2, 0.9), BLACK), (limit, (5.5, 3.0), LIMIT)):
        for width, ink in zip(widths, (WHITE, color), strict=True):
            plot.multi_line("xs", "ys", source=source, line_width=width, line_color=ink)
    words = _source("labels", "x", "y", "text")
    plot.text("x", "y", "text", source=words, text_align="center", **LABEL)
    subjects = _source("subjects", "x", "y", "label")
    marks: dict[str, Any] = {"fill_color": WHITE, "line_color": BLACK}
    plot.scatter("x", "y", source=subjects, marker="diamond", size=13, line_width=1.5, **marks)
    plot.text("x", "y", "label", source=subjects, x_offset=9, **LABEL)
    point = _source("point", "x", "y")
    plot.scatter("x", "y", source=point, size=17, line_width=2.5, **marks)
    plot.scatter("x", "y", source=point, size=7, fill_color=BLACK, line_color=BLACK)
    return plot


def _roots() -> figure:
    """Return the figure of the roots, in which the unstable half is shaded and hatched."""
    plot = _plot("roots", tools="")
    unstable = BoxAnnotation(
        left=0.0,
        fill_color=LIMIT,
        fill_alpha=0.12,
        line_color=None,
        hatch_pattern="right_diagonal_line",
        hatch_color=LIMIT,
        hatch_alpha=0.35,
        hatch_scale=10.0,
        level="underlay",
    )
    plot.add_layout(unstable)
    for dimension in ("height", "width"):
        plot.add_layout(Span(location=0.0, dimension=dimension, line_color="#7f868e"))
    stable, growing = (_source(name, "x", "y") for name in ("stable", "unstable"))
    plot.scatter("x", "y", source=stable, size=10, fill_color=STABLE, line_color=WHITE)
    for width, color in ((5.0, WHITE), (2.5, LIMIT)):
        plot.scatter(
            "x", "y", source=growing, marker="x", size=11, line_width=width, line_color=color
        )
    return plot
