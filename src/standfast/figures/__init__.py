"""Arrays to matplotlib: each function draws into the axes that it is given and returns them.

No model is evaluated and nothing is read here. Curves differ in line style and are labelled where
they run, so that a figure reads in grey; the few colours are those of Okabe & Ito, which are safe
for colour-blind readers.
"""

from standfast.figures.population import (
    risk_by_multiple,
    risk_map,
    sobol_bars,
    survival_curve,
)
from standfast.figures.standing import (
    frequency_against_bmi,
    quantity_curves,
    quantity_map,
    root_locus,
    stability_contours,
    stick_figure,
    strategy_regions,
)
from standfast.figures.style import (
    BLUE,
    COLUMN,
    GREY,
    STYLE,
    VERMILION,
    WHITE_GROUND,
    label_together,
    paper_figure,
    remark,
    save,
)

__all__ = [
    "BLUE",
    "COLUMN",
    "GREY",
    "STYLE",
    "VERMILION",
    "WHITE_GROUND",
    "frequency_against_bmi",
    "label_together",
    "paper_figure",
    "quantity_curves",
    "quantity_map",
    "remark",
    "risk_by_multiple",
    "risk_map",
    "root_locus",
    "save",
    "sobol_bars",
    "stability_contours",
    "stick_figure",
    "strategy_regions",
    "survival_curve",
]
