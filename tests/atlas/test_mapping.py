"""An atlas is a mapping and a context manager; the same grid in memory."""

import json

import numpy as np
import pytest

import standfast as sf
from populations import GOOD as PEOPLE
from populations import of
from standfast.population.simulation import simulate
from studies import GOOD, UNEQUAL, changed


@pytest.fixture(scope="module")
def atlas(tmp_path_factory):
    study = sf.Study.from_dict(changed("output.quantities", ["stable", "frequency"], UNEQUAL))
    return sf.sweep(study, tmp_path_factory.mktemp("atlas") / "a.h5")


def test_it_is_a_mapping(atlas):
    assert list(atlas) == ["stable", "frequency"]
    assert len(atlas) == 2
    assert "stable" in atlas
    assert "stabel" not in atlas
    assert atlas.get("stabel") is None
    assert dict(atlas.items())["stable"].dims == atlas["stable"].dims
    assert atlas == sf.open_atlas(atlas.path)
    assert len({atlas, sf.open_atlas(atlas.path)}) == 1
    for kind in (sf.InputError, KeyError):
        with pytest.raises(kind, match="has no 'stabel'; did you mean 'stable'"):
            atlas["stabel"]


def test_it_is_a_context_manager(atlas):
    outside = np.asarray(atlas["frequency"])
    with sf.open_atlas(atlas.path) as opened:
        with opened.file() as first, opened.file() as second:
            assert first is second
        assert np.array_equal(np.asarray(opened["frequency"]), outside, equal_nan=True)
    assert not first
    assert np.array_equal(np.asarray(opened["frequency"]), outside, equal_nan=True)


def test_the_grid_in_memory_is_that_of_the_file(tmp_path):
    pytest.importorskip("xarray")
    study = sf.Study.from_dict(UNEQUAL)
    stored = sf.sweep(study, tmp_path / "a.h5").to_xarray().load()
    computed = sf.compute(study)
    assert computed.identical(stored)
    assert not (computed + 1.0).identical(stored)
    assert sf.compute(study, threads=1).identical(stored)


def test_a_population_has_a_log_and_an_estimate_like_a_sweep(tmp_path):
    estimates, steps = [], []
    study = of(PEOPLE, size=300_000)
    simulate(
        study,
        tmp_path / "p.h5",
        estimate=estimates.append,
        progress=lambda done, total: steps.append((done, total)),
    )
    (estimate,) = estimates
    assert estimate.points == 300_000
    assert estimate.free_bytes > estimate.disk_bytes > 0
    assert steps[-1] == (300_000, 300_000)
    log = json.loads((tmp_path / "p.run.json").read_text(encoding="utf-8"))
    assert log["persons_computed_in_this_run"] == 300_000
    assert log["study_sha256"] == study.fingerprint
    assert {"seconds", "machine", "versions", "persons_per_second"} <= set(log)


def test_studies_are_keys_and_atlases_answer_in():
    """Equal studies have one hash, in whatever order they were written."""
    study = sf.Study.from_dict(GOOD)
    turned = sf.Study.from_dict(dict(reversed(GOOD.items())))
    assert study == turned
    assert hash(study) == hash(turned)
    assert {study: 1}[sf.Study.from_canonical(study.canonical)] == 1


def test_busy_is_a_public_name():
    assert issubclass(sf.BusyError, sf.InputError)
