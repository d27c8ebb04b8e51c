"""Integrals of a density over all frequencies, of many persons at once, to a given accuracy.

(1/2π) ∫ S(ω) dω = (1/π) ∫₀^∞, in ω = Ω t/(1 − t) over 0 ≤ t < 1, Ω above all crossings.

1. Up to W by the Gauss-Kronrod rule of 15 points on intervals of t. Where the rule of seven points
   is too far off the interval is halved, round by round. A peak of a mode that hardly any damping
   makes wide could lie between two points unseen: det H⁻¹ turns by π there, and so is asked as
   well, and an interval in which it turns too far between two points is halved too.
2. Beyond W nothing resonates, but what is fed back comes in with a phase ωτ that turns on and on.
   There the density is a function f(ω, ωτ), smooth in ω: its mean over the phase is integrated, and
   of what turns the first term of its asymptotic expansion is added,
   ∫_W^∞ g_k(ω) e^(ikωτ) dω ≈ i g_k(W) e^(ikWτ)/(kτ). If the next term matters, W is doubled.

notation: τ delay (s), ω angular frequency (rad/s), g_k Fourier coefficients of f over the phase.
"""

import numpy as np
from numpy.polynomial import Legendre

from standfast.numerics.arrays import TURN, Array, Scalar
from standfast.stability.delay.problem import Apply, Problem, directly, highest
from standfast.stability.sway.density import Swaying, characteristic, densities

# Most that the error is thought to be, relative to the integral; and of it for an interval.
ACCURACY = 1e-9
SHARE = 1.0 / 16.0
# Ends of the first intervals: peaks lie below Ω, where t is 1/2; W is the last.
FIRST = np.array([0.0, 2.0**-6, 2.0**-5, 2.0**-4, 2.0**-3, 0.25, 0.5])
ROUNDS = 44  # an interval has been halved until float64 sees no more of it
PERSONS = 4096  # integrated together
PHASES = np.arange(8) / 8.0 * TURN
# Most that det H⁻¹ may turn between two points (rad): a peak between them makes it up to π.
MOST_TURN = 1.0
# The next term of the expansion, relative to the first, is at most this over Wτ: g_k ∝ ω⁻⁵ or ω⁻⁶.
STEEPEST = 6.0

# Nodes and weights of Kronrod's 15 points and Gauss's 7 on (−1, 1), to the last digit of float64.
_NODES = (
    0.9914553711208126, 0.9491079123427585, 0.8648644233597691, 0.7415311855993945,
    0.5860872354676911, 0.4058451513773972, 0.2077849550078985, 0.0,
)  # fmt: skip
_KRONROD = (
    0.02293532201052922, 0.06309209262997855, 0.1047900103222502, 0.1406532597159259,
    0.1690047266392679, 0.1903505780647854, 0.2044329400752989, 0.2094821410847278,
)  # fmt: skip
_GAUSS = (
    0.0, 0.1294849661688697, 0.0, 0.2797053914892767,
    0.0, 0.3818300505051189, 0.0, 0.4179591836734694,
)  # fmt: skip
NODES = np.array([-x for x in _NODES] + list(_NODES[-2::-1]))
KRONROD = np.array(_KRONROD + _KRONROD[-2::-1])
GAUSS = np.array(_GAUSS + _GAUSS[-2::-1])
# Combinations of values that are 0 of polynomials up to degrees 13, 12 and 11: one of them may be
# small by chance.
UNSEEN = np.stack([KRONROD - GAUSS, *(KRONROD * Legendre.basis(k)(NODES) for k in (13, 12))])


def integral(
    row: int,
    swaying: Swaying,
    *,
    accuracy: float = ACCURACY,
    size: np.ndarray | None = None,
    apply: Apply = directly,
) -> tuple[np.ndarray, np.ndarray]:
    """Return (1/2π) ∫ of a row of densities, (persons,), and whether each is that accurate.

    The accuracy is relative to ``size``, (persons,), of a covariance the product of the deviations;
    or to the integral itself. The persons must stand: of others the integral means nothing, and
    costs much.
    """
    persons = swaying.delay.size
    found, sure = np.zeros(persons), np.zeros(persons, bool)
    for first in range(0, persons, PERSONS):
        some = slice(first, first + PERSONS)
        part = Swaying(*(each[..., some] for each in swaying))
        own = None if size is None else np.pi * size[some]
        found[some], sure[some] = _Rounds(row, part, accuracy, own, apply).integrated()
    return found / np.pi, sure


class _Rounds:
    """Intervals of some persons that are still to be integrated, and what is settled."""

    def __init__(
        self, row: int, swaying: Swaying, accuracy: float, size: np.ndarray | None, apply: Apply
    ) -> None:
        self.row, self.swaying, self.size, self.apply = row, swaying, size, apply
        self.allowed = accuracy * SHARE
        self.scale = np.sqrt(np.asarray(apply(highest, Problem(3, 0), swaying.numbers)))
        self.done = np.zeros(swaying.delay.size)

    def integrated(self) -> tuple[np.ndarray, np.ndarray]:
        everyone = np.arange(self.done.size)
        person = np.repeat(everyone, len(FIRST) - 1)
        low, high = np.tile(FIRST[:-1], everyone.size), np.tile(FIRST[1:], everyone.size)
        whose, start = everyone, np.full(everyone.size, FIRST[-1])
        unseen = np.ones(person.size, bool)
        for _ in range(ROUNDS):
            value, error = self._up_to(person, low, high)
            unseen[unseen] = self._hides_peak(person[unseen], low[unseen], high[unseen])
            rest, rest_error = self._beyond(whose, start)
            size = self.size
            if size is None:
                size = abs(self.done + self._each(person, value) + self._each(whose, rest))
            most = self.allowed * size
            wide, early = unseen | (error > most[person]), rest_error > most[whose]
            self.done += self._each(person[~wide], value[~wide])
            self.done += self._each(whose[~early], rest[~early])
            if not (wide.any() or early.any()):
                return self.done, np.ones(everyone.size, bool)
            left = value[wide], rest[early]
            person, low, high = person[wide], low[wide], high[wide]
            whose, start = whose[early], start[early]
            halves = 0.5 * (low + high)
            further = 2.0 * start / (1.0 + start)  # where ω is twice as high
            before = person, whose
            person = np.concatenate([person, person, whose])
            low, high = (
                np.concatenate([low, halves, start]), np.concatenate([halves, high, further])
            )  # fmt: skip
            start = further
            unseen = np.concatenate([unseen[wide], unseen[wide], np.zeros(start.size, bool)])
        self.done += self._each(before[0], left[0]) + self._each(before[1], left[1])
        sure = np.ones(everyone.size, bool)
        sure[person] = False
        return self.done, sure

    def _each(self, person: np.ndarray, values: np.ndarray) -> np.ndarray:
        return np.bincount(person, values, minlength=self.done.size)

    def _own(self, person: np.ndarray) -> tuple[np.ndarray, ...]:
        return tuple(each.take(person, axis=-1) for each in (*self.swaying, self.scale))

    def _up_to(
        self, person: np.ndarray, low: np.ndarray, high: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Return the integral over intervals, and its error."""
        if not person.size:
            return np.zeros(0), np.zeros(0)
        rows = np.asarray(self.apply(at_nodes, self.row, *self._own(person), low, high))
        value = KRONROD @ rows
        error = abs(UNSEEN @ rows).max(axis=0)
        around = KRONROD @ abs(rows - 0.5 * value)
        # as QUADPACK takes it (Piessens et al. 1983)
        ratio = 200.0 * error / np.where(around > 0.0, around, 1.0)
        return value, np.minimum(error, around * np.minimum(1.0, ratio**1.5))

    def _hides_peak(self, person: np.ndarray, low: np.ndarray, high: np.ndarray) -> np.ndarray:
        """Return whether a peak may lie between two nodes of an interval."""
        if not person.size:
            return np.zeros(0, bool)
        values = np.asarray(self.apply(turning, self.row, *self._own(person), low, high))
        turns = np.angle(values[1:] * values[:-1].conj())
        hidden: np.ndarray = (abs(turns) > MOST_TURN).any(axis=0) & (high - low > 1e-14)
        return hidden

    def _beyond(self, person: np.ndarray, start: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the integral from W on, and its error."""
        if not person.size:
            return np.zeros(0), np.zeros(0)
        own = self._own(person)
        mean, error = self._smooth_beyond(own, start)
        omega = self.scale[person] * start / (1.0 - start)
        delay = self.swaying.delay[person]
        around = np.asarray(self.apply(at_phases, self.row, *own[:-1], omega))
        orders = np.arange(1, PHASES.size // 2)[:, None]
        parts = np.exp(-1j * orders * PHASES) @ around / PHASES.size
        turned = 1j * parts * np.exp(1j * orders * omega * delay)
        over = orders * np.where(delay > 0.0, delay, np.inf)
        first = 2.0 * (turned / over).real.sum(axis=0)
        following = STEEPEST * 2.0 * (abs(parts) / (omega * over**2)).sum(axis=0)
        # what the phases do not tell from the mean is of the next orders, each smaller by a factor
        unseen = abs(parts[-1]) ** 2 / np.where(abs(parts[0]) > 0.0, abs(parts[0]), 1.0) * omega
        return mean + first, error + following + unseen

    def _smooth_beyond(
        self, own: tuple[np.ndarray, ...], start: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        rows = np.asarray(self.apply(mean_at_nodes, self.row, *own, start, np.ones_like(start)))
        value = KRONROD @ rows
        return value, abs(value - GAUSS @ rows) * 1e-3


def at_nodes(row: int, *own_and_ends: Array) -> Array:
    """Return half the width of an interval times the density in t at its nodes, (15, intervals)."""
    swaying, omega, slope = _mapped(*own_and_ends)
    return densities(swaying, omega, omega * swaying.delay)[row] * slope


def turning(row: int, *own_and_ends: Array) -> Array:
    """Return det H⁻¹ at ends and nodes of an interval, whatever ``row``, (17, intervals)."""
    del row
    *parts, scale, low, high = own_and_ends
    points = np.concatenate([[-1.0], NODES, [1.0]])[:, None]
    t = 0.5 * (low + high) + 0.5 * (high - low) * points
    return characteristic(Swaying(*parts), scale * t / (1.0 - t))


def mean_at_nodes(row: int, *own_and_ends: Array) -> Array:
    """Return :func:`at_nodes` of the density's mean over the phase."""
    swaying, omega, slope = _mapped(*own_and_ends)
    turning = swaying.delay > 0.0
    total: Scalar = 0.0
    for phase in PHASES:
        total = total + densities(swaying, omega, phase * turning)[row]
    return total * slope / PHASES.size


def at_phases(row: int, *own_and_omega: Array) -> Array:
    """Return the density at a frequency over the phases, (phases, persons)."""
    *parts, omega = own_and_omega
    swaying = Swaying(*parts)
    turning = swaying.delay > 0.0
    return densities(swaying, omega, PHASES[:, None] * turning)[row]


def _mapped(*own_and_ends: Array) -> tuple[Swaying, Scalar, Scalar]:
    """Return persons, the frequencies at the nodes of an interval of t, and dω of a node."""
    *parts, scale, low, high = own_and_ends
    half = 0.5 * (high - low)
    t = 0.5 * (low + high) + half * NODES[:, None]
    rest = 1.0 - t
    return Swaying(*parts), scale * t / rest, half * scale / (rest * rest)
