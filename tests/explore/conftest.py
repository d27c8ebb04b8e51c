"""One browser for the tests of a file, a fresh page for each of them, and two pages to open."""

import pytest

from browser import new_page, running_browser
from explore_content import embedded_content, springs_content
from explore_page import ready
from standfast.explore.page import page_html


@pytest.fixture(scope="module")
def browser():
    # Not for the session: while Playwright runs, no other test of the process may run asyncio.
    with running_browser() as started:
        yield started


@pytest.fixture
def browser_page(browser):
    """A ``BrowserPage``: ``page`` of Playwright, ``console_errors``, ``requests``."""
    with new_page(browser) as watched:
        yield watched


@pytest.fixture(scope="session")
def springs_file(tmp_path_factory):
    return written(tmp_path_factory, springs_content())


@pytest.fixture(scope="session")
def atlas_file(tmp_path_factory):
    return written(tmp_path_factory, embedded_content())


def written(factory, content):
    path = factory.mktemp("page") / "page.html"
    path.write_text(page_html(content), encoding="utf-8")
    return path


@pytest.fixture
def opened(browser_page):
    """Open a page at some state; it must be quiet and ask for nothing."""

    def open_page(path, state="", *, still=True, dark=False, size=(1400, 900)):
        page = browser_page.page
        page.set_viewport_size({"width": size[0], "height": size[1]})
        page.emulate_media(
            color_scheme="dark" if dark else "light",
            reduced_motion="reduce" if still else "no-preference",
        )
        page.goto(f"{path.as_uri()}{'#' if state else ''}{state}")
        ready(page)
        return page

    yield open_page
    assert browser_page.console_errors == []
    assert {address.split(":")[0] for address in browser_page.requests} <= {"file", "data", "blob"}
