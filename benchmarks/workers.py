"""What a second worker buys, and what it costs to have a worker at all.

Every timing is of a fresh process: warm workers, or a thread, bound to one core each, and a caller
that has the same cores and no more. Run as ``python benchmarks/workers.py`` (twenty minutes).
"""

import json
import multiprocessing
import os
import subprocess
import sys
import time
from collections.abc import Callable, Iterable
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import standfast as sf
from harness import Demand, Report, Row, ratio
from standfast.atlas.sweeping import sweep_shards
from standfast.population.people.study import PopulationStudy
from standfast.population.simulation import simulate_shards
from standfast.study.toml import read_toml
from standfast.version import __version__

PERSONS = 4 * 10**8
SIDE = 800  # values of an axis of numbers
RATIO_SIDE = 560
ROUNDS = 2
PEOPLE = Path(__file__).with_name("population.toml")

# Of each work how it is made in two versions, one to warm up with; how it is done; its task.
Kind = tuple[Callable[[bool], Any], Callable[..., Any], Callable[..., Any]]


def persons(warm: bool) -> PopulationStudy:
    """Return women of NHANES."""
    content = read_toml(PEOPLE)
    content["population"]["size"] = PERSONS
    content["title"] = f"{content['title']}{' again' * warm}"
    return PopulationStudy.from_dict(content)


def numbers(quantity: str, side: int, warm: bool) -> sf.Study:
    """Return a grid of one person's stiffnesses."""
    axis = {"start": 1, "stop": 2000, "num": side}
    return sf.Study.from_dict({
        "title": "Numbers", "gravity": 9.0 if warm else 9.8,
        "body": {"model": "edwards2007", "height": 1.753, "mass": 70.0},
        "stiffness": {"ankle": axis, "knee": axis, "hip": axis},
        "output": {"quantities": [quantity]},
    })  # fmt: skip


KINDS: dict[str, Kind] = {
    "persons": (persons, sf.simulate, simulate_shards),
    "eigenvalue": (lambda warm: numbers("eigenvalue_1", SIDE, warm), sf.sweep, sweep_shards),
    "ratio": (lambda warm: numbers("hip_ankle_ratio", RATIO_SIDE, warm), sf.sweep, sweep_shards),
}
# How many workers each way has; without any, a thread of the caller works. "side by side": two
# callers that know nothing of each other, a core each, which tells what the machine gives at most.
WORKERS = {"thread": 0, "one": 1, "two": 2, "side by side": 0, "task": 1, "task here": 0}
WORDS = {
    "persons": f"{PERSONS:.3g} persons",
    "eigenvalue": f"{SIDE**3:.3g} eigenvalues",
    "ratio": f"{RATIO_SIDE**3:.3g} rotation ratios",
}


def main() -> None:
    """Measure in turn, and write the report."""
    report = Report(
        "workers",
        "What does a second worker buy, and what does a worker cost?",
        f"spawned workers, one thread each, {ROUNDS} rounds in turn; caller and workers share as "
        "many cores as there are workers; the folder is on the disk of temporary files",
        limitations=[
            "All is measured after every worker, and the caller, has done a task of another study "
            "of the same shape; what that takes, with imports and compiling, is told apart.",
            "With two workers the caller's assembling competes with them for two cores.",
        ],
    )
    for name, words in WORDS.items():
        seconds: dict[str, list[float]] = {}
        starts: list[float] = []
        for _ in range(ROUNDS):
            for how in WORKERS:
                found = side_by_side(name) if how == "side by side" else measured(name, how)
                print(f"  {name}, {how}: {found['run']:.1f} s", flush=True)
                seconds.setdefault(how, []).append(found["run"])
                starts += [found["start"]] * (how == "one")
        work = found_work(name)
        for how, what in (
            ("thread", "a thread of the caller, one core"),
            ("one", "one worker, one core"),
            ("two", "two workers, two cores"),
        ):
            report.rows.append(Row(f"{words}: {what}", seconds[how], work, name))
        twice = f"{words}, twice: two callers side by side, a core each"
        report.rows.append(Row(twice, seconds["side by side"], 2 * work, name))
        share = work * taken(name) / KINDS[name][0](False).shard_count
        report.rows += [
            Row(f"{words}: some shards, by the caller", seconds["task here"], share, name),
            Row(f"{words}: the same shards as a task", seconds["task"], share, name),
            Row(f"{words}: start of a worker, with its first shard", starts, 1, "starts"),
        ]
        report.demands += [
            Demand(f"{words}: two workers over one", 1.8, ratio(seconds, "one", "two")),
            Demand(
                f"{words}: a worker over a thread, seconds", 1.05,
                1.0 / ratio(seconds, "thread", "one"), most=True,
            ),
            Demand(
                f"{words}: a task over the same here, seconds", 1.05,
                1.0 / ratio(seconds, "task here", "task"), most=True,
            ),
        ]  # fmt: skip
    report.write()


def found_work(name: str) -> float:
    """Return how many persons or values a work is."""
    return PERSONS if name == "persons" else {"eigenvalue": SIDE, "ratio": RATIO_SIDE}[name] ** 3


def taken(name: str) -> int:
    """Return how many shards go into the task that is timed alone."""
    return KINDS[name][0](False).shard_count // 2


def measured(name: str, how: str) -> dict[str, float]:
    """Return seconds of one way, from a process that has its cores alone from the beginning."""
    return answer_of(begun(name, how, range(max(WORKERS[how], 1))))


def side_by_side(name: str) -> dict[str, float]:
    """Return seconds of the slower of two callers at once, each with a core and a folder."""
    both = [begun(name, "thread", [core]) for core in (0, 1)]
    return max(map(answer_of, both), key=lambda found: found["run"])


def begun(name: str, how: str, cores: Iterable[int]) -> subprocess.Popen[str]:
    """Begin one way in a process that has some cores, and no others."""
    all_cores = os.sched_getaffinity(0)
    # before it is begun: threads that its imports start would keep all cores
    os.sched_setaffinity(0, cores)
    command = [sys.executable, __file__, name, how]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
    os.sched_setaffinity(0, all_cores)
    return process


def answer_of(process: subprocess.Popen[str]) -> dict[str, float]:
    """Wait for a way, and return what it found."""
    text, _ = process.communicate()
    if process.returncode != 0:
        raise subprocess.CalledProcessError(process.returncode, process.args)
    found: dict[str, float] = json.loads(text)
    return found


def timed(name: str, how: str) -> dict[str, float]:
    """Do a work one way, warm; this process was begun for it."""
    workers = WORKERS[how]
    make, compute, _ = KINDS[name]
    spawn = multiprocessing.get_context("spawn")
    turn, together = spawn.Value("i", 0), spawn.Barrier(max(workers, 1))
    with TemporaryDirectory() as folder, ProcessPoolExecutor(
        workers or 1, mp_context=spawn, initializer=bind, initargs=(turn, together)
    ) as pool:  # fmt: skip
        given = pool if workers else None
        began = time.perf_counter()
        # all workers begin at once, so that each gets one of the tasks
        run_tasks(name, make(True), [f"{folder}/w{n}.h5" for n in range(workers or 1)], 2, given)
        start = time.perf_counter() - began
        study = make(False)
        began = time.perf_counter()
        if how.startswith("task"):
            run = run_tasks(name, study, [f"{folder}/a.h5"], taken(name), given)
        else:
            compute(study, f"{folder}/a.h5", threads=1, executor=given)
            run = time.perf_counter() - began
        return {"start": start, "run": run}


def run_tasks(
    name: str, study: Any, outputs: list[str], count: int, pool: ProcessPoolExecutor | None
) -> float:
    """Do the first shards of a study as one task an output, here or elsewhere; return seconds."""
    _, compute, task = KINDS[name]
    last = study.shard_count
    for output in outputs:
        # makes the folder that says whose it is, and in it the last shard
        compute(study, output, part=(last, last), threads=1)
    shards = tuple(range(count))
    told = [(job_text(name, study), output, shards, 1, __version__) for output in outputs]
    began = time.perf_counter()
    if pool is None:
        done = [task(*each) for each in told]
    else:
        done = [each.result() for each in [pool.submit(task, *each) for each in told]]
    if any(each != list(shards) for each in done):
        raise RuntimeError(done)
    return time.perf_counter() - began


def job_text(name: str, study: Any) -> str:
    """Return what a task is told."""
    if name != "persons":
        return str(study.canonical)
    return json.dumps({"study": study.canonical, "files": [str(p) for p in study.files]})


def bind(turn: Any, together: Any) -> None:
    """Bind a worker to a core of its own, and wait for the others."""
    with turn.get_lock():
        os.sched_setaffinity(0, [turn.value])
        turn.value += 1
    together.wait()


if __name__ == "__main__":
    if len(sys.argv) > 1:
        print(json.dumps(timed(*sys.argv[1:])))
    else:
        main()
