"""Limits of standing as files: a table of points, and the same curves in HDF5."""

import csv
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from standfast.atlas.writer import new_file, reserve
from standfast.files import whole_file
from standfast.parameters import PARAMETERS, STIFFNESS_UNIT
from standfast.study.study import Study
from standfast.thresholds.contours import Contour
from standfast.thresholds.planes import PLANE_AXES


def write_tables(study: Study, found: Iterable[Contour], stem: Path) -> list[Path]:
    """Write ``stem``.csv and ``stem``.h5, each whole or not at all, plane by plane.

    The CSV has a row a point: the other axes, ankle, hip, and whether the point is of the closed
    form or of the atlas. The HDF5 file has the group ``thresholds`` and in it a group a plane:
    ``closed_form`` (n, 2), ``contour`` (m, 2) with ``contour_starts``, and the plane's other
    parameters as attributes.
    """
    others = [name for name in study.axes if name not in PLANE_AXES]
    table, store = (stem.with_name(f"{stem.name}.{suffix}") for suffix in ("csv", "h5"))
    with (
        whole_file(table) as table_partial,
        whole_file(store) as store_partial,
        table_partial.open("w", encoding="utf-8", newline="") as text,
        new_file(store_partial) as file,
    ):
        writer = csv.writer(text, lineterminator="\n")
        units = {name: f" [{row.unit}]" for name, row in PARAMETERS.items() if not row.choices}
        columns = (f"{name}{units.get(name, '')}" for name in (*others, *PLANE_AXES))
        writer.writerow([*columns, "source"])
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
    head = [contour.plane.values[name] for name in others]
    curve = np.column_stack([contour.ankle, contour.hip])
    for source, points in (("closed form", curve), *(("atlas", at) for at in contour.lines)):
        for ankle, hip in points:
            yield [*head, f"{ankle:.6f}", f"{hip:.6f}", source]


def _write_contour(group: h5py.Group, study: Study, contour: Contour) -> None:
    for name, value in {**study.fixed, **contour.plane.values}.items():
        group.attrs[name] = str(value) if name == "body_model" else float(value)
    curves = {"closed_form": np.column_stack([contour.ankle, contour.hip])}
    if contour.lines:
        curves["contour"] = np.concatenate(contour.lines)
    reserve(group.file, sum(points.nbytes for points in curves.values()))
    for name, points in curves.items():
        curve = group.create_dataset(name, data=points)
        curve.attrs["columns"] = ", ".join(PLANE_AXES)
        curve.attrs["units"] = STIFFNESS_UNIT
    if contour.lines:
        lengths = [len(line) for line in contour.lines]
        group.create_dataset("contour_starts", data=np.cumsum([0, *lengths[:-1]]))
        group.attrs["greatest_distance"] = contour.greatest
        group.attrs["mean_distance"] = contour.mean
