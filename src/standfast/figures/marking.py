"""Subjects of one's own on a figure: who they are, in which panel they lie, and their marks."""

import csv
import difflib
import math
import re
import warnings
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from io import StringIO
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from standfast.errors import InputError, nearest_name, shortened
from standfast.figures.labels import NOWHERE, half_size, in_data, in_frame
from standfast.figures.slicing import full_name, short_names, value_in
from standfast.figures.style import note, remark
from standfast.files import opened_plainly
from standfast.parameters import PARAMETERS, checked_number
from standfast.study.study import Study

Given = Mapping[str, Any]

LABELS = ("id", "name", "subject")
MOST_SUBJECTS = 200
# A parameter and a unit, as people name a column: height_cm, mass (kg).
WITH_UNIT = re.compile(
    r"(\w+?)[ _]*[ _(\[](?:cm|mm|m|kg|g|lb|ms|s|Nm|N·?m/rad)[)\]]?", re.IGNORECASE
)

LIKELY = 0.75  # a column's name as near as that to a parameter's is a slip
SIZES = {"mass", "bmi"}  # one follows from the other by the height
SAME = 1e-6  # a value that is the figure's, relative

# Where a label is tried beside its mark, in half sizes of both; after the first ones with a line.
NEAR = 6
AROUND = [
    (1, 0.6),
    (-1, 0.6),
    (1, -0.6),
    (-1, -0.6),
    (0, 1),
    (0, -1),
    (1, 2),
    (-1, 2),
    (1, -2),
    (-1, -2),
]

MARK: Any = {"marker": "D", "markersize": 5.0, "linestyle": "", "zorder": 6, "clip_on": False}
MARK |= {"markerfacecolor": "white", "markeredgecolor": "black", "markeredgewidth": 1.2}


@dataclass(frozen=True, slots=True)
class Subject:
    """A person to be marked: a label, which may be empty, and parameters by name."""

    label: str
    values: Mapping[str, float | str]

    @property
    def called(self) -> str:
        """How messages call the subject."""
        words = (f"{k}={v}" if isinstance(v, str) else f"{k}={v:g}" for k, v in self.values.items())
        return self.label or ", ".join(words)


def subjects_of(mark: Given | str | Path | Iterable[Given | Subject] | None) -> list[Subject]:
    """Return the subjects that a caller wants to mark.

    A mapping of parameters, by their names or a study's keys, with an optional ``id``; several; or
    the name of a CSV file of them.
    """
    if mark is None:
        return []
    if isinstance(mark, str | Path):
        return subjects_in(Path(mark))[0]
    several = [mark] if isinstance(mark, Mapping | Subject) or not np.iterable(mark) else list(mark)
    for each in several:
        if not isinstance(each, Mapping | Subject):
            raise InputError(
                f"mark = {shortened(mark)}; give parameters by name, as "
                '{"ankle": 900, "hip": 400}, several of them, or a CSV file'
            )
    return [each if isinstance(each, Subject) else subject("mark", each) for each in several]


def subjects_on(axes: tuple[str, str], mark: Any) -> list[Subject]:
    """Return :func:`subjects_of`; refuse one who does not name both axes of a figure."""
    subjects = subjects_of(mark)
    for one in subjects:
        if lacking := missing_axes(one, axes):
            raise InputError(f"mark: {one.called} does not name {' and '.join(lacking)}")
    return subjects


def subject(where: str, given: Given) -> Subject:
    """Check one subject; what is given may be text."""
    label = str(next((given[key] for key in LABELS if key in given), ""))
    values: dict[str, float | str] = {}
    for key, value in given.items():
        if key not in LABELS:
            name = full_name(where, str(key))
            found = value_in(where, name, value)
            if not isinstance(found, str):
                checked_number(f"{where}: {name}", found, row=PARAMETERS[name])
            values[name] = found
    if "bmi" not in values and {"height", "mass"} <= values.keys():
        values["bmi"] = float(values["mass"]) / float(values["height"]) ** 2
    if "mass" not in values and {"height", "bmi"} <= values.keys():
        values["mass"] = float(values["bmi"]) * float(values["height"]) ** 2
    return Subject(label, values)


def subjects_in(path: Path) -> tuple[list[Subject], str]:
    """Read subjects from a CSV file: columns of parameters, and ``id``; say which are not used.

    Raises
    ------
    InputError
        if it cannot be read, has no rows, or a column that is nearly a parameter's name.
    """
    try:
        with opened_plainly(path) as file:
            text = file.read().decode("utf-8-sig")
    except OSError as error:
        raise InputError(f"{path} cannot be read: {error.strerror}") from None
    except UnicodeDecodeError:
        raise InputError(f"{path} is not a CSV file in UTF-8") from None
    head = text.lstrip().partition("\n")[0]
    rows = list(csv.DictReader(StringIO(text, newline=""), delimiter=max(",;\t", key=head.count)))
    columns = [key for key in (rows[0] if rows else {}) if key]
    names = {*short_names(), *LABELS}
    known = {key: key.strip().lower() for key in columns if key.strip().lower() in names}
    others = [key for key in columns if key not in known]
    for key in others:
        united = WITH_UNIT.fullmatch(key.strip().lower())
        if united and united[1] in short_names():
            unit = PARAMETERS[short_names()[united[1]]].unit
            raise InputError(f"{path} has a column {key!r}; name it {united[1]}, in {unit}")
        if difflib.get_close_matches(key.strip().lower(), short_names(), n=1, cutoff=LIKELY):
            hint = nearest_name(key.strip().lower(), short_names())
            raise InputError(f"{path} has a column {key!r}, which is no parameter{hint}")
    if not rows or set(known.values()) <= {*LABELS}:
        raise InputError(
            f"{path} has no subjects; give columns such as id, ankle, hip and a row each"
        )
    if len(rows) > MOST_SUBJECTS:
        raise InputError(
            f"{path} has {len(rows):,} subjects; at most {MOST_SUBJECTS} can be marked"
        )
    comma = max(",;\t", key=head.count) != ","
    found = []
    for number, row in enumerate(rows, start=1):
        cells = {name: (row[key] or "").strip() for key, name in known.items()}
        given = {
            name: cell.replace(",", ".") if comma and name not in LABELS else cell
            for name, cell in cells.items()
            if cell
        }
        found.append(subject(f"{path}, row {number}", given))
    return found, f"{path}: not used: {', '.join(others)}" if others else ""


def warn_of(ax: Axes, subjects: Sequence[Subject], axes: tuple[str, str]) -> None:
    """Warn of subjects who lie outside of the axes that are drawn for a caller in Python."""
    frame = dict(zip(axes, (ax.get_xlim(), ax.get_ylim()), strict=True))
    for one in subjects:
        if words := is_outside(one, frame):
            warnings.warn(words, UserWarning, stacklevel=3)


def missing_axes(one: Subject, axes: Sequence[str]) -> list[str]:
    """Return the axes of a figure that a subject does not name."""
    return [axis for axis in axes if axis not in one.values]


def nearest_panel(
    one: Subject, study: Study, shown: Mapping[str, set[int]]
) -> dict[str, int] | None:
    """Return where a subject belongs on the axes of panels that it names; None if nowhere."""
    places = {}
    for axis, kept in shown.items():
        if axis not in one.values:
            continue
        values, mine = study.axes[axis], one.values[axis]
        if isinstance(mine, str):
            near = [place for place in kept if values[place] == mine]
        else:
            # to a rigid joint all are equally far: the stiffest is the nearest
            near = sorted(kept, key=lambda at: (_distance(values[at], mine), -values[at]))
        if not near:
            return None
        places[axis] = near[0]
    return places


def _distance(one: Any, other: float) -> float:
    return 0.0 if one == other else abs(float(one) - other)


def contradictions(
    one: Subject,
    held: Mapping[str, float | str],
    curves: Mapping[str, Sequence[Any]] | None = None,
    known: Collection[str] = tuple(PARAMETERS),
) -> str:
    """Say which values of a subject are others than those that a figure holds.

    ``curves`` are the values of an axis at which curves are drawn, ``known`` all parameters of the
    study.
    """
    words = []
    for name, value in one.values.items():
        unknown = name not in known and not (name in SIZES and SIZES & {*known})
        if unknown:
            words.append(f"{name} {_said(name, value)}, which the study does not hold")
        drawn = (curves or {}).get(name, ())
        if len(drawn) and not any(_is(value, each) for each in drawn):
            each = ", ".join(_said(name, v, unit=False) for v in drawn)
            words.append(f"{name} {_said(name, value)}, curves at {each}")
        there = held.get(name)
        if there is None or _is(value, there):
            continue
        words.append(
            f"{name} {_said(name, value)}, drawn where it is {_said(name, there, unit=False)}"
        )
    return f"{one.called}: {'; '.join(words)}" if words else ""


def _said(name: str, value: float | str, *, unit: bool = True) -> str:
    if isinstance(value, str) or math.isinf(value):
        return value if isinstance(value, str) else "rigid"
    return f"{value:.4g} {PARAMETERS[name].unit}" if unit else f"{value:.4g}"


def _is(one: float | str, other: float | str) -> bool:
    if isinstance(one, str) or isinstance(other, str):
        return one == other
    return math.isclose(one, other, rel_tol=SAME)


def is_outside(one: Subject, frame: Mapping[str, tuple[float, float]]) -> str:
    """Say by which axis of a frame a subject lies outside; empty if it lies inside."""
    for axis, (low, high) in frame.items():
        value = one.values[axis]
        if not isinstance(value, str) and not low <= value <= high:
            given = "rigid" if math.isinf(value) else f"{value:g}"
            return f"{one.called} is outside: {axis} {given}, axis {low:g} to {high:g}"
    return ""


def draw_subjects(ax: Axes, subjects: Sequence[Subject], axes: tuple[str, str]) -> np.ndarray:
    """Mark subjects; say of who lies outside in a corner.

    A label lies beside its mark where it covers no mark and no other label; without such a place
    the corner says so. Returns the places (n, 2) of marks and labels, in widths and heights of the
    frame, which no word is to cover.
    """
    ends = dict(zip(axes, (ax.get_xlim(), ax.get_ylim()), strict=True))
    inside = [one for one in subjects if not is_outside(one, ends)]
    for one in subjects:
        if one not in inside:
            note(ax, f"outside: {one.label or 'subject'}")
    points = [[float(one.values[name]) for name in axes] for one in inside]
    if not points:
        return NOWHERE
    marks = in_frame(ax, np.array(points))
    mark = half_size(ax, "x") * [1.0, 0.6]
    taken = [(place, mark) for place in marks]
    for one, point, at in zip(inside, points, marks, strict=True):
        ax.plot(*([each] for each in point), **MARK)
        size = half_size(ax, one.label)
        beside = at + np.array(AROUND) * (size + 1.2 * mark)
        free = ((beside > size) & (beside < 1.0 - size)).all(axis=1)
        for place, other in taken:
            free &= (np.abs(beside - place) >= size + other).any(axis=1)
        if one.label and free.any():
            first = int(np.argmax(free))
            taken.append((beside[first], size))
            end = in_data(ax, beside[first])
            if first >= NEAR:
                ax.plot(*zip(point, end, strict=True), color="black", linewidth=0.5, zorder=5)
            remark(ax, *end, one.label.replace("$", r"\$"), zorder=6.0)
        elif one.label:
            note(ax, f"not labelled: {one.label}")
    return np.array([place for place, _ in taken])
