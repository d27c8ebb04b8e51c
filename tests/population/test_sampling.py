"""Random variates: the right distributions, and the same whatever the order of blocks."""

import itertools

import numpy as np
import pytest
from scipy import stats
from scipy.stats import qmc

from standfast.population.people.draws import Coordinate
from standfast.population.people.sampling import Sampler
from standfast.population.people.sections import UNCORRELATED
from standfast.population.people.sobol import direction_numbers, sobol_block

SIZE = 2**16

# Chance of a Kolmogorov-Smirnov test failing by accident, with seeds fixed; a wrong distribution
# has a p-value of 0 at this size.
ACCIDENT = 1e-3

COORDINATES = (
    Coordinate("group", "uniform"),
    Coordinate("height", "normal"),
    Coordinate("ankle", "normal", lowest=-1.5),
    Coordinate("knee", "uniform"),
    Coordinate("hip", "normal"),
)
CORRELATED = ((1.0, 0.6, -0.3), (0.6, 1.0, 0.2), (-0.3, 0.2, 1.0))
DISTRIBUTIONS = {
    "group": stats.uniform(),
    "height": stats.norm(),
    "ankle": stats.truncnorm(-1.5, np.inf),
    "knee": stats.uniform(),
    "hip": stats.norm(),
}
METHODS = ("monte-carlo", "quasi-monte-carlo")


def sampler(method, correlation=UNCORRELATED, seed=3):
    return Sampler(COORDINATES, correlation, method, seed)


def test_sobol_points_are_those_of_scipy():
    """Direction numbers against another implementation's points, which come in Gray's order."""
    count = 2**10
    numbers = direction_numbers()
    points = np.zeros((len(numbers), count), np.uint64)
    gray = np.arange(count) ^ (np.arange(count) >> 1)
    for bit in range(10):
        points[:, (gray >> bit) & 1 == 1] ^= numbers[:, bit, None]
    theirs = qmc.Sobol(len(numbers), scramble=False, bits=32).random(count)
    assert np.array_equal(points.T / 2.0**32, theirs)
    # it can fail: one initial number of one dimension wrong
    points[40, gray & 1 == 1] ^= numbers[41, 0] ^ np.uint64(1 << 29)
    assert not np.array_equal(points.T / 2.0**32, theirs)


@pytest.mark.parametrize("block_size", [64, 256])
def test_scrambled_points_fill_every_interval_once(block_size):
    """A scrambled Sobol sequence stays one: each of 1024 intervals of every axis holds one."""
    blocks = [sobol_block(3, 1, b, 8, block_size) for b in range(1024 // block_size)]
    points = np.concatenate(blocks, axis=1)
    for row in points:
        assert (np.bincount((row * 1024).astype(int), minlength=1024) == 1).all()
    assert np.array_equal(points, sobol_block(3, 1, 0, 8, 1024))


def test_scramblings_differ_and_are_uniform():
    first, second = (sobol_block(3, replicate, 0, 8, 4096) for replicate in (0, 1))
    assert not np.array_equal(first, second)
    # over many scramblings one and the same point is uniform
    spot = np.array([sobol_block(9, replicate, 0, 3, 4)[:, 2] for replicate in range(2000)])
    for column in spot.T:
        assert stats.kstest(column, "uniform").pvalue > ACCIDENT


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("correlation", [UNCORRELATED, CORRELATED])
def test_each_score_has_its_distribution(method, correlation):
    variates = sampler(method, correlation).variates(0, 0, SIZE)
    for row, coordinate in zip(variates, COORDINATES, strict=True):
        wanted = DISTRIBUTIONS[coordinate.name]
        assert stats.kstest(row, wanted.cdf).pvalue > ACCIDENT
        assert row.min() >= wanted.support()[0]
    # and the test can fail: a normal score that is not cut off
    assert stats.kstest(variates[2], stats.norm.cdf).pvalue < ACCIDENT


@pytest.mark.parametrize("method", METHODS)
def test_joints_are_correlated_by_a_gaussian_copula(method):
    """Ranks do not know the marginals: Spearman's ρ of the copula is 6/π asin(r/2)."""
    variates = sampler(method, CORRELATED).variates(0, 0, SIZE)
    joints = variates[2:]
    for i, j in itertools.combinations(range(3), 2):
        ranks = stats.spearmanr(joints[i], joints[j]).statistic
        wanted = 6.0 / np.pi * np.arcsin(CORRELATED[i][j] / 2.0)
        assert ranks == pytest.approx(wanted, abs=4.0 / np.sqrt(SIZE))
    with_height = stats.spearmanr(variates[1], joints[0]).statistic
    assert with_height == pytest.approx(0.0, abs=4.0 / np.sqrt(SIZE))


JOINTS_ALONE = tuple(Coordinate(name, "normal") for name in ("ankle", "knee", "hip"))


def mixing_of(correlation):
    """The matrix by which independent rows are mixed: what becomes of the unit vectors."""
    sampler = Sampler(JOINTS_ALONE, correlation, "quasi-monte-carlo", 1)
    units = stats.norm.cdf(np.eye(3))
    return sampler.from_uniform(units)


@pytest.mark.parametrize(
    ("ankle_knee", "ankle_hip", "knee_hip"),
    [
        (0.6, -0.3, 0.2), (0.3, 0.3, 0.3), (1.0, 1.0, 1.0), (-1.0, 1.0, -1.0), (1.0, 0.5, 0.5),
        (0.5, -1.0, -0.5), (0.5, 1.0, 0.5), (0.6, 0.8, 0.0), (-0.5, -0.5, -0.5),
        (1.0 - 1e-13, 0.5, 0.5), (1.0 - 1e-11, 0.5, 0.5 + 1e-6),
    ],
)  # fmt: skip
def test_mixing_gives_the_correlation_also_where_it_is_singular(ankle_knee, ankle_hip, knee_hip):
    """L Lᵀ is the correlation and every row of L a unit vector, so that marginals stay normal."""
    wanted = np.array([
        [1.0, ankle_knee, ankle_hip], [ankle_knee, 1.0, knee_hip], [ankle_hip, knee_hip, 1.0],
    ])  # fmt: skip
    mixing = mixing_of(tuple(map(tuple, wanted)))
    assert np.array_equal(mixing, np.tril(mixing))
    assert np.linalg.norm(mixing, axis=1) == pytest.approx(1.0, abs=1e-12)
    just_possible = 2e-6 if ankle_knee == 1.0 - 1e-11 else 1e-12
    assert mixing @ mixing.T == pytest.approx(wanted, abs=just_possible)
    # it can fail
    mixing[2, 0] += 1e-5
    assert mixing @ mixing.T != pytest.approx(wanted, abs=just_possible)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_joints_correlated_by_one_are_the_same_to_the_last_digit(sign):
    one = ((1.0, sign, 1.0), (sign, 1.0, sign), (1.0, sign, 1.0))
    ankle, knee, hip = Sampler(JOINTS_ALONE, one, "monte-carlo", 1).variates(0, 0, 1000)
    assert np.array_equal(ankle, sign * knee)
    assert np.array_equal(ankle, hip)


@pytest.mark.parametrize("method", METHODS)
def test_a_block_depends_on_seed_and_block_alone(method):
    blocks = [sampler(method).variates(0, block, 512) for block in (0, 1, 2)]
    backwards = [sampler(method).variates(0, block, 512) for block in (2, 1, 0)][::-1]
    assert all(np.array_equal(a, b) for a, b in zip(blocks, backwards, strict=True))
    assert not np.array_equal(blocks[0], blocks[1])
    assert not np.array_equal(blocks[0], sampler(method, seed=4).variates(0, 0, 512))
