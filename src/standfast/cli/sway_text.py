"""The measures of recordings as text: of one a line a measure, of several a line a recording."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from standfast.recordings.measures import SwayMeasures
    from standfast.recordings.recording import Recording

# Of several recordings these are printed; all are in --csv and --json.
SHORT = {
    "area": "area",
    "sd_ap": "SD AP",
    "sd_ml": "SD ML",
    "mean_velocity": "velocity",
    "mean_frequency": "mean f",
    "median_frequency": "median f",
}


def print_measures(
    recordings: Sequence["Recording"],
    found: Sequence["SwayMeasures"],
    remarks: Sequence[Sequence[str]],
    low_pass: float | None,
) -> None:
    """Print what was found, in the units of the field, and what is to be said of each."""
    filtered = "no filter" if low_pass is None else f"low-pass at {low_pass:g} Hz"
    if len(recordings) == 1:
        (recording,), (measures,) = recordings, found
        seconds = recording.ap.size / recording.rate
        print(f"{recording.name}: {seconds:.4g} s at {recording.rate:.6g} Hz, {filtered}\n")
        print_columns({"recording": measures})
    else:
        print(f"{len(recordings)} recordings, {filtered}\n")
        _print_rows(recordings, found)
    if any(remarks):
        print()
    told: dict[str, list[str]] = {}
    for recording, said in zip(recordings, remarks, strict=True):
        for remark in said:
            told.setdefault(remark, []).append(recording.name)
    for remark, names in told.items():
        more = f" and {len(names) - 3} more" if len(names) > 3 else ""
        where = f"{', '.join(names[:3])}{more}: " if len(recordings) > 1 else ""
        print(f"  note: {where}{remark}")


def print_columns(columns: dict[str, "SwayMeasures"]) -> None:
    """Print a line a measure, and a column each of those who have them, by its title."""
    from standfast.recordings.measures import MEASURES

    width = max(len(row.meaning) for row in MEASURES.values())
    print(f"  {'':{width}}  {'':5}" + "".join(f"{title:>12}" for title in columns))
    for name, row in MEASURES.items():
        values = "".join(f"{row.factor * getattr(each, name):12.4g}" for each in columns.values())
        print(f"  {row.meaning:{width}}  {row.printed:5}{values}")


def _print_rows(recordings: Sequence["Recording"], found: Sequence["SwayMeasures"]) -> None:
    from standfast.recordings.measures import MEASURES

    width = min(40, max(len(recording.name) for recording in recordings))
    heads, units = [*SHORT.values()], [MEASURES[name].printed for name in SHORT]
    for words in (["duration", *heads], ["s", *units]):
        print(f"  {'':{width}}" + "".join(f"{word:>10}" for word in words))
    for recording, measures in zip(recordings, found, strict=True):
        values = [MEASURES[name].factor * getattr(measures, name) for name in SHORT]
        seconds = recording.ap.size / recording.rate
        line = "".join(f"{value:10.4g}" for value in (seconds, *values))
        print(f"  {recording.name:{width}}{line}")
