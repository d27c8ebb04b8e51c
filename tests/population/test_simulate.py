"""Whole populations: against plain NumPy, known answers, real people, and themselves."""

import math

import numpy as np
import pytest
from scipy.stats import norm

import covering
import plain_population as plain
from populations import GOOD, RIGID, changed, counted, drawn, events, law, of
from real_people import DATA, needs_people
from standfast.population.cohort.cohort import cohort_of
from standfast.population.cohort.histograms import bin_edges
from standfast.population.people.builtin import ANSUR, NHANES
from standfast.population.people.study import PopulationStudy
from standfast.population.summary.estimators import Distribution

G = 9.81
SIZE = 200_000


def group(sex, age):
    rows = [g for g in (*NHANES, *ANSUR) if (g.sex, g.age) == (sex, age)]
    g = rows[0]
    return (g.height_mean, g.height_sd, g.bmi_shift, g.log_mean, g.log_sd, g.correlation)


# Stiffness laws of a study, and the same drawn by plain NumPy from height and mass.
def stiff_women(random, height, mass):
    g1, _, _ = plain.loads(height, mass, G)
    n = len(height)
    return (
        g1 * plain.truncated_normal(random, n, 1.8, 0.3),
        g1 * plain.lognormal(random, n, 2.0, 0.5),
        random.uniform(200.0, 900.0, n),
    )


def absolute(random, height, mass):
    n = len(height)
    return plain.lognormal(random, n, 1124.0, 284.0), np.full(n, np.inf), np.full(n, 600.0)


def widely_cut(random, height, mass):
    g1, g2, g3 = plain.loads(height, mass, G)
    n = len(height)
    return (
        g1 * plain.truncated_normal(random, n, 1.0, 1.0),
        g2 * random.uniform(1.0, 8.0, n),
        g3 * plain.lognormal(random, n, 3.0, 3.0),
    )


def correlated(random, height, mass):
    g1, g2, g3 = plain.loads(height, mass, G)
    n = len(height)
    z = random.multivariate_normal([0, 0, 0], CORRELATION, n).T
    sigma = np.sqrt(np.log1p(0.25**2))
    factor = np.exp(sigma * z - sigma**2 / 2.0)
    return 1.9 * g1 * factor[0], 2.5 * g2 * factor[1], g3 * (1.0 + 4.0 * norm.cdf(z[2]))


CORRELATION = [[1.0, 0.7, 0.2], [0.7, 1.0, -0.1], [0.2, -0.1, 1.0]]

STUDIES = {
    "women, relative laws": (GOOD, ("female", "20+"), stiff_women),
    "old men, absolute": (
        {
            "gravity": G,
            "population": {"builtin": "nhanes-2017-2018", "sex": "male", "age": "65+"},
            "stiffness": {
                "ankle": law("lognormal", mean=1124.0, sd=284.0),
                "knee": RIGID,
                "hip": law("fixed", value=600.0),
            },
        },
        ("male", "65+"),
        absolute,
    ),
    "soldiers, absolute": (
        {
            "gravity": G,
            "population": {"builtin": "ansur-2012", "sex": "male"},
            "stiffness": {
                "ankle": law("lognormal", mean=1124.0, sd=284.0),
                "knee": RIGID,
                "hip": law("fixed", value=600.0),
            },
        },
        ("male", "17-58"),
        absolute,
    ),
    "young women, cut laws": (
        {
            "gravity": G,
            "population": {"builtin": "nhanes-2017-2018", "sex": "female", "age": "20-39"},
            "stiffness": {
                "ankle": law("normal", "single_joint_critical", mean=1.0, sd=1.0),
                "knee": law("uniform", "single_joint_critical", low=1.0, high=8.0),
                "hip": law("lognormal", "single_joint_critical", mean=3.0, sd=3.0),
            },
        },
        ("female", "20-39"),
        widely_cut,
    ),
    "soldiers, correlated": (
        {
            "gravity": G,
            "population": {"builtin": "ansur-2012", "sex": "female"},
            "stiffness": {
                "correlation": CORRELATION,
                "ankle": law("lognormal", "mgh", mean=1.9, sd=1.9 * 0.25),
                "knee": law("lognormal", "single_joint_critical", mean=2.5, sd=2.5 * 0.25),
                "hip": law("uniform", "single_joint_critical", low=1.0, high=5.0),
            },
        },
        ("female", "17-58"),
        correlated,
    ),
}


def plainly(who, laws, size, seed=11):
    random = np.random.default_rng(seed)
    height, mass = plain.drawn_group(random, size, *group(*who))
    return height, mass, laws(random, height, mass)


def assert_near(events_ours, size_ours, events_plain, size_plain, errors):
    p, q = events_ours / size_ours, events_plain / size_plain
    error = math.sqrt(p * (1.0 - p) / size_ours + q * (1.0 - q) / size_plain)
    assert abs(p - q) < errors * error


@pytest.mark.parametrize("method", ["monte-carlo", "quasi-monte-carlo"])
@pytest.mark.parametrize("name", STUDIES)
def test_the_fraction_is_that_of_plain_numpy(name, method):
    content, who, laws = STUDIES[name]
    found = counted(of(content, size=SIZE, method=method, seed=3))
    falls, persons = (each.sum() for each in events(found))
    height, mass, stiffness = plainly(who, laws, SIZE)
    theirs = plain.falls(height, mass, G, *stiffness).sum()
    assert 0.02 < falls / persons < 0.98
    assert_near(falls, persons, theirs, SIZE, errors=4.0)
    # the comparison can fail: an ankle 3 % stiffer
    stiffer = plain.falls(height, mass, G, 1.03 * stiffness[0], *stiffness[1:]).sum()
    with pytest.raises(AssertionError):
        assert_near(falls, persons, stiffer, SIZE, errors=4.0)


def test_the_fraction_of_a_mixture_of_groups_is_that_of_plain_numpy():
    content = changed("population", {"builtin": "nhanes-2017-2018", "size": SIZE})
    falls, persons = (each.sum() for each in events(counted(PopulationStudy.from_dict(content))))
    rows = [g for g in NHANES if g.age in ("20-39", "40-59", "60+")]
    assert sum(g.share for g in rows) == pytest.approx(1.0, abs=1e-9)
    theirs = 0
    random = np.random.default_rng(2)
    for g, n in zip(rows, random.multinomial(SIZE, [g.share for g in rows]), strict=True):
        height, mass = plain.drawn_group(random, n, *group(g.sex, g.age))
        theirs += plain.falls(height, mass, G, *stiff_women(random, height, mass)).sum()
    assert_near(falls, persons, theirs, SIZE, errors=4.0)


@pytest.mark.parametrize(("method", "seeds"), [("monte-carlo", 300), ("quasi-monte-carlo", 60)])
def test_intervals_cover_the_truth_in_95_of_100_seeds(method, seeds):
    """Within three errors of so few seeds; of thousands, `benchmarks/coverage.py`: 95 ± 2 %."""
    found = list(covering.estimates(method, 4096, seeds))
    chance = 3.0 * math.sqrt(0.95 * 0.05 / seeds)
    for column, truth in enumerate((covering.FALL, covering.NINE_IN_TEN)):
        held = np.mean([covering.holds(each[column], truth) for each in found])
        assert held == pytest.approx(0.95, abs=chance)
        # intervals of half the width, as of four times the persons, are noticed
        held = np.mean([covering.holds(each[column], truth, width=0.5) for each in found])
        assert held < 0.95 - chance


def test_quasi_monte_carlo_converges_faster_than_the_root():
    """Error of the mean load, a smooth functional, over sizes: faster than N^-0.7."""
    content = changed("population.sex", "male")
    nodes, weights = np.polynomial.hermite_e.hermegauss(60)
    weights = weights / weights.sum()
    mean, sd, shift, log_mean, log_sd, r = group("male", "20+")
    z, other = np.meshgrid(nodes, nodes)
    height = mean + sd * z
    bmi = shift + np.exp(log_mean + log_sd * (r * z + math.sqrt(1 - r**2) * other))
    load = plain.loads(height.ravel(), (bmi * height**2).ravel(), G)[0].reshape(z.shape)
    exact = float((weights[:, None] * weights * load).sum())
    sizes, errors = 2 ** np.arange(7, 15, 2), []
    for size in sizes:
        found = counted(of(content, method="quasi-monte-carlo", size=16 * int(size)))
        means = np.array([each.load_sums[0, 0] for each in found]) / size
        errors.append(math.sqrt(np.mean((means - exact) ** 2)))
    slope = np.polyfit(np.log(sizes), np.log(errors), 1)[0]
    assert slope < -0.7
    # plain Monte Carlo does not pass: its error falls with the root
    spread = [
        counted(of(content, size=int(n), seed=s))[0].load_sums[0, 0] / n
        for n in (sizes[0], sizes[-1])
        for s in range(40)
    ]
    rms = np.sqrt(np.mean((np.array(spread).reshape(2, -1) - exact) ** 2, axis=1))
    assert math.log(rms[1] / rms[0]) / math.log(sizes[-1] / sizes[0]) > -0.7


def test_two_routes_to_the_required_stiffness_agree():
    """Thresholds sorted, against a root search on fractions simulated by plain NumPy."""
    content, who, laws = STUDIES["women, relative laws"]
    size = 60_000
    found = counted(of(content, size=size))
    edges = bin_edges()
    height, mass, (ankle, knee, hip) = plainly(who, laws, size)

    def standing(**stiffness):
        joints = {"ankle": ankle, "knee": knee, "hip": hip, **stiffness}
        return 1.0 - plain.falls(height, mass, G, **joints).mean()

    def smallest(share, of_value, low, high, halvings):
        for _ in range(halvings):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if standing(**of_value(middle)) < share else (low, middle)
        return high

    for i, (joint, own, top) in enumerate((("ankle", ankle, 9e3), ("knee", knee, 5e4))):
        for share in (0.5, 0.9):
            error = math.sqrt(share * (1.0 - share) / size)
            for kind, of_value, highest in (
                (0, lambda v, j=joint: {j: np.full(size, v)}, top),
                (1, lambda v, j=joint, k=own: {j: v * k}, 40.0),
            ):
                ours = Distribution(edges, found[0].required[i, kind][None]).quantile(share)
                middle = smallest(share, of_value, 0.0, highest, 18)
                # the ends lie near; beyond these bounds they would be taken for too near
                near = 0.9 * middle, 1.1 * middle, 11
                low = smallest(share - 1.96 * error, of_value, *near)
                high = smallest(share + 1.96 * error, of_value, *near)
                assert ours.low < high
                assert low < ours.high
                assert ours.value == pytest.approx(middle, rel=0.03)


# The spread is printed without decimals and without its estimator; weighted, that of the men is
# 226.49, and 226.60 with the correction for their effective number.
SD_ROUNDING = 1.0


@needs_people
@pytest.mark.parametrize(
    ("sex", "mean", "sd", "mean_half", "sd_half"),
    [("male", 861.0, 227.0, 0.5, SD_ROUNDING), ("female", 670.0, 200.0, 0.5, SD_ROUNDING)],
)
def test_nhanes_needs_the_ankle_stiffness_of_the_reference(sex, mean, sd, mean_half, sd_half):
    """Weighted, 20 years and more, winter, 9.81 m/s²; printed with three digits."""
    study = real(["BMX_J.csv", "DEMO_J.csv"], sex=sex, age="20+")
    people = study.read_people()
    load = plain.loads(people.height, people.mass, G)[0]
    exact = np.average(load, weights=people.weight)
    spread = math.sqrt(np.average((load - exact) ** 2, weights=people.weight))
    assert exact == pytest.approx(mean, abs=mean_half)
    assert spread == pytest.approx(sd, abs=sd_half)
    sums = counted(study)[0].load_sums[:, 0] / study.size
    assert sums[0] == pytest.approx(exact, abs=4.0 * spread / math.sqrt(study.size))
    assert math.sqrt(sums[1] - sums[0] ** 2) == pytest.approx(spread, rel=0.01)


def real(files, **population):
    content = {
        "gravity": G,
        "population": {"people": [str(DATA / name) for name in files], "size": 500_000},
        "stiffness": GOOD["stiffness"],
    }
    return of(content, **population)


@needs_people
@pytest.mark.parametrize(
    ("files", "builtin", "sex", "age"),
    [
        (["BMX_J.csv", "DEMO_J.csv"], "nhanes-2017-2018", sex, age)
        for sex in ("male", "female")
        for age in ("20+", "20-39", "40-59", "60+", "65+")
    ]
    + [
        (["ANSUR_II_MALE_Public.csv"], "ansur-2012", "male", None),
        (["ANSUR_II_FEMALE_Public.csv"], "ansur-2012", "female", None),
    ],
)
def test_built_in_populations_stand_for_their_files(files, builtin, sex, age):
    """Mean within 1 %, spread within 3 %: height, mass, BMI and the load of the ankle."""
    chosen = {"sex": sex} | ({"age": age} if age else {})
    people = real(files, **chosen).read_people()
    study = of(GOOD | {"population": {"builtin": builtin}}, size=2**20, **chosen)
    cohort = cohort_of(study, None)
    variates = np.concatenate([cohort.sampler.variates(0, b, 2**16) for b in range(16)], axis=1)
    found = drawn(cohort, variates)
    height, mass = found["height"], found["mass"]
    pairs = (
        (people.height, height),
        (people.mass, mass),
        (people.mass / people.height**2, mass / height**2),
        (plain.loads(people.height, people.mass, G)[0], found["ankle_load"]),
    )
    for theirs, ours in pairs:
        mean = np.average(theirs, weights=people.weight)
        spread = math.sqrt(np.average((theirs - mean) ** 2, weights=people.weight))
        assert ours.mean() == pytest.approx(mean, rel=0.01)
        assert ours.std() == pytest.approx(spread, rel=0.03)


def test_survey_weights_are_respected(tmp_path):
    (tmp_path / "p.csv").write_text(
        "height,mass,weight\n1.6,60,1\n1.7,70,0\n1.8,80,2.5\n1.9,120,6.5\n"
    )
    for method in ("monte-carlo", "quasi-monte-carlo"):
        content = changed("population", {"people": str(tmp_path / "p.csv"), "size": 2**16})
        content["population"]["method"] = method
        rows = sum(each.rows for each in counted(PopulationStudy.from_dict(content)))
        assert rows.sum(axis=1) / 2**16 == pytest.approx([0.1, 0.0, 0.25, 0.65], abs=0.01)
