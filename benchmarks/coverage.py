"""How often intervals of 95 % hold the truth, over thousands of seeds.

Run as ``python benchmarks/coverage.py`` (some minutes); writes ``results/coverage/README.md``. The
population is that of ``tests/helpers/covering.py``, whose answers are known exactly.
"""

import sys

import numpy as np

from harness import ROOT, machine

sys.path.insert(0, str(ROOT / "tests" / "helpers"))

from covering import FALL, NINE_IN_TEN, estimates, holds

RESULTS = ROOT / "results" / "coverage" / "README.md"
SIZE = 4096
SEEDS = {"monte-carlo": 1500, "quasi-monte-carlo": 500}
WANTED, WITHIN = 0.95, 0.02


def main() -> None:
    """Count, write, and fail where an interval does not keep its promise."""
    rows, kept = [], True
    for method, seeds in SEEDS.items():
        found = list(estimates(method, SIZE, seeds))
        for what, truth, column in (("falls", FALL, 0), ("multiple", NINE_IN_TEN, 1)):
            share = float(np.mean([holds(each[column], truth) for each in found]))
            kept = kept and abs(share - WANTED) <= WITHIN
            words = {"falls": "who falls", "multiple": "multiple of the load for nine in ten"}
            rows.append(f"| {method} | {words[what]} | {truth:.6f} | {seeds} | {100 * share:.1f} |")
    RESULTS.parent.mkdir(parents=True, exist_ok=True)
    text = [
        "# Intervals of 95 % hold the truth",
        "",
        f"`python benchmarks/coverage.py`: {SIZE} persons a seed; only the ankle bends, so that",
        f"the truth is known. Wanted: 95 ± {100 * WITHIN:.0f} % of the seeds.",
        "",
        "| method | of what | truth | seeds | held, % |",
        "|---|---|---|---|---|",
        *rows,
    ]
    RESULTS.write_text("\n".join(text) + "\n", encoding="utf-8")
    print("\n".join(rows), machine(), sep="\n")
    sys.exit(0 if kept else "an interval holds the truth too seldom or too often")


if __name__ == "__main__":
    main()
