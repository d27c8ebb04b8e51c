"""A law on a person's body, of which noise, gains and delay are open: points, and what they mean.

The law's stiffness, damping and gains are multiples of m g h of its own body; on another body they
are the same multiples of that body's. Of the gains all proportional ones have one factor p, all
derivative ones one factor d. A point holds log σ, log(p − p₀), log d and log τ of what is open;
below p₀ the person falls at any damping, because det(C + p P) is 0 there.

notation: C stiffness less gravity, P and D gains of the law, τ delay, σ noise.
"""

from typing import Any, NamedTuple

import numpy as np
from scipy import linalg

from standfast.anthropometry.body import Body
from standfast.mechanics.law import Law
from standfast.mechanics.matrices import joint_gravity
from standfast.parameters import DAMPING_UNIT, JOINTS, STIFFNESS_UNIT
from standfast.stability.delay.persons import all_crossings, all_rightmost
from standfast.stability.feedback import numbers_of
from standfast.stability.sway.density import Swaying
from standfast.stability.sway.person import swaying_alone
from standfast.stability.sway.responses import Change

NOISE, PROPORTIONAL, DERIVATIVE, DELAY = (
    "noise", "proportional_gain", "derivative_gain", "feedback_delay",
)  # fmt: skip
OPEN = (NOISE, PROPORTIONAL, DERIVATIVE)  # what is fitted unless it is said
# How far each is looked for: as factors of the law's, of p what is above p₀; of τ in s. A p nearer
# to p₀ is slower than any recording tells.
LIMITS = {
    NOISE: (1e-6, 1e6), PROPORTIONAL: (3e-4, 10.0), DERIVATIVE: (0.03, 30.0), DELAY: (5e-3, 1.0),
}  # fmt: skip
UNITS = {
    NOISE: "N·m·√s", PROPORTIONAL: STIFFNESS_UNIT, DERIVATIVE: DAMPING_UNIT, DELAY: "s",
    "critical_delay": "s", "delay_margin": "s", "decay_rate": "1/s", "static_gain_margin": "1",
}  # fmt: skip
MARGINS = ("critical_delay", "delay_margin", "decay_rate", "static_gain_margin")


class Candidate(NamedTuple):
    """One point: the person with its noise (1 at noisy joints, not σ), and how the gains change.

    ``noise`` is log σ; ``changes`` are those of the point's other coordinates.
    """

    swaying: Swaying
    noise: float
    changes: tuple[Change, ...]


class Family(NamedTuple):
    """A law on a body, and what of it is open.

    Attributes
    ----------
    law : the law; body, gravity (m/s²) : the person
    delay : s, unless it is open
    noisy : (3,), which joints' torques are noisy
    free : what is open, in the order of a point's coordinates
    """

    law: Law
    body: Body
    gravity: float
    delay: float
    noisy: tuple[bool, ...]
    free: tuple[str, ...]

    @property
    def person(self) -> dict[str, Any]:
        """The law on this body, with its delay: arguments of a public function."""
        person = self.law.on(self.body, self.gravity)
        return {**person, "feedback": person["feedback"]._replace(delay=self.delay)}

    @property
    def numbers(self) -> tuple[np.ndarray, np.ndarray]:
        """A, B, C, P, D as (5, 3, 3, 1), and which joints are rigid, (3, 1), of the law itself."""
        return numbers_of(**self.person)


class Points(NamedTuple):
    """The points of a family: what is the same for all of them, found once."""

    family: Family
    numbers: np.ndarray
    rigid: np.ndarray
    lowest: float

    @property
    def bounds(self) -> tuple[np.ndarray, np.ndarray]:
        """The least and the largest coordinates."""
        low, high = np.log([LIMITS[name] for name in self.family.free]).T
        return low, high

    def factors(self, point: np.ndarray) -> dict[str, float]:
        """Return σ, p, d and τ, of what is not open those of the law."""
        found = {NOISE: 1.0, PROPORTIONAL: 1.0, DERIVATIVE: 1.0, DELAY: self.family.delay}
        for name, value in zip(self.family.free, np.exp(point), strict=True):
            found[name] = float(value) + (self.lowest if name == PROPORTIONAL else 0.0)
        return found

    def values(self, point: np.ndarray) -> dict[str, float]:
        """Return what is open as it is written: N·m·√s, the ankle's gains, s."""
        factors = self.factors(point)
        ankle = {PROPORTIONAL: self.numbers[3, 0, 0, 0], DERIVATIVE: self.numbers[4, 0, 0, 0]}
        return {name: factors[name] * float(ankle.get(name, 1.0)) for name in self.family.free}

    def at(self, point: np.ndarray) -> tuple[np.ndarray, float]:
        """Return A, B, C, P, D and the delay at a point."""
        factors = self.factors(point)
        numbers = self.numbers.copy()
        numbers[3] *= factors[PROPORTIONAL]
        numbers[4] *= factors[DERIVATIVE]
        return numbers, factors[DELAY]

    def _all_at(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return A, B, C, P, D, the delays, and which joints are rigid, of all points."""
        each = [self.at(point) for point in points]
        numbers = np.concatenate([own for own, _ in each], axis=-1)
        delay = np.array([late for _, late in each])
        return numbers, delay, np.repeat(self.rigid, len(each), axis=1)

    def stand(self, points: np.ndarray) -> np.ndarray:
        """Return who of points, (n, coordinates), stands, (n,).

        Whom rounding leaves open, on the boundary, does not.
        """
        numbers, delay, rigid = self._all_at(points)
        table = all_crossings(numbers, rigid)
        found: np.ndarray = table.stable_each(delay) & ~table.uncertain
        return found

    def candidate(self, point: np.ndarray, *, slopes: bool = True) -> Candidate:
        """Return the person at a point, who stands, with changes if ``slopes``."""
        numbers, delay = self.at(point)
        body, gravity, noisy = self.family.body, self.family.gravity, self.family.noisy
        swaying = swaying_alone(body, gravity, numbers, self.rigid, delay, noisy)
        factors, none = self.factors(point), np.zeros((3, 3))
        open_share = 1.0 - self.lowest / factors[PROPORTIONAL]
        each = {
            PROPORTIONAL: Change(open_share * numbers[3, ..., 0], none, 0.0),
            DERIVATIVE: Change(none, numbers[4, ..., 0], 0.0),
            DELAY: Change(none, none, delay),
        }
        changes = tuple(each[name] for name in self.family.free if slopes and name != NOISE)
        return Candidate(swaying, float(np.log(factors[NOISE])), changes)

    def margins(self, points: np.ndarray) -> dict[str, np.ndarray]:
        """Return the margins of :data:`MARGINS` of points, (n, coordinates), who stand, (n,) each.

        NaN of what is not proven.
        """
        numbers, delay, rigid = self._all_at(points)
        critical = all_crossings(numbers, rigid).critical_delay()
        root, proven = all_rightmost(numbers, rigid, delay)
        free = np.ix_(*[np.flatnonzero(~self.rigid[:, 0])] * 2)
        held = np.moveaxis((numbers[2] + numbers[3])[free], -1, 0)
        load = np.array(joint_gravity(self.family.body, self.family.gravity), float)[free]
        # K + P may be divided by s until (K + P) v = s G v has a real root s; without one by any
        shares = np.linalg.eigvals(np.linalg.solve(held + load, np.broadcast_to(load, held.shape)))
        largest = np.where(_is_real(shares), shares.real, 0.0).max(axis=-1).clip(min=0.0)
        return {
            "critical_delay": critical,
            "delay_margin": critical - delay,
            "decay_rate": np.where(proven, -root.real, np.nan),
            "static_gain_margin": np.divide(
                1.0, largest, np.full_like(largest, np.inf), where=largest > 0.0
            ),
        }


def points_of(family: Family) -> Points:
    """Return the points of a family."""
    numbers, rigid = family.numbers
    free = np.ix_(*[np.flatnonzero(~rigid[:, 0])] * 2)
    c, p = (numbers[k, ..., 0][free] for k in (2, 3))
    shares = linalg.eigvals(-c, p)
    return Points(family, numbers, rigid, max(0.0, *shares[_is_real(shares)].real))


def noisy_joints(joints: tuple[str, ...]) -> tuple[bool, ...]:
    """Return which of the three joints are named."""
    return tuple(joint in joints for joint in JOINTS)


def _is_real(roots: np.ndarray) -> np.ndarray:
    """Return which roots are real and finite."""
    real: np.ndarray = np.isfinite(roots) & (abs(roots.imag) < 1e-9 * (1.0 + abs(roots)))
    return real
