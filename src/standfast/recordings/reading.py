"""A recording out of the file of a force plate: CSV, TSV or text, with lines above, or C3D."""

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from standfast.errors import InputError, says_its_arguments, shortened
from standfast.files import checked_path
from standfast.numerics.arrays import Array
from standfast.population.people.decoding import (
    MARKS,
    OLD_EXCEL,
    STANDARD_INPUT,
    ZIPPED,
    bytes_of,
    called,
    decoded,
)
from standfast.recordings.c3d_file import is_c3d
from standfast.recordings.c3d_plates import centre_in_c3d
from standfast.recordings.centre import Found, Wanted, centre_of, only
from standfast.recordings.clock import clock_seconds, is_clock
from standfast.recordings.columns import Column, chosen, listed, recognised
from standfast.recordings.plates import checked_choice
from standfast.recordings.recording import Recording, checked_rate
from standfast.recordings.sampling import RATES_DIFFER, Samples, evenly, in_seconds
from standfast.recordings.table import Table, entries_in, numbers_in, rate_above, table_of

HIGHEST_SURFACE = 0.3  # m


@says_its_arguments()
def read_recording(
    path: str | Path,
    *,
    time: str | None = None,
    ap: str | None = None,
    ml: str | None = None,
    unit: str | None = None,
    rate: float | None = None,
    surface: float = 0.0,
    plate: str | Mapping[str, Sequence[float]] | None = None,
) -> Recording:
    """Read the centre of pressure of a person on one or more force plates from a file.

    Columns are found by their names, units by what is in the names or the line below them. From
    forces and moments it is, at the surface of the plate (z = d),

    x = (d Fx − My)/Fz,  y = (d Fy + Mx)/Fz,

    and of several plates Σ Fz (x, y)/Σ Fz with all of them in one frame.

    Parameters
    ----------
    path
        CSV, TSV or text, or C3D (the extra ``standfast[c3d]``), which says itself where its plates
        lie, so that the axes are those of the laboratory; ``-`` is standard input.
    time, ap, ml
        name or number (from 1) of a column where names do not say it; ``ap="y"`` says that the
        plate's y is anterior-posterior (x, if nothing says it, which a remark tells).
    unit
        of the centre of pressure (m, cm, mm) or of the moments (N·m, N·mm), where names do not say
        it.
    rate
        Hz, where there is no column of time; both may be given if they agree.
    surface
        d (m): height of the surface over the origin of the moments along the plate's z, below 0
        where z points down.
    plate
        of several plates in the file, by the number or word in the columns' names: one that is read
        alone, ``"1"``; or where their origins lie (m), along the axes that they share, from that of
        the one that is left out: ``{"2": (0, 0.6)}``.

    Raises
    ------
    InputError
        if what a column holds, or its unit, is not clear, or what it holds is no recording of quiet
        standing (:class:`Recording`).

    Examples
    --------
    >>> import standfast as sf
    >>> recording = sf.read_recording("recording.csv", unit="mm", rate=100)
    >>> recording.duration, recording.rate
    (59.99, 100.0)
    """
    where = checked_path("path", path)
    _check_words(time=time, ap=ap, ml=ml, unit=unit)
    given = None if rate is None else checked_rate("rate", rate)
    wanted = Wanted(ap, ml, unit, _checked_surface(surface), checked_choice(plate))
    return _recorded(where, time, given, wanted)


def _recorded(path: Path, time: str | None, rate: float | None, wanted: Wanted) -> Recording:
    """Return the recording in a file; errors begin with its name."""
    name = called(path) if str(path) == STANDARD_INPUT else str(path)
    try:
        with np.errstate(all="ignore"):  # of numbers that no plate writes, refused as what they are
            raw = bytes_of(path, "a recording")
            of = _of_c3d if is_c3d(raw) else _of_text
            samples, remarks = of(path, raw, time, rate, wanted)
        return Recording(samples.ap, samples.ml, samples.rate, name, tuple(remarks))
    except InputError as error:
        told = str(error)
        raise InputError(told if told.startswith(name) else f"{name}: {told}") from None


def _of_text(
    path: Path, raw: bytes, time: str | None, rate: float | None, wanted: Wanted
) -> tuple[Samples, list[str]]:
    """Return even samples of a table, and what is to be said of how they were read."""
    table = table_of(_text(path, raw), _known)
    found = recognised(table.names, table.units, table.groups)
    remarks = list(table.remarks)
    times = _time(table, found, time, rate, remarks)
    columns, said = centre_of(table, found, wanted)
    known = (rate or 0.0) if times is not None else _rate(table, rate, remarks)
    samples = evenly(times, known, *columns, table.lines)
    return samples, [*said, *remarks, *samples.remarks]


def _of_c3d(
    path: Path, raw: bytes, time: str | None, rate: float | None, wanted: Wanted
) -> tuple[Samples, list[str]]:
    """Return the samples of a C3D file, and what is to be said of how they were read."""
    if time is not None:
        raise InputError(f"time={time}: {called(path)} is a C3D file, which has a rate")
    (ap, ml), known, said = centre_in_c3d(raw, wanted)
    if rate is not None and abs(known / rate - 1.0) > RATES_DIFFER:
        raise InputError(
            f"the file says {known:.5g} Hz, and rate={rate:.5g} is given; leave one away"
        )
    samples = evenly(None, checked_rate("the rate of the analog channels", known), ap, ml,
                     [0] * ap.size)  # fmt: skip
    return samples, [*said, *samples.remarks]


def _known(names: Sequence[str], units: Sequence[str]) -> int:
    try:
        return len(recognised(names, units))
    except InputError:  # of a unit, which is said once the columns are chosen
        return len(recognised(names, ()))


def _check_words(**given: Any) -> None:
    for name, value in given.items():
        if value is not None and not isinstance(value, str):
            raise InputError(f"{name} = {shortened(value)} is not a text")


def _checked_surface(given: Any) -> float:
    try:
        height = float(given)
    except (TypeError, ValueError):
        height = math.nan
    if not abs(height) <= HIGHEST_SURFACE:
        like = ", is it in mm?" if HIGHEST_SURFACE < abs(height) <= 1e3 * HIGHEST_SURFACE else ""
        raise InputError(
            f"surface = {shortened(given)} is not a height of {-HIGHEST_SURFACE:g} to "
            f"{HIGHEST_SURFACE:g} m{like}"
        )
    return height


def _text(path: Path, raw: bytes) -> str:
    if raw.startswith((ZIPPED, OLD_EXCEL)):
        raise InputError("it is a spreadsheet or an archive; save the table as CSV")
    marked = any(raw.startswith(mark) for mark, _ in MARKS)
    if b"\0" in raw and not marked:
        raise InputError("it is no text; export the recording as CSV")
    text = decoded(str(path), raw)
    if not text.strip():
        raise InputError("it is empty; give a line of names and a line a sample")
    return text


def _time(
    table: Table,
    found: Found,
    option: str | None,
    rate: float | None,
    remarks: list[str],
) -> Array | None:
    if option is not None:
        column: Column | None = chosen("time", option, table.names, table.units, "time")
    else:
        column = only(found.get("time", []), "time")
    if column is None:
        return None
    entries = entries_in(table, column.place)
    try:
        if is_clock(entries):
            return clock_seconds(entries, table.lines, column.name)
        (numbers,) = numbers_in(table, [column.place])
    except InputError:
        if rate is None or option is not None:
            raise
        remarks.append(f"the time in {column.name!r} is not read; the rate is as given")
        return None
    times, remark = in_seconds(numbers, column.unit)
    if remark:
        remarks.append(remark)
    return times


def _rate(table: Table, given: float | None, remarks: list[str]) -> float:
    if given is not None:
        return given
    if (above := rate_above(table)) is not None:
        remarks.append(f"the rate of {above:g} Hz is read from the lines before the table")
        return checked_rate("the rate in the lines before the table", above)
    raise InputError(
        f"there is no column of time; name one time (s), or say the samples "
        f"a second as rate=100 {listed(table.names)}"
    )
