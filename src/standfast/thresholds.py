"""Thresholds of standing: critical surfaces in closed form, contours out of a stored atlas.

On a plane of ankle × hip stiffness the limit of standing is one falling curve. Closed form gives it
exactly for any study; an atlas gives it again from its verdicts (to half a step of the grid) or,
finer, from a quantity that changes sign there. Both are computed and their distance is reported, so
a stored atlas carries the measure of its own resolution.
"""

import contextlib
import csv
import itertools
import os
from collections.abc import Iterable, Iterator, Mapping
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
from standfast.store.layout import LIBRARIES
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
    (n, 2) of ankle and hip; ``greatest`` and ``mean`` the distance of its points from the closed
    form, along the ankle's axis or the hip's, whichever is less; ``resolution`` the greatest step
    of the grid along that axis at those points.
    """

    place: Place
    ankle: np.ndarray
    hip: np.ndarray
    lines: list[np.ndarray] = field(default_factory=list)
    greatest: float = np.nan
    mean: float = np.nan
    resolution: float = np.nan


def places(study: Study, only: Mapping[str, set[int]] | None = None) -> Iterator[Place]:
    """Go through the planes of ankle × hip of a study, in its order.

    ``only`` keeps those whose index along an axis is in a set.
    """
    others = [name for name in study.axes if name not in PLANE]
    kept = only or {}
    ranges = (
        [i for i in range(len(study.axes[name])) if i in kept.get(name, {i})] for name in others
    )
    for index in itertools.product(*ranges):
        yield place_at(study, dict(zip(others, index, strict=True)))


def place_at(study: Study, index: Mapping[str, int]) -> Place:
    """Return the plane of ankle × hip at an index of the other axes."""
    values = {name: study.axes[name][i] for name, i in index.items()}
    given = {**study.fixed, **values}
    reference = REFERENCE_PEOPLE[str(given["body_model"])]
    height = float(given["height"])
    mass = float(given["mass"]) if "mass" in given else float(given["bmi"]) * height**2
    return Place(
        rescaled(reference.body, height / reference.height, mass / reference.mass),
        float(given["gravity"]),
        float(given.get(KNEE, np.nan)),
        values,
        index,
    )


def has_plane(study: Study) -> bool:
    """Return whether ankle and hip are axes of a study, each with two finite values or more."""
    return all(name in study.axes and _finite(study.axes[name]).size > 1 for name in PLANE)


def hips_needed(place: Place, ankles: np.ndarray) -> np.ndarray:
    """Return the hip stiffness at which the person just stands, for each ankle stiffness."""
    return np.array(
        [float(critical_hip_stiffness(place.body, k, place.knee, place.gravity)) for k in ankles]
    )


def closed_form(study: Study, place: Place) -> tuple[np.ndarray, np.ndarray]:
    """Return the exact limit of standing within the plane: ankle and hip stiffness (N·m/rad).

    The curve is taken at every value of both axes, so that both of its steep ends are followed.
    """
    ankles, hips = (_finite(study.axes[name]) for name in PLANE)
    at_hips = [
        float(critical_ankle_stiffness(place.body, place.knee, k, place.gravity)) for k in hips
    ]
    at_ankles = hips_needed(place, ankles)
    ankle = np.concatenate([at_hips, ankles])
    hip = np.concatenate([hips, at_ankles])
    inside = (ankle >= ankles[0]) & (ankle <= ankles[-1]) & (hip >= hips[0]) & (hip <= hips[-1])
    order = np.lexsort((-hip[inside], ankle[inside]))
    return ankle[inside][order], hip[inside][order]


def contours(study: Study, only: Mapping[str, set[int]] | None = None) -> Iterator[Contour]:
    """Go through the limits of standing of a study in closed form, plane by plane.

    ``only`` as in :func:`places`.

    Raises
    ------
    InputError
        if ankle or hip is not an axis with two finite values or more.
    """
    _require_plane(study)
    for place in places(study, only):
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
    for index, plane in variable.slabs(along=PLANE):
        place = place_at(study, index)
        if source == "frequency":
            plane = plane * np.abs(plane)  # noqa: PLW2901 - λ is smooth at the limit, its root is not
        over_ankle_and_hip = plane.T if swapped else plane
        lines = _lines(ankles, hips, over_ankle_and_hip, level)
        errors, steps = _distances(place, ankles, hips, lines)
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


def write_tables(study: Study, found: Iterable[Contour], stem: Path) -> list[Path]:
    """Write ``stem``.csv and ``stem``.h5, each whole or not at all, plane by plane.

    The CSV has a row a point: the other axes, ankle, hip, and whether the point is of the closed
    form or of the atlas. The HDF5 file has the group ``thresholds`` and in it a group a plane:
    ``closed_form`` (n, 2), ``contour`` (m, 2) with ``contour_starts``, and the plane's other
    parameters as attributes.

    Raises
    ------
    OSError
        if the disk does not take them.
    """
    others = [name for name in study.axes if name not in PLANE]
    table = stem.with_name(f"{stem.name}.csv")
    store = stem.with_name(f"{stem.name}.h5")
    with (
        _whole(table) as table_partial,
        _whole(store) as store_partial,
        table_partial.open("w", encoding="utf-8", newline="") as text,
        h5py.File(store_partial, "w", libver=LIBRARIES) as file,
    ):
        writer = csv.writer(text, lineterminator="\n")
        writer.writerow([*(_column(name) for name in (*others, *COLUMNS)), "source"])
        file.attrs["title"] = f"Limits of standing: {study.title}"
        file.attrs["study"] = study.canonical
        file.attrs["study_sha256"] = study.fingerprint
        root = file.create_group("thresholds")
        for number, contour in enumerate(found):
            writer.writerows(_rows(others, contour))
            _write_contour(root.create_group(f"{number:06d}"), study, contour)
    return [table, store]


def _rows(others: list[str], contour: Contour) -> Iterator[list[Any]]:
    """Go through the points of a plane's curves as rows of the table."""
    head = [contour.place.values[name] for name in others]
    curve = np.column_stack([contour.ankle, contour.hip])
    for source, points in (("closed form", curve), *(("atlas", at) for at in contour.lines)):
        for ankle, hip in points:
            yield [*head, f"{ankle:.6f}", f"{hip:.6f}", source]


def _write_contour(group: h5py.Group, study: Study, contour: Contour) -> None:
    for name, value in {**study.fixed, **contour.place.values}.items():
        group.attrs[name] = str(value) if name == "body_model" else float(value)
    curves = {"closed_form": np.column_stack([contour.ankle, contour.hip])}
    if contour.lines:
        curves["contour"] = np.concatenate(contour.lines)
    for name, points in curves.items():
        curve = group.create_dataset(name, data=points)
        curve.attrs["columns"] = ", ".join(COLUMNS)
        curve.attrs["units"] = PARAMETERS[ANKLE].unit
    if contour.lines:
        lengths = [len(line) for line in contour.lines]
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
    place: Place, ankles: np.ndarray, hips: np.ndarray, lines: list[np.ndarray]
) -> tuple[np.ndarray, np.ndarray]:
    """Return how far the points of lines lie from the closed form, and the grid's steps there.

    Measured along the ankle's axis or the hip's, whichever is nearer.
    """
    if not lines:
        return np.empty(0), np.empty(0)
    points = np.concatenate(lines)
    needed = [
        float(critical_ankle_stiffness(place.body, place.knee, hip, place.gravity))
        for hip in points[:, 1]
    ]
    away = np.abs(points - np.column_stack([needed, hips_needed(place, points[:, 0])]))
    nearer = np.argmin(away, axis=1)
    steps = np.column_stack(
        [_step_at(values, at) for values, at in zip((ankles, hips), points.T, strict=True)]
    )
    rows = np.arange(len(points))
    return away[rows, nearer], steps[rows, nearer]


def _step_at(values: np.ndarray, at: np.ndarray) -> np.ndarray:
    """Return the step of an axis around each of some values."""
    finite = _finite(values)
    places = np.searchsorted(finite, at) - 1
    steps: np.ndarray = np.diff(finite)[np.clip(places, 0, finite.size - 2)]
    return steps


def _require_plane(study: Study) -> None:
    for name in PLANE:
        if name not in study.axes:
            raise InputError(
                f"thresholds are curves over ankle and hip stiffness, and {name} is no axis of "
                "this study; give it a list or a range"
            )
        if _finite(study.axes[name]).size < 2:
            raise InputError(
                f"thresholds are curves over ankle and hip stiffness, and {name} has fewer than "
                "two finite values in this study"
            )


def _finite(values: np.ndarray) -> np.ndarray:
    finite: np.ndarray = values[np.isfinite(values)]
    return finite


def _column(name: str) -> str:
    return name if name == "body_model" else f"{name} [{PARAMETERS[name].unit}]"
