"""What follows from the crossings of some persons at any delay: one table, all delays.

Between two crossings the number of unstable roots stays. So a verdict along the delay is a
comparison with a few numbers, and the delays of a study cost next to nothing once the table is
there.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from standfast.numerics.arrays import TURN

CROSSING = 1.0 + 1e-12  # ratio of delays that a crossing's rounding does not tell apart
BESIDE = CROSSING**3  # from any delay that is taken for a crossing's to one that is not


@dataclass(frozen=True, slots=True, eq=False)
class Crossings:
    """The crossings of some persons, and their unstable roots without delay.

    Attributes
    ----------
    unstable : (persons,)
        roots with a positive real part without delay.
    on_axis, neutral, uncertain : (persons,), bool
        whether roots lie on the axis without delay; whether 0 is a root, at every delay then;
        where rounding leaves anything open.
    by_springs : (persons,), bool
        whether nothing is fed back: then the person stands if C is positive definite, whatever
        lies on the axis, and roots to the right are the negative eigenvalues of C.
    person, frequency, angle, direction : (crossings,)
        whose, ω (rad/s), θ (rad, 0 ≤ θ < 2π), +1 to the right or −1 as the delay grows; the root
        iω lies on the axis for the delays (θ + 2πk)/ω.
    """

    unstable: np.ndarray
    on_axis: np.ndarray
    neutral: np.ndarray
    uncertain: np.ndarray
    by_springs: np.ndarray
    person: np.ndarray
    frequency: np.ndarray
    angle: np.ndarray
    direction: np.ndarray

    def critical_delay(self) -> np.ndarray:
        """Return the smallest delay at which stability is lost (s); 0 without any, inf if never."""
        delay = np.full(len(self.unstable), np.inf)
        to_right = self.direction > 0.0
        first = self.angle[to_right] / self.frequency[to_right]
        np.minimum.at(delay, self.person[to_right], first)
        delay[(self.unstable > 0) | self.on_axis | self.neutral] = 0.0
        return delay

    def unstable_each(self, delay: np.ndarray) -> np.ndarray:
        """Return the number of roots with a positive real part, each person at its own delay."""
        turns = delay[self.person] * self.frequency - self.angle
        passed = np.maximum(np.ceil(turns / TURN), 0.0)
        change = 2.0 * passed * self.direction
        found = np.bincount(self.person, change, minlength=len(self.unstable))
        return self.unstable + np.rint(found).astype(np.int32)

    def stable_each(self, delay: np.ndarray) -> np.ndarray:
        """Return whether each person stands at its own delay, bool, as :meth:`stable_at`."""
        stable: np.ndarray = (self.unstable_each(delay) == 0) & ~self.neutral
        stable &= ~self.on_axis | (delay > 0.0)
        own = delay[self.person]
        turns = np.maximum(np.rint((own * self.frequency - self.angle) / TURN), 0.0)
        crossing = (self.angle + turns * TURN) / self.frequency
        on_axis = (crossing / CROSSING <= own) & (own <= crossing * CROSSING)
        stable[self.person[on_axis]] = False
        return stable

    def unstable_at(self, delays: np.ndarray) -> np.ndarray:
        """Return the number of roots with a positive real part, (persons, rising delays)."""
        places = len(delays) + 1
        changes = np.zeros(len(self.unstable) * places, np.int16)
        changes[::places] = self.unstable
        for person, delay, change in self.passages(float(delays[-1])):
            # at the very delay of a crossing the root lies on the axis
            at = person * places + np.searchsorted(delays, delay, side="right")
            np.add.at(changes, at, change.astype(np.int16))
        return np.cumsum(changes.reshape(-1, places)[:, :-1], axis=1, dtype=np.int16)

    def stable_at(self, delays: np.ndarray) -> np.ndarray:
        """Return whether persons stand at rising delays, (persons, delays), bool.

        A delay within rounding of a crossing has roots on the axis, and does not stand.
        """
        stable: np.ndarray = self.unstable_at(delays) == 0
        stable[self.neutral] = False
        stable[self.on_axis] &= delays > 0.0
        for person, delay, _ in self.passages(float(delays[-1]) * CROSSING):
            first = np.searchsorted(delays, delay / CROSSING, side="left")
            last = np.searchsorted(delays, delay * CROSSING, side="right")
            for number in np.flatnonzero(last > first):
                stable[person[number], first[number] : last[number]] = False
        return stable

    def open_each(self, delay: np.ndarray) -> np.ndarray:
        """Return of whom rounding leaves it open at the own delay, bool, as :meth:`open_at`."""
        return self._left_open(self.stable_each, delay)

    def open_at(self, delays: np.ndarray) -> np.ndarray:
        """Return where rounding leaves the verdict open, (persons, rising delays), bool.

        That is of who is uncertain, and at the delay of a crossing beside which the person stands.
        Of who has no feedback springs decide, and nothing is open.
        """
        return self._left_open(self.stable_at, delays)

    def _left_open(
        self, stable: Callable[[np.ndarray], np.ndarray], delay: np.ndarray
    ) -> np.ndarray:
        found: np.ndarray = stable(delay / BESIDE) | stable(delay * BESIDE)
        found &= ~stable(delay)
        found[self.uncertain & ~self.by_springs] = True
        return found

    def settle(self, person: int, *, stands: bool) -> None:
        """Note for a person without feedback what exact arithmetic says: whether it stands."""
        self.neutral[person] = False
        self.uncertain[person] = False
        self.unstable[person] = 0 if stands else max(self.unstable[person], 1)

    def passages(self, longest: float) -> Iterator[tuple[np.ndarray, np.ndarray, np.ndarray]]:
        """Give persons, delays up to ``longest`` at which roots cross, and ±2, turn by turn."""
        person, frequency, angle = self.person, self.frequency, self.angle
        change = 2.0 * self.direction
        while person.size:
            delay = angle / frequency
            reached = delay <= longest
            person, frequency, change = person[reached], frequency[reached], change[reached]
            angle = angle[reached] + TURN
            yield person, delay[reached], change
