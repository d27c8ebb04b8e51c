"""Estimates and their intervals, against known answers and against SALib."""

import numpy as np
import pytest
from scipy import stats

from standfast.population.cohort.histograms import VALUE_BINS, bin_edges, bin_of
from standfast.population.people.sobol import REPLICATES, sobol_block
from standfast.population.summary.estimators import (
    Distribution,
    NoVarianceError,
    effective_size,
    fraction,
    sobol_indices,
    wilson,
)


def test_wilson_is_the_inversion_of_the_score_test():
    """At the ends of the interval the observed fraction is just 1.96 standard errors away."""
    for events, persons in ((3, 50), (0, 80), (499, 1000), (1, 10**9)):
        found = wilson(events, persons)
        for end in (found.low, found.high):
            if 0.0 < end < 1.0:
                error = np.sqrt(end * (1.0 - end) / persons)
                assert abs(found.value - end) / error == pytest.approx(stats.norm.ppf(0.975))
    assert wilson(0, 80).low == 0.0
    assert wilson(80, 80).high == 1.0


@pytest.mark.parametrize("share", [0.02, 0.3, 0.9])
def test_the_interval_of_plain_monte_carlo_covers_in_95_of_100(share):
    """Exactly, by summing the binomial distribution; averaged over sizes, since it oscillates."""
    coverage = []
    for persons in range(900, 1100, 5):
        events = np.arange(persons + 1)
        inside = [w.low <= share <= w.high for w in (wilson(int(k), persons) for k in events)]
        coverage.append(stats.binom.pmf(events, persons, share)[inside].sum())
    assert np.mean(coverage) == pytest.approx(0.95, abs=0.01)


def test_a_fraction_of_replicates_has_students_interval():
    falls, persons = np.array([12, 15, 9, 14]), np.full(4, 100)
    found = fraction(falls, persons)
    low, high = stats.t.interval(0.95, 3, 0.125, stats.sem(falls / persons))
    assert (found.value, found.low, found.high) == pytest.approx((0.125, low, high))
    assert effective_size(falls, persons) == pytest.approx(
        0.125 * 0.875 / stats.sem(falls / persons) ** 2
    )


def test_a_fraction_without_spread_still_has_an_interval():
    found = fraction(np.zeros(16, int), np.full(16, 64))
    assert found == wilson(0, 1024)


def test_bins_hold_what_lies_between_their_edges():
    edges = bin_edges()
    values = np.geomspace(edges[0], edges[-1] * 0.999, 20_001)
    bins = bin_of(values)
    assert ((edges[bins - 1] <= values) & (values < edges[bins])).all()
    assert (np.diff(edges) / edges[:-1]).max() < 0.004
    outside = np.array([0.0, -1.0, 1e-9, 1e9, np.inf])
    assert bin_of(outside).tolist() == [0, 0, 0, VALUE_BINS + 1, VALUE_BINS + 1]


def test_quantiles_of_counts_are_those_of_the_values():
    random = np.random.default_rng(1)
    values = random.lognormal(3.0, 0.5, 200_000)
    counts = np.bincount(bin_of(values), minlength=VALUE_BINS + 2)
    of_counts = Distribution(bin_edges(), counts[None])
    for share in (0.01, 0.5, 0.95):
        found = of_counts.quantile(share)
        # a bin is 0.4 % wide, and linear inside
        assert found.value == pytest.approx(np.quantile(values, share), rel=1e-3)
        ranks = stats.binom.ppf((0.025, 0.975), values.size, share) / values.size
        assert (found.low, found.high) == pytest.approx(np.quantile(values, ranks), rel=1e-3)
    assert of_counts.below(np.array([20.0]))[0] == pytest.approx((values < 20.0).mean(), abs=1e-4)


def test_a_quantile_beyond_all_bins_is_infinite():
    counts = np.zeros((1, VALUE_BINS + 2), int)
    counts[0, 5000], counts[0, -1] = 90, 10
    of_counts = Distribution(bin_edges(), counts)
    assert of_counts.quantile(0.95).value == np.inf
    assert np.isfinite(of_counts.quantile(0.5).value)


def ishigami(x):
    """Ishigami's function on (0, 1)³, as in SALib: a = 7, b = 0.1."""
    angles = np.pi * (2.0 * x - 1.0)
    return (
        np.sin(angles[0]) + 7.0 * np.sin(angles[1]) ** 2 + 0.1 * angles[2] ** 4 * np.sin(angles[0])
    )


def ours(function, dimensions, size=2**12, seed=1):
    first, second, mixed = [], [], []
    for replicate in range(REPLICATES):
        points = sobol_block(seed, replicate, 0, 2 * dimensions, size)
        a, b = points[:dimensions], points[dimensions:]
        first.append(function(a))
        second.append(function(b))
        each = []
        for i in range(dimensions):
            ab = a.copy()
            ab[i] = b[i]
            each.append(function(ab))
        mixed.append(each)
    return sobol_indices(np.array(first), np.array(second), np.array(mixed))


def test_sobol_indices_of_ishigami_are_the_known_ones():
    """Closed forms: V1 = ½ (1 + b π⁴/5)², V2 = a²/8, V13 = b² π⁸ (1/18 − 1/50)."""
    v1, v2 = 0.5 * (1.0 + 0.1 * np.pi**4 / 5.0) ** 2, 49.0 / 8.0
    v13 = 0.01 * np.pi**8 * (1.0 / 18.0 - 1.0 / 50.0)
    total = v1 + v2 + v13
    found = ours(ishigami, 3)
    first, whole = (v1 / total, v2 / total, 0.0), ((v1 + v13) / total, v2 / total, v13 / total)
    for estimates, known in ((found.first, first), (found.total, whole)):
        for estimate, value in zip(estimates, known, strict=True):
            half = max(estimate.high - estimate.value, 1e-12)
            assert abs(estimate.value - value) < 2.0 * half
            assert half < 0.02


def test_sobol_indices_agree_with_salib_on_ishigami():
    salib_sample = pytest.importorskip("SALib.sample.sobol")
    salib_analyze = pytest.importorskip("SALib.analyze.sobol")
    problem = {"num_vars": 3, "names": ["a", "b", "c"], "bounds": [[0.0, 1.0]] * 3}
    points = salib_sample.sample(problem, 2**13, calc_second_order=False, seed=2)
    theirs = salib_analyze.analyze(problem, ishigami(points.T), calc_second_order=False, seed=2)
    found = ours(ishigami, 3)
    for key, estimates in (("S1", found.first), ("ST", found.total)):
        for i, estimate in enumerate(estimates):
            both = theirs[f"{key}_conf"][i] + (estimate.high - estimate.value)
            assert abs(estimate.value - theirs[key][i]) < both


def test_no_variance_is_said_and_not_divided_by():
    constant = np.full((4, 8), 2.5)
    with pytest.raises(NoVarianceError):
        sobol_indices(constant, constant, constant[:, None])


def test_where_many_draws_are_one_value_the_interval_holds_it():
    """Draws from few people: the bin is known, the place in it is not."""
    values = np.repeat([1512.55, 1001.0, 1333.3], [300, 500, 200])
    counts = np.bincount(bin_of(values), minlength=VALUE_BINS + 2)
    of_counts = Distribution(bin_edges(), counts[None])
    for share, value in ((0.3, 1001.0), (0.6, 1333.3), (0.95, 1512.55)):
        found = of_counts.quantile(share)
        assert found.low <= value <= found.high
        assert found.high / found.low < 1.01


@pytest.mark.parametrize("size", [30, 100, 1000])
@pytest.mark.parametrize("share", [0.5, 0.95, 0.99])
def test_intervals_of_quantiles_cover_also_in_small_samples(size, share):
    """At least 95 of 100 up to chance; where no draw lies beyond, the interval is open."""
    random = np.random.default_rng(6)
    inside = 0
    for _ in range(400):
        values = random.lognormal(3.0, 0.5, size)
        counts = np.bincount(bin_of(values), minlength=VALUE_BINS + 2)
        found = Distribution(bin_edges(), counts[None]).quantile(share)
        inside += found.low <= stats.lognorm.ppf(share, 0.5, scale=np.exp(3.0)) <= found.high
    assert inside / 400 > 0.925


def test_few_events_of_replicates_have_a_wide_enough_interval():
    random = np.random.default_rng(7)
    for expected in (3.5, 8.0):
        inside = 0
        for _ in range(1000):
            falls = random.poisson(expected / 16, 16)
            found = fraction(falls, np.full(16, 10_000))
            inside += found.low <= expected / 160_000 <= found.high
        assert inside / 1000 > 0.93
