"""Bodies of fewer links than three, as the literature gives them: :class:`Body` with rigid joints.

A rigid joint takes its row and column out of A and C, so a pendulum is a body whose knee and hip
are rigid, and a leg with a trunk one whose knee is. How the parts of a link are cut is free then.

notation: m mass, J inertia about the ankle, I about the centre of mass, h height, g gravity.
"""

import math
from typing import NamedTuple

from standfast.anthropometry.body import Body

# A point mass cannot be cut into segments that have inertia; it is taken this much heavier, and
# lower, which leaves J and m g h as they are.
NO_POINT = 1.001


class OneLink(NamedTuple):
    """A pendulum about the ankle: mass (kg), J (kg·m²) and m g h (N·m/rad)."""

    mass: float
    inertia: float
    load: float

    def body(self, gravity: float) -> Body:
        """Return the body that knee and hip, being rigid, make one pendulum of.

        A third of the mass each at h − d, h and h + d. One half of what J has beyond m h² is in d,
        the other in the segments' own inertia, so that A₁₁ = J and the load is m g h.
        """
        moment = self.load / gravity  # m h
        mass = max(self.mass, NO_POINT * moment**2 / self.inertia)
        height = moment / mass
        beyond = self.inertia - mass * height**2
        d = math.sqrt(0.75 * beyond / mass)
        return Body(
            segment_mass=(mass / 3.0,) * 3,
            segment_inertia=(beyond / 6.0,) * 3,
            segment_length=(height - 0.5 * d, d),
            segment_com=(height - d, 0.5 * d, 0.5 * d),
        )


class TwoLinks(NamedTuple):
    """Leg and trunk, for ankle and hip, both legs together.

    Masses (kg), inertias about their own centres of mass (kg·m²), heights of these above the lower
    end (m), each of leg and trunk; and the length of the leg (m).
    """

    mass: tuple[float, float]
    inertia: tuple[float, float]
    com: tuple[float, float]
    leg: float

    def body(self) -> Body:
        """Return the body that the knee, being rigid, makes two links of.

        The knee lies at the leg's centre of mass; half of the leg's mass each is d below and above
        it. One half of the leg's inertia is in d, the other in shank and thigh.
        """
        (leg, trunk), (i_leg, i_trunk), (e_leg, e_trunk) = self.mass, self.inertia, self.com
        d = math.sqrt(0.5 * i_leg / leg)
        return Body(
            segment_mass=(0.5 * leg, 0.5 * leg, trunk),
            segment_inertia=(0.25 * i_leg, 0.25 * i_leg, i_trunk),
            segment_length=(e_leg, self.leg - e_leg),
            segment_com=(e_leg - d, d, e_trunk),
        )
