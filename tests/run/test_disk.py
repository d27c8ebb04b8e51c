"""When the disk is full or fails while an atlas is made: told in one error, and nothing lost."""

import errno
import shutil

import pytest

import populations
import standfast as sf
from standfast.atlas import writer
from standfast.run import folder as run_folder
from standfast.run.folder import parts_of
from standfast.run.shards import new_shard
from studies import GOOD


def test_a_full_disk_is_one_error_and_can_be_resumed(study, whole, small_disk):
    path = small_disk / "a.h5"
    ballast = small_disk / "ballast"

    def fill(forecast):
        free = shutil.disk_usage(small_disk).free
        ballast.write_bytes(b"x" * (free - 20_000_000))

    with pytest.raises(OSError, match=r".") as caught:
        sf.sweep(study, path, estimate=fill)
    assert caught.value.errno == errno.ENOSPC
    assert not path.exists()
    assert not list(parts_of(path).glob("*.partial"))
    ballast.unlink()
    sf.sweep(study, path)
    assert path.read_bytes() == whole[1]


def test_a_full_disk_at_the_very_end(study, whole, small_disk):
    """Room for the shards but not for the finished file beside them."""
    path = small_disk / "a.h5"
    ballast = small_disk / "ballast"
    sf.sweep(study, path, part=(1, 1))
    free = shutil.disk_usage(small_disk).free
    ballast.write_bytes(b"x" * (free - 10_000_000))
    with pytest.raises(OSError, match="no space left") as caught:
        sf.sweep(study, path)
    assert caught.value.errno == errno.ENOSPC
    assert not path.exists()
    ballast.unlink()
    sf.sweep(study, path)
    assert path.read_bytes() == whole[1]


def test_a_study_that_does_not_fit_the_disk_is_refused_with_the_numbers(study, small_disk):
    (small_disk / "ballast").write_bytes(b"x" * 60_000_000)
    with pytest.raises(sf.InputError, match=r"needs about .* MB of disk .* and .* MB are free"):
        sf.sweep(study, small_disk / "a.h5")


def test_a_failed_sync_while_the_file_grows_is_told(study, whole, begun, monkeypatch):
    """The system tells a failure to write once; a later sync knows nothing of it."""
    calls = []

    def fail_once(path):
        calls.append(path)
        if len(calls) == 1:
            raise OSError(errno.EIO, "the disk said no")

    with monkeypatch.context() as patch:
        patch.setattr(writer, "sync_file", fail_once)
        patch.setattr(writer, "SYNCED_BYTES", 2**20)
        with pytest.raises(OSError, match="the disk said no"):
            sf.sweep(study, begun)
    assert len(calls) > 1
    assert not begun.exists()
    sf.sweep(study, begun)
    assert begun.read_bytes() == whole[1]


def test_a_file_that_cannot_be_written_leaves_no_partial_shard(study, whole, tmp_path, monkeypatch):
    """Also while somebody holds the traceback."""
    path = tmp_path / "a.h5"

    def refusing(path, study, tiles, *, header=0):
        for number, tile in enumerate(tiles):
            if number == 8:
                raise OSError(errno.ENOSPC, "no space left")
            yield tile

    with monkeypatch.context() as patch:
        patch.setattr(writer, "write_chunks", refusing)
        with pytest.raises(OSError, match="no space left") as caught:
            sf.sweep(study, path)
    assert caught.tb is not None
    assert not list(parts_of(path).glob(".*.partial"))
    sf.sweep(study, path)
    assert path.read_bytes() == whole[1]


def test_errors_of_others_are_not_called_hdf5s(study, tmp_path):
    def interrupt(done, total):
        raise RuntimeError("mine")

    with pytest.raises(RuntimeError, match="mine"):
        sf.sweep(study, tmp_path / "a.h5", progress=interrupt)
    people = sf.PopulationStudy.from_dict(populations.GOOD)
    with pytest.raises(RuntimeError, match="mine"):
        sf.simulate(people, tmp_path / "p.h5", progress=interrupt)


def test_the_forecast_of_the_disk_is_what_is_written(study, whole, tmp_path):
    """Within the chunks that were not computed for it; a part needs its shards alone."""
    path = tmp_path / "a.h5"
    told = []
    sf.sweep(study, path, part=(1, 2), estimate=lambda forecast: told.append(forecast.disk_bytes))
    shards = sum(item.stat().st_size for item in parts_of(path).glob("shard-*.h5"))
    assert told[0] == pytest.approx(shards, rel=0.2)
    sf.sweep(study, path, estimate=lambda forecast: told.append(forecast.disk_bytes))
    size = path.stat().st_size
    assert size < told[1] < 1.2 * 2 * size


def test_what_a_failed_finish_left_is_swept_away(study, whole, begun, monkeypatch):
    """Also when there is room for the file only once the leftover is gone."""
    folder = parts_of(begun)
    for name in (".whole.partial", ".shard-000001.h5.99.partial"):
        (folder / name).write_bytes(b"x" * 1000)
    seen = []
    require = run_folder.require_room
    monkeypatch.setattr(
        run_folder, "require_room",
        lambda place, size: seen.append(list(place.glob(".*.partial"))) or require(place, size),
    )  # fmt: skip
    sf.sweep(study, begun)
    assert seen == [[]]
    assert begun.read_bytes() == whole[1]


def test_a_finish_that_fails_leaves_the_shards_and_no_partial(study, whole, begun, monkeypatch):
    def fail(path):
        raise OSError(errno.EIO, "the disk said no")

    with monkeypatch.context() as patch:
        patch.setattr(run_folder, "sync_file", fail)
        with pytest.raises(OSError, match="the disk said no"):
            sf.sweep(study, begun)
    assert not begun.exists()
    assert not list(parts_of(begun).glob(".*.partial"))
    sf.sweep(study, begun)
    assert begun.read_bytes() == whole[1]


@pytest.mark.parametrize("kind", ["sweep", "population"])
def test_a_shard_with_a_true_header_and_false_content_gets_a_sentence(tmp_path, kind):
    """Only who means to deceive makes one: its checksum is right."""
    target = tmp_path / "a.h5"
    if kind == "sweep":
        study, compute = sf.Study.from_dict(GOOD), sf.sweep
    else:
        study, compute = populations.of(populations.GOOD, size=1000), sf.simulate
    compute(study, target, part=(1, 1))
    with new_shard(parts_of(target), study, 0) as path:
        path.write_bytes(bytes(5000))
    with pytest.raises(sf.InputError, match=r"is damaged or cut short|is not of its size"):
        compute(study, target)
    assert not target.exists()
