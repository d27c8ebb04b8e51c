"""Figures of the tests, as they are saved."""

import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg

from standfast.figures import style


@pytest.fixture
def drawn(monkeypatch):
    """Every figure that is saved, as it was saved."""
    seen = []
    save = style.save

    def keep(figure, stem, formats=("png",)):
        FigureCanvasAgg(figure).draw()
        seen.append(figure)
        return save(figure, stem, formats)

    monkeypatch.setattr(style, "save", keep)
    return seen
