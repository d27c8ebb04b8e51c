"""The file of a population: whole, the same for any threads or parts, labelled, coherent."""

import re
import subprocess
import sys
from pathlib import Path

import h5py
import numpy as np
import pytest

import populations
import standfast as sf
from populations import GOOD, RIGID, changed, law, of
from real_people import DATA, needs_people
from standfast.engine.mapping import map_over_batch
from standfast.population.cohort.cohort import WeightedRows, cohort_of
from standfast.population.cohort.persons import margins
from standfast.population.people.study import PopulationStudy
from standfast.population.simulation import simulate
from standfast.population.summary.file import open_population

G = 9.81

SMALL = changed("population.size", 300_000)


@pytest.fixture(scope="module")
def small(tmp_path_factory):
    """A finished population of several shards, and its bytes."""
    path = tmp_path_factory.mktemp("small") / "p.h5"
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("standfast.population.people.study.BLOCKS_PER_SHARD", 1)
        simulate(PopulationStudy.from_dict(SMALL), path, threads=1)
    return path.read_bytes()


@pytest.fixture
def short_shards(monkeypatch):
    monkeypatch.setattr("standfast.population.people.study.BLOCKS_PER_SHARD", 1)


@pytest.mark.parametrize("threads", [2, 3])
def test_the_number_of_threads_is_irrelevant(tmp_path, small, short_shards, threads):
    simulate(PopulationStudy.from_dict(SMALL), tmp_path / "p.h5", threads=threads)
    assert (tmp_path / "p.h5").read_bytes() == small


def test_parts_in_any_order_give_the_same_file(tmp_path, small, short_shards):
    study = PopulationStudy.from_dict(SMALL)
    for i in (3, 1, 2):
        assert simulate(study, tmp_path / "p.h5", part=(i, 3)) is None
    assert not (tmp_path / "p.h5").exists()
    simulate(study, tmp_path / "p.h5")
    assert (tmp_path / "p.h5").read_bytes() == small


def test_a_run_that_is_broken_off_goes_on_to_the_same_file(tmp_path, small, short_shards):
    study = PopulationStudy.from_dict(SMALL)
    assert study.shard_count == 3

    def stop(done, total):
        if done > total // 2:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        simulate(study, tmp_path / "p.h5", progress=stop)
    done = []
    simulate(study, tmp_path / "p.h5", progress=lambda d, t: done.append(t))
    assert (tmp_path / "p.h5").read_bytes() == small
    assert done[-1] < study.size
    assert not (tmp_path / "p.h5.parts").exists()


def test_the_output_of_another_study_is_refused(tmp_path):
    path = tmp_path / "p.h5"
    simulate(of(GOOD, size=100), path)
    with pytest.raises(sf.InputError, match=r"population\.seed: 5 there, 6 here"):
        simulate(of(GOOD, size=100, seed=6), path)
    assert open_population(path).summary["size"] == 100


def test_the_file_is_labelled(tmp_path):
    xarray = pytest.importorskip("xarray")
    path = tmp_path / "p.h5"
    found = simulate(of(GOOD, size=20_000), path)
    with xarray.open_dataset(path, engine="h5netcdf") as ds:
        assert ds["risk"].dims == ("height", "bmi")
        assert ds["required_ankle_stiffness"].attrs["units"] == "N·m/rad"
        at_95 = ds["required_ankle_stiffness"].sel(standing_share=0.95).item()
        assert at_95 == found.summary["required_stiffness"]["ankle"]["0.95"]["stiffness"]
        survival = ds["survival"].interp(safety_factor=1.0).item()
        assert survival == pytest.approx(1.0 - found.summary["unstable_fraction"], abs=1e-9)
        assert ds["persons"].sum() <= 20_000


def test_the_answers_hang_together(tmp_path):
    """Strata add up to the whole, and a multiple of 1 gives the fraction itself."""
    study = of(changed("population.sex", None), size=100_000, age="60+")
    found = simulate(study, tmp_path / "p.h5")
    summary = found.summary
    for classes in summary["strata"].values():
        shares = [each["share"] for each in classes.values()]
        risks = [each["unstable_fraction"] for each in classes.values()]
        assert sum(shares) == pytest.approx(1.0)
        assert np.dot(shares, risks) == pytest.approx(summary["unstable_fraction"])
    multiple = found.array("multiple")
    for joint in ("ankle", "knee", "hip", "all"):
        risk = np.interp(1.0, multiple, found.array(f"risk_by_{joint}_multiple"))
        assert risk == pytest.approx(summary["unstable_fraction"], abs=2e-3)
        assert (np.diff(found.array(f"risk_by_{joint}_multiple")) <= 1e-12).all()
    low, high = summary["unstable_fraction_interval"]
    assert low < summary["unstable_fraction"] < high


def test_more_persons_than_are_looked_at_closely(tmp_path, monkeypatch):
    """Beyond a size, distributions come from the first persons; fractions from all."""
    whole = simulate(of(GOOD, size=400_000), tmp_path / "a.h5").summary
    monkeypatch.setattr("standfast.population.cohort.counting.DETAILED", 2**17)
    less = simulate(of(GOOD, size=400_000), tmp_path / "b.h5").summary
    assert less["unstable_fraction"] == whole["unstable_fraction"]
    assert less["persons_with_details"] == 2**17
    for share in ("0.5", "0.95"):
        ours, all_of_them = (s["required_stiffness"]["ankle"][share] for s in (less, whole))
        (low, high), (lowest, highest) = (s["stiffness_interval"] for s in (ours, all_of_them))
        assert low < highest
        assert lowest < high
        assert high - low > highest - lowest


def test_persons_are_kept_when_asked(tmp_path):
    content = changed("output.persons", True)
    content["population"]["size"] = 70_000
    found = simulate(PopulationStudy.from_dict(content), tmp_path / "p.h5")
    stable, safety = found.array("person_stable"), found.array("person_safety_factor")
    assert stable.shape == (70_000,)
    assert 1.0 - stable.mean() == pytest.approx(found.summary["unstable_fraction"])
    assert np.array_equal(stable == 1, safety > 1.0)
    body = sf.Body.from_height_mass(
        float(found.array("person_height")[-1]), float(found.array("person_mass")[-1])
    )
    K = sf.Stiffness(*(found.array(f"person_{j}_stiffness")[-1] for j in ("ankle", "knee", "hip")))
    assert sf.safety_factor(body, K, gravity=G) == pytest.approx(safety[-1], rel=1e-12)
    with h5py.File(tmp_path / "p.h5") as file:
        assert file["person_height"].attrs["units"] == b"m"


PEOPLE = "id,height,mass,sex,age\nÄ1,1.7,70,f,80+\nB,1.8,80,divers,30\nlonger id,1.6,60,,\n"


@pytest.mark.parametrize("fed_back", [False, True])
def test_kept_persons_say_who_they_are_to_any_reader(tmp_path, fed_back):
    xarray = pytest.importorskip("xarray")
    (tmp_path / "p.csv").write_text(PEOPLE, encoding="utf-8")
    content = changed("population", {"people": "p.csv", "size": 500, "age_bands": [18, 65]})
    content["output"] = {"persons": True}
    if fed_back:
        content["feedback"] = {"delay": 0.1, "proportional": {"ankle": 300.0}}
    study = PopulationStudy.from_dict(content, folder=tmp_path)
    found = simulate(study, tmp_path / "p.h5")
    rows = {"Ä1": (1.7, "female", 80.0), "B": (1.8, "other", 30.0)}
    rows |= {"longer id": (1.6, "unknown")}
    for engine in ("h5netcdf", "netcdf4"):
        with xarray.open_dataset(tmp_path / "p.h5", engine=engine) as ds:
            assert not [name for name in ds.dims if "phony" in str(name)]
            assert ds.sizes["person"] == 500
            sexes = ds["person_sex"].attrs["flag_meanings"].split()
            ages = ds["person_age_class"].attrs["flag_meanings"].split()
            assert ages == ["under_18", "18-64", "65+", "unknown"]
            for variable in ds.variables.values():
                assert len(variable.attrs.get("long_name", "")) <= 40
            ids = [i.decode() if isinstance(i, bytes) else i for i in ds["person_id"].values]
            assert set(ids) == set(rows)
            for number, name in enumerate(ids):
                height, sex, *age = rows[name]
                assert ds["person_height"].values[number] == height
                assert sexes[int(ds["person_sex"].values[number])] == sex
                years = ds["person_age"].values[number]
                assert (years == age[0]) if age else np.isnan(years)
                wanted = "unknown" if not age else "65+" if age[0] >= 65 else "18-64"
                assert ages[int(ds["person_age_class"].values[number])] == wanted
    assert found.array("person_id")[0].decode() in rows
    assert found.summary["strata"]["age"].keys() == {"18-64", "65+", "unknown"}
    assert list(found.summary["strata"]["sex"]) == ["female", "other", "unknown"]


def test_nobody_who_differs_has_no_drivers(tmp_path):
    content = changed("stiffness.ankle", law("fixed", "mgh", value=5.0))
    content["stiffness"] |= {"knee": RIGID, "hip": RIGID}
    summary = simulate(PopulationStudy.from_dict(content), tmp_path / "p.h5").summary
    assert summary["unstable_fraction"] == 0.0
    assert summary["unstable_fraction_interval"][1] > 0.0
    assert summary["growth_rate_of_the_unstable"] is None
    remark = summary["drivers"]["unstable"]["remark"]
    assert re.fullmatch(r"none of [\d,]+ looked at falls; nothing drives it", remark)
    rigid = {"ankle": RIGID, "knee": RIGID, "hip": RIGID}
    content = changed("stiffness", rigid)
    summary = simulate(PopulationStudy.from_dict(content), tmp_path / "q.h5").summary
    assert "infinite for some" in summary["drivers"]["safety_factor"]["remark"]


def test_drivers_of_this_model_agree_with_salib(tmp_path):
    """The package's own margins, sampled and analysed by SALib."""
    sample = pytest.importorskip("SALib.sample.sobol")
    analyze = pytest.importorskip("SALib.analyze.sobol")
    study = of(changed("stiffness.ankle", law("lognormal", mean=1124.0, sd=284.0)), size=1000)
    cohort = cohort_of(study, None)
    names = [c.name for c in cohort.sampler.coordinates]
    problem = {
        "num_vars": len(names),
        "names": names,
        "bounds": [[1e-12, 1.0 - 1e-12]] * len(names),
    }
    points = sample.sample(problem, 2**14, calc_second_order=False, seed=8).T
    values = map_over_batch(margins, cohort.model, cohort.names)(
        cohort.sampler.from_uniform(points.copy())
    )
    drivers = simulate(study, tmp_path / "p.h5").summary["drivers"]
    for output in ("unstable", "safety_factor"):
        theirs = analyze.analyze(problem, values[output], calc_second_order=False, seed=8)
        for i, ours in enumerate(drivers[output].values()):
            for key, name in (("S1", "first"), ("ST", "total")):
                half = 0.5 * np.ptp(ours[f"{name}_interval"])
                assert abs(theirs[key][i] - ours[name]) < theirs[f"{key}_conf"][i] + half


@pytest.mark.skipif(sys.platform != "linux", reason="reads the peak from /proc")
def test_memory_is_bounded(tmp_path):
    """Peak memory of counting: below 1 GiB, and not growing by a byte for each of 60 million.

    From run to run the peak of two threads differs by up to 70 MB, whatever the number of persons:
    as many in parts come first, so that both peaks are the largest of as many batches.
    """
    script = f"""
from pathlib import Path
from standfast.population.simulation import simulate
import sys; sys.path.insert(0, {str(Path(populations.__file__).parent)!r})
from populations import GOOD, of
peaks = []
for part, size in enumerate([20_000_000] * 4 + [80_000_000]):
    simulate(of(GOOD, size=size), "p%d.h5" % part)
    status = Path("/proc/self/status").read_text()
    peaks.append(int(status.split("VmHWM:")[1].split()[0]))
print(*peaks)
"""
    out = subprocess.run(
        [sys.executable, "-c", script], cwd=tmp_path, capture_output=True, text=True, check=True
    )
    *_, first, last = map(int, out.stdout.split())
    assert (last - first) * 1024 < 60e6
    assert last * 1024 < 2**30


def test_the_function_is_exported():
    assert sf.simulate is simulate
    assert sf.PopulationStudy is PopulationStudy


def test_strata_that_nobody_was_drawn_of_are_left_out(tmp_path):
    summary = simulate(
        of(GOOD | {"population": {"builtin": "nhanes-2017-2018"}}, size=1), tmp_path / "p.h5"
    ).summary
    assert sum(len(summary["strata"][key]) for key in ("sex", "age")) == 2


def test_the_beginnings_of_a_sweep_are_not_destroyed(tmp_path):
    sweep = {
        "body": {"height": 1.7, "mass": 70.0},
        "stiffness": {"ankle": [1.0, 2.0], "knee": 900.0, "hip": 500.0},
    }
    path = tmp_path / "p.h5"
    sf.sweep(sf.Study.from_dict(sweep), path, part=(1, 2))
    with pytest.raises(sf.InputError, match="the beginnings of another kind of study"):
        simulate(of(GOOD, size=100), path)
    sf.sweep(sf.Study.from_dict(sweep), path)
    simulate(of(GOOD, size=100), tmp_path / "q.h5", part=(1, 2))
    with pytest.raises(sf.InputError, match="the beginnings of another kind of study"):
        sf.sweep(sf.Study.from_dict(sweep), tmp_path / "q.h5")


def test_rare_rows_are_drawn_as_often_as_they_weigh():
    weights = np.array([1.0] * 10 + [1e-3] * 5 + [0.0])
    rows = WeightedRows.of(weights).at(np.random.default_rng(1).random(2_000_000))
    counts = np.bincount(rows, minlength=16)
    wanted = weights / weights.sum() * 2_000_000
    assert counts[-1] == 0
    assert (abs(counts - wanted)[:-1] < 5.0 * np.sqrt(wanted[:-1])).all()


@needs_people
def test_the_survey_interval_never_claims_more_than_the_people_tell(tmp_path):
    content = changed(
        "population", {"people": str(DATA / "ANSUR_II_FEMALE_Public.csv"), "size": 20_000}
    )
    content["stiffness"]["ankle"] = law("fixed", "mgh", value=50.0)
    content["stiffness"] |= {"knee": RIGID, "hip": RIGID}
    people = simulate(PopulationStudy.from_dict(content), tmp_path / "p.h5").summary["people"]
    low, high = people["survey_interval"]
    assert low == 0.0
    assert high == pytest.approx(3.84 / 1986, rel=0.01)
