"""What all benchmarks share: jobs in turn, medians, the machine, and one JSON file each."""

import gc
import json
import os
import platform
import statistics
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

import jax

ROOT = Path(__file__).parents[1]

# On a GPU the same scripts run unchanged, and write beside the results of the processor.
BACKEND = jax.default_backend()
RESULTS = ROOT / "results" / "benchmarks" / ("" if BACKEND == "cpu" else BACKEND)
PACKAGES = ("standfast", "jax", "numpy", "scipy", "h5py", "isal")


@dataclass
class Row:
    """One job: what was done, how long each round took, and how much work it was."""

    what: str
    seconds: list[float]
    work: float
    unit: str
    accuracy: str = ""

    @property
    def median(self) -> float:
        """Median seconds."""
        return statistics.median(self.seconds)

    @property
    def rate(self) -> float:
        """Work a second, by the median."""
        return self.work / self.median


@dataclass
class Demand:
    """A ratio that must hold within one run: ours over theirs, or seconds below a limit."""

    what: str
    wanted: float
    found: float
    most: bool = False  # ``wanted`` is an upper limit

    @property
    def met(self) -> bool:
        """Whether it holds."""
        return self.found <= self.wanted if self.most else self.found >= self.wanted


@dataclass
class Report:
    """What one script found."""

    name: str
    question: str
    settings: str
    rows: list[Row] = field(default_factory=list)
    demands: list[Demand] = field(default_factory=list)
    limitations: list[str] = field(default_factory=list)
    extra: dict[str, Any] = field(default_factory=dict)

    def write(self, packages: Sequence[str] = ()) -> None:
        """Write ``results/benchmarks/NAME.json`` and say on the screen what it holds."""
        content = asdict(self) | {"machine": machine(), "versions": versions(packages)}
        for demand, plain in zip(self.demands, content["demands"], strict=True):
            plain["met"] = bool(demand.met)
        RESULTS.mkdir(parents=True, exist_ok=True)
        path = RESULTS / f"{self.name}.json"
        path.write_text(json.dumps(content, indent=1) + "\n", encoding="utf-8")
        print(f"{self.name}: {self.question}")
        for row in self.rows:
            print(f"  {row.what:58} {row.rate:10.3g} {row.unit}/s   {row.accuracy}")
        for demand in self.demands:
            mark = "met" if demand.met else "NOT MET"
            print(f"  {demand.what}: {demand.found:.3g} (wanted {demand.wanted:g}) {mark}")


def in_turn(
    jobs: Mapping[str, Callable[[], object]],
    rounds: int,
    clock: Callable[[], float] = time.perf_counter,
) -> dict[str, list[float]]:
    """Time jobs one after the other, round by round, after one round that is not counted."""
    seconds: dict[str, list[float]] = {what: [] for what in jobs}
    for number in range(rounds + 1):
        for what, job in jobs.items():
            gc.collect()
            began = clock()
            job()
            if number:
                seconds[what].append(clock() - began)
    return seconds


def ratio(seconds: Mapping[str, Sequence[float]], theirs: str, ours: str) -> float:
    """Return how many times faster ours is: the median of the rounds' own ratios."""
    pairs = zip(seconds[theirs], seconds[ours], strict=True)
    return statistics.median(t / o for t, o in pairs)


def machine() -> dict[str, Any]:
    """Return what the machine is."""
    model = ""
    cpuinfo = Path("/proc/cpuinfo")
    if cpuinfo.exists():
        lines = cpuinfo.read_text(encoding="utf-8").splitlines()
        model = next((line.split(":")[1].strip() for line in lines if "model name" in line), "")
    return {
        "cores": os.cpu_count(),
        "computes_on": str(jax.devices()[0]) if BACKEND != "cpu" else "",
        "processor": model or platform.processor(),
        "system": f"{platform.system()} {platform.machine()}",
        "python": platform.python_version(),
    }


def versions(packages: Sequence[str]) -> dict[str, str]:
    """Return the versions of the packages that took part and are installed."""
    found = {}
    for name in (*PACKAGES, *packages):
        try:
            found[name] = version(name)
        except PackageNotFoundError:
            continue
    return found
