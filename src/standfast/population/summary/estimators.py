"""Estimates with their intervals: fractions, quantiles, Sobol indices.

All intervals are of 95 %. Plain Monte Carlo has those of independent draws; quasi-Monte Carlo those
of its independent scramblings, by Student's t.
"""

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from scipy.special import bdtrik, stdtrit

CONFIDENCE = 0.95
# What the interval of a fraction is called, by the method of sampling.
METHODS = {
    "monte-carlo": "Wilson's score interval of independent draws",
    "quasi-monte-carlo": "Student's t over 16 scramblings, Wilson's where events are few",
}
NORMAL_QUANTILE = 1.959963984540054
LARGE = 10**6  # from here on the binomial distribution is normal
# With fewer events the spread of the replicates is itself too uncertain to go by alone.
FEW_EVENTS = 30
# A bin that holds so many times more than its neighbours holds one value, not a stretch of them.
ATOM = 4.0


@dataclass(frozen=True, slots=True)
class Estimate:
    """A number and the interval in which the true one lies with 95 % confidence."""

    value: float
    low: float
    high: float

    @property
    def interval(self) -> list[float]:
        """The two ends."""
        return [self.low, self.high]

    def told(self, name: str, interval: str = "") -> dict[str, Any]:
        """Return value and interval by name (name_interval), None for infinity as JSON has none."""
        ends = (self.value, self.low, self.high)
        value, low, high = (float(end) if math.isfinite(end) else None for end in ends)
        return {name: value, interval or f"{name}_interval": [low, high]}


def wilson(events: float, persons: float) -> Estimate:
    """Return a fraction with Wilson's score interval (J Am Stat Assoc 22 (1927) 209-212).

    (p + z²/2n ± z √(p(1−p)/n + z²/4n²)) / (1 + z²/n); never empty, also without any event.
    """
    share = events / persons
    z2 = NORMAL_QUANTILE**2 / persons
    middle = (share + 0.5 * z2) / (1.0 + z2)
    half = math.sqrt(share * (1.0 - share) * z2 + 0.25 * z2**2) / (1.0 + z2)
    low = 0.0 if events == 0 else middle - half
    high = 1.0 if events == persons else middle + half
    return Estimate(share, low, high)


def over_replicates(values: np.ndarray) -> Estimate:
    """Return the mean of independent replicates, ± t s/√R with R − 1 degrees of freedom."""
    half = float(stdtrit(values.size - 1, 0.5 + 0.5 * CONFIDENCE)) * standard_error(values)
    mean = float(values.mean())
    return Estimate(mean, mean - half, mean + half)


def standard_error(values: np.ndarray) -> float:
    """Return s/√R, the standard error of the mean of independent replicates."""
    return float(values.std(ddof=1)) / math.sqrt(values.size)


def fraction(events: np.ndarray, persons: np.ndarray) -> Estimate:
    """Return the fraction of events (replicates,) among persons (replicates,)."""
    total, of_all = int(events.sum()), int(persons.sum())
    overall = wilson(total, of_all)
    if events.size == 1 or (persons == 0).any():
        return overall
    shares = events / persons
    if (shares == shares[0]).all():  # no spread to go by, as without any event
        return overall
    of_replicates = over_replicates(shares)
    half = of_replicates.high - of_replicates.value
    share = overall.value
    low, high = max(share - half, 0.0), min(share + half, 1.0)
    if min(total, of_all - total) < FEW_EVENTS:
        low, high = min(low, overall.low), max(high, overall.high)
    return Estimate(share, low, high)


def effective_size(events: np.ndarray, persons: np.ndarray) -> float:
    """Return how many independent draws would tell the fraction as well, p(1−p)/SE²."""
    size = float(persons.sum())
    if events.size == 1:
        return size
    share = events.sum() / size
    error = standard_error(events / persons)
    return share * (1.0 - share) / error**2 if error > 0.0 else size


@dataclass(frozen=True)
class Distribution:
    """Counts of a number in bins, by replicate, read as a distribution function."""

    edges: np.ndarray  # (bins + 1,), rising
    counts: np.ndarray  # (replicates, bins + 2); the first lie below all bins, the last above
    lowest: float = 0.0  # that a value can be
    same: float | None = None  # the value of everybody, where they have one and the same

    @property
    def size(self) -> int:
        """Number of values counted."""
        return int(self.counts.sum())

    def below(self, values: np.ndarray) -> np.ndarray:
        """Return the share of what lies below each value, linear within a bin."""
        return np.asarray(np.interp(values, self.edges, self._shares))

    def quantile(self, share: float) -> Estimate:
        """Return the value below which a share lies; ``inf`` beyond the bins, ``lowest`` before.

        The interval is that of independent draws by their ranks, from the binomial distribution, or
        Woodruff's (J Am Stat Assoc 47 (1952) 635-646) from the spread of the replicates' shares
        below the value. It is open (``inf`` or ``lowest``) where no draw lies beyond.
        """
        if self.same is not None:
            return Estimate(self.same, self.same, self.same)
        value = self.at(share)
        if len(self.counts) == 1 or not math.isfinite(value):
            first, last = _ranks(self.size, share)
        else:
            shares = [np.interp(value, self.edges, _cumulated(each)) for each in self.counts]
            around = over_replicates(np.array(shares))
            spread = around.high - around.value
            first, last = (share - spread) * self.size, (share + spread) * self.size
        low = self.at(first / self.size) if first >= 1.0 else self.lowest
        high = self.at(last / self.size) if last <= self.size else math.inf
        return Estimate(value, self._from_atom(low, 0), self._from_atom(high, 1))

    def _from_atom(self, value: float, end: int) -> float:
        """Return the lower (0) or upper (1) edge of a bin that holds one and the same value.

        Where people are few, many draws are alike; where in its bin they lie is not known.
        """
        if not self.edges[0] < value < math.inf:
            return value
        counts = self.counts.sum(axis=0)
        found = min(int(np.searchsorted(self.edges, value)), len(counts) - 2)
        alike = counts[found] > ATOM * max(counts[found - 1], counts[found + 1])
        return float(self.edges[found - 1 + end]) if alike else value

    @cached_property
    def _shares(self) -> np.ndarray:
        return _cumulated(self.counts.sum(axis=0))

    def at(self, share: float) -> float:
        """Return the value below which a share lies, as :meth:`quantile`."""
        shares = self._shares
        if share > shares[-1]:
            return math.inf
        if share <= shares[0]:
            return self.lowest if shares[0] > 0.0 else float(self.edges[0])
        above = int(np.searchsorted(shares, share))
        # linear between the edge below and the edge above
        step = (share - shares[above - 1]) / (shares[above] - shares[above - 1])
        low, high = self.edges[above - 1], self.edges[above]
        return float(low + step * (high - low))


def _cumulated(counts: np.ndarray) -> np.ndarray:
    """Return the share below each edge."""
    return np.asarray(np.cumsum(counts[:-1]) / counts.sum())


def _ranks(size: int, share: float) -> tuple[float, float]:
    """Return the ranks between which a quantile lies with 95 %: order statistics of its sample."""
    tail = 0.5 - 0.5 * CONFIDENCE
    if size > LARGE:
        half = NORMAL_QUANTILE * math.sqrt(size * share * (1.0 - share))
        return size * share - half, size * share + half
    low, high = bdtrik([tail, 1.0 - tail], size, share)
    return math.floor(low), math.ceil(high) + 1.0


@dataclass(frozen=True)
class SobolIndices:
    """How much of an output's variance each factor explains, alone and with all others."""

    first: tuple[Estimate, ...]
    total: tuple[Estimate, ...]


class NoVarianceError(ValueError):
    """The output is the same for everyone, so nothing drives it."""


def sobol_indices(first: np.ndarray, second: np.ndarray, mixed: np.ndarray) -> SobolIndices:
    """Return Sobol indices with intervals from the spread of independent replicates.

    With f(A), f(B) on two independent samples and f(ABi) on A with factor i taken from B:
    S_i = ⟨f(B) (f(ABi) − f(A))⟩ / V and T_i = ⟨(f(A) − f(ABi))²⟩ / 2V (Saltelli et al., Comput Phys
    Commun 181 (2010) 259-270, after Jansen), V the variance of f(A) and f(B) together. ``first``
    and ``second`` are f(A) and f(B) (replicates, n), ``mixed`` is f(ABi) (replicates, factors, n);
    :class:`NoVarianceError` if all values are equal.
    """
    both = np.concatenate([first, second], axis=1)
    if np.ptp(both) == 0.0:
        raise NoVarianceError
    # the mean over all replicates, taken off, leaves the estimators unchanged and their spread low
    centre = both.mean()
    variance = ((both - centre) ** 2).mean(axis=1)
    a, b, ab = first - centre, second - centre, mixed - centre
    main = (b[:, None, :] * (ab - a[:, None, :])).mean(axis=2)
    total = 0.5 * ((a[:, None, :] - ab) ** 2).mean(axis=2)
    return SobolIndices(
        tuple(_ratio(column, variance) for column in main.T),
        tuple(_ratio(column, variance) for column in total.T),
    )


def _ratio(over: np.ndarray, under: np.ndarray) -> Estimate:
    """Return the ratio of two means over replicates, with the spread of both in its interval."""
    ratio = float(over.mean() / under.mean())
    residual = over_replicates((over - ratio * under) / under.mean())
    return Estimate(ratio, ratio + residual.low, ratio + residual.high)
