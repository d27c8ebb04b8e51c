"""How long a user waits: for help, for the first figure, for the paper.

Every command runs in a process of its own. Run as ``python benchmarks/startup.py`` (a minute).
"""

import os
import subprocess
import sys
import tempfile
import time
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


def main() -> None:
    """Measure, and write the report."""
    program = Path(sys.executable).with_name("standfast")
    seconds: dict[str, list[float]] = {what: [] for what in COMMANDS}
    for number in range(ROUNDS + 1):
        for what, commands in COMMANDS.items():
            if number > 3 and what != "standfast --help":
                continue
            with tempfile.TemporaryDirectory() as folder:
                began = time.perf_counter()
                for arguments in commands:
                    subprocess.run(
                        [program, *arguments], cwd=folder, check=True, capture_output=True
                    )
                if number:
                    seconds[what].append(time.perf_counter() - began)
    rows = [Row(what, each, 1, "runs") for what, each in seconds.items()]
    demands = [
        Demand(f"{row.what}, seconds", LIMITS[row.what], row.median, most=True)
        for row in rows
        if row.what in LIMITS
    ]
    Report(
        "startup",
        "How long does a user wait?",
        f"each command in a process of its own, files in the page cache, {os.cpu_count()} cores",
        rows,
        demands,
        ["The first round, which reads the programs from the disk, is not counted."],
    ).write(("matplotlib", "rich"))


if __name__ == "__main__":
    main()
