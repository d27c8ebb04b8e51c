"""Figures from Python: a function for each kind, into axes of one's own or new ones.

Each returns the axes; with ``ax=None`` they are of a new figure of pyplot. The caller's settings of
matplotlib hold and stay. ``standfast plot`` draws by the same functions.
"""

from standfast.figures.along import curves_of as curves
from standfast.figures.along import locus_of as locus
from standfast.figures.limits import limits
from standfast.figures.maps import map_of as map  # noqa: A004 - called as sf.plot.map
from standfast.figures.population_charts import (
    drivers,
    risk_by_multiple,
    risk_map,
    standing_by_delay,
    survival,
)
from standfast.figures.spectra import sway_spectrum

__all__ = [
    "curves",
    "drivers",
    "limits",
    "locus",
    "map",
    "risk_by_multiple",
    "risk_map",
    "standing_by_delay",
    "survival",
    "sway_spectrum",
]
