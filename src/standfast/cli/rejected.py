"""Rows of a file of people that were not used: some on the screen, all in a file."""

import contextlib
import csv
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from standfast.errors import InputError
from standfast.files import for_spreadsheets, require_replaceable, whole_table

# Rows that are printed; a file beside the result has all.
MOST_PRINTED = 5
COLUMNS = ("file", "line", "reason")
HEADER = ",".join(COLUMNS)


def print_rejected(rejected: Sequence[dict[str, Any]]) -> None:
    """Print some rejected rows, and how often each of the plain reasons occurs."""
    for row in rejected[:MOST_PRINTED]:
        print(f"    {row['file']}, line {row['line']}: {row['reason']}")
    if len(rejected) > MOST_PRINTED:
        often = Counter(row["reason"].split(" =")[0] for row in rejected)
        reasons = ", ".join(f"{n:,} {reason}" for reason, n in often.most_common(MOST_PRINTED))
        print(f"    … in all {reasons}; see the file of rejected rows")


def rejected_path(output: Path) -> Path:
    """Return where the rejected rows of a result are written."""
    return output.parent / f"{output.stem}-rejected.csv"


def write_rejected(rejected: Sequence[dict[str, Any]], output: Path) -> list[Path]:
    """Write which rows were not used and why, beside the result; nothing if all were."""
    path = rejected_path(output)
    if not rejected:
        with contextlib.suppress(InputError):  # another's file is left alone
            require_replaceable(path, HEADER)
            path.unlink(missing_ok=True)  # of a run before
        return []
    with whole_table(path, HEADER) as file:
        rows = csv.DictWriter(file, COLUMNS, lineterminator="\n")
        rows.writeheader()
        rows.writerows({**row, "file": for_spreadsheets(row["file"])} for row in rejected)
    return [path]
