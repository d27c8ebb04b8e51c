"""Equations as MathML, which browsers draw themselves: no script, no font of another host.

MathJax would be megabytes of script and fonts to keep beside the pages. docutils converts.
"""

from docutils import nodes
from docutils.utils.math import wrap_math_code
from docutils.utils.math.latex2mathml import tex2mathml
from sphinx.application import Sphinx
from sphinx.writers.html5 import HTML5Translator


def inline(writer: HTML5Translator, node: nodes.math) -> None:
    """Write an equation within a line."""
    writer.body.append(tex2mathml(node.astext()))
    raise nodes.SkipNode


def block(writer: HTML5Translator, node: nodes.math_block) -> None:
    """Write an equation on lines of its own; the box scrolls on a narrow screen."""
    found = tex2mathml(wrap_math_code(node.astext(), as_block=True), as_block=True)
    writer.body.append(f'<div class="equation" tabindex="0">{found}</div>')
    raise nodes.SkipNode


def setup(app: Sphinx) -> dict[str, bool]:
    """Register the renderer that ``html_math_renderer`` names."""
    app.add_html_math_renderer("mathml", (inline, None), (block, None))
    return {"parallel_read_safe": True, "parallel_write_safe": True}
