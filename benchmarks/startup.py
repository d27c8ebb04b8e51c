"""How long a user waits: for help, for the first figure, for the paper.

Every command runs in a process of its own. Run as ``python benchmarks/startup.py`` (a minute).
"""

import os
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path

from harness import ROOT, Demand, Report, Row

ROUNDS = 7
COMMANDS = {
    "standfast --help": (["--help"],),
    "standfast reproduce": (["reproduce", "-o", "paper"],),
    "first figure: sweep studies/atlas.toml, plot": (
        ["sweep", str(ROOT / "studies" / "atlas.toml"), "-o", "atlas.h5"],
        ["plot", "atlas.h5", "-o", "figures"],
    ),
    "standfast population studies/us-adults.toml": (
        ["population", str(ROOT / "studies" / "us-adults.toml"), "-o", "us.h5"],
    ),
}
LIMITS = {"standfast --help": 0.2, "standfast reproduce": 6.0}
# Commands that compile, which are timed with the programs of an earlier run kept and without.
COMPILING = [what for what in COMMANDS if what not in LIMITS]
WITHOUT = "  compiled anew"


def main() -> None:
    """Measure, and write the report."""
    program = Path(sys.executable).with_name("standfast")
    timed = [*COMMANDS, *(what + WITHOUT for what in COMPILING)]
    seconds: dict[str, list[float]] = {what: [] for what in timed}
    with tempfile.TemporaryDirectory() as cache:
        for number in range(ROUNDS + 1):
            for what in timed:
                if number > 3 and what != "standfast --help":
                    continue
                keep = "off" if what.endswith(WITHOUT) else cache
                took = _timed(program, COMMANDS[what.removesuffix(WITHOUT)], keep)
                if number:
                    seconds[what].append(took)
    rows = [Row(what, each, 1, "runs") for what, each in seconds.items()]
    demands = [
        Demand(f"{row.what}, seconds", LIMITS[row.what], row.median, most=True)
        for row in rows
        if row.what in LIMITS
    ]
    demands += [
        Demand(f"{what}, over compiling anew", 1.0, statistics.median(ratios), most=True)
        for what in COMPILING
        if (ratios := [k / a for k, a in zip(seconds[what], seconds[what + WITHOUT], strict=True)])
    ]
    Report(
        "startup",
        "How long does a user wait?",
        f"each command in a process of its own, files in the page cache, {os.cpu_count()} cores",
        rows,
        demands,
        [
            "The first round, which reads the programs from the disk and fills the cache of "
            "compiled ones, is not counted."
        ],
    ).write(("matplotlib", "rich"))


def _timed(program: Path, commands: Sequence[Sequence[str]], keep: str) -> float:
    """Run some commands in an empty folder; ``keep`` is where compiled programs are kept."""
    environment = {**os.environ, "STANDFAST_COMPILE_CACHE": keep}
    with tempfile.TemporaryDirectory() as folder:
        began = time.perf_counter()
        for arguments in commands:
            subprocess.run(
                [program, *arguments], cwd=folder, check=True, capture_output=True, env=environment
            )
        return time.perf_counter() - began


if __name__ == "__main__":
    main()
