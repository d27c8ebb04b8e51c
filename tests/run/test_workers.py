"""Executors: the same bytes whoever computes, and whatever happens to who computes."""

import contextlib
import multiprocessing
import os
import sys
import time
from concurrent.futures import BrokenExecutor, Future, ProcessPoolExecutor, ThreadPoolExecutor
from pathlib import Path

import distributed
import loky
import pytest

import deadly
import standfast as sf
from populations import GOOD, of
from standfast.atlas import sweeping
from standfast.atlas.sweeping import sweep_shards
from standfast.files import PARTIAL
from standfast.population import simulation
from standfast.population.people import study as people_study
from standfast.run import workers
from standfast.run.folder import parts_of
from standfast.version import __version__

HELPERS = str(Path(deadly.__file__).parent)
GROWS_WITHIN = 20.0  # s; it takes tenths


@contextlib.contextmanager
def spawned():
    with ProcessPoolExecutor(2, mp_context=multiprocessing.get_context("spawn")) as pool:
        yield pool


@contextlib.contextmanager
def of_loky():
    pool = loky.ProcessPoolExecutor(2)
    yield pool
    pool.shutdown()


@contextlib.contextmanager
def of_dask(tmp_path):
    settings = {"n_workers": 2, "threads_per_worker": 1, "dashboard_address": None}
    where = {"local_directory": str(tmp_path / "dask")}
    with (
        distributed.LocalCluster(**settings, **where) as cluster,
        distributed.Client(cluster) as client,
    ):
        yield client


@contextlib.contextmanager
def threads():
    with ThreadPoolExecutor(2) as pool:
        yield pool


def executor(kind, tmp_path):
    return {
        "spawned": spawned, "loky": of_loky, "dask": lambda: of_dask(tmp_path), "threads": threads,
    }[kind]()  # fmt: skip


@pytest.fixture(autouse=True)
def importable(monkeypatch):
    """Workers find the helpers of the tests."""
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join(filter(None, sys.path)))


@pytest.fixture(scope="module")
def people():
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(people_study, "BLOCKS_PER_SHARD", deadly.BLOCKS)
        study = of(GOOD, size=3_000_000)
        assert study.shard_count > 2
    return study


@pytest.fixture(scope="module")
def counted(people, tmp_path_factory):
    path = tmp_path_factory.mktemp("people") / "people.h5"
    sf.simulate(people, path)
    return path.read_bytes()


# dask tells of workers that die in warnings of its own threads
@pytest.mark.filterwarnings("default")
@pytest.mark.parametrize("kind", ["spawned", "loky", "dask"])
def test_the_same_bytes_with_a_worker_killed_inside_a_shard(
    kind, study, whole, people, counted, tmp_path, monkeypatch
):
    monkeypatch.setattr(sweeping, "sweep_shards", deadly.sweep_killed_once)
    monkeypatch.setattr(simulation, "simulate_shards", deadly.simulate_killed_once)
    pool, jobs = None, ((sf.sweep, study, whole[1]), (sf.simulate, people, counted))
    with contextlib.ExitStack() as started:
        for compute, what, expected in jobs:
            path = tmp_path / f"{compute.__name__}.h5"
            # dask goes on with a new worker; the others are broken
            if pool is None or kind != "dask":
                pool = started.enter_context(executor(kind, tmp_path))
            compute(what, path, executor=pool)
            assert Path(f"{path}.killed").read_text() == "True"  # content was written by then
            assert path.read_bytes() == expected
            assert not parts_of(path).exists()


def test_a_worker_killed_in_the_last_shard_leaves_it_to_the_caller(
    study, whole, tmp_path, monkeypatch
):
    monkeypatch.setattr(sweeping, "sweep_shards", deadly.sweep_killed_at_the_end)
    path = tmp_path / "a.h5"
    with spawned() as pool:
        sf.sweep(study, path, executor=pool)
    assert Path(f"{path}.killed").exists()
    assert path.read_bytes() == whole[1]
    assert not parts_of(path).exists()


class Liar:
    """Says that everything is done, and does nothing the first times it is asked."""

    def __init__(self, lies):
        self.lies, self.asked = lies, 0

    def submit(self, function, *arguments):
        self.asked += 1
        future = Future()
        future.set_result([0] if self.asked <= self.lies else function(*arguments))
        return future


class Late(Liar):
    """Does shard after shard at once; the last one later, once half of the file is there."""

    def __init__(self, pool, study, path, size, last=None):
        super().__init__(0)
        self.pool, self.number, self.half = pool, study.shard_count - 1, size // 2
        self.file, self.last, self.seen = parts_of(path) / f".whole{PARTIAL}", last, False

    def submit(self, function, *arguments):
        if arguments[2] != (self.number,):
            return super().submit(function, *arguments)
        return self.pool.submit(self.later, self.last or function, *arguments)

    def later(self, function, *arguments):
        until = time.monotonic() + GROWS_WITHIN
        while time.monotonic() < until and not self.seen:
            with contextlib.suppress(FileNotFoundError):
                self.seen = self.file.stat().st_size > self.half
            time.sleep(0.01)
        return function(*arguments)


def test_the_file_grows_while_shards_are_computed(study, whole, tmp_path):
    path = tmp_path / "a.h5"
    with ThreadPoolExecutor(1) as pool:
        late = Late(pool, study, path, len(whole[1]))
        sf.sweep(study, path, executor=late)
    assert late.seen
    assert path.read_bytes() == whole[1]


def test_threads_do_as_an_executor(study, whole, tmp_path):
    path, seen = tmp_path / "a.h5", []
    with threads() as pool:
        sf.sweep(study, path, executor=pool, progress=lambda *at: seen.append(at),
                 estimate=lambda found: seen.append(found.points))  # fmt: skip
    assert path.read_bytes() == whole[1]
    assert seen[0] == study.points
    assert seen[-1] == (study.points, study.points)


def test_a_part_goes_to_an_executor_too(study, whole, tmp_path):
    path = tmp_path / "a.h5"
    with threads() as pool:
        assert sf.sweep(study, path, part=(1, 2), executor=pool) is None
        done = sorted(file.name for file in parts_of(path).glob("shard-*"))
        assert done == [f"shard-{n:06d}.h5" for n in range(0, study.shard_count, 2)]
        sf.sweep(study, path, executor=pool)
    assert path.read_bytes() == whole[1]


def test_what_a_worker_says_is_not_believed(study, whole, tmp_path):
    path = tmp_path / "a.h5"
    liar = Liar(2)
    sf.sweep(study, path, executor=liar)
    assert path.read_bytes() == whole[1]
    assert liar.asked == study.shard_count + 2


def test_a_worker_that_fails_again_and_again_ends_the_run_with_its_sentence(study, tmp_path):
    path = tmp_path / "a.h5"
    with pytest.raises(OSError, match=r"failed 4 times; .*its shard did not appear"):
        sf.sweep(study, path, executor=Liar(10**9))
    assert not path.exists()


class Broken(Liar):
    def submit(self, function, *arguments):
        if self.asked == 1:
            raise RuntimeError("cannot schedule new futures after shutdown")
        return super().submit(function, *arguments)


def test_what_a_broken_executor_leaves_is_computed_by_the_caller(study, whole, tmp_path):
    path = tmp_path / "a.h5"
    sf.sweep(study, path, executor=Broken(0))
    assert path.read_bytes() == whole[1]


def test_an_executor_that_breaks_in_the_middle_leaves_gaps_that_the_caller_fills(
    study, whole, tmp_path
):
    class Breaking(Liar):
        """Loses shard 1, does shard 2, and takes nothing more."""

        def submit(self, function, *arguments):
            if self.asked == 3:
                raise BrokenExecutor("a process was terminated abruptly")
            if arguments[2] != (1,):
                return super().submit(function, *arguments)
            self.asked += 1
            future = Future()
            future.set_exception(BrokenExecutor("a process was terminated abruptly"))
            return future

    assert study.shard_count > 3
    path, progress, shards = tmp_path / "a.h5", [], []

    def told(done, total):
        progress.append((done, total))
        shards.append(len([*parts_of(path).glob("shard-*")]))

    sf.sweep(study, path, executor=Breaking(0), progress=told)
    assert shards[:2] == [3 - 1, 3 - 1]  # 0 and 2, and none computed twice
    done, total = progress[-1]
    assert done == total < study.points  # what was left, by the caller
    assert path.read_bytes() == whole[1]


def test_what_fails_late_leaves_no_file_begun_and_the_same_call_goes_on(study, whole, tmp_path):
    path = tmp_path / "a.h5"
    with ThreadPoolExecutor(1) as pool:
        late = Late(pool, study, path, len(whole[1]), last=lambda *task: "no memory")
        with pytest.raises(OSError, match=rf"shard {late.number} failed 4 times; .*: no memory"):
            sf.sweep(study, path, executor=late)
    assert late.seen  # the file was begun
    assert not [file for file in parts_of(path).iterdir() if file.name.startswith(".")]
    assert len([*parts_of(path).glob("shard-*")]) == late.number
    sf.sweep(study, path, executor=Liar(0))
    assert path.read_bytes() == whole[1]


def test_an_error_of_who_is_told_of_progress_is_not_taken_for_a_broken_executor(study, tmp_path):
    def fail(done, total):
        raise RuntimeError("mine")

    with pytest.raises(RuntimeError, match="mine"):
        sf.sweep(study, tmp_path / "a.h5", executor=Liar(0), progress=fail)


def test_tasks_that_never_end_are_sent_again(study, whole, tmp_path, monkeypatch):
    class Forgetful(Liar):
        def submit(self, function, *arguments):
            self.asked += 1
            return Future() if self.asked <= self.lies else super().submit(function, *arguments)

    monkeypatch.setattr(workers, "PATIENCE", 0.05)
    path = tmp_path / "a.h5"
    executor = Forgetful(3)
    executor.lies = 3
    with contextlib.suppress(sf.InputError):
        sf.sweep(study, path, executor=executor)
    assert path.read_bytes() == whole[1]


def test_a_task_twice_is_once(study, whole, tmp_path):
    path = tmp_path / "a.h5"
    sf.sweep(study, path, part=(1, study.shard_count))
    for _ in range(2):
        assert sweep_shards(study.canonical, str(path), (0, 1), 1, __version__) == [0, 1]
    sf.sweep(study, path)
    assert path.read_bytes() == whole[1]


def test_a_task_says_in_a_sentence_what_is_wrong(study, tmp_path):
    path = tmp_path / "a.h5"
    assert "do all machines share that folder?" in sweep_shards(
        study.canonical, str(path), (0,), 1, __version__
    )
    assert "a worker has standfast" in sweep_shards(study.canonical, str(path), (0,), 1, "0.0.0")


@pytest.mark.filterwarnings("ignore:.*fork.*")
def test_an_executor_that_forks_is_refused(study, tmp_path):
    with (
        ProcessPoolExecutor(1, mp_context=multiprocessing.get_context("fork")) as pool,
        pytest.raises(OSError, match="forks its workers, which JAX does not survive"),
    ):
        sf.sweep(study, tmp_path / "a.h5", executor=pool)


def test_what_takes_no_work_is_refused(study, tmp_path):
    with pytest.raises(sf.InputError, match=r"executor = 4 takes no work"):
        sf.sweep(study, tmp_path / "a.h5", executor=4)
