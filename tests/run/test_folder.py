"""The folder of a run: what is there already is neither believed nor overwritten, nothing stays."""

import json
import os
import shutil

import pytest

import standfast as sf
from standfast.files import whole_file, writer_of
from standfast.run import folder as run_folder
from standfast.run.folder import RunFolder, parts_of
from standfast.run.shards import shard_path


def names(place):
    return sorted(path.name for path in place.iterdir())


def test_a_file_that_appears_during_the_run_is_not_overwritten(study, whole, tmp_path):
    path = tmp_path / "a.h5"

    def intrude(found):
        path.write_text("my only copy")

    with pytest.raises(sf.InputError, match="came to be while it was computed"):
        sf.sweep(study, path, estimate=intrude)
    assert path.read_text() == "my only copy"
    path.unlink()
    sf.sweep(study, path)
    assert path.read_bytes() == whole[1]


@pytest.mark.parametrize("code", sorted(run_folder.NO_LINKS))
def test_where_a_file_has_one_name_only_it_is_renamed(code, study, whole, tmp_path, monkeypatch):
    def refuse(*_):
        raise OSError(code, "no links here")

    monkeypatch.setattr(os, "link", refuse)
    path = tmp_path / "a.h5"
    sf.sweep(study, path)
    assert path.read_bytes() == whole[1]
    with pytest.raises(sf.InputError, match="came to be while"):
        sf.sweep(study, tmp_path / "b.h5", estimate=lambda _: (tmp_path / "b.h5").write_text("x"))
    assert (tmp_path / "b.h5").read_text() == "x"


def test_a_dangling_link_is_not_replaced(study, tmp_path):
    path = tmp_path / "a.h5"
    path.symlink_to(tmp_path / "nothing")
    with pytest.raises(sf.InputError, match="is a link to nothing"):
        sf.sweep(study, path)
    assert names(tmp_path) == ["a.h5"]


def test_a_folder_elsewhere_is_refused_at_the_start(study, tmp_path, small_disk):
    path = tmp_path / "a.h5"
    parts_of(path).symlink_to(small_disk)
    with pytest.raises(sf.InputError, match="is a link, or on another file system"):
        sf.sweep(study, path)
    assert not path.exists()


def test_what_is_refused_before_its_first_shard_leaves_no_folder(study, tmp_path, small_disk):
    (small_disk / "ballast").write_bytes(b"x" * 60_000_000)
    with pytest.raises(sf.InputError, match="of disk"):
        sf.sweep(study, small_disk / "a.h5")
    assert names(small_disk) == ["ballast"]


def test_a_straggler_finds_no_folder_and_leaves_nothing(study, whole, tmp_path):
    """A worker that was given up writes on while the caller finishes and tidies up."""
    path = tmp_path / "a.h5"
    sf.sweep(study, path, part=(1, 2))
    shard = RunFolder(path, study, parts_of(path)).new_shard(1)
    shard.__enter__().write_bytes(bytes(1000))
    sf.sweep(study, path)
    with pytest.raises(FileNotFoundError):
        shard.__exit__(None, None, None)
    assert path.read_bytes() == whole[1]
    assert names(tmp_path) == ["a.h5", "a.run.json"]


def test_a_run_killed_between_name_and_log_gets_its_log(study, whole, tmp_path, monkeypatch):
    path = tmp_path / "a.h5"

    def killed(folder):
        raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr(run_folder, "sync_folder", killed)
        patch.setattr(run_folder, "whole_file", whole_file_without_sync)
        with pytest.raises(KeyboardInterrupt):
            sf.sweep(study, path)
    assert path.read_bytes() == whole[1]
    assert not path.with_name("a.run.json").exists()
    sf.sweep(study, path)
    assert json.loads(path.with_name("a.run.json").read_text())["bytes"] == len(whole[1])
    assert names(tmp_path) == ["a.h5", "a.run.json"]


def whole_file_without_sync(path, *, synced=False):
    return whole_file(path)


def test_what_a_killed_tidying_left_is_removed(study, whole, tmp_path):
    path = tmp_path / "a.h5"
    shutil.copy(whole[0], path)
    moved = tmp_path / ".a.h5.parts.elsewhere.77.abcd.partial"
    moved.mkdir()
    (moved / "shard-000000.h5").write_text("x")
    sf.sweep(study, path)
    assert names(tmp_path) == ["a.h5"]


def test_a_part_looks_at_its_own_shards_alone(study, begun, monkeypatch):
    looked = []
    valid = run_folder.is_valid
    monkeypatch.setattr(run_folder, "is_valid", lambda *at: looked.append(at[2]) or valid(*at))
    sf.sweep(study, begun, part=(2, 3))
    assert looked == list(range(1, study.shard_count, 3))


def test_a_folder_is_listed_before_a_shard_is_called_missing(study, begun, monkeypatch):
    """Network file systems remember for a while what was not there, until the folder is listed."""
    listed = []
    valid = run_folder.is_valid
    lists = type(begun).iterdir
    monkeypatch.setattr(type(begun), "iterdir", lambda path: listed.append(path) or lists(path))
    monkeypatch.setattr(run_folder, "is_valid", lambda *at: bool(listed) and valid(*at))
    assert RunFolder(begun, study, parts_of(begun)).missing([0, 1]) == []
    assert listed == [parts_of(begun)]


def test_a_share_without_work_leaves_nothing(study, tmp_path):
    count = study.shard_count
    assert sf.sweep(study, tmp_path / "a.h5", part=(count + 1, count + 1)) is None
    assert names(tmp_path) == []


def test_shards_name_their_processor_and_need_not_be_of_one(study, whole, begun, monkeypatch):
    folder = RunFolder(begun, study, parts_of(begun))
    here = folder.processors()
    assert len(here) == 1
    path = shard_path(parts_of(begun), 0)
    content = path.read_bytes()
    header = content[:512].replace(here[0].encode(), b"another kind").rstrip().ljust(512)
    path.write_bytes(header + content[512:])
    assert folder.missing([0, 1]) == []
    assert folder.processors() == sorted(["another kind", *here])
    sf.sweep(study, begun)
    assert begun.read_bytes() == whole[1]
    noted = json.loads(begun.with_name("a.run.json").read_text())["processors_of_shards"]
    assert noted == sorted(["another kind", *here])


def test_what_killed_processes_of_this_host_left_is_removed(tmp_path):
    with whole_file(tmp_path / "a.png") as partial:
        host, _ = writer_of(partial)
        dead = tmp_path / f".a.png.{host}.{2**22 + 1}.abcd.partial"
        other = tmp_path / f".a.png.elsewhere.{2**22 + 1}.abcd.partial"
        dead.write_text("x")
        other.write_text("x")
        partial.write_text("whole")
    assert names(tmp_path) == [other.name, dead.name, "a.png"] or dead.exists()
    with whole_file(tmp_path / "a.png") as partial:
        partial.write_text("again")
    assert names(tmp_path) == [other.name, "a.png"]


def test_an_error_of_the_disk_names_the_file_that_was_asked_for(tmp_path):
    with (
        pytest.raises(OSError, match="No such file") as caught,
        whole_file(tmp_path / "nowhere" / "a.png") as partial,
    ):
        partial.write_text("x")
    assert caught.value.filename == str(tmp_path / "nowhere" / "a.png")
