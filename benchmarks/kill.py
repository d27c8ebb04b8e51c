"""Kill sweeps at random moments, resume them, and compare with uninterrupted runs byte by byte.

Answers: does any SIGKILL lose or spoil anything? Run as ``python benchmarks/kill.py [KILLS]``
(default 100, some minutes); writes ``results/kill/README.md``.
"""

import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import standfast as sf

RESULTS = Path(__file__).parents[1] / "results" / "kill"
SEED = 2007

# Five studies that differ in axes, sizes and kinds of quantities; each takes seconds.
STUDIES = {
    "verdicts": """
[body]
height = 1.75
mass = 80
[stiffness]
ankle = { start = 0, stop = 2000, num = 1200 }
knee = { start = 0, stop = 2000, num = 1100 }
hip = { start = 0, stop = 2000, num = 1000 }
""",
    "margins": """
[body]
height = 1.75
bmi = [20, 25, 30]
[stiffness]
ankle = { start = 0, stop = 2500, num = 1100 }
knee = [700, 900, 2000, inf]
hip = { start = 0, stop = 1500, num = 901 }
[output]
quantities = ["stable", "stability_determinant", "critical_ankle_stiffness"]
""",
    "modes": """
[body]
height = 1.75
mass = 80
[stiffness]
ankle = { start = 1, stop = 2500, num = 500, spacing = "log" }
knee = [700, 2000, inf]
hip = { start = 0, stop = 1500, num = 1501 }
[output]
quantities = ["eigenvalue_1", "stable"]
""",
    "bodies": """
[body]
model = ["winter", "edwards2007", "de-leva-male", "de-leva-female"]
height = { start = 1.4, stop = 2.1, num = 71 }
bmi = { start = 16, stop = 45, num = 59 }
[stiffness]
ankle = { start = 0, stop = 3000, num = 301 }
knee = 2000
hip = [300, 500, 800, inf]
[output]
quantities = ["stability_determinant", "stable", "critical_hip_stiffness"]
""",
    "thresholds": """
gravity = [1.62, 3.71, 9.80665]
[body]
height = { start = 1.4, stop = 2.1, num = 141 }
mass = { start = 40, stop = 160, num = 121 }
[stiffness]
ankle = 1000
knee = { start = 300, stop = 3000, num = 109 }
hip = [300, 500, 800, inf]
[output]
quantities = ["critical_ankle_stiffness", "critical_hip_stiffness"]
""",
}


# Shards are made small, so that seconds of work have several.
SHARD_WORK = 16
RUN = (
    "import sys; from standfast.study import grid; from standfast.cli.app import main; "
    f"grid.SHARD_WORK = {SHARD_WORK}; sys.exit(main(sys.argv[1:]))"
)


def started(study: Path, output: Path) -> subprocess.Popen[bytes]:
    """Start a sweep by its command line."""
    command = [sys.executable, "-c", RUN, "sweep", str(study), "-o", str(output)]
    return subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def seconds_of(study: Path, output: Path) -> float:
    """Run a sweep to its end and return how long it took."""
    began = time.monotonic()
    if started(study, output).wait() != 0:
        raise SystemExit(f"{study} did not run")
    return time.monotonic() - began


def killed(study: Path, whole: bytes, length: float, kills: int, rng: random.Random) -> list[str]:
    """Kill and resume; return one row of the report."""
    output = study.with_name(f"{study.stem}-killed.h5")
    landed = finished = resumed = torn = 0
    while landed < kills:
        run = started(study, output)
        deadline = time.monotonic() + rng.uniform(0.0, 1.05 * length)
        while time.monotonic() < deadline and run.poll() is None:
            time.sleep(0.005)
        run.send_signal(signal.SIGKILL)
        run.wait()
        landed += run.returncode == -signal.SIGKILL
        parts = output.with_name(f"{output.name}.parts")
        resumed += any(parts.glob("shard-*.h5"))
        if output.exists():
            finished += 1
            torn += output.read_bytes() != whole
            output.unlink()
            shutil.rmtree(parts, ignore_errors=True)
    seconds_of(study, output)
    torn += output.read_bytes() != whole
    size = f"{len(whole) / 1e6:.1f} MB"
    return [study.stem, size, f"{length:.1f} s", *map(str, (landed, resumed, finished, torn))]


def main() -> None:
    """Kill, and write the report."""
    kills = int(sys.argv[1]) if len(sys.argv) > 1 else 100
    rng = random.Random(SEED)  # noqa: S311 - moments, not secrets
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        for number, (name, text) in enumerate(STUDIES.items()):
            study = Path(folder) / f"{name}.toml"
            study.write_text(text, encoding="utf-8")
            whole = Path(folder) / f"{name}.h5"
            length = seconds_of(study, whole)
            share = kills // len(STUDIES) + (number < kills % len(STUDIES))
            rows.append(killed(study, whole.read_bytes(), length, share, rng))
            print(*rows[-1], sep="\t", flush=True)
    RESULTS.mkdir(parents=True, exist_ok=True)
    lines = [
        "# Sweeps killed at random moments",
        "",
        f"Made by `python benchmarks/kill.py {kills}`, standfast {sf.__version__}, seed {SEED}.",
        "Each sweep was killed with SIGKILL at a random moment of its length and started again by",
        "the same command; every file found under the final name was compared with that of an",
        "uninterrupted run, byte by byte. Shards were made small, so that each study has several.",
        "",
        "| study | file | length | kills | found shards to resume | found finished | unlike |",
        "|---|---|---|---|---|---|---|",
        *("| " + " | ".join(row) + " |" for row in rows),
        "",
    ]
    (RESULTS / "README.md").write_text("\n".join(lines), encoding="utf-8")
    if any(row[-1] != "0" for row in rows):
        raise SystemExit("a file differs from an uninterrupted run's")


if __name__ == "__main__":
    main()
