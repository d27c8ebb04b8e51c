"""People with segments of their own, and a body model for each sex."""

import csv
import math

import numpy as np
import pytest

import standfast as sf
from populations import RIGID, drawn, law
from standfast.cli.app import main
from standfast.engine.mapping import map_over_batch
from standfast.parameters import OWN_BODY
from standfast.population.assess import assess
from standfast.population.cohort.cohort import cohort_of
from standfast.population.cohort.persons import outcome
from standfast.population.people.records import read_people
from standfast.population.people.study import PopulationStudy

G = 9.81
MODELS = {"female": "de-leva-female", "male": "de-leva-male"}
SEXES = ("male", "female", "")
SPRINGS = (900.0, 1500.0, 500.0)
BY_SEX = {"male": "de-leva-male", "female": "de-leva-female", "": "winter"}
# The same body by two ways: its segments written with all digits, or scaled in the batch.
RTOL = 1e-12


def people(count=9):
    """Sex, height and mass of some persons."""
    random = np.random.default_rng(3)
    for number in range(count):
        yield SEXES[number % 3], random.uniform(1.5, 1.9), random.uniform(50.0, 100.0)


def heavier(body):
    """A body whose upper body's centre of mass lies higher than a model says."""
    shank, thigh, upper = body.segment_com
    return body._replace(segment_com=(shank, thigh, 1.1 * upper))


def write(path, *, own=lambda number: True, columns=OWN_BODY, changed=None):
    """Write people with their own segments, or empty entries, under their columns."""
    with path.open("w", newline="") as file:
        rows = csv.writer(file)
        rows.writerow(["sex", "height", "mass", *columns])
        for number, (sex, height, mass) in enumerate(people()):
            body = heavier(sf.Body.from_height_mass(height, mass, BY_SEX[sex]))
            values = dict(zip(OWN_BODY, (float(v) for part in body for v in part), strict=True))
            values |= (changed or {}).get(number, {})
            entries = [values[name] if own(number) else "" for name in columns]
            rows.writerow([sex, height, mass, *entries])
    return path


def factors(bodies):
    return [float(sf.safety_factor(body, sf.Stiffness(*SPRINGS), G)) for body in bodies]


def assessed(path, **more):
    stiffness = dict(zip(("ankle", "knee", "hip"), SPRINGS, strict=True))
    found = assess(read_people([path]), gravity=G, otherwise=stiffness, **more)
    return found.columns["safety_factor"]


def test_each_is_assessed_with_the_own_segments_and_the_rest_by_the_model_of_their_sex(tmp_path):
    path = write(tmp_path / "people.csv", own=lambda number: number >= 3)
    scaled = [sf.Body.from_height_mass(h, m, BY_SEX[sex]) for sex, h, m in people()]
    wanted = factors([*scaled[:3], *map(heavier, scaled[3:])])
    np.testing.assert_allclose(
        assessed(path, body_model={**MODELS, "other": "winter"}), wanted, RTOL
    )
    words = "6 of 9 have segments of their own, the others are scaled"
    assert words in read_people([path]).remarks
    # a model of all changes those alone who are scaled
    all_winter = assessed(path)
    assert np.array_equal(np.isclose(all_winter, wanted, rtol=RTOL), [False, False] + 7 * [True])


def test_own_segments_decide_with_feedback_too(tmp_path):
    feedback = {
        "feedback_delay": 0.05,
        "ankle_proportional_gain": 400.0,
        "ankle_derivative_gain": 200.0,
    }
    path = write(tmp_path / "people.csv", own=lambda number: number != 1)
    with path.open() as file:
        head, *rows = file.read().splitlines()
    lines = [",".join([head, *feedback])]
    lines += [",".join([row, *map(str, feedback.values())]) for row in rows]
    path.write_text("\n".join(lines))
    stiffness = {"ankle": 600.0, "knee": math.inf, "hip": math.inf}
    found = assess(read_people([path]), body_model={**MODELS, "other": "winter"}, gravity=G,
                   otherwise=stiffness)  # fmt: skip
    wanted = []
    for number, (sex, height, mass) in enumerate(people()):
        body = sf.Body.from_height_mass(height, mass, BY_SEX[sex])
        fed_back = sf.Feedback((400.0, 0.0, 0.0), (200.0, 0.0, 0.0))
        springs = sf.Stiffness(600.0, math.inf, math.inf)
        body = body if number == 1 else heavier(body)
        wanted.append(sf.critical_delay(body, springs, G, feedback=fed_back))
    np.testing.assert_allclose(found.columns["critical_delay_s"], wanted, rtol=1e-9)


@pytest.mark.parametrize("proportions", ["fixed", "scattered"])
def test_a_population_of_the_file_is_of_these_bodies(tmp_path, proportions):
    path = write(tmp_path / "people.csv", own=lambda number: number >= 3)
    study = PopulationStudy.from_dict(
        {
            "gravity": G,
            "population": {"people": path.name, "size": 256, "body_model": MODELS,
                           "proportions": proportions},
            "stiffness": {joint: law("fixed", value=k) for joint, k in
                          zip(("ankle", "knee", "hip"), SPRINGS, strict=True)},
        },
        folder=tmp_path,
    )  # fmt: skip
    assert study.content["population"]["body_model"] == {**MODELS, "other": "winter"}
    assert PopulationStudy.from_canonical(study.canonical).canonical == study.canonical
    cohort = cohort_of(study, study.read_people())
    numbers = cohort.numbers(cohort.sampler.variates(0, 0, 256))
    found = map_over_batch(outcome, cohort.model, cohort.names)(numbers)
    wanted = {}
    for number, (sex, height, mass) in enumerate(people()):
        body = sf.Body.from_height_mass(height, mass, BY_SEX[sex])
        wanted[height] = factors([heavier(body) if number >= 3 else body])[0]
    assert len(set(found["height"])) == 9
    of_own = np.array([list(wanted).index(height) >= 3 for height in found["height"]])
    right = np.isclose(found["safety_factor"], [wanted[h] for h in found["height"]], rtol=RTOL)
    # scattered proportions are of those alone whose body is not known
    assert right[of_own].all()
    assert right[~of_own].all() == (proportions == "fixed")


def test_a_model_by_sex_in_a_builtin_population():
    def loads(model, sex):
        content = {
            "gravity": G,
            "population": {"builtin": "nhanes-2017-2018", "size": 64, "body_model": model,
                           **({"sex": sex} if sex else {})},
            "stiffness": {"ankle": law("fixed", value=900.0), "knee": RIGID, "hip": RIGID},
        }  # fmt: skip
        cohort = cohort_of(PopulationStudy.from_dict(content), None)
        numbers = cohort.numbers(cohort.sampler.variates(0, 0, 64))
        found = drawn(cohort, numbers)
        sexes = np.array([sex for sex, _ in cohort.strata])[found["stratum"].astype(int)]
        return found["ankle_load"], sexes

    mixed, sexes = loads(MODELS, None)
    of_women, _ = loads(MODELS["female"], None)
    of_men, _ = loads(MODELS["male"], None)
    assert set(sexes) == {"female", "male"}
    np.testing.assert_allclose(mixed, np.where(sexes == "female", of_women, of_men), rtol=RTOL)
    assert not np.isclose(of_women, of_men, rtol=0.01).any()


WRONG_ROWS = (
    ({"thigh_mass": ""}, "no thigh_mass, but other segments; give all of them, or none"),
    ({"shank_com": 0.7}, "the centre of mass of the shank lies 0.7 m above its lower end, but"),
    ({"upper_body_mass": 150.0}, "kg together and the person"),
    ({"shank_length": 38.0}, "shank_length = 38 is outside the allowed range, 0.01 to 2 m"),
)


@pytest.mark.parametrize(("changes", "reason"), WRONG_ROWS)
def test_wrong_segments_refuse_their_row(tmp_path, changes, reason):
    found = read_people([write(tmp_path / "people.csv", changed={4: changes})])
    (rejection,) = found.rejected
    assert reason in str(rejection)
    assert rejection.line == 6


def test_some_segments_alone_are_not_used_and_it_is_said(tmp_path):
    path = write(tmp_path / "people.csv", columns=("shank_length", "thigh_length"))
    found = read_people([path])
    assert found.measured == {}
    words = (
        "people.csv: shank_length, thigh_length not used: bodies of own segments need the columns"
    )
    assert found.remarks[0].startswith(words)


def test_lengths_in_centimetres_are_read(tmp_path):
    columns = [f"{n}_cm" if n.endswith(("length", "com")) else n for n in OWN_BODY]
    path = write(tmp_path / "people.csv")
    in_metres = assessed(path)
    head, *rows = csv.reader(path.read_text().splitlines())
    with path.open("w", newline="") as file:
        out = csv.writer(file)
        out.writerow([*head[:3], *columns])
        out.writerows(
            [*row[:3], *(float(v) * (100.0 if c.endswith("_cm") else 1.0)
                         for v, c in zip(row[3:], columns, strict=True))]
            for row in rows
        )  # fmt: skip
    np.testing.assert_allclose(assessed(path), in_metres, rtol=RTOL)


def test_models_on_the_command_line(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    write(tmp_path / "people.csv", own=lambda number: False)
    springs = ["--ankle", "900", "--knee", "1500", "--hip", "500", "--gravity", "9.81"]
    by_sex = "female=de-leva-female,male=de-leva-male"
    assert main(["assess", "people.csv", *springs, "--body-model", by_sex, "-o", "a.csv"]) == 0
    rows = list(csv.DictReader((tmp_path / "a.csv").read_text().splitlines()))
    bodies = [sf.Body.from_height_mass(h, m, BY_SEX[sex]) for sex, h, m in people()]
    assert [row["safety_factor"] for row in rows] == [f"{f:.6g}" for f in factors(bodies)]
    for text, sentence in (
        ("female=winter", "--body-model has no model for male; give female and male, or one"),
        ("female=wintr,male=winter", "--body-model.female = 'wintr' is not known; did you mean"),
        ("femal=winter,male=winter", "--body-model has no key 'femal'; did you mean 'female'?"),
        ("female=winter,male", "--body-model.male = '' is not known"),
        ("wintr", "--body-model = 'wintr' is not known; did you mean 'winter'?"),
    ):
        assert main(["assess", "people.csv", "--body-model", text]) == 2
        assert sentence in capsys.readouterr().err
