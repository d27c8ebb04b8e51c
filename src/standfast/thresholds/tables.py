"""Limits of standing as files: a table of points, and the same curves in HDF5."""

import csv
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from standfast.atlas.writer import new_file, reserve
from standfast.files import whole_file
from standfast.parameters import PARAMETERS
from standfast.study.study import Study
from standfast.thresholds.contours import Contour
from standfast.thresholds.planes import PLANE_AXES
from standfast.thresholds.regions import Region, plane_of


def write_tables(study: Study, found: Iterable[Contour | Region], stem: Path) -> list[Path]:
    """Write ``stem``.csv and ``stem``.h5, each whole or not at all, plane by plane.

    The CSV has a row a point: the other axes, the two of the plane (ankle and hip, or those of the
    regions), and whether the point is of the closed form or of the atlas. With feedback, where a
    plane may have several limits, ``line`` counts them; one around a region ends where it begins.
    The HDF5 file has the group ``thresholds`` and in it a group a plane: ``closed_form`` (n, 2),
    ``contour`` (m, 2) with ``contour_starts``, and the plane's other parameters as attributes.
    """
    axes = plane_of(study) if study.has_gains else PLANE_AXES
    others = [name for name in study.axes_of("stable") if name not in axes]
    table, store = (stem.with_name(f"{stem.name}.{suffix}") for suffix in ("csv", "h5"))
    with (
        whole_file(table) as table_partial,
        whole_file(store) as store_partial,
        table_partial.open("w", encoding="utf-8", newline="") as text,
        new_file(store_partial) as file,
    ):
        writer = csv.writer(text, lineterminator="\n")
        units = {name: f" [{row.unit}]" for name, row in PARAMETERS.items() if not row.choices}
        columns = (f"{name}{units.get(name, '')}" for name in (*others, *axes))
        writer.writerow([*columns, *(["line"] if study.has_gains else []), "source"])
        file.attrs["title"] = f"Limits of standing: {study.title}"
        file.attrs["study"] = study.canonical
        file.attrs["study_sha256"] = study.fingerprint
        root = file.create_group("thresholds")
        for number, each in enumerate(found):
            writer.writerows(_rows(others, each))
            _write_limits(root.create_group(f"{number:06d}"), study, axes, each)
    return [table, store]


def _rows(others: list[str], found: Contour | Region) -> Iterator[list[Any]]:
    """Go through the points of a plane's curves as rows of the table."""
    head = [found.values[name] for name in others]
    if isinstance(found, Contour):
        curve = np.column_stack(found.curve)
        for source, points in (("closed form", curve), *(("atlas", at) for at in found.lines)):
            for x, y in points:
                yield [*head, f"{x:.6f}", f"{y:.6f}", source]
    else:
        for number, points in enumerate(found.lines, start=1):
            for x, y in points:
                yield [*head, f"{x:.9g}", f"{y:.9g}", number, "atlas"]


def _write_limits(
    group: h5py.Group, study: Study, axes: tuple[str, str], found: Contour | Region
) -> None:
    for name, value in {**study.fixed, **found.values}.items():
        group.attrs[name] = str(value) if name == "body_model" else float(value)
    curves = {}
    if isinstance(found, Contour):
        curves["closed_form"] = np.column_stack(found.curve)
    if found.lines:
        curves["contour"] = np.concatenate(found.lines)
    reserve(group.file, sum(points.nbytes for points in curves.values()))
    for name, points in curves.items():
        curve = group.create_dataset(name, data=points)
        curve.attrs["columns"] = ", ".join(axes)
        curve.attrs["units"] = ", ".join(dict.fromkeys(PARAMETERS[axis].unit for axis in axes))
    if found.lines:
        lengths = [len(line) for line in found.lines]
        group.create_dataset("contour_starts", data=np.cumsum([0, *lengths[:-1]]))
    if found.lines and isinstance(found, Contour):
        group.attrs["greatest_distance"] = found.greatest
        group.attrs["mean_distance"] = found.mean
