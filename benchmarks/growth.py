"""How time and memory grow from 10⁴ to 10⁹ points, and what a second worker brings.

Every size is swept by the command line in a process of its own. Run as
``python benchmarks/growth.py`` (about a minute).
"""

import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from harness import Demand, Report, Row

SIDES = {10**4: (22, 22, 21), 10**6: (100, 100, 100), 10**8: (465, 465, 463), 10**9: (1000,) * 3}
STUDY = """
title = "Growth"
gravity = 9.8
[body]
model = "edwards2007"
height = 1.753
mass = 75.3
[stiffness]
ankle = {{ start = 0, stop = 2000, num = {} }}
knee = {{ start = 300, stop = 3000, num = {} }}
hip = {{ start = 0, stop = 2000, num = {} }}
"""
PEOPLE = Path(__file__).with_name("population.toml").read_text(encoding="utf-8")
PEOPLE_SIZE = 8 * 2**23  # eight shards, so that two workers have as much to do

# A worker with one core: it counts its part, and says how long that took without starting up.
WORKER = """
import os, sys, time
os.sched_setaffinity(0, {int(sys.argv[1])})
from standfast.population.people.study import PopulationStudy
from standfast.population.simulation import simulate
study = PopulationStudy.from_toml("people.toml")
part = (int(sys.argv[2]), int(sys.argv[3]))
warm = PopulationStudy.from_dict({**_toml, "population": {**_toml["population"], "size": 2**17}})
simulate(warm, f"warm-{sys.argv[2]}.h5", threads=1)
print("ready", flush=True)
sys.stdin.readline()
began = time.perf_counter()
simulate(study, f"people-{sys.argv[3]}.h5", threads=1, part=part)
print(time.perf_counter() - began)
""".replace(
    "study =",
    "from standfast.study.toml import read_toml\n_toml = read_toml('people.toml')\nstudy =",
    1,
)


def main() -> None:
    """Measure, and write the report."""
    rows, memory = [], {}
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for points, sides in SIDES.items():
            (folder / "study.toml").write_text(STUDY.format(*sides), encoding="utf-8")
            seconds, peaks = [], []
            for _ in range(3):
                elapsed, peak = _process(
                    ["-m", "standfast", "sweep", "study.toml", "-o", "a.h5"], folder
                )
                seconds.append(elapsed)
                peaks.append(peak)
                (folder / "a.h5").unlink()
            count = sides[0] * sides[1] * sides[2]
            rows.append(
                Row(
                    f"{points:.0e} verdicts, whole command",
                    seconds,
                    count,
                    "points",
                    f"{max(peaks):.0f} MB",
                )
            )
            memory[f"{points:.0e}"] = max(peaks)
        (folder / "people.toml").write_text(
            PEOPLE.replace("100000000", str(PEOPLE_SIZE)), encoding="utf-8"
        )
        one, two = [], []
        for _ in range(3):
            one.append(_workers(1, folder))
            two.append(_workers(2, folder))
    rows += [
        Row("67 million persons, one worker on one core", one, PEOPLE_SIZE, "persons"),
        Row("67 million persons, two workers on a core each", two, PEOPLE_SIZE, "persons"),
    ]
    gain = sorted(a / b for a, b in zip(one, two, strict=True))[1]
    Report(
        "growth",
        "How do time and memory grow, and what does a second worker bring?",
        f"studies/billion.toml at four sizes, by the command line; {os.cpu_count()} cores",
        rows,
        [Demand("second worker", 1.8, gain)],
        [
            "Small sizes cost what starting Python, importing JAX and compiling cost.",
            "Workers are processes with --part, each bound to one core, warmed up before they are "
            "timed; the slower of the two counts.",
        ],
        {"peak_memory_MB": memory},
    ).write()


def _process(arguments: list[str], folder: Path) -> tuple[float, float]:
    """Return the seconds and the peak memory (MB) of a Python process."""
    began = time.perf_counter()
    child = subprocess.Popen(
        [sys.executable, *arguments],
        cwd=folder,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    _, status, usage = os.wait4(child.pid, 0)
    child.returncode = os.waitstatus_to_exitcode(status)
    assert child.returncode == 0  # noqa: S101
    return time.perf_counter() - began, usage.ru_maxrss / 1e3


def _workers(count: int, folder: Path) -> float:
    """Return how long the slowest of some workers takes for its part."""
    workers = [
        subprocess.Popen(
            [sys.executable, "-c", WORKER, str(i), str(i + 1), str(count)],
            cwd=folder,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )
        for i in range(count)
    ]
    for worker in workers:
        assert worker.stdout is not None  # noqa: S101
        assert worker.stdout.readline() == "ready\n"  # noqa: S101
    for worker in workers:
        assert worker.stdin is not None  # noqa: S101
        worker.stdin.write("go\n")
        worker.stdin.flush()
    slowest = max(float(worker.communicate()[0]) for worker in workers)
    for left in folder.glob("warm-*"):
        left.unlink()
    _remove(folder / f"people-{count}.h5.parts")
    return slowest


def _remove(parts: Path) -> None:
    for item in parts.iterdir():
        item.unlink()
    parts.rmdir()


if __name__ == "__main__":
    main()
