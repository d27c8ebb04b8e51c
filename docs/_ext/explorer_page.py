"""The page of ``standfast explore``, exported beside the documentation's pages."""

import subprocess
from pathlib import Path

from sphinx.application import Sphinx

NAME = "explorer.html"


def export(app: Sphinx, error: Exception | None) -> None:
    """Export the page of a nominal adult into the site."""
    if error is None and app.builder.format == "html":
        page = Path(app.outdir) / NAME
        page.unlink(missing_ok=True)
        subprocess.run(["standfast", "explore", "--export", str(page)], check=True)


def setup(app: Sphinx) -> dict[str, bool]:
    """Export when all pages are written."""
    app.connect("build-finished", export)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
