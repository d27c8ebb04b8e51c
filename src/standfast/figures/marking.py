"""Subjects of one's own on a figure: who they are, in which panel they lie, and their marks."""

import csv
import difflib
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from io import StringIO
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from standfast.errors import InputError, nearest_name, shortened
from standfast.figures.labels import NOWHERE, in_frame
from standfast.figures.slicing import full_name, short_names, value_in
from standfast.figures.style import note
from standfast.files import opened_plainly
from standfast.parameters import PARAMETERS
from standfast.study.study import Study

Given = Mapping[str, Any]

MOST_SUBJECTS = 200
LIKELY = 0.75  # a column's name as near as that to a parameter's is a slip
SAME = 1e-6  # a value that is the figure's, relative

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
    label = str(given.get("id", ""))
    values: dict[str, float | str] = {}
    for key, value in given.items():
        if key != "id":
            name = full_name(where, str(key))
            values[name] = value_in(where, name, value)
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
    names = {*short_names(), "id"}
    known = {key: key.strip().lower() for key in columns if key.strip().lower() in names}
    others = [key for key in columns if key not in known]
    for key in others:
        if difflib.get_close_matches(key.strip().lower(), short_names(), n=1, cutoff=LIKELY):
            hint = nearest_name(key.strip().lower(), short_names())
            raise InputError(f"{path} has a column {key!r}, which is no parameter{hint}")
    if not rows or set(known.values()) <= {"id"}:
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
            name: cell.replace(",", ".") if comma and name != "id" else cell
            for name, cell in cells.items()
            if cell
        }
        found.append(subject(f"{path}, row {number}", given))
    return found, f"{path}: not used: {', '.join(others)}" if others else ""


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


def contradictions(one: Subject, held: Mapping[str, float | str]) -> str:
    """Say which values of a subject are others than those that a figure holds."""
    words = []
    for name, value in one.values.items():
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

    Returns the places (n, 2) of those inside, in widths and heights of the frame, which no word is
    to cover.
    """
    ends = dict(zip(axes, (ax.get_xlim(), ax.get_ylim()), strict=True))
    places = [NOWHERE]
    for one in subjects:
        if is_outside(one, ends):
            note(ax, f"outside: {one.label or 'subject'}")
            continue
        point = float(one.values[axes[0]]), float(one.values[axes[1]])
        at = in_frame(ax, np.array([point]))
        places.append(at)
        ax.plot(*([each] for each in point), **MARK)
        if one.label:
            left = at[0, 0] > 0.5
            where: Any = {"textcoords": "offset points", "ha": "right" if left else "left"}
            where |= {"bbox": {"boxstyle": "square,pad=0.1", "facecolor": "white", "lw": 0.0}}
            words = one.label.replace("$", r"\$")
            offset = (-6, 4) if left else (6, 4)
            ax.annotate(words, point, offset, fontsize="small", zorder=6, **where)
            places.append(at + np.array([[-0.08 if left else 0.08, 0.03]]))
    return np.concatenate(places)
