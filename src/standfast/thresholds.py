"""Thresholds of standing: critical surfaces in closed form, contours out of a stored atlas.

On a plane of ankle × hip stiffness the limit of standing is one falling curve. Closed form gives it
exactly for any study; an atlas gives it again from its verdicts (to half a step of the grid) or,
finer, from a quantity that changes sign there. Both are computed and their distance is reported, so
a stored atlas carries the measure of its own resolution.
"""

import contextlib
import csv
import io
import itertools
import os
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import contourpy
import h5py
import numpy as np

from standfast.body import REFERENCE_PEOPLE, Body, rescaled
from standfast.quantities import PARAMETERS, InputError
from standfast.stability import critical_ankle_stiffness, critical_hip_stiffness
from standfast.store import Atlas
from standfast.store.layout import LIBRARY_VERSION
from standfast.study import Study

ANKLE, KNEE, HIP = "ankle_stiffness", "knee_stiffness", "hip_stiffness"
PLANE = (ANKLE, HIP)

# Quantities that change sign exactly at the limit of standing, the best first. The determinant
# is not one: it is positive again where two modes fall.
SIGNED = ("stiffness_reserve", "eigenvalue_1", "frequency")


@dataclass(frozen=True, slots=True)
class Place:
    """One plane of ankle × hip: the values of all other parameters."""

    body: Body
    gravity: float
    knee: float
    values: Mapping[str, Any]  # of the other axes, by name
    index: Mapping[str, int]


@dataclass(frozen=True, slots=True)
class Contour:
    """The limit of standing on one plane.

    ``ankle`` and ``hip`` are the curve in closed form; ``lines`` what an atlas shows, as arrays
    (n, 2) of ankle and hip; ``distance`` the greatest and mean distance of its points from the
    closed form along the ankle's axis, and ``resolution`` the step of the grid there.
    """

    place: Place
    ankle: np.ndarray
    hip: np.ndarray
    lines: list[np.ndarray] = field(default_factory=list)
    greatest: float = np.nan
    mean: float = np.nan
    resolution: float = np.nan


def places(study: Study) -> Iterator[Place]:
    """Go through all planes of ankle × hip of a study, in its order."""
    others = [name for name in study.axes if name not in PLANE]
    for index in itertools.product(*(range(len(study.axes[name])) for name in others)):
        values = {name: study.axes[name][i] for name, i in zip(others, index, strict=True)}
        given = {**study.fixed, **values}
        reference = REFERENCE_PEOPLE[str(given["body_model"])]
        height = float(given["height"])
        mass = float(given["mass"]) if "mass" in given else float(given["bmi"]) * height**2
        yield Place(
            rescaled(reference.body, height / reference.height, mass / reference.mass),
            float(given["gravity"]),
            float(given.get(KNEE, np.nan)),
            values,
            dict(zip(others, index, strict=True)),
        )


def has_plane(study: Study) -> bool:
    """Return whether ankle and hip are both axes of a study."""
    return all(name in study.axes for name in PLANE)


def closed_form(study: Study, place: Place) -> tuple[np.ndarray, np.ndarray]:
    """Return the exact limit of standing within the plane: ankle and hip stiffness (N·m/rad).

    The curve is taken at every value of both axes, so that both of its steep ends are followed.
    """
    ankles, hips = (_finite(study.axes[name]) for name in PLANE)
    at_hips = [
        float(critical_ankle_stiffness(place.body, place.knee, k, place.gravity)) for k in hips
    ]
    at_ankles = [
        float(critical_hip_stiffness(place.body, k, place.knee, place.gravity)) for k in ankles
    ]
    ankle = np.concatenate([at_hips, ankles])
    hip = np.concatenate([hips, at_ankles])
    inside = (ankle >= ankles[0]) & (ankle <= ankles[-1]) & (hip >= hips[0]) & (hip <= hips[-1])
    order = np.lexsort((-hip[inside], ankle[inside]))
    return ankle[inside][order], hip[inside][order]


def contours(study: Study) -> Iterator[Contour]:
    """Go through the limits of standing of a study in closed form, plane by plane.

    Raises
    ------
    InputError
        if ankle or hip is not an axis.
    """
    _require_plane(study)
    for place in places(study):
        yield Contour(place, *closed_form(study, place))


def extracted(atlas: Atlas) -> Iterator[Contour]:
    """Go through the limits of standing that an atlas shows, plane by plane.

    From a quantity that changes sign at the limit if the atlas holds one, else from the verdicts.
    One plane is in memory at a time.

    Raises
    ------
    InputError
        if ankle or hip is not an axis, or the atlas holds nothing that shows the limit.
    """
    study = atlas.study
    _require_plane(study)
    source, level = source_of(atlas)
    ankles, hips = (study.axes[name] for name in PLANE)
    variable = atlas[source]
    swapped = variable.dims.index(HIP) < variable.dims.index(ANKLE)
    by_index = {tuple(place.index.values()): place for place in places(study)}
    for index, plane in variable.slabs(along=PLANE):
        place = by_index[tuple(index.values())]
        if source == "frequency":
            plane = plane * np.abs(plane)  # noqa: PLW2901 - λ is smooth at the limit, its root is not
        over_ankle_and_hip = plane.T if swapped else plane
        lines = _lines(ankles, hips, over_ankle_and_hip, level)
        errors, steps = _distances(place, ankles, lines)
        yield Contour(
            place,
            *closed_form(study, place),
            lines,
            float(errors.max()) if errors.size else np.nan,
            float(errors.mean()) if errors.size else np.nan,
            float(steps.max()) if steps.size else np.nan,
        )


def source_of(atlas: Atlas) -> tuple[str, float]:
    """Return the quantity that shows the limit best, and its value there.

    Raises
    ------
    InputError
        if the atlas holds none.
    """
    for name in SIGNED:
        if name in atlas.quantities:
            return name, 0.0
    if "stable" in atlas.quantities:
        return "stable", 0.5
    raise InputError(
        f"{atlas.path} holds no verdicts and no margin (one of stable, {', '.join(SIGNED)}), "
        "so it shows no limit of standing"
    )


COLUMNS = ("ankle_stiffness", "hip_stiffness")


def as_csv(study: Study, found: list[Contour]) -> str:
    """Return the closed-form curves as CSV: the other axes, then ankle and hip, point by point."""
    others = [name for name in study.axes if name not in PLANE]
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow([_column(name) for name in (*others, *COLUMNS)])
    for contour in found:
        head = [contour.place.values[name] for name in others]
        for ankle, hip in zip(contour.ankle, contour.hip, strict=True):
            writer.writerow([*head, f"{ankle:.6f}", f"{hip:.6f}"])
    return text.getvalue()


def write_tables(study: Study, found: list[Contour], stem: Path) -> list[Path]:
    """Write ``stem``.csv and ``stem``.h5, each whole or not at all.

    The HDF5 file has the group ``thresholds`` and in it a group a plane: ``closed_form`` (n, 2),
    ``contour`` (m, 2) with ``contour_starts``, and the plane's other parameters as attributes.

    Raises
    ------
    OSError
        if the disk does not take them.
    """
    table, store = stem.with_suffix(".csv"), stem.with_suffix(".h5")
    with _whole(table) as partial:
        partial.write_text(as_csv(study, found), encoding="utf-8")
    with (
        _whole(store) as partial,
        h5py.File(partial, "w", libver=(LIBRARY_VERSION, "latest")) as file,
    ):
        file.attrs["title"] = f"Limits of standing: {study.title}"
        file.attrs["study"] = study.canonical
        file.attrs["study_sha256"] = study.fingerprint
        root = file.create_group("thresholds")
        for number, contour in enumerate(found):
            _write_contour(root.create_group(f"{number:06d}"), contour)
    return [table, store]


def _write_contour(group: h5py.Group, contour: Contour) -> None:
    for name, value in {**contour.place.values, "gravity": contour.place.gravity}.items():
        group.attrs[name] = str(value) if name == "body_model" else float(value)
    curve = group.create_dataset("closed_form", data=np.column_stack([contour.ankle, contour.hip]))
    curve.attrs["columns"] = ", ".join(COLUMNS)
    curve.attrs["units"] = PARAMETERS[ANKLE].unit
    if contour.lines:
        lengths = [len(line) for line in contour.lines]
        group.create_dataset("contour", data=np.concatenate(contour.lines))
        group.create_dataset("contour_starts", data=np.cumsum([0, *lengths[:-1]]))
        group.attrs["greatest_distance"] = contour.greatest
        group.attrs["mean_distance"] = contour.mean


@contextlib.contextmanager
def _whole(path: Path) -> Iterator[Path]:
    """Give a temporary name beside ``path`` and rename it when all is written."""
    partial = path.with_name(f".{path.name}.{os.getpid()}.partial")
    try:
        yield partial
        partial.replace(path)
    finally:
        partial.unlink(missing_ok=True)


def _lines(
    ankles: np.ndarray, hips: np.ndarray, plane: np.ndarray, level: float
) -> list[np.ndarray]:
    """Return the level lines of a plane (ankle, hip) as arrays of ankle and hip."""
    rows, columns = np.isfinite(ankles), np.isfinite(hips)
    inside = plane[np.ix_(rows, columns)].astype(float)
    if min(inside.shape) < 2:
        return []
    # an infinite margin is as stable as any large one
    inside = np.nan_to_num(inside, posinf=np.finfo(float).max, neginf=-np.finfo(float).max)
    generator = contourpy.contour_generator(hips[columns], ankles[rows], inside)
    found: Any = generator.lines(level)
    return [line[:, ::-1] for line in found]


def _distances(
    place: Place, ankles: np.ndarray, lines: list[np.ndarray]
) -> tuple[np.ndarray, np.ndarray]:
    """Return how far the points of lines lie from the closed form, and the grid's steps there.

    Measured along the ankle's axis where the curve is flat in it, along the hip's where it is
    steep: whichever is nearer, as for a curve drawn on paper.
    """
    points = np.concatenate(lines) if lines else np.empty((0, 2))
    errors = []
    for ankle, hip in points:
        along_ankle = abs(
            ankle - float(critical_ankle_stiffness(place.body, place.knee, hip, place.gravity))
        )
        along_hip = abs(
            hip - float(critical_hip_stiffness(place.body, ankle, place.knee, place.gravity))
        )
        errors.append(min(along_ankle, along_hip))
    finite = _finite(ankles)
    steps = np.diff(finite)
    at = np.clip(np.searchsorted(finite, points[:, 0]) - 1, 0, max(steps.size - 1, 0))
    return np.array(errors), steps[at] if steps.size else np.empty(0)


def _require_plane(study: Study) -> None:
    for name in PLANE:
        if name not in study.axes:
            raise InputError(
                f"thresholds are curves over ankle and hip stiffness, and {name} is no axis of "
                f"this study; give it a list or a range"
            )


def _finite(values: np.ndarray) -> np.ndarray:
    finite: np.ndarray = values[np.isfinite(values)]
    return finite


def _column(name: str) -> str:
    return name if name == "body_model" else f"{name} [{PARAMETERS[name].unit}]"
