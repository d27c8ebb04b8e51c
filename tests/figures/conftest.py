"""Figures of the tests, as they would be saved."""

import pytest

from reading import keep_figures


@pytest.fixture
def drawn(monkeypatch):
    """Every figure that would be saved; nothing is written."""
    return keep_figures(monkeypatch)
