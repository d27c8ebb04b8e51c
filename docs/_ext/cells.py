"""Cells of notebooks as a reader meets them: commands as in a terminal, files under their names."""

from docutils import nodes
from sphinx.application import Sphinx


def show(app: Sphinx, doctree: nodes.document) -> None:
    """Take the magic out of cells of commands, and name the file that a cell writes."""
    for block in list(doctree.findall(nodes.literal_block)):
        magic, _, text = block.astext().partition("\n")
        if magic == "%%sh":
            lines = [line if line.startswith("  ") else f"$ {line}" for line in text.splitlines()]
            replace(block, "\n".join(lines), "console")
        elif magic.startswith("%%writefile "):
            name = magic.split()[1]
            replace(block, text, "toml" if name.endswith(".toml") else "text")
            caption = nodes.paragraph("", "", nodes.literal("", name), classes=["file-name"])
            block.parent.insert(block.parent.index(block), caption)


def replace(block: nodes.literal_block, text: str, language: str) -> None:
    """Show another text in a block."""
    block["language"] = language
    block.rawsource = text
    block.children = [nodes.Text(text)]
    block.children[0].parent = block


def setup(app: Sphinx) -> dict[str, bool]:
    """Look at each page once it is read."""
    app.connect("doctree-read", show)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
