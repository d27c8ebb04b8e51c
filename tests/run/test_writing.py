"""Making an atlas: the same bytes always, whole or not there, whatever is killed or damaged."""

import contextlib
import itertools
import json
import os
import random
import shutil
import signal
import socket
import subprocess
import sys
import time
from pathlib import Path

import pytest

import standfast as sf
import studies
from standfast.run import folder as run_folder
from standfast.run.folder import parts_of
from standfast.run.shards import is_valid, shard_path
from studies import GOOD, changed, several_shards

VERSION = sf.__version__


KILLS = 6


HELPERS = Path(studies.__file__).parent


RUN = (
    "import sys; sys.path.insert(0, {tests!r}); import studies, standfast as sf\n"
    "sf.sweep(sf.Study.from_dict(studies.several_shards()), sys.argv[1], {arguments})"
)


def process(output: Path, arguments: str = "") -> subprocess.Popen[bytes]:
    code = RUN.format(tests=str(HELPERS), arguments=arguments)
    return subprocess.Popen([sys.executable, "-c", code, str(output)], stderr=subprocess.PIPE)


def test_nothing_but_the_atlas_and_its_story_is_left(whole):
    path, _ = whole
    assert {item.name for item in path.parent.iterdir()} == {"atlas.h5", "atlas.run.json"}
    story = json.loads((path.parent / "atlas.run.json").read_text())
    assert story["values"] == sf.open_atlas(path).study.points
    assert {"seconds", "machine", "versions", "values_per_second"} <= set(story)


def test_the_same_call_returns_the_finished_atlas(study, whole):
    path, content = whole
    before = path.stat().st_mtime_ns
    assert sf.sweep(study, path).study == study
    assert path.stat().st_mtime_ns == before
    assert path.read_bytes() == content


@pytest.mark.parametrize("threads", [1, 2, 3])
def test_thread_count_is_irrelevant(study, whole, tmp_path, threads):
    sf.sweep(study, tmp_path / "a.h5", threads=threads)
    assert (tmp_path / "a.h5").read_bytes() == whole[1]


def test_order_of_parts_is_irrelevant_and_a_later_call_finishes_the_rest(study, whole, tmp_path):
    path = tmp_path / "a.h5"
    for part in (3, 1):
        assert sf.sweep(study, path, part=(part, 3)) is None
        assert not path.exists()
    sf.sweep(study, path)
    assert path.read_bytes() == whole[1]
    assert not parts_of(path).exists()


def test_two_processes_share_the_work(study, whole, tmp_path):
    path = tmp_path / "a.h5"
    runs = [process(path, f"part=({number}, 2)") for number in (1, 2)]
    for run in runs:
        _, message = run.communicate(timeout=120)
        assert run.returncode == 0, message.decode()
    calls = []
    sf.sweep(study, path, progress=lambda done, total: calls.append((done, total)))
    assert calls == []  # nothing was left to compute
    assert path.read_bytes() == whole[1]


def test_kills_at_random_moments_leave_no_trace(study, whole, tmp_path):
    """SIGKILL, resume, and again: the long form is benchmarks/kill.py."""
    rng = random.Random(7)  # noqa: S311 - a test's draws
    path = tmp_path / "a.h5"
    killed = finished = 0
    while killed < KILLS:
        run = process(path)
        deadline = time.monotonic() + rng.uniform(0.8, 4.0)
        while time.monotonic() < deadline and run.poll() is None:
            time.sleep(0.01)
            if path.exists():
                assert path.read_bytes() == whole[1]  # never a torn file under the final name
        run.kill()
        run.communicate()
        killed += run.returncode == -signal.SIGKILL
        if path.exists():
            finished += 1
            assert path.read_bytes() == whole[1]
            path.unlink()
            shutil.rmtree(parts_of(path), ignore_errors=True)
    sf.sweep(study, path)
    assert path.read_bytes() == whole[1]


def damaged(path: Path, how: str) -> None:
    content = bytearray(path.read_bytes())
    if how == "torn":
        content = content[: len(content) // 2]
    elif how == "emptied":
        content = bytearray()
    elif how == "flipped":
        content[len(content) // 3] ^= 4
    elif how == "flipped header":
        content[30] ^= 1
    elif how == "longer":
        content += b"x"
    path.write_bytes(content)


@pytest.mark.parametrize("how", ["torn", "emptied", "flipped", "flipped header", "longer"])
def test_a_damaged_shard_is_detected_and_recomputed(study, whole, begun, how):
    folder = parts_of(begun)
    damaged(shard_path(folder, 2), how)
    assert not is_valid(folder, study, 2)
    assert is_valid(folder, study, 1)
    calls = []
    sf.sweep(study, begun, progress=lambda done, total: calls.append(total))
    inside = sum(study.grid.groups[t.group].points for t in study.grid.shard(2)[:1])
    assert 0 < calls[-1] < inside
    assert begun.read_bytes() == whole[1]


def test_a_foreign_shard_is_detected_and_recomputed(study, whole, begun, tmp_path):
    folder = parts_of(begun)
    other = sf.Study.from_dict(changed("gravity", 9.8, several_shards()))
    sf.sweep(other, tmp_path / "other.h5", part=(1, 1))
    shutil.copy(shard_path(parts_of(tmp_path / "other.h5"), 0), shard_path(folder, 0))
    shutil.copy(shard_path(folder, 1), shard_path(folder, 2))  # another place's shard
    assert not is_valid(folder, study, 0)
    assert not is_valid(folder, study, 2)
    sf.sweep(study, begun)
    assert begun.read_bytes() == whole[1]


def test_a_changed_study_is_refused_naming_what_changed(begun):
    content = several_shards()
    content["stiffness"]["knee"] = [700.0, 950.0]
    other = sf.Study.from_dict(content)
    with pytest.raises(sf.InputError) as caught:
        sf.sweep(other, begun)
    assert (
        "(knee_stiffness: [700, 900, 2000, inf] there, [700, 950] here); finish that one, "
        "remove the folder, or choose another output"
    ) in str(caught.value)


def test_another_studys_atlas_is_not_overwritten(whole, tmp_path):
    path = tmp_path / "a.h5"
    shutil.copy(whole[0], path)
    with pytest.raises(sf.InputError, match="is the atlas of another study"):
        sf.sweep(sf.Study.from_dict(GOOD), path)
    assert path.read_bytes() == whole[1]


def test_any_other_file_is_not_overwritten(study, tmp_path):
    path = tmp_path / "a.h5"
    path.write_text("my only copy")
    with pytest.raises(sf.InputError, match="is not an HDF5 file"):
        sf.sweep(study, path)
    assert path.read_text() == "my only copy"


def test_a_second_run_is_refused_while_the_first_holds_its_lock(study, whole, tmp_path):
    path = tmp_path / "a.h5"
    refused = []

    def intrude(done, total):
        if refused:
            return
        for part in (None, (1, 2)):
            with pytest.raises(sf.InputError, match=r"is being written by another run \(process"):
                sf.sweep(study, path, part=part)
        refused.append(done)

    sf.sweep(study, path, progress=intrude)
    assert refused
    assert path.read_bytes() == whole[1]


def test_the_same_part_twice_is_refused(study, tmp_path):
    path = tmp_path / "a.h5"

    def intrude(forecast):
        with pytest.raises(sf.InputError, match="is being written by another run"):
            sf.sweep(study, path, part=(1, 3))

    sf.sweep(study, path, part=(1, 3), estimate=intrude)


def test_a_study_of_one_shard_is_the_same_file_with_and_without_it(tmp_path):
    """A run writes its last shard into the file alone; a part leaves it as a shard."""
    study = sf.Study.from_dict(GOOD)
    assert study.shard_count == 1
    straight, through = tmp_path / "straight.h5", tmp_path / "through.h5"
    sf.sweep(study, straight)
    sf.sweep(study, through, part=(1, 1))
    assert is_valid(parts_of(through), study, 0)
    sf.sweep(study, through)
    assert straight.read_bytes() == through.read_bytes()


def test_shards_in_any_order_make_the_same_file(study, whole, tmp_path):
    count = len(study.grid.shards)
    for number, order in enumerate(
        itertools.islice(itertools.permutations(range(1, count + 1)), 1, 700, 350)
    ):
        path = tmp_path / f"{number}.h5"
        for part in order:
            sf.sweep(study, path, part=(part, count))
        sf.sweep(study, path)
        assert path.read_bytes() == whole[1]


def test_an_interrupted_run_goes_on_where_it_was(study, whole, tmp_path):
    path = tmp_path / "a.h5"
    most = study.points * 3 // 4

    def interrupt(done, total):
        if done > most:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        sf.sweep(study, path, progress=interrupt)
    totals = []
    sf.sweep(study, path, progress=lambda done, total: totals.append(total))
    assert totals[-1] < study.points
    assert path.read_bytes() == whole[1]


def test_the_lock_goes_with_the_process(study, whole, tmp_path):
    path = tmp_path / "a.h5"
    run = process(path)
    while not (parts_of(path) / "lock").exists() and run.poll() is None:
        time.sleep(0.01)
    os.kill(run.pid, signal.SIGKILL)
    run.communicate()
    with contextlib.suppress(FileNotFoundError):
        path.unlink()
    sf.sweep(study, path)
    assert path.read_bytes() == whole[1]


@pytest.mark.parametrize("content", [b"", b"\xff\xfe", b"{}"])
def test_a_spoilt_study_file_is_written_again(study, whole, begun, content):
    (parts_of(begun) / "study.json").write_bytes(content)
    calls = []
    sf.sweep(study, begun, progress=lambda done, total: calls.append(total))
    assert calls == []  # the shards were still good
    assert begun.read_bytes() == whole[1]


def test_the_leftover_folder_of_a_finished_file_is_removed(study, whole, tmp_path):
    path = tmp_path / "a.h5"
    sf.sweep(study, path, part=(1, 3))
    shutil.copy(whole[0], path)
    assert parts_of(path).is_dir()
    sf.sweep(study, path)
    assert not parts_of(path).exists()


def test_a_newcomer_during_the_tidying_finds_a_lock_of_its_own(study, whole, tmp_path, monkeypatch):
    """The lock goes last; who opened it before it went must take a new one."""
    path = tmp_path / "a.h5"
    tidy = run_folder.tidy

    def locked(folder):
        return run_folder.locked(folder / "lock", path)

    def crowded(folder):
        with pytest.raises(sf.InputError, match="is being written by another run"), locked(folder):
            pass
        tidy(folder)
        with locked(folder):
            assert (folder / "lock").read_text().split()[:2] == [
                socket.gethostname(),
                str(os.getpid()),
            ]
            tidy(folder)

    monkeypatch.setattr(run_folder, "tidy", crowded)
    sf.sweep(study, path)
    assert path.read_bytes() == whole[1]
    assert not parts_of(path).exists()


def test_a_stale_lock_does_not_name_a_process_that_is_gone(study, tmp_path):
    path = tmp_path / "a.h5"

    def intrude(forecast):
        (parts_of(path) / "lock").write_text(f"{socket.gethostname()} 99999999 5")
        with pytest.raises(sf.InputError, match="by another run; wait"):
            sf.sweep(study, path)

    sf.sweep(study, path, part=(1, 3), estimate=intrude)


def test_ctrl_c_is_one_sentence_and_exit_code_1(tmp_path):
    big = tmp_path / "big.toml"
    big.write_text(
        "[body]\nheight = 1.75\nmass = 80\n[stiffness]\nknee = 2000\n"
        "ankle = { start = 0, stop = 2000, num = 9000 }\n"
        "hip = { start = 0, stop = 999, num = 9000 }"
        '\n[output]\nquantities = ["frequency"]\n'
    )
    command = [sys.executable, "-m", "standfast", "sweep", "big.toml"]
    for wait in (0.3, 1.5):
        run = subprocess.Popen(command, cwd=tmp_path, stderr=subprocess.PIPE)
        while not (tmp_path / "big.h5.parts" / "study.json").exists() and run.poll() is None:
            time.sleep(0.01)
        time.sleep(wait)
        run.send_signal(signal.SIGINT)
        _, message = run.communicate(timeout=60)
        assert run.returncode == 1
        assert b"Traceback" not in message
        assert b"stopping after what is under way; Ctrl-C again stops at once" in message
        assert (
            b"stopped; shards that are done are kept in big.h5.parts. To go on: standfast"
            in message
        )


def test_no_threads_gets_a_sentence(study, tmp_path):
    with pytest.raises(sf.InputError, match="threads = 0 is not a number of threads"):
        sf.sweep(study, tmp_path / "a.h5", threads=0)
