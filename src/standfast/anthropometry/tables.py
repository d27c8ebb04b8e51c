"""Segment parameters from the literature, as fractions of body mass, stature and segment length."""

import math
from typing import NamedTuple


class SegmentRow(NamedTuple):
    """One row of a table of segment parameters; fractions, so without units.

    ``mass`` is of one limb, as a fraction of body mass; ``length`` a fraction of stature; ``com``
    a fraction of the segment's length, from the end named in ``com_from``; ``gyration`` the radius
    of gyration about the centre of mass and the medio-lateral axis, a fraction of the length.
    """

    limbs: int
    mass: float
    length: float
    com: float
    com_from: str
    gyration: float

    @property
    def total_mass(self) -> float:
        """Mass of all limbs of this kind."""
        return self.limbs * self.mass

    @property
    def com_above_lower_end(self) -> float:
        """Centre of mass above the lower end, a fraction of stature."""
        return self.length * (self.com if self.com_from == "lower" else 1.0 - self.com)

    @property
    def inertia(self) -> float:
        """Inertia of all limbs about their own centre of mass, a fraction of mass · stature²."""
        return self.total_mass * (self.gyration * self.length) ** 2

    @property
    def mass_com_inertia(self) -> tuple[float, float, float]:
        """What :func:`upper_body` returns of several segments."""
        return self.total_mass, self.com_above_lower_end, self.inertia


# The ankle joint above the floor, a fraction of stature (Drillis & Contini, in Winter, figure 4.1).
ANKLE_HEIGHT = 0.039

# Dempster's cadaver data in the form of D. A. Winter, Biomechanics and Motor Control of Human
# Movement, Table 4.1 and the segment lengths of Drillis & Contini (figure 4.1). HAT = head, arms
# and trunk; its fractions are of the distance from greater trochanter to shoulder, 0.288 of
# stature, not of the whole height above the hip.
WINTER = {
    "shank": SegmentRow(2, 0.0465, 0.246, 0.567, "lower", 0.302),
    "thigh": SegmentRow(2, 0.100, 0.245, 0.567, "lower", 0.323),
    "upper body": SegmentRow(1, 0.678, 0.288, 0.626, "lower", 0.496),
}

# P. de Leva, J Biomech 29 (1996) 1223-1230, table 4; lengths as fractions of his mean statures.
# Radii of gyration are his "transverse" ones: sagittal motion turns about the medio-lateral axis.
# The trunk reaches from mid-hip to cervicale, the head from there to the vertex.
DE_LEVA = {
    "de-leva-male": {
        "shank": SegmentRow(2, 0.0433, 0.2529, 0.4395, "upper", 0.246),
        "thigh": SegmentRow(2, 0.1416, 0.2425, 0.4095, "upper", 0.329),
        "trunk": SegmentRow(1, 0.4346, 0.34652, 0.5138, "upper", 0.306),
        "head": SegmentRow(1, 0.0694, 0.13952, 0.4998, "lower", 0.315),
        "upper arm": SegmentRow(2, 0.0271, 0.16180, 0.5772, "upper", 0.269),
        "forearm": SegmentRow(2, 0.0162, 0.15445, 0.4574, "upper", 0.265),
        "hand": SegmentRow(2, 0.0061, 0.04951, 0.7900, "upper", 0.513),
    },
    "de-leva-female": {
        "shank": SegmentRow(2, 0.0481, 0.2528, 0.4352, "upper", 0.263),
        "thigh": SegmentRow(2, 0.1478, 0.21239, 0.3612, "upper", 0.364),
        "trunk": SegmentRow(1, 0.4257, 0.35435, 0.4964, "upper", 0.292),
        "head": SegmentRow(1, 0.0668, 0.14046, 0.5159, "lower", 0.295),
        "upper arm": SegmentRow(2, 0.0255, 0.15856, 0.5754, "upper", 0.260),
        "forearm": SegmentRow(2, 0.0138, 0.15233, 0.4559, "upper", 0.257),
        "hand": SegmentRow(2, 0.0056, 0.04496, 0.7474, "upper", 0.454),
    },
}
# Mid-shoulder above mid-hip (same table, trunk MIDS-MIDH), of stature: where the arms hang.
SHOULDER = {"de-leva-male": 0.29609, "de-leva-female": 0.28697}


def upper_body(model: str) -> tuple[float, float, float]:
    """Compose trunk, head and hanging arms of a de Leva model by the parallel-axis theorem.

    Returns mass (of body mass), centre of mass above the hip (of stature) and inertia about that
    centre (of mass · stature²). The arms hang straight down from the shoulder.
    """
    table = DE_LEVA[model]
    elbow = SHOULDER[model] - table["upper arm"].length
    wrist = elbow - table["forearm"].length
    lower_ends = {
        "trunk": 0.0,
        "head": table["trunk"].length,
        "upper arm": elbow,
        "forearm": wrist,
        "hand": wrist - table["hand"].length,
    }
    heights = {part: low + table[part].com_above_lower_end for part, low in lower_ends.items()}
    mass = math.fsum(table[part].total_mass for part in heights)
    com = math.fsum(table[part].total_mass * height for part, height in heights.items()) / mass
    inertia = math.fsum(
        table[part].inertia + table[part].total_mass * (height - com) ** 2
        for part, height in heights.items()
    )
    return mass, com, inertia
