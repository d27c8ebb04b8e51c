"""Rows of a file of people that were not used: some on the screen, all in a file."""

import csv
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from standfast.files import for_spreadsheets, whole_file

# Rows that are printed; a file beside the result has all.
MOST_PRINTED = 5


def print_rejected(rejected: Sequence[dict[str, Any]]) -> None:
    """Print some rejected rows, and how often each of the plain reasons occurs."""
    for row in rejected[:MOST_PRINTED]:
        print(f"    {row['file']}, line {row['line']}: {row['reason']}")
    if len(rejected) > MOST_PRINTED:
        often = Counter(row["reason"].split(" =")[0] for row in rejected)
        reasons = ", ".join(f"{n:,} {reason}" for reason, n in often.most_common(MOST_PRINTED))
        print(f"    … in all {reasons}; see the file of rejected rows")


def write_rejected(rejected: Sequence[dict[str, Any]], output: Path) -> list[Path]:
    """Write which rows were not used and why, beside the result; nothing if all were."""
    path = output.with_name(f"{output.stem}-rejected.csv")
    if not rejected:
        path.unlink(missing_ok=True)  # of a run before
        return []
    with whole_file(path) as partial, partial.open("w", encoding="utf-8", newline="") as file:
        rows = csv.DictWriter(file, ("file", "line", "reason"), lineterminator="\n")
        rows.writeheader()
        rows.writerows({**row, "file": for_spreadsheets(row["file"])} for row in rejected)
    return [path]
