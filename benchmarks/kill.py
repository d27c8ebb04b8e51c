"""Kill commands, at exact events of the disk and at random moments; start them again; compare.

Answers: does any SIGKILL lose or spoil anything, or leave anything over? Run as
``python benchmarks/kill.py [KILLS]`` (default 1000, half an hour); writes
``results/kill/README.md``.
"""

import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from pathlib import Path

import standfast as sf

RESULTS = Path(__file__).parents[1] / "results" / "kill"
SEED = 2007

MARGINS = """
[body]
height = 1.75
bmi = [20, 25, 30]
[stiffness]
ankle = { start = 0, stop = 2500, num = 550 }
knee = [700, 900, 2000, inf]
hip = { start = 0, stop = 1500, num = 451 }
[output]
quantities = ["stable", "stability_determinant", "critical_ankle_stiffness"]
"""
MODES = """
[body]
height = 1.75
mass = 80
[stiffness]
ankle = { start = 1, stop = 2500, num = 500, spacing = "log" }
knee = [700, 2000, inf]
hip = { start = 0, stop = 1500, num = 701 }
[output]
quantities = ["eigenvalue_1", "stable"]
"""
PEOPLE = """
[population]
builtin = "nhanes-2017-2018"
size = 600000
seed = 1
[stiffness.ankle]
distribution = "normal"
relative_to = "mgh"
mean = 1.2
sd = 0.3
[stiffness.knee]
distribution = "fixed"
value = 2000
[stiffness.hip]
distribution = "fixed"
value = 900
"""

# Shards are made small in every process, also of workers, so that a second of work has several.
SMALL_SHARDS = """
from standfast.study import grid
from standfast.population.people import study
grid.SHARD_WORK, study.BLOCKS_PER_SHARD = 8, 2
"""

# The process counts what it does to the disk in its folder, by Python's audit events and around
# every sync, and kills itself at the event that it is told.
RUN = """
import os, signal, sys
from pathlib import Path
at, place, seen = int(os.environ.pop("KILL_AT")), os.getcwd(), [0]
NAMES = {"open", "os.rename", "os.link", "os.remove", "os.mkdir", "os.rmdir", "os.truncate"}
def event():
    seen[0] += 1
    if seen[0] == at:
        os.kill(os.getpid(), signal.SIGKILL)
def hook(name, arguments):
    if name in NAMES and isinstance(arguments[0], (str, bytes, os.PathLike)):
        if os.path.abspath(os.fsdecode(arguments[0])).startswith(place):
            event()
def around(function):
    def wrapped(*arguments, **named):
        event()
        result = function(*arguments, **named)
        event()
        return result
    return wrapped
sys.addaudithook(hook)
for name in ("fsync", "link", "rename", "replace"):
    setattr(os, name, around(getattr(os, name)))
leave = os._exit
def leaving(code):
    if at == 0:
        Path(os.environ["COUNT"]).write_text(str(seen[0]))
    leave(code)
os._exit = leaving
from standfast.cli.app import run
run()
"""


@dataclass
class Job:
    """A command that is killed, and what it makes when it is not."""

    name: str
    share: float
    command: list[str]
    start: Path
    whole: dict[str, bytes] = field(default_factory=dict)
    events: int = 0
    seconds: float = 0.0


def run(job: Job, place: Path, at: int = 0) -> "subprocess.Popen[bytes]":
    """Start a job in a folder; ``at`` is the event at which it kills itself."""
    folder = place.parent
    environment = {
        **os.environ, "KILL_AT": str(at), "COUNT": str(folder / "count"),
        "STANDFAST_COMPILE_CACHE": str(job.start.parent / "compiled"),
        "DASK_TEMPORARY_DIRECTORY": str(folder / "dask"),
        "PYTHONPATH": os.pathsep.join(filter(None, [str(job.start.parent / "site"), *sys.path])),
    }  # fmt: skip
    return subprocess.Popen(
        [sys.executable, "-c", RUN, *job.command],
        cwd=place,
        env=environment,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )


def fresh(job: Job, folder: Path) -> Path:
    """Return a new folder with what the job starts from."""
    place = folder / "place"
    shutil.rmtree(place, ignore_errors=True)
    shutil.copytree(job.start, place)
    return place


def content(place: Path) -> dict[str, bytes]:
    """Return all files of a folder; of a log only that it is there."""
    return {
        str(path.relative_to(place)): b"" if path.name.endswith(".run.json") else path.read_bytes()
        for path in place.rglob("*")
        if path.is_file()
    }


def measured(job: Job, folder: Path) -> Job:
    """Run a job to its end twice: what it makes, its events and its seconds."""
    for _ in range(2):  # the second time nothing compiles
        place = fresh(job, folder)
        began = time.monotonic()
        if run(job, place).wait() != 0:
            raise SystemExit(f"{job.name} did not run")
        job.seconds = time.monotonic() - began
    job.whole, job.events = content(place), int((folder / "count").read_text())
    return job


@dataclass
class Found:
    """What one kill found."""

    at_event: bool
    landed: bool
    resumed: bool
    finished: bool
    torn: bool
    different: bool
    left_over: bool


def kill(job: Job, folder: Path, rng: random.Random, *, at_event: bool) -> Found:
    """Kill a job once, look at what lies there, start it again, compare."""
    place = fresh(job, folder)
    process = run(job, place, rng.randint(1, job.events) if at_event else 0)
    deadline = time.monotonic() + (60.0 if at_event else rng.uniform(0.0, job.seconds))
    while time.monotonic() < deadline and process.poll() is None:
        time.sleep(0.002)
    process.send_signal(signal.SIGKILL)
    landed = process.wait() == -signal.SIGKILL
    there = content(place)
    named = {name: raw for name, raw in there.items() if name in job.whole}
    again = run(job, place).wait()
    after = content(place)
    return Found(
        at_event=at_event,
        landed=landed,
        resumed=any("shard-" in name and not name.startswith(".") for name in there),
        finished=set(job.whole) <= set(there),
        torn=any(raw != job.whole[name] for name, raw in named.items()),
        different=again != 0 or any(after.get(name) != raw for name, raw in job.whole.items()),
        left_over=bool(set(after) - set(job.whole)),
    )


def jobs(folder: Path) -> list[Job]:
    """Make the folders that the commands start from."""
    atlas = ["sweep", "study.toml", "-o", "a.h5"]
    texts = {"margins": MARGINS, "modes": MODES, "people": PEOPLE}
    for name, text in texts.items():
        (folder / name).mkdir()
        (folder / name / "study.toml").write_text(text, encoding="utf-8")
    (folder / "site").mkdir()
    (folder / "site" / "sitecustomize.py").write_text(SMALL_SHARDS, encoding="utf-8")
    people = folder / "csv"
    people.mkdir()
    rows = [f"{n},{1.5 + n % 50 / 100},{50 + n % 60},900,1500,400" for n in range(2000)]
    header = "id,height,mass,ankle_stiffness,knee_stiffness,hip_stiffness"
    (people / "people.csv").write_text("\n".join([header, *rows]) + "\n", encoding="utf-8")
    drawn = folder / "drawn"
    drawn.mkdir()
    sf.sweep(sf.Study.from_toml(folder / "margins" / "study.toml"), drawn / "a.h5")
    (drawn / "a.run.json").unlink()
    population = ["population", "study.toml", "-o", "p.h5"]
    return [
        Job("sweep of margins, threads", 0.2, atlas, folder / "margins"),
        Job("sweep of modes, threads", 0.15, atlas, folder / "modes"),
        Job("sweep of margins, Dask", 0.1, [*atlas, "--executor", "dask", "--workers", "2"],
            folder / "margins"),
        Job("population with figures", 0.2, population, folder / "people"),
        Job("thresholds", 0.12, ["thresholds", "a.h5", "-o", "out"], drawn),
        Job("plot", 0.11, ["plot", "a.h5", "-o", "out"], drawn),
        Job("assess", 0.12, ["assess", "people.csv", "-o", "out.csv"], people),
    ]  # fmt: skip


def row_of(job: Job, found: list[Found]) -> list[str]:
    """Return one row of the report."""
    landed = [each for each in found if each.landed]
    counts = [
        len(landed),
        sum(each.at_event for each in landed),
        sum(each.resumed for each in landed),
        sum(each.finished for each in landed),
        sum(each.torn for each in found),
        sum(each.different for each in found),
        sum(each.left_over for each in found),
    ]
    return [job.name, str(job.events), f"{job.seconds:.1f} s", *map(str, counts)]


def killed(job: Job, kills: int, folder: Path, seed: int) -> list[Found]:
    """Kill a job until as many kills landed, every other one at an event of the disk."""
    folder.mkdir()
    rng = random.Random(seed)  # noqa: S311 - moments, not secrets
    found: list[Found] = []
    while sum(each.landed for each in found) < kills:
        found.append(kill(job, folder, rng, at_event=len(found) % 2 == 0))
    return found


def main() -> None:
    """Kill, and write the report."""
    kills = int(sys.argv[1]) if len(sys.argv) > 1 else 1000
    rows = []
    with tempfile.TemporaryDirectory() as temporary, ThreadPoolExecutor(2) as pool:
        folder = Path(temporary)
        for number, job in enumerate(jobs(folder)):
            measured(job, folder)
            halves = [
                pool.submit(killed, job, round(kills * job.share / 2), folder / f"{number}{half}",
                            SEED + 2 * number + half)
                for half in range(2)
            ]  # fmt: skip
            rows.append(row_of(job, [each for half in halves for each in half.result()]))
            print(*rows[-1], sep="\t", flush=True)
    landed = sum(int(row[3]) for row in rows)
    lines = [
        "# Commands killed at any moment, and whether the same command finishes them",
        "",
        f"Made by `python benchmarks/kill.py {kills}`, standfast {sf.__version__}, seed {SEED}:",
        f"{landed} kills by SIGKILL, half of them at an exact event of the disk (a file opened,",
        "renamed, linked or removed, a folder made or removed, before and after a sync), half at a",
        "random moment. Each command was then started again. A file under a final name that was",
        "not as an uninterrupted run makes it is *torn*; after the second run, *different*; any",
        "file more is *left over*. Shards were made small, so that a second of work has several.",
        "",
        "| command | events | length | kills | at an event | found shards | found all finished "
        "| torn | different | left over |",
        "|---|---|---|---|---|---|---|---|---|---|",
        *("| " + " | ".join(row) + " |" for row in rows),
        "",
    ]
    RESULTS.mkdir(parents=True, exist_ok=True)
    (RESULTS / "README.md").write_text("\n".join(lines), encoding="utf-8")
    if any(row[-3:] != ["0", "0", "0"] for row in rows):
        raise SystemExit("something was torn, different or left over")


if __name__ == "__main__":
    main()
