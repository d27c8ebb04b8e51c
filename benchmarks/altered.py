"""Alter every kind of file that standfast reads, and count what the commands answer.

Answers: does a damaged file ever get a traceback, a crash, a hang or a great deal of memory? Run as
``python benchmarks/altered.py [FILES]`` (default 10000, some minutes); writes
``results/altered/README.md``. Each altered file is given to the commands that read its kind, in a
worker process whose memory and time are limited.
"""

import contextlib
import io
import random
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import traceback
from collections import Counter
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np

import standfast as sf
from standfast.cli.app import main as standfast
from standfast.population.people.records import read_people
from standfast.population.summary.file import open_population

RESULTS = Path(__file__).parents[1] / "results" / "altered"
SEED = 2007
MEMORY, SECONDS = 2**30, 60  # of a worker, above what good files need; for one file
WORKERS = 2
PLOTTED = 16  # one file in so many is drawn too, which takes longest

STUDY = """
[body]
model = ["winter", "de-leva-female"]
height = [1.6, 1.8]
bmi = 24
[stiffness]
ankle = { start = 0, stop = 2500, num = 40 }
knee = [700, 900, inf]
hip = { start = 0, stop = 1500, num = 30 }
[output]
quantities = ["stable", "frequency", "critical_hip_stiffness", "safety_factor"]
"""
PEOPLE = "id,height_m,mass_kg,sex,age\n" + "".join(
    f"{n},{1.5 + 0.01 * n:.2f},{50 + n},{'fm'[n % 2]},{20 + n}\n" for n in range(40)
)
POPULATION = """
[population]
people = "people.csv"
size = 2000
seed = 3
[stiffness.ankle]
distribution = "normal"
relative_to = "single_joint_critical"
mean = 1.8
sd = 0.3
[stiffness.knee]
distribution = "fixed"
value = inf
[stiffness.hip]
distribution = "uniform"
low = 200
high = 900
[output]
persons = true
"""


def altered(content: bytes, rng: random.Random) -> tuple[str, bytes]:
    """Alter a file in one of six ways; return which."""
    data = bytearray(content)
    size = len(data)
    first, other = rng.randrange(size), rng.randrange(size)
    block = min(rng.choice((1, 8, 64, 512, 4096)), size)
    way = rng.choice(("bit", "bits", "byte", "cut", "zeroed", "swapped"))
    if way == "bit":
        data[first] ^= 1 << rng.randrange(8)
    elif way == "bits":
        for _ in range(rng.randint(2, 20)):
            data[rng.randrange(size)] ^= 1 << rng.randrange(8)
    elif way == "byte":
        data[first] = rng.randrange(256)
    elif way == "cut":
        del data[first:]
    elif way == "zeroed":
        data[first : first + block] = bytes(len(data[first : first + block]))
    else:
        first, other = sorted((min(first, size - block), min(other, size - block)))
        if first + block <= other:
            one, two = data[first : first + block], data[other : other + block]
            data[first : first + block], data[other : other + block] = two, one
    return way, bytes(data)


def command(*words: str | Path) -> str:
    """Run a command in this process; return how it answered."""
    said = io.StringIO()
    with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(said):
        code = standfast([str(word) for word in words])
    lines = said.getvalue().count("\nstandfast: ") + said.getvalue().startswith("standfast: ")
    return "read" if code == 0 else "sentence" if lines == 1 else f"said: {said.getvalue()[-80:]}"


def read_atlas(path: Path, good: Path, *, drawn: bool) -> str:
    """Look at an atlas in every way; tell whether the numbers are those of the good one."""
    out = path.parent / "out"
    found = {command("info", path), command("info", path, "--json")}
    found |= {command("thresholds", path, "-o", out)}
    found |= {command("plot", path, "-o", out)} if drawn else set()
    with sf.open_atlas(path) as atlas, sf.open_atlas(good) as other:
        same = all(np.array_equal(atlas[n][...], other[n][...], equal_nan=True) for n in other)
    return "; ".join(found) if found != {"read"} else "read" if same else "read, other numbers"


def read_population(path: Path, good: Path, *, drawn: bool) -> str:
    """Look at a population in every way; tell whether the numbers are those of the good one."""
    found = {command("info", path), command("info", path, "--json")}
    found |= {command("plot", path, "-o", path.parent / "out")} if drawn else set()
    one, other = open_population(path), open_population(good)
    names = ("risk", "survival", "required_ankle_stiffness", "person_mass", "person_stable")
    same = one.summary == other.summary and all(
        np.array_equal(one.array(n), other.array(n), equal_nan=True) for n in names
    )
    return "; ".join(found) if found != {"read"} else "read" if same else "read, other numbers"


def finish(path: Path, good: Path, *, drawn: bool) -> str:
    """Look at an unfinished file and finish it; it is to be the good one byte by byte."""
    del drawn
    target = path.parent.with_name(path.parent.name.removesuffix(".parts"))
    whole = good.parent.with_name(target.name.replace("begun", "whole"))
    kind = "sweep" if "atlas" in target.name else "population"
    if (said := command("info", target)) not in ("read", "sentence"):
        return said
    study = good.parent.with_name(f"{target.stem.removesuffix('-begun')}.toml")
    more = [] if kind == "sweep" else ["--no-figures"]
    found = command(kind, study, "-o", target, *more)
    return found if found != "read" or target.read_bytes() == whole.read_bytes() else "UNLIKE"


def read_study(path: Path, good: Path, *, drawn: bool) -> str:
    """Read the study of a sweep, and its limits of standing."""
    del good, drawn
    return command("thresholds", path, "-o", path.parent / "out")


def read_population_study(path: Path, good: Path, *, drawn: bool) -> str:
    """Read the study of a population, and its people."""
    del good, drawn
    sf.PopulationStudy.from_toml(path).read_people()
    return "read"


def assess(path: Path, good: Path, *, drawn: bool) -> str:
    """Assess a file of people."""
    del good
    if drawn:
        return command("assess", path, "-o", path.parent / "out.csv", "--json")
    read_people([path])
    return "read"


# Of each kind of file: its name in the folder, what reads it, and how many in a hundred there are.
KINDS: dict[str, tuple[str, Callable[..., str], int]] = {
    "atlas": ("atlas.h5", read_atlas, 30),
    "population": ("people.h5", read_population, 30),
    "shard of an atlas": ("atlas-begun.h5.parts/shard-000000.h5", finish, 3),
    "shard of a population": ("people-begun.h5.parts/shard-000000.h5", finish, 1),
    "study beside shards": ("atlas-begun.h5.parts/study.json", finish, 3),
    "study of a sweep": ("atlas.toml", read_study, 11),
    "study of a population": ("people.toml", read_population_study, 11),
    "file of people": ("people.csv", assess, 11),
}


def made_files(folder: Path) -> None:
    """Make a good file of every kind."""
    for name, text in (("atlas.toml", STUDY), ("people.csv", PEOPLE), ("people.toml", POPULATION)):
        (folder / name).write_text(text, encoding="utf-8")
    grid = sf.Study.from_toml(folder / "atlas.toml")
    people = sf.PopulationStudy.from_toml(folder / "people.toml")
    sf.sweep(grid, folder / "atlas-begun.h5", part=(1, 1))
    sf.simulate(people, folder / "people-begun.h5", part=(1, 1))
    sf.sweep(grid, folder / "atlas.h5")
    sf.simulate(people, folder / "people.h5")
    for name in ("atlas", "people"):
        shutil.copy(folder / f"{name}.h5", folder / f"{name}-whole.h5")


def work(folder: Path, first: int, last: int, step: int) -> None:
    """Alter and read files of some numbers; print number, kind, way and answer of each."""
    names, own = list(KINDS), folder / f"worker-{first % step}"
    weights = [weight for _, _, weight in KINDS.values()]
    for number in (-1, *range(first, last, step)):
        rng = random.Random(f"{SEED}-{number}")  # noqa: S311 - damage, not secrets
        for kind in names if number < 0 else rng.choices(names, weights):
            name, read, _ = KINDS[kind]
            if read is finish or not own.exists():  # it takes its folder away
                shutil.rmtree(own, ignore_errors=True)
                shutil.copytree(folder, own, ignore=shutil.ignore_patterns("worker-*"))
            path, good = own / name, folder / name
            way = "none"
            if number >= 0:
                way, content = altered(good.read_bytes(), rng)
                path.write_bytes(content)
            signal.alarm(SECONDS)
            print(number, kind, way, sep="\t", end="\t", flush=True)
            try:
                answer = read(path, good, drawn=number < 0 or number % PLOTTED == 0)
            except sf.InputError as error:
                answer = "sentence" if "\n" not in str(error) else "said: several lines"
            except MemoryError:
                answer = "MEMORY"
            except BaseException:
                answer = "TRACEBACK " + traceback.format_exc().strip().replace("\n", " | ")
            signal.alarm(0)
            print(answer, flush=True)
            with contextlib.suppress(OSError):
                shutil.copy(good, path)
            if number < 0 and answer != "read":
                raise SystemExit(f"a good {kind} is not read: {answer}")
        if number < 0:  # what good files need is known now
            used = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
            resource.setrlimit(resource.RLIMIT_AS, (used + MEMORY, resource.RLIM_INFINITY))


def supervised(folder: Path, first: int, last: int) -> list[list[str]]:
    """Let workers go through every ``WORKERS``-th number, a new one after each that dies."""
    found: list[list[str]] = []
    while first < last:
        words = [sys.executable, __file__, "--worker", folder, first, last, WORKERS]
        ended = subprocess.run(map(str, words), stdout=subprocess.PIPE, text=True, check=False)
        rows = [line.split("\t") for line in ended.stdout.splitlines()]
        found += [row for row in rows if row[0] != "-1" and row[-1]]
        if ended.returncode == 0:
            break
        number, *told, _ = rows[-1]
        if number == "-1" or ended.returncode > 0:
            raise SystemExit(f"a worker failed: {rows[-1:]}")
        hang = -ended.returncode == signal.SIGALRM
        death = "HANG" if hang else f"CRASH by signal {-ended.returncode}"
        found.append([number, *told, death])
        first = int(number) + WORKERS
    return found


def main() -> None:
    """Alter files, and write the report."""
    if sys.argv[1:2] == ["--worker"]:
        work(Path(sys.argv[2]), *map(int, sys.argv[3:]))
        return
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 10_000
    with tempfile.TemporaryDirectory() as folder, ThreadPoolExecutor(WORKERS) as pool:
        made_files(Path(folder))
        parts = [pool.submit(supervised, Path(folder), n, count) for n in range(WORKERS)]
        rows = [row for part in parts for row in part.result()]
    bad = [row for row in rows if row[3] not in ANSWERS[:3]]
    for row in sorted(bad, key=lambda row: row[3]):
        print(*row, sep="\t")
    RESULTS.mkdir(parents=True, exist_ok=True)
    (RESULTS / "README.md").write_text(report(rows, count), encoding="utf-8")
    raise SystemExit(f"{len(bad)} answers that are none" if bad else 0)


ANSWERS = ("sentence", "read", "read, other numbers", "TRACEBACK", "CRASH", "HANG", "MEMORY")


def report(rows: list[list[str]], count: int) -> str:
    """Return the table of all answers as a page."""
    tally = Counter(
        (kind, answer if answer in ANSWERS else answer.split()[0]) for _, kind, _, answer in rows
    )
    others = sorted({answer for _, answer in tally} - set(ANSWERS))
    columns = [*ANSWERS, *others]
    lines = [
        "# Files altered at random, and whether standfast reads wrong numbers from them",
        "",
        f"Made by `python benchmarks/altered.py {count}`, standfast {sf.__version__}, seed {SEED}.",
        "Copies of good files were altered (bits flipped, bytes changed, cut short, blocks zeroed",
        "or swapped) and given to the commands and functions that read them, in processes that may",
        f"take {MEMORY >> 30} GiB more than good files need and {SECONDS} s a file. An unfinished",
        "file counts as read if the finished one is that of an undisturbed run byte by byte.",
        "*Other numbers* are damage in bytes that no checksum covers: of answers and small arrays",
        f"of a population, and of the places of chunks. One file in {PLOTTED} was drawn too.",
        "",
        "| file | altered | " + " | ".join(word.lower() for word in columns) + " |",
        "|---" * (len(columns) + 2) + "|",
    ]
    for kind in KINDS:
        counts = [tally[kind, answer] for answer in columns]
        lines.append("| " + " | ".join(map(str, (kind, sum(counts), *counts))) + " |")
    return "\n".join([*lines, ""])


if __name__ == "__main__":
    main()
