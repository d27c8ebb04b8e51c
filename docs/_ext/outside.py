"""Pages of what lies outside of this folder: measured results, the changelog, how to get help.

They are copied when the documentation is built, with their links turned; and links of the pages to
them, written as a code host understands them, lead to the copies.
"""

import os
import re
from pathlib import Path

from sphinx.application import Sphinx
from sphinx.config import Config

DOCS = Path(__file__).parents[1]
ROOT = DOCS.parent
COPIES = "copied"  # the folder of the copies, within this one
LINK = re.compile(r"(\]\()(?!\w+:|#)([^)\s#]+)")


def copies() -> dict[Path, Path]:
    """Return where the copy of each file lies."""
    of_root = sorted(path for path in ROOT.glob("*.md") if path.stem != "README")
    found = {path: DOCS / COPIES / path.name.lower() for path in of_root}
    for path in sorted(ROOT.glob("results/*/*.md")):
        name = path.parent.name if path.stem == "README" else f"{path.parent.name}-{path.stem}"
        found[path] = DOCS / COPIES / "results" / f"{name}.md"
    return found


def turned(text: str, place: Path, page: Path) -> str:
    """Turn the relative links of a text that is written for ``place`` to those of ``page``."""
    known = {ROOT / "README.md": DOCS / "index.md", **copies()}

    def link(match: re.Match[str]) -> str:
        target = Path(os.path.normpath(place / match[2]))
        target = known.get(target, target)
        return match[1] + os.path.relpath(target, page.parent).replace(os.sep, "/")

    return LINK.sub(link, text)


def copy(app: Sphinx, config: Config) -> None:
    """Write the copies that are new, so that a second build reads only those again."""
    (DOCS / COPIES / "results").mkdir(parents=True, exist_ok=True)
    for path, page in copies().items():
        text = turned(path.read_text("utf-8"), path.parent, page)
        if not page.is_file() or page.read_text("utf-8") != text:
            page.write_text(text, "utf-8")


def lead_to_copies(app: Sphinx, docname: str, source: list[str]) -> None:
    """Turn the links of a page to what was copied."""
    page = Path(app.env.doc2path(docname))
    if page.suffix == ".md" and DOCS / COPIES not in page.parents:
        source[0] = turned(source[0], page.parent, page)


def setup(app: Sphinx) -> dict[str, bool]:
    """Copy before pages are read."""
    app.connect("config-inited", copy)
    app.connect("source-read", lead_to_copies)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
