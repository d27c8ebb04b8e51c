"""Integrals of densities over all frequencies, of many persons at once, to a given accuracy.

(1/2π) ∫ S(ω) dω = (1/π) ∫₀^∞, in ω = Ω t/(1 − t) over 0 ≤ t < 1, Ω above all crossings.

1. Up to W by the Gauss-Kronrod rule of 15 points on intervals of t. Where the rule of seven points
   is too far off the interval is halved, round by round. A peak of a mode that hardly any damping
   makes wide could lie between two points unseen: det H⁻¹ turns by π there, and so is asked as
   well, and an interval in which it turns too far between two points is halved too.
2. Beyond W nothing resonates, but what is fed back comes in with a phase ωτ that turns on and on.
   There the density is a function f(ω, ωτ), smooth in ω: its mean over the phase is integrated, and
   of what turns the first term of its asymptotic expansion is added,
   ∫_W^∞ g_k(ω) e^(ikωτ) dω ≈ i g_k(W) e^(ikWτ)/(kτ). If the next term matters, W is doubled.

All rows of densities that are asked share intervals, and so H: nearly all of the work is common.

notation: τ delay (s), ω angular frequency (rad/s), g_k Fourier coefficients of f over the phase.
"""

import numpy as np

from standfast.stability.delay.problem import Apply, Problem, directly, highest
from standfast.stability.sway.density import Swaying
from standfast.stability.sway.nodes import (
    PHASES,
    Rows,
    at_phases,
    mean_over_intervals,
    over_intervals,
    turning,
)

# Most that the error is thought to be, relative to the integral; and of it for an interval.
ACCURACY = 1e-9
SHARE = 1.0 / 16.0
# Ends of the first intervals: peaks lie below Ω, where t is 1/2; W is the last.
FIRST = np.array([0.0, 2.0**-6, 2.0**-5, 2.0**-4, 2.0**-3, 0.25, 0.5])
ROUNDS = 44  # an interval has been halved until float64 sees no more of it
PERSONS = 2**14  # integrated together: the last rounds are of few intervals, and cost a batch each
# Most that det H⁻¹ may turn between two points (rad): a peak between them makes it up to π.
MOST_TURN = 1.0
# The next term of the expansion, relative to the first, is at most this over Wτ: g_k ∝ ω⁻⁵ or ω⁻⁶.
STEEPEST = 6.0


def integrals(
    rows: Rows,
    swaying: Swaying,
    *,
    accuracy: float = ACCURACY,
    sizes: np.ndarray | None = None,
    apply: Apply = directly,
) -> tuple[np.ndarray, np.ndarray]:
    """Return (1/2π) ∫ of rows of densities, and whether each is that accurate, (rows, persons).

    The accuracy is relative to ``sizes``, (rows, persons), of a covariance the product of the
    deviations; or to the integrals themselves. The persons must stand: of others an integral means
    nothing, and costs much.
    """
    persons = swaying.delay.size
    found, sure = np.zeros((len(rows), persons)), np.zeros((len(rows), persons), bool)
    for first in range(0, persons, PERSONS):
        some = slice(first, first + PERSONS)
        part = Swaying(*(each[..., some] for each in swaying))
        own = None if sizes is None else np.pi * sizes[:, some]
        found[:, some], sure[:, some] = _Rounds(rows, part, accuracy, own, apply).integrated()
    return found / np.pi, sure


class _Rounds:
    """Intervals of some persons that are still to be integrated, and what is settled."""

    def __init__(
        self, rows: Rows, swaying: Swaying, accuracy: float, sizes: np.ndarray | None, apply: Apply
    ) -> None:
        self.rows, self.swaying, self.sizes, self.apply = rows, swaying, sizes, apply
        self.allowed = accuracy * SHARE
        self.scale = np.sqrt(np.asarray(apply(highest, Problem(3, 0), swaying.numbers)))
        self.done = np.zeros((len(rows), swaying.delay.size))

    def integrated(self) -> tuple[np.ndarray, np.ndarray]:
        everyone = np.arange(self.done.shape[1])
        person = np.repeat(everyone, len(FIRST) - 1)
        low, high = np.tile(FIRST[:-1], everyone.size), np.tile(FIRST[1:], everyone.size)
        whose, start = everyone, np.full(everyone.size, FIRST[-1])
        unseen = np.ones(person.size, bool)
        sure = np.ones(self.done.shape, bool)
        for _ in range(ROUNDS):
            value, error = self._up_to(person, low, high)
            unseen[unseen] = self._hides_peak(person[unseen], low[unseen], high[unseen])
            rest, rest_error = self._beyond(whose, start)
            sizes = self.sizes
            if sizes is None:
                sizes = abs(self.done + self._each(person, value) + self._each(whose, rest))
            most = self.allowed * sizes
            off, rest_off = unseen | (error > most[:, person]), rest_error > most[:, whose]
            wide, early = off.any(axis=0), rest_off.any(axis=0)
            self.done += self._each(person[~wide], value[:, ~wide])
            self.done += self._each(whose[~early], rest[:, ~early])
            if not (wide.any() or early.any()):
                return self.done, sure
            last = (person[wide], value[:, wide], off[:, wide]), (
                whose[early], rest[:, early], rest_off[:, early],
            )  # fmt: skip
            person, low, high = person[wide], low[wide], high[wide]
            whose, start = whose[early], start[early]
            halves = 0.5 * (low + high)
            further = 2.0 * start / (1.0 + start)  # where ω is twice as high
            person = np.concatenate([person, person, whose])
            low, high = (
                np.concatenate([low, halves, start]), np.concatenate([halves, high, further])
            )  # fmt: skip
            start = further
            unseen = np.concatenate([unseen[wide], unseen[wide], np.zeros(start.size, bool)])
        for who, part, open_ in last:
            self.done += self._each(who, part)
            sure &= self._each(who, open_) == 0.0
        return self.done, sure

    def _each(self, person: np.ndarray, values: np.ndarray) -> np.ndarray:
        """Add up what belongs to one person, (rows, persons)."""
        persons = self.done.shape[1]
        return np.stack([np.bincount(person, row, minlength=persons) for row in values])

    def _own(self, person: np.ndarray) -> tuple[np.ndarray, ...]:
        return tuple(each.take(person, axis=-1) for each in (*self.swaying, self.scale))

    def _up_to(self, person: np.ndarray, low: np.ndarray, high: np.ndarray) -> np.ndarray:
        """Return the integrals over intervals, and their errors, (2, rows, intervals)."""
        if not person.size:
            return np.zeros((2, len(self.rows), 0))
        return np.asarray(self.apply(over_intervals, self.rows, *self._own(person), low, high))

    def _hides_peak(self, person: np.ndarray, low: np.ndarray, high: np.ndarray) -> np.ndarray:
        """Return whether a peak may lie between two nodes of an interval."""
        if not person.size:
            return np.zeros(0, bool)
        values = np.asarray(self.apply(turning, (), *self._own(person), low, high))
        turns = np.angle(values[1:] * values[:-1].conj())
        hidden: np.ndarray = (abs(turns) > MOST_TURN).any(axis=0) & (high - low > 1e-14)
        return hidden

    def _beyond(self, person: np.ndarray, start: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the integrals from W on, and their errors, (rows, persons) each."""
        if not person.size:
            return np.zeros((len(self.rows), 0)), np.zeros((len(self.rows), 0))
        own = self._own(person)
        ends = start, np.ones_like(start)
        mean, error = np.asarray(self.apply(mean_over_intervals, self.rows, *own, *ends))
        omega = self.scale[person] * start / (1.0 - start)
        delay = self.swaying.delay[person]
        around = np.asarray(self.apply(at_phases, self.rows, *own[:-1], omega))
        orders = np.arange(1, PHASES.size // 2)[:, None]
        parts = np.exp(-1j * orders * PHASES) @ around / PHASES.size
        turned = 1j * parts * np.exp(1j * orders * omega * delay)
        over = orders * np.where(delay > 0.0, delay, np.inf)
        first = 2.0 * (turned / over).real.sum(axis=1)
        following = STEEPEST * 2.0 * (abs(parts) / (omega * over**2)).sum(axis=1)
        # what the phases do not tell from the mean is of the next orders, each smaller by a factor
        lowest, highest_told = abs(parts[:, 0]), abs(parts[:, -1])
        unseen = highest_told**2 / np.where(lowest > 0.0, lowest, 1.0) * omega
        return mean + first, abs(error) + following + unseen
