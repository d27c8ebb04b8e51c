"""Chromium, driven by Playwright, and what a page does in it beside what it shows."""

import os
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field

import pytest
from playwright.sync_api import Browser, Page, sync_playwright

# The first has no window of its own and opens a page with half of the work.
NAMES = ("chromium-headless-shell", "chromium", "chromium-browser", "google-chrome")
# As root it runs without a sandbox; and it calls nobody of its own accord.
ARGUMENTS = (
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
)


@dataclass(frozen=True)
class BrowserPage:
    """A page with the errors of its console, uncaught ones too, and all addresses it asked for."""

    page: Page
    console_errors: list[str] = field(default_factory=list)
    requests: list[str] = field(default_factory=list)


def executable() -> str | None:
    """Path of the first browser that is installed."""
    return next((path for name in NAMES if (path := shutil.which(name))), None)


def required_executable() -> str:
    """The browser's path; without one the test skips, or fails where a browser is required."""
    if path := executable():
        return path
    absent = f"no browser: none of {', '.join(NAMES)} is on the PATH"
    if os.environ.get("STANDFAST_BROWSER") == "required":
        pytest.fail(absent)
    pytest.skip(absent)


@contextmanager
def running_browser() -> Iterator[Browser]:
    path = required_executable()
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(
            executable_path=path, headless=True, args=list(ARGUMENTS)
        )
        yield browser
        browser.close()


@contextmanager
def new_page(browser: Browser) -> Iterator[BrowserPage]:
    """An empty page with storage and downloads of its own."""
    context = browser.new_context(locale="en-US", viewport={"width": 1280, "height": 800})
    watched = BrowserPage(context.new_page())
    context.on("request", lambda request: watched.requests.append(request.url))
    context.on("weberror", lambda raised: watched.console_errors.append(str(raised.error)))
    context.on(
        "console",
        lambda said: said.type == "error" and watched.console_errors.append(said.text),
    )
    yield watched
    context.close()
