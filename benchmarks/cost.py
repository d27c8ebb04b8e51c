"""What do the hot kernels cost, counted by XLA instead of timed.

Operations, and bytes read and written, a point: a guard against slow code coming back that no noise
disturbs. A change of XLA may move them, a change of ours should have a reason. Run as
``python benchmarks/cost.py`` (half a minute).
"""

import sys

from harness import ROOT, Demand, Report

sys.path.insert(0, str(ROOT / "tests" / "helpers"))
from kernels import KERNELS, POINTS, program

# Operations and bytes a point when this was written, and a tenth more.
BOUNDS = {
    "fast eigenvalue": (920.0, 414.0),
    "safety factor": (128.0, 238.0),
    "threshold and its ends": (140.0, 300.0),
    "modes": (2270.0, 2300.0),
    "class of a person": (135.0, 137.0),
    "all bins of a person": (1250.0, 1620.0),
}


def main() -> None:
    """Count, and write the report."""
    report = Report("cost", "What do the hot kernels cost?", "counts of XLA, a point")
    for name, (function, arguments) in KERNELS.items():
        cost = program(function, *arguments()).cost_analysis()
        counts = (cost["flops"] / POINTS, cost["bytes accessed"] / POINTS)
        for count, bound, unit in zip(counts, BOUNDS[name], ("operations", "bytes"), strict=True):
            report.demands.append(Demand(f"{name}: {unit} a point", bound, count, most=True))
    report.write()


if __name__ == "__main__":
    main()
