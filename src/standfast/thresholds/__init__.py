"""Thresholds of standing: critical surfaces in closed form, contours out of a stored atlas.

On a plane of ankle × hip stiffness the limit of standing is one falling curve. Closed form gives it
exactly for any study; an atlas gives it again from what it stores.
"""

from standfast.thresholds.closed_form import critical_ankles, critical_hips, limit_of_standing
from standfast.thresholds.contours import Contour, exact_contours, extracted_contours, source_of
from standfast.thresholds.planes import (
    ANKLE,
    HIP,
    KNEE,
    PLANE_AXES,
    Plane,
    has_plane,
    plane_at,
    planes_of,
)
from standfast.thresholds.tables import write_tables

__all__ = [
    "ANKLE",
    "HIP",
    "KNEE",
    "PLANE_AXES",
    "Contour",
    "Plane",
    "critical_ankles",
    "critical_hips",
    "exact_contours",
    "extracted_contours",
    "has_plane",
    "limit_of_standing",
    "plane_at",
    "planes_of",
    "source_of",
    "write_tables",
]
