"""Studies of populations: what is wrong gets one sentence."""

import math

import pytest

import standfast as sf
from populations import GOOD, changed, law
from standfast.population.people.classes import age_class, age_classes
from standfast.population.people.study import PopulationStudy

WRONG = [
    ("population.size", 0, "population.size = 0 is not a whole number from 1 to 100000000000"),
    ("population.size", 2.5, "population.size = 2.5 is not a whole number from 1 to 100000000000"),
    (
        "population.seed",
        -1,
        "population.seed = -1 is not a whole number from 0 to 9223372036854775807",
    ),
    ("population.sex", "femal", "population.sex = 'femal' is not known; did you mean 'female'?"),
    ("population.age", "70+", "population.age = '70+' is not a group of nhanes-2017-2018"),
    ("population.age", "old", "population.age = 'old' is not a range of ages; write \"65+\""),
    ("population.builtin", "nhanes", "population.builtin = 'nhanes' is not known; did you mean"),
    ("population.people", "a.csv", "[population] needs people (a CSV file) or builtin"),
    ("population.age_bands", [18, 65], "population.age_bands needs people of known age in a file"),
    ("population.sex", "other", "population.sex = 'other' is not known"),
    ("population", {"people": "-"}, "population.people = '-' is standard input, which a study"),
    ("stiffness.ankle.distribution", None, "[stiffness.ankle] has no distribution; write"),
    ("stiffness.ankle.mean", -1.0, "-1 is outside the allowed range, 0 to 1e+06"),
    ("population.method", "qmc", "population.method = 'qmc' is not known"),
    ("population.body_model", "wintr", "population.body_model = 'wintr' is not known; did you"),
    ("population.proportions", "free", "population.proportions = 'free' is not known"),
    ("population.sise", 5, "[population] has no key 'sise'; did you mean 'size'?"),
    ("population", None, "[population] is missing: say people or builtin, and size"),
    ("stiffness", None, "[stiffness.ankle], [stiffness.knee] and [stiffness.hip] are missing"),
    ("stiffness.knee", None, "[stiffness.knee] is missing; for a rigid knee write knee = inf in"),
    ("stiffness.knee", "stiff", "stiffness.knee = 'stiff' is not a law; write [stiffness.knee]"),
    ("stiffness.knee", True, "stiffness.knee = True is not a law; write [stiffness.knee] with"),
    ("stiffness.knee", -1.0, "stiffness.knee.value = -1 is outside the allowed range"),
    ("stiffness.ankle.sd", -0.3, "stiffness.ankle.sd = -0.3 is outside the allowed range"),
    ("stiffness.ankle.sd", None, "stiffness.ankle.sd is missing; normal takes mean, sd"),
    ("stiffness.ankle.mean", math.nan, "stiffness.ankle.mean is NaN"),
    ("stiffness.ankle.mean", math.inf, 'stiffness.ankle: only distribution = "fixed" may be inf'),
    ("stiffness.ankle.meen", 1.0, "has no key 'meen'; did you mean 'mean'?"),
    ("stiffness.ankle.distribution", "gauss", "stiffness.ankle.distribution = 'gauss' is not"),
    (
        "stiffness.ankle.relative_to",
        "weight",
        "stiffness.ankle.relative_to = 'weight' is not known",
    ),
    ("stiffness.hip.low", 950.0, "stiffness.hip goes from low = 950 to high = 900; high must not"),
    ("stiffness.knee.mean", 0.0, "stiffness.knee.mean = 0 has no lognormal; give a mean above 0"),
    ("stiffness.ankle", {"law": "winter"}, "stiffness.ankle.law = 'winter' is not known"),
    (
        "stiffness.correlation",
        [[1, 0.9, 0.9], [0.9, 1, -0.9], [0.9, -0.9, 1]],
        "stiffness.correlation is impossible: no three numbers are correlated like that",
    ),
    (
        "stiffness.correlation",
        [[1, 0.5, 0], [0.4, 1, 0], [0, 0, 1]],
        "stiffness.correlation: ankle with knee is 0.5, but knee with ankle 0.4",
    ),
    (
        "stiffness.correlation",
        [[2, 0, 0], [0, 1, 0], [0, 0, 1]],
        "stiffness.correlation[0][0] = 2 is outside the allowed range, -1 to 1",
    ),
    (
        "stiffness.correlation",
        [[0.5, 0, 0], [0, 1, 0], [0, 0, 1]],
        "stiffness.correlation: ankle with itself is 0.5; it must be 1",
    ),
    ("stiffness.correlation", [1, 0.5], "stiffness.correlation = [1, 0.5] is not a 3 × 3 matrix"),
    ("gravity", [9.8, 1.6], "gravity is one number in a population, without list or range"),
    ("gravity", 0.0, "gravity = 0 is outside the allowed range"),
    ("output.persons", "yes", "output.persons = 'yes' is not true or false"),
    ("body", {"height": 1.7}, "study has no key 'body'"),
    (
        "stiffness.ankle",
        law("lognormal", mean=1e-200, sd=284.0),
        "stiffness.ankle.sd = 284 is more than a thousand times the mean, 1e-200",
    ),
    ("population", {"people": "a\0b.csv"}, "'a\\x00b.csv' is not the name of a file"),
    ("title", 5, "title = 5 is not one line of text"),
    (
        "stiffness.hip",
        {"distribution": "measured"},
        "stiffness.hip: measured needs people with a column hip_stiffness, and a built-in",
    ),
    ("stiffness.hip", {"law": "casadio-2005"}, "'casadio-2005' is a law of the ankle"),
]


@pytest.mark.parametrize(("key", "value", "sentence"), WRONG)
def test_a_wrong_study_gets_its_sentence(key, value, sentence):
    with pytest.raises(sf.InputError) as caught:
        PopulationStudy.from_dict(changed(key, value))
    assert str(caught.value).startswith(sentence) or sentence in str(caught.value)
    assert "\n" not in str(caught.value)


def test_what_is_drawn_is_never_offered_to_be_rigid():
    for key in ("mean", "sd"):
        with pytest.raises(sf.InputError) as caught:
            PopulationStudy.from_dict(changed(f"stiffness.ankle.{key}", -0.3))
        assert "inf" not in str(caught.value)
        assert "rigid" not in str(caught.value)


@pytest.mark.parametrize(
    ("bands", "sentence"),
    [
        ("18", "population.age_bands = '18' is no list of whole years from 0 to 130"),
        ([], "population.age_bands = [] is no list of whole years"),
        ([18.5], "population.age_bands = [18.5] is no list of whole years"),
        ([18, 150], "population.age_bands = [18, 150] is no list of whole years"),
        ([30, 18], "population.age_bands = [30, 18] does not rise"),
    ],
)
def test_wrong_age_bands_get_their_sentence(tmp_path, bands, sentence):
    (tmp_path / "p.csv").write_text("height,mass\n1.7,70\n")
    content = changed("population", {"people": "p.csv", "age_bands": bands})
    with pytest.raises(sf.InputError) as caught:
        PopulationStudy.from_dict(content, folder=tmp_path)
    assert sentence in str(caught.value)


def test_age_bands_are_called_by_their_ages():
    names = [name for _, name in age_classes([18, 30, 31, 65])]
    assert names == ["under 18", "18-29", "30", "31-64", "65+"]
    assert [name for _, name in age_classes([0, 50])] == ["0-49", "50+"]
    for age, name in ((17.99, "under 18"), (18.0, "18-29"), (29.5, "18-29"), (130.0, "65+")):
        assert age_class(age, age_classes([18, 30, 31, 65])) == name


def test_a_joint_that_is_not_random_cannot_be_correlated():
    content = changed("stiffness.knee", {"distribution": "fixed", "value": 900.0})
    content["stiffness"]["correlation"] = [[1, 0.5, 0], [0.5, 1, 0], [0, 0, 1]]
    with pytest.raises(sf.InputError, match="the stiffness of the knee is not random; put 0 there"):
        PopulationStudy.from_dict(content)


@pytest.mark.parametrize("stiffness", [math.inf, 500.0, 0])
def test_a_plain_number_is_the_stiffness_of_everybody(stiffness):
    """As in a study of a grid, where inf is rigid; it is the same study as with a table."""
    table = {"distribution": "fixed", "value": stiffness}
    plain, written = (
        PopulationStudy.from_dict(changed("stiffness.knee", given)) for given in (stiffness, table)
    )
    assert plain.canonical == written.canonical
    other = PopulationStudy.from_dict(changed("stiffness.knee", 501.0))
    assert other.fingerprint != plain.fingerprint


def test_too_many_persons_to_keep_are_refused():
    content = changed("output.persons", True)
    content["population"]["size"] = 10**9
    with pytest.raises(sf.InputError, match="keeps at most 100,000,000 persons"):
        PopulationStudy.from_dict(content)


def test_the_study_of_a_sweep_is_told_apart():
    with pytest.raises(sf.InputError, match="run: standfast sweep"):
        PopulationStudy.from_dict({"body": {}, "stiffness": {}})


def test_the_canonical_form_reads_back():
    content = changed("stiffness.hip", {"distribution": "fixed", "value": math.inf})
    study = PopulationStudy.from_dict(content)
    again = PopulationStudy.from_canonical(study.canonical)
    assert again.fingerprint == study.fingerprint
    assert again.distributions == study.distributions
    assert again.shards == study.shards
    other = PopulationStudy.from_dict(changed("population.seed", 6, content))
    assert study.difference(other) == "population.seed: 6 there, 5 here"
    for text in ("", "[]", "{}", '{"population":5}'):
        with pytest.raises(sf.InputError, match="cannot be read"):
            PopulationStudy.from_canonical(text)


def test_where_a_file_of_people_lies_does_not_change_the_study(tmp_path):
    studies = []
    for folder in ("here", "there"):
        (tmp_path / folder).mkdir()
        (tmp_path / folder / "p.csv").write_text("height,mass\n1.7,70\n")
        content = changed("population", {"people": "p.csv", "size": 100})
        studies.append(PopulationStudy.from_dict(content, folder=tmp_path / folder))
    assert studies[0].fingerprint == studies[1].fingerprint
    (tmp_path / "there" / "p.csv").write_text("height,mass\n1.7,71\n")
    changed_people = PopulationStudy.from_dict(content, folder=tmp_path / "there")
    assert changed_people.fingerprint != studies[0].fingerprint


def test_a_good_study_is_good():
    assert PopulationStudy.from_dict(GOOD).size == 40_000
    quasi = PopulationStudy.from_dict(changed("population.method", "quasi-monte-carlo"))
    assert quasi.size == 65_536  # 16 scramblings of a power of two
    assert law("fixed", value=1.0)["value"] == 1.0
