"""Look at the built site: links within it lead somewhere, nothing is loaded from elsewhere."""

from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

from sphinx.application import Sphinx
from sphinx.util import logging

LOADED = {("img", "src"), ("script", "src"), ("iframe", "src"), ("link", "href"), ("source", "src")}
LAST = 900  # after what other extensions add to the site


class Page(HTMLParser):
    """What a page links to and loads, and the anchors that it has."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.links: list[tuple[str, bool]] = []
        self.anchors: set[str] = set()
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Note the links and anchors of a tag."""
        for name, value in attrs:
            if name in {"id", "name"} and value:
                self.anchors.add(value)
            elif name in {"href", "src"} and value:
                self.links.append((value, (tag, name) in LOADED))


def broken_links(site: Path) -> list[str]:
    """Return a sentence for each link that leads nowhere, or loads from another host."""
    paths = [path for path in sorted(site.rglob("*.html")) if "_static" not in path.parts]
    pages = {path: Page(path.read_text("utf-8")) for path in paths}
    found = []
    for path, page in pages.items():
        for link, loads in page.links:
            parts = urlsplit(link)
            if parts.scheme or parts.netloc:
                if loads and parts.scheme != "data":
                    found.append(f"{path.relative_to(site)} loads {link}")
                continue
            target = (path.parent / unquote(parts.path)).resolve() if parts.path else path
            target = target / "index.html" if target.is_dir() else target
            if not target.exists():
                found.append(f"{path.relative_to(site)} links to {link}, which is not there")
            elif parts.fragment and unquote(parts.fragment) not in anchors(pages, target):
                found.append(f"{path.relative_to(site)} links to {link}: no such anchor")
    return found


def anchors(pages: dict[Path, Page], target: Path) -> set[str]:
    """Return the anchors of a page that a link may name; of what is no page, none."""
    return pages[target].anchors if target in pages else set()


def check(app: Sphinx, error: Exception | None) -> None:
    """Warn of what is broken, which fails a build with ``-W``."""
    if error is None and app.builder.format == "html":
        for sentence in broken_links(Path(app.outdir).resolve()):
            logging.getLogger(__name__).warning(sentence)


def setup(app: Sphinx) -> dict[str, bool]:
    """Check when all is written."""
    app.connect("build-finished", check, priority=LAST)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
