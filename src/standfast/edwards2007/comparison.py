"""The comparison table: every published number beside ours, with a verdict."""

import csv
import io
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from standfast.anthropometry.body import Body
from standfast.edwards2007.published import INPUT_ROUNDING, PUBLISHED, PublishedNumber
from standfast.files import whole_file

AGREES, WITHIN_ROUNDING, NOT_REPRODUCED = "agrees", "within rounding", "not reproduced"

# Printed intervals are closed; this much relative slack is rounding of their ends in binary.
END_SLACK = 1e-12


@dataclass(frozen=True, slots=True)
class Comparison:
    """One published number, ours, and the interval that rounding of the listed inputs allows."""

    published: PublishedNumber
    computed: float
    lowest: float
    highest: float

    @property
    def verdict(self) -> str:
        """Agrees as printed, agrees for some inputs that round to the listed ones, or neither."""
        slack = END_SLACK * abs(self.computed)
        low, high = self.published.lowest - slack, self.published.highest + slack
        if low <= self.computed <= high:
            return AGREES
        if self.lowest <= high and low <= self.highest:
            return WITHIN_ROUNDING
        return NOT_REPRODUCED


def compare() -> list[Comparison]:
    """Compute every published number from the listed values."""
    body = Body.edwards2007()
    return [
        Comparison(number, number.compute(body), *rounding_interval(number.compute, body))
        for number in PUBLISHED
    ]


def rounding_interval(compute: Callable[[Body], float], body: Body) -> tuple[float, float]:
    """Return the least and greatest value over all inputs that round to the listed ones.

    The box of inputs is so small that both lie at corners. Each is found by climbing: from the
    corner that the slopes at the centre point to, inputs are flipped while that helps (where a
    mode turns from swaying to falling, a slope can change its sign inside the box).
    """
    centre = np.concatenate(body)
    splits = np.cumsum([part.size for part in body])[:-1]

    def value(offsets: np.ndarray) -> float:
        inputs = centre + INPUT_ROUNDING * offsets
        return compute(Body._make(np.split(inputs, splits)))

    def climb(direction: float) -> float:
        corner = direction * rising
        best = value(corner)
        improved = True
        while improved:
            improved = False
            for flip in flips:
                tried = value(corner * flip)
                if direction * tried > direction * best:
                    corner, best, improved = corner * flip, tried, True
        return best

    steps = np.eye(centre.size)
    flips = 1.0 - 2.0 * steps
    rising = np.array([1.0 if value(step) >= value(-step) else -1.0 for step in steps])
    return climb(-1.0), climb(1.0)


COLUMNS = (
    *("quantity", "where", "unit", "published", "stands_for_lowest", "stands_for_highest"),
    *("computed", "lowest", "highest", "verdict", "note"),
)


def as_rows(comparisons: list[Comparison]) -> list[tuple[str, ...]]:
    """Return the table as text, one tuple a row in the order of ``COLUMNS``."""
    rows = []
    for ours in comparisons:
        paper = ours.published
        words = (paper.what, paper.where, paper.unit, paper.printed)
        numbers = (paper.lowest, paper.highest, ours.computed, ours.lowest, ours.highest)
        rows.append((*words, *(f"{number:.6g}" for number in numbers), ours.verdict, paper.note))
    return rows


def as_markdown(comparisons: list[Comparison]) -> str:
    """Return the table as a page, with what is known where numbers differ."""
    lines = [
        "# Effect of joint stiffness on standing stability: published and recomputed",
        "",
        "Source: Gait & Posture 25 (2007) 432-439. Computed from the segment values that the paper",
        "lists, g = 9.8 m/s², stiffness of both legs together. *Allowed* is the interval that the",
        "rounding of the listed values leaves open; *stands for* is what rounds to the printed",
        "number, or our reading of what the paper states in words. A number **agrees** if ours",
        "lies in what the printed one stands for, is **within rounding** if it does for some",
        "inputs that round to the listed ones, and is **not reproduced** otherwise. Made by",
        "`standfast reproduce`.",
        "",
        "| quantity | where | published | stands for | computed | allowed | unit | verdict |",
        "|---|---|---|---|---|---|---|---|",
    ]
    notes: dict[str, int] = {}
    for row in as_rows(comparisons):
        what, where, unit, text, least, most, computed, low, high, verdict, note = row
        mark = f" [{notes.setdefault(note, len(notes) + 1)}]" if note else ""
        shown = f"**{verdict}**" if verdict == NOT_REPRODUCED else verdict
        lines.append(
            f"| {what} | {where} | {text} | {least} … {most} | {computed} | {low} … {high} "
            f"| {unit} | {shown}{mark} |"
        )
    lines += ["", *(f"[{number}] {note}\n" for note, number in notes.items())]
    return "\n".join(lines)


def write_tables(comparisons: list[Comparison], folder: Path) -> list[Path]:
    """Write comparison.md and comparison.csv, each whole or not at all."""
    table = io.StringIO()
    csv.writer(table, lineterminator="\n").writerows([COLUMNS, *as_rows(comparisons)])
    pages = {"comparison.md": as_markdown(comparisons), "comparison.csv": table.getvalue()}
    for name, text in pages.items():
        with whole_file(folder / name) as partial:
            partial.write_text(text, encoding="utf-8")
    return [folder / name for name in pages]
