"""Equations as MathML, which browsers draw themselves: no script, nothing of another host.

MathJax would be megabytes of script and fonts to keep beside the pages. docutils converts. A
browser needs a font with a table of mathematics, without which indices stand beside the line; not
every system has one, so the pages bring STIX Two Math (Open Font License; out of the package
ziamath), less what is not needed, 0.5 MB.
"""

from importlib.resources import as_file, files
from pathlib import Path

from docutils import nodes
from docutils.utils.math import MathError
from docutils.utils.math.latex2mathml import tex2mathml
from fontTools import subset
from sphinx.application import Sphinx
from sphinx.util import logging
from sphinx.writers.html5 import HTML5Translator

FONT = "stix-two-math.woff"
# Latin, Greek, marks above letters, punctuation and arrows, operators, letters of mathematics.
NEEDED = (
    (0x20, 0x17F), (0x2B0, 0x3FF), (0x2000, 0x23FF), (0x27C0, 0x27FF), (0x2A00, 0x2AFF),
    (0x1D400, 0x1D7FF),
)  # fmt: skip


def inline(writer: HTML5Translator, node: nodes.math) -> None:
    """Write an equation within a line."""
    writer.body.append(converted(node, as_block=False))
    raise nodes.SkipNode


def block(writer: HTML5Translator, node: nodes.math_block) -> None:
    """Write an equation on lines of its own; the box scrolls on a narrow screen."""
    found = converted(node, as_block=True)
    writer.body.append(f'<div class="equation" tabindex="0">{found}</div>')
    raise nodes.SkipNode


def converted(node: nodes.Element, *, as_block: bool) -> str:
    """Return an equation as MathML; warn of one that is not understood."""
    try:
        return tex2mathml(node.astext(), as_block=as_block)
    except MathError as error:
        logging.getLogger(__name__).warning("%s: %s", error, node.astext(), location=node)
        return ""


def add_font(app: Sphinx, error: Exception | None) -> None:
    """Write the font beside the style that names it."""
    if error is not None or app.builder.format != "html":
        return
    options = subset.Options(flavor="woff", layout_features=["*"], notdef_outline=True)
    with as_file(files("ziamath") / "fonts" / "STIXTwoMath-Regular.ttf") as whole:
        font = subset.load_font(str(whole), options)
        subsetter = subset.Subsetter(options)
        subsetter.populate(unicodes=[one for first, last in NEEDED for one in range(first, last)])
        subsetter.subset(font)
        subset.save_font(font, str(Path(app.outdir) / "_static" / FONT), options)


def setup(app: Sphinx) -> dict[str, bool]:
    """Register the renderer that ``html_math_renderer`` names."""
    app.add_html_math_renderer("mathml", (inline, None), (block, None))
    app.connect("build-finished", add_font)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
