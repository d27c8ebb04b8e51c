"""One browser for the tests of a file, and a fresh page for each of them."""

import pytest

from browser import new_page, running_browser


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
