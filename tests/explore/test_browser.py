"""The browser of the tests sees what a page does wrong, and is not skipped where it is required."""

import pytest

import browser as of_tests


def test_a_quiet_page_makes_no_error_and_asks_for_itself_alone(browser_page, tmp_path):
    (tmp_path / "page.html").write_text("<h1>Standing</h1>", encoding="utf-8")
    address = (tmp_path / "page.html").as_uri()
    browser_page.page.goto(address)
    assert browser_page.page.inner_text("h1") == "Standing"
    assert browser_page.requests == [address]
    assert browser_page.console_errors == []


def test_errors_and_requests_of_a_page_are_seen(browser_page, tmp_path):
    """Of a file beside the page the error at least: not every browser tells that it was asked."""
    address = "http://127.0.0.1:9/other.json"
    asked = f"for (const it of ['beside.json', '{address}']) fetch(it).catch(() => 0)"
    script = f"{asked}; console.error('written'); throw Error('thrown')"
    (tmp_path / "page.html").write_text(f"<script>{script}</script>", encoding="utf-8")
    page = (tmp_path / "page.html").as_uri()
    with browser_page.page.expect_event("requestfailed", lambda one: one.url == address):
        browser_page.page.goto(page)
    assert browser_page.requests[0] == page
    assert address in browser_page.requests
    said = "\n".join(browser_page.console_errors)
    assert "written" in said
    assert "thrown" in said
    assert "beside.json" in said


@pytest.mark.parametrize(
    ("said", "outcome"), [("required", pytest.fail.Exception), ("", pytest.skip.Exception)]
)
def test_without_a_browser_tests_skip_or_fail_where_it_is_required(said, outcome, monkeypatch):
    monkeypatch.setattr(of_tests.shutil, "which", lambda name: None)
    monkeypatch.setenv("STANDFAST_BROWSER", said)
    with pytest.raises(outcome, match="no browser: none of chromium-headless-shell, "):
        of_tests.required_executable()
