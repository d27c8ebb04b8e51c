"""What do the hot kernels cost, counted by XLA instead of timed.

Operations, and bytes read and written, a point, and the loops of an eigenvalue on a grid: a guard
against slow code coming back that no noise disturbs. A change of XLA may move them, a change of
ours should have a reason. Run as ``python benchmarks/cost.py`` (half a minute).
"""

import sys

import jax
import numpy as np

import standfast as sf
from harness import ROOT, Demand, Report
from standfast.engine.mapping import Inputs, map_over_grid
from standfast.parameters import JOINTS, STIFFNESSES
from standfast.quantities import Person

sys.path.insert(0, str(ROOT / "tests" / "helpers"))
from kernels import KERNELS, POINTS, lowest_or_nan, program

# Operations and bytes a point: a tenth more than when each was first counted.
BOUNDS = {
    "fast eigenvalue": (380.0, 124.0),
    "safety factor": (128.0, 238.0),
    "threshold and its ends": (140.0, 300.0),
    "modes": (2270.0, 2300.0),
    "class of a person": (80.0, 119.0),
    "all bins of a person": (980.0, 1385.0),
}
SIDE = 16


def loops_on_a_grid() -> int:
    """Count the loops over all of a grid in which XLA computes its eigenvalues.

    It cuts where a result is used twice; then each part may compute all anew.
    """
    axis = {"start": 100.0, "stop": 100.0 + SIDE, "num": SIDE}
    stiffness = dict.fromkeys(JOINTS, axis)
    study = sf.Study.from_dict({"body": {"height": 1.7, "mass": 70.0}, "stiffness": stiffness})
    inputs = Inputs(study)
    places = dict.fromkeys(STIFFNESSES, np.arange(SIDE))
    mapped = map_over_grid(lambda given: lowest_or_nan(*Person.of(given)[:3]), STIFFNESSES)
    with jax.enable_x64(True):
        text = mapped.lower(inputs.fixed, inputs.pieces(places)).compile().as_text()
    return text[text.index("ENTRY") :].count(f"[{SIDE},{SIDE},{SIDE}]{{2,1,0}} fusion(")


def main() -> None:
    """Count, and write the report."""
    report = Report("cost", "What do the hot kernels cost?", "counts of XLA, a point")
    for name, (function, arguments) in KERNELS.items():
        cost = program(function, *arguments()).cost_analysis()
        counts = (cost["flops"] / POINTS, cost["bytes accessed"] / POINTS)
        for count, bound, unit in zip(counts, BOUNDS[name], ("operations", "bytes"), strict=True):
            report.demands.append(Demand(f"{name}: {unit} a point", bound, count, most=True))
    report.demands.append(
        Demand("fast eigenvalue on a grid: loops", 1.0, loops_on_a_grid(), most=True)
    )
    report.limitations.append("Counts are no seconds: which way is faster, the timed scripts say.")
    report.write()


if __name__ == "__main__":
    main()
