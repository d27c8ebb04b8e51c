"""What looks at the built documentation finds what is broken."""

import importlib.util
from pathlib import Path

import pytest

EXTENSIONS = Path(__file__).parents[1] / "docs" / "_ext"


@pytest.fixture
def broken_links():
    pytest.importorskip("sphinx", reason="needs the extra docs")
    spec = importlib.util.spec_from_file_location("site_check", EXTENSIONS / "site_check.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module.broken_links


def test_links_that_lead_nowhere_and_foreign_content_are_found(broken_links, tmp_path):
    (tmp_path / "deep").mkdir()
    (tmp_path / "index.html").write_text(
        '<h1 id="top"></h1><a href="deep/a.html#there">a</a><a href="#top">up</a>'
        '<a href="https://example.org">outside</a><img src="data:image/png;base64,">'
    )
    good = '<p id="there"></p><a href="../index.html">home</a>'
    (tmp_path / "deep" / "a.html").write_text(good)
    assert broken_links(tmp_path) == []
    (tmp_path / "deep" / "a.html").write_text(
        '<a href="b.html">no page</a><a href="../index.html#bottom">no anchor</a>'
        '<script src="https://example.org/x.js"></script>'
    )
    page, anchor, loaded, first = broken_links(tmp_path)
    assert "no such anchor" in first
    assert "b.html, which is not there" in page
    assert "#bottom: no such anchor" in anchor
    assert "loads https://example.org/x.js" in loaded
