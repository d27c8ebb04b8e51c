"""The measures of recordings as text: of one a line a measure, of several a line a recording."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from standfast.cli.sway_model import columns_beside, model_in_words

if TYPE_CHECKING:
    from standfast.cli.sway_model import ModelBeside
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
# And beside the model of several.
BESIDE = {
    "sd_ap": "SD AP",
    "mean_velocity_ap": "velocity AP",
    "mean_frequency_ap": "mean f AP",
}


def print_measures(
    recordings: Sequence["Recording"],
    found: Sequence["SwayMeasures"],
    remarks: Sequence[Sequence[str]],
    low_pass: float | None,
    model: "ModelBeside | None" = None,
) -> None:
    """Print what was found, in the units of the field, and what is to be said of each."""
    filtered = "no filter" if low_pass is None else f"low-pass at {low_pass:g} Hz"
    if len(recordings) == 1:
        (recording,), (measures,) = recordings, found
        seconds = recording.ap.size / recording.rate
        print(f"{recording.name}: {seconds:.4g} s at {recording.rate:.6g} Hz, {filtered}\n")
        columns = [{"recording": measures}] if model is None else columns_beside(model, found)
        print_columns(*columns)
    else:
        print(f"{len(recordings)} recordings, {filtered}\n")
        _print_rows(recordings, found)
        if model is not None:
            _print_rows_beside(recordings, list(columns_beside(model, found)))
    if model is not None:
        print(f"\n{model_in_words(model, low_pass)}")
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


def print_columns(columns: Mapping[str, Any]) -> None:
    """Print a line a measure that anybody has, and a column each of those who have some."""
    from standfast.recordings.expected import MODELLED
    from standfast.recordings.measures import MEASURES

    rows = {
        name: row
        for name, row in {**MEASURES, **MODELLED}.items()
        if any(hasattr(each, name) for each in columns.values())
    }
    width = max(len(row.meaning) for row in rows.values())
    print(f"  {'':{width}}  {'':5}" + "".join(f"{title:>12}" for title in columns))
    for name, row in rows.items():
        values = (_entry(each, name, row.factor) for each in columns.values())
        print(f"  {row.meaning:{width}}  {row.printed:5}" + "".join(f"{v:>12}" for v in values))


def _entry(of: Any, name: str, factor: float) -> str:
    return f"{factor * getattr(of, name):.4g}" if hasattr(of, name) else "–"


def _print_rows_beside(
    recordings: Sequence["Recording"], columns: Sequence[Mapping[str, Any]]
) -> None:
    """Print of each recording what the model predicts beside what was found."""
    from standfast.recordings.expected import MODELLED

    width = min(40, max(len(recording.name) for recording in recordings))
    heads = [word for head in BESIDE.values() for word in (head, "model")]
    units = [MODELLED[name].printed for name in BESIDE for _ in range(2)]
    print()
    for words in (heads, units):
        print(f"  {'':{width}}" + "".join(f"{word:>14}" for word in words))
    for recording, both in zip(recordings, columns, strict=True):
        values = (
            _entry(each, name, MODELLED[name].factor) for name in BESIDE for each in both.values()
        )
        print(f"  {recording.name:{width}}" + "".join(f"{value:>14}" for value in values))


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
