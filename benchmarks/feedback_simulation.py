"""Two hundred random persons simulated in time by their full nonlinear equations, with the delay.

Answers: does a person fall or stand as the verdict says? Run as
``python benchmarks/feedback_simulation.py [CASES]`` (default 200, some minutes); writes
``results/feedback/simulation.md``. Cases lie at least 0.2 1/s away from the boundary, half of them
stand. A simulation starts 1e-5 rad beside upright and lasts seven time constants of the rightmost
root; it falls if rotations grow by half from its second quarter to its last, and stands if they
shrink by a third.
"""

import sys
import time

import numpy as np

import standfast as sf
from harness import ROOT, machine

sys.path.insert(0, str(ROOT / "tests" / "helpers"))

from delay_simulation import GRAVITY, amplitudes, falls, random_cases

RESULTS = ROOT / "results" / "feedback" / "simulation.md"
SEED = 2007
AWAY = 0.2  # 1/s
TOGETHER = 25  # cases in one call, sorted by how long they last


def main() -> None:
    """Simulate and compare."""
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 200
    began = time.perf_counter()
    cases, decay = random_cases(np.random.default_rng(SEED), count, AWAY)
    stands = np.array([
        sf.is_stable(body, stiffness, GRAVITY, damping=damping, feedback=feedback)
        for body, stiffness, damping, feedback in cases
    ])  # fmt: skip
    fell = np.full(count, np.nan)
    order = np.argsort(-abs(decay))
    for first in range(0, count, TOGETHER):
        part = order[first : first + TOGETHER]
        fell[part] = falls(amplitudes([cases[number] for number in part], decay[part]))
        print(f"{min(first + TOGETHER, count)}/{count}", flush=True)
    neither = np.isnan(fell)
    unlike = ~neither & (fell == stands)
    free = [int(np.isfinite(stiffness.joints).sum()) for _, stiffness, _, _ in cases]
    here = machine()
    lines = [
        "# Verdicts and simulations in time\n",
        f"Made by `python benchmarks/feedback_simulation.py {count}`, seed {SEED}; "
        f"{here['processor']}, {(time.perf_counter() - began) / 60:.0f} minutes. "
        f"Full nonlinear equations in time with the delay; persons {AWAY} 1/s or more away from "
        "the boundary, half of them standing; what counts as falling is told in the script.\n",
        f"**{int(unlike.sum())} of {count} verdicts are unlike the simulation**, which says "
        f"neither in {int(neither.sum())}.\n",
        "| free joints | cases | stand | fall | unlike |",
        "|---|---|---|---|---|",
    ]
    for joints in (1, 2, 3):
        of = np.array(free) == joints
        lines.append(
            f"| {joints} | {of.sum()} | {(of & stands).sum()} | {(of & ~stands).sum()} | "
            f"{(of & unlike).sum()} |"
        )
    RESULTS.parent.mkdir(parents=True, exist_ok=True)
    RESULTS.write_text("\n".join(lines) + "\n", encoding="utf-8")
    print(RESULTS.relative_to(ROOT), f"{int(unlike.sum())} unlike", sep=": ")


if __name__ == "__main__":
    main()
