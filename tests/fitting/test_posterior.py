"""Weights of all persons: intervals of densities whose quantiles are known otherwise."""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy import optimize, special, stats

from standfast.fitting.ridge import posterior_of
from standfast.fitting.search import coarse_grid, minima_of
from standfast.fitting.slices import HALVED, Weights, laid

NOISE_AND_GAINS = ("noise", "proportional_gain", "derivative_gain")
GAINS = NOISE_AND_GAINS[1:]
LOW, HIGH = -8.0, 3.0
# Of an interval's width: between slices that hold 3 % of the weight each, weights are interpolated.
CLOSE = 0.012
ENDS = stats.norm.ppf([0.025, 0.975])


class Mixed:
    """A likelihood that is a mixture of Gaussians, and what the fit asks of one."""

    def __init__(self, free, parts):
        self.free, self.parts = free, parts
        bounds = np.full(len(free), LOW), np.full(len(free), HIGH)
        self.points = SimpleNamespace(family=SimpleNamespace(free=free), bounds=bounds)
        self._roots = [np.linalg.inv(np.linalg.cholesky(covariance)) for _, _, covariance in parts]
        self._sizes = [
            np.log(share * np.diagonal(root).prod()) - 0.5 * len(free) * np.log(2.0 * np.pi)
            for (share, _, _), root in zip(parts, self._roots, strict=True)
        ]

    def _scaled(self, point):
        return [
            root @ (point - mean)
            for root, (_, mean, _) in zip(self._roots, self.parts, strict=True)
        ]

    def _logarithms(self, point):
        scaled = self._scaled(point)
        return np.array([
            size - 0.5 * (each @ each) for size, each in zip(self._sizes, scaled, strict=True)
        ])  # fmt: skip

    def size(self, point):
        # as a likelihood of measures has it, a constant keeps its root real
        return 100.0 - 2.0 * np.logaddexp.reduce(self._logarithms(point))

    def _in_two(self, point):
        """The square of the likeliest part, as its root and slopes, and the root of the rest."""
        weights = special.softmax(self._logarithms(point))
        inner, scaled = self._roots, self._scaled(point)
        pulls = [root.T @ each for root, each in zip(inner, scaled, strict=True)]
        best = int(np.argmax(weights))
        rest = np.sqrt(self.size(point) - scaled[best] @ scaled[best])
        slope = (np.einsum("k,ki->i", weights, np.stack(pulls)) - pulls[best]) / rest
        return np.append(scaled[best], rest), np.concatenate([inner[best], slope[None]])

    def ask(self, points):
        """Who stands is known without asking."""

    def residual(self, point):
        return self._in_two(point)[0]

    def slope(self, point):
        return self._in_two(point)[1]

    def over_noise(self, point):
        if "noise" not in self.free:
            return self.size(point), 0.0, 0.0
        ((_, mean, covariance),) = self.parts
        precision = np.linalg.inv(covariance)
        others = point[1:] - mean[1:]
        best = mean[0] - precision[0, 1:] @ others / precision[0, 0]
        return self.size(np.array([best, *point[1:]])), best, precision[0, 0] ** -0.5


class Falling(Mixed):
    """The same, of which those with less of the last coordinate than an edge fall."""

    def __init__(self, free, parts, edge):
        super().__init__(free, parts)
        self.edge = edge

    def size(self, point):
        return super().size(point) if point[-1] > self.edge else np.inf

    def residual(self, point):
        found = super().residual(point)
        return found if point[-1] > self.edge else np.full_like(found, np.inf)

    def over_noise(self, point):
        found = super().over_noise(point)
        return found if point[-1] > self.edge else (np.inf, 0.0, 0.0)


def found_of(likelihood):
    coarse = coarse_grid(likelihood)
    return posterior_of(likelihood, coarse, minima_of(likelihood, coarse))


def gaussian(free, mean, spread, correlation):
    """One Gaussian, all pairs of whose coordinates are correlated alike."""
    size = len(free)
    inner = (1.0 - correlation) * np.eye(size) + correlation * np.ones((size, size))
    return Mixed(free, [(1.0, np.array(mean), np.outer(spread, spread) * inner)])


def shifted(likelihood):
    """Mean and covariance of a Gaussian times e^p, which is what is taken of p beforehand."""
    ((_, mean, covariance),) = likelihood.parts
    return mean + covariance[:, likelihood.free.index("proportional_gain")], covariance


CASES = {
    "wide": ((0.3, -1.0, -0.5), (0.3, 0.5, 0.2), 0.4),
    "a thin ridge": ((0.3, -1.0, -0.5), (0.02, 0.03, 0.01), 0.999),
    "a ridge that falls": ((0.3, -1.0, -0.5), (0.2, 0.3, 0.1), -0.45),
}


@pytest.mark.parametrize("case", CASES)
def test_intervals_of_a_gaussian_are_its_own(case):
    likelihood = gaussian(NOISE_AND_GAINS, *CASES[case])
    posterior, best = found_of(likelihood)
    mean, covariance = shifted(likelihood)
    assert best == pytest.approx(likelihood.parts[0][1], abs=1e-5)
    spread = np.sqrt(np.diagonal(covariance))
    noise, _ = posterior.noise_interval()
    assert abs(noise - mean[0] - spread[0] * ENDS).max() < CLOSE * 4.0 * spread[0]
    both = np.array([1.0, 1.0])

    def numbers(points):
        nothing = np.full(len(points), np.nan)
        return np.column_stack([points, points @ both, np.exp(points[:, 0]), nothing])

    ends, open_ = posterior.intervals(numbers, 5)
    for row in (0, 1):
        expected = mean[1 + row] + spread[1 + row] * ENDS
        assert abs(ends[row] - expected).max() < CLOSE * 4.0 * spread[1 + row]
    # along and across the ridge: any function has its own interval
    of_sum = np.sqrt(both @ covariance[1:, 1:] @ both)
    assert abs(ends[2] - mean[1:].sum() - of_sum * ENDS).max() < CLOSE * 4.0 * of_sum
    np.testing.assert_allclose(ends[3], np.exp(ends[0]), rtol=CLOSE)
    assert np.isnan(ends[4]).all()
    assert not open_.any()
    # able to fail: without what is taken beforehand the gain would lie lower
    unmoved = likelihood.parts[0][1][1] + spread[1] * ENDS
    if case != "a thin ridge":
        assert abs(ends[0] - unmoved).max() > 3.0 * CLOSE * 4.0 * spread[1]


def test_four_numbers_have_intervals_too():
    free = (*NOISE_AND_GAINS, "feedback_delay")
    likelihood = gaussian(free, (0.3, -1.0, -0.5, -2.0), (0.3, 0.5, 0.2, 0.4), 0.6)
    posterior, _ = found_of(likelihood)
    mean, covariance = shifted(likelihood)
    ends, _ = posterior.intervals(lambda points: points, 3)
    for row in range(3):
        spread = np.sqrt(covariance[1 + row, 1 + row])
        # across, 3 standard deviations hold all but 0.3 %
        assert abs(ends[row] - mean[1 + row] - spread * ENDS).max() < 1.5 * CLOSE * 4.0 * spread


def quantiles(parts):
    """Between what a mixture of Gaussians of one number lies."""
    return [
        optimize.brentq(
            lambda value, tail=tail: sum(
                share * stats.norm.cdf((value - mean) / spread) for share, mean, spread in parts
            ) - tail,
            LOW, HIGH,
        )
        for tail in (0.025, 0.975)
    ]  # fmt: skip


def test_two_thin_valleys_both_count():
    spread = np.array([0.02, 0.01])
    covariance = np.diag(spread**2)
    places = np.array([-3.0, 0.4]), np.array([-1.0, -0.2])
    shares = 0.7, 0.3
    likelihood = Mixed(
        GAINS, [(share, at, covariance) for share, at in zip(shares, places, strict=True)]
    )
    posterior, best = found_of(likelihood)
    assert best == pytest.approx(places[0], abs=1e-4)
    # times e^p the other valley weighs three times as much
    weights = np.array(shares) * np.exp([at[0] for at in places])
    weights /= weights.sum()
    ends, _ = posterior.intervals(lambda points: points, 2)
    for row in (0, 1):
        expected = quantiles(
            [(weight, at[row], spread[row]) for weight, at in zip(weights, places, strict=True)]
        )
        assert ends[row] == pytest.approx(expected, abs=0.1 * spread[row])


def test_two_valleys_beside_each_other_both_count():
    """At the same proportional gain, far apart in the derivative gain: no ridge joins them."""
    covariance = np.diag([0.3**2, 0.05**2])
    parts = [(0.8, np.array([-1.0, -1.5]), covariance), (0.2, np.array([-1.0, 0.5]), covariance)]
    posterior, _ = found_of(Mixed(GAINS, parts))
    ends, _ = posterior.intervals(lambda points: points, 2)
    shift = 0.3**2
    assert ends[0] == pytest.approx(-1.0 + shift + 0.3 * ENDS, abs=CLOSE * 4.0 * 0.3)
    expected = quantiles([(share, mean[1], 0.05) for share, mean, _ in parts])
    assert ends[1] == pytest.approx(expected, abs=0.1 * 0.05)


def test_who_weighs_again_next_to_falling_counts():
    """Beyond the tail of what is most likely the weight rises, up to an edge where people fall."""
    # no point of the coarse grid lies between the tail and the edge
    edge, spread = -0.62, 0.3
    across = [(0.7, -0.15, 0.08), (0.3, -0.6, 0.1)]
    likelihood = Falling(
        GAINS,
        [(share, np.array([-1.0, at]), np.diag([spread**2, own**2])) for share, at, own in across],
        edge,
    )
    posterior, _ = found_of(likelihood)
    ends, open_ = posterior.intervals(lambda points: points, 2)
    value = np.linspace(edge, 1.0, 20_001)
    density = sum(share * stats.norm.pdf(value, at, own) for share, at, own in across)
    below = np.cumsum(density) / density.sum()
    expected = np.interp([0.025, 0.975], below, value)
    # within the last step before the edge it is not known where people begin to fall
    assert ends[1] == pytest.approx(expected, abs=0.08)
    assert expected[0] < -0.15 - 5.0 * 0.08  # able to fail: a Gaussian ends before
    assert not open_.any()


class Band(Mixed):
    """Nobody stands but in a band of the last coordinate, narrower than its standard deviation."""

    LOW, HIGH = -0.5001, -0.4925

    def size(self, point):
        return super().size(point) if self.LOW < point[-1] < self.HIGH else np.inf

    def over_noise(self, point):
        return self.size(point), 0.0, 0.0


def test_a_slice_of_a_narrow_band_has_only_who_stands():
    band = Band(GAINS, [(1.0, np.array([-1.0, -0.493]), np.diag([0.09, 0.01]))])
    start = np.array([-1.0, -0.5])
    found = laid(Weights(band, band.size(start)), start, lambda point: False)
    steps = found.first + np.arange(found.weight.size)
    at = found.centre[1] + steps * found.axes[0, 0]
    stands = np.isfinite(found.weight)
    assert stands.sum() >= 2
    np.testing.assert_array_equal(stands, (at > Band.LOW) & (at < Band.HIGH))
    assert found.axes[0, 0] >= 0.1 / 2**HALVED * 0.99


def test_who_falls_has_no_say_in_the_noise():
    mean, spread, correlation = (0.3, -1.0, -0.5), (0.4, 0.3, 0.2), 0.8
    whole = gaussian(NOISE_AND_GAINS, mean, spread, correlation)
    middle, covariance = shifted(whole)
    edge = middle[2] - 0.5 * spread[2]
    posterior, _ = found_of(Falling(NOISE_AND_GAINS, whole.parts, edge))
    ends, _ = posterior.noise_interval()
    both = stats.multivariate_normal(middle[[0, 2]], covariance[np.ix_([0, 2], [0, 2])])
    stand = stats.norm.sf(edge, middle[2], spread[2])

    def below(value):
        falling = both.cdf([value, edge])
        return (stats.norm.cdf(value, middle[0], spread[0]) - falling) / stand

    expected = [
        optimize.brentq(lambda x, tail=tail: below(x) - tail, -3.0, 3.0) for tail in (0.025, 0.975)
    ]
    assert ends == pytest.approx(expected, abs=0.1 * spread[0])
    # able to fail: with those who fall it would begin a standard deviation lower
    assert abs(middle[0] + ENDS[0] * spread[0] - expected[0]) > 0.3 * spread[0]


def infinite(points):
    return np.column_stack([points, np.full(len(points), np.inf)])


def summed(points):
    return np.column_stack([points, points.sum(axis=1)])


def test_what_the_measures_do_not_tell_is_open():
    # of the derivative gain nothing is known: all of its range is as likely
    likelihood = gaussian(GAINS, (-1.0, 0.0), (0.3, 300.0), 0.0)
    posterior, _ = found_of(likelihood)
    ends, open_ = posterior.intervals(infinite, 3)
    np.testing.assert_array_equal(open_[:2], [[False, False], [True, True]])
    assert ends[1] == pytest.approx([LOW + 0.025 * 11.0, HIGH - 0.025 * 11.0], abs=0.2)
    assert np.isinf(ends[2]).all()
    # most likely at the limit, and less and less within
    steep = gaussian(GAINS, (-1.0, LOW - 0.5), (0.3, 0.05), 0.0)
    posterior, _ = found_of(steep)
    _, open_ = posterior.intervals(summed, 3)
    # of a coordinate its own limit counts, of a margin any
    np.testing.assert_array_equal(open_, [[False, False], [True, True], [True, True]])
