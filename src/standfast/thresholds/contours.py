"""Limits of standing by springs, plane by plane: in closed form, and out of a stored atlas.

An atlas shows its limits by its verdicts (to half a step of the grid) or, finer, by a quantity that
changes sign there. The distance from the closed form is reported, so a stored atlas carries the
measure of its own resolution.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

import contourpy
import numpy as np

from standfast.atlas.reader import Atlas
from standfast.errors import InputError
from standfast.study.study import Study
from standfast.thresholds import planes
from standfast.thresholds.planes import ANKLE, HIP, PLANE_AXES, Plane

# Quantities that change sign exactly at the limit of standing, the best first. The determinant
# is not one: it is positive again where two modes fall.
SIGNED = ("stiffness_reserve", "eigenvalue_1", "frequency")

# Points of a plane that are contoured at once; it takes some 40 bytes each.
BAND_POINTS = 2**20


@dataclass(frozen=True, slots=True)
class Contour:
    """The limit of standing on one plane.

    ``ankle`` and ``hip`` are the curve in closed form; ``lines`` what an atlas shows, as arrays
    (n, 2) of ankle and hip; ``greatest`` and ``mean`` the distance of its points from the closed
    form, along the ankle's axis or the hip's, whichever is less; ``resolution`` the greatest step
    of the grid along that axis at those points.
    """

    plane: Plane
    ankle: np.ndarray
    hip: np.ndarray
    lines: list[np.ndarray] = field(default_factory=list)
    greatest: float = np.nan
    mean: float = np.nan
    resolution: float = np.nan

    @property
    def values(self) -> Mapping[str, Any]:
        """Values of the other axes by name."""
        return self.plane.values

    @property
    def index(self) -> Mapping[str, int]:
        """Places on the other axes by name."""
        return self.plane.index

    @property
    def curve(self) -> tuple[np.ndarray, np.ndarray]:
        """The limit in closed form, as horizontal and vertical coordinates."""
        return self.ankle, self.hip


def exact_contours(study: Study) -> Iterator[Contour]:
    """Go through the limits of standing of a study in closed form, plane by plane."""
    planes.require_closed_form(study)
    for plane in planes.planes_of(study):
        yield Contour(plane, *plane.limit_of_standing(study.axes[ANKLE], study.axes[HIP]))


def extracted_contours(atlas: Atlas) -> Iterator[Contour]:
    """Go through the limits of standing that an atlas shows, plane by plane.

    From a quantity that changes sign at the limit if the atlas holds one, else from the verdicts.
    One plane is in memory at a time.
    """
    planes.require_closed_form(atlas.study)
    source, level = source_of(atlas)
    ankles, hips = (atlas.study.axes[name] for name in PLANE_AXES)
    variable = atlas[source]
    swapped = variable.dims.index(HIP) < variable.dims.index(ANKLE)
    for index, values in variable.planes(along=PLANE_AXES):
        plane = planes.plane_at(atlas.study, index)
        # λ is smooth at the limit, its root, the frequency, is not
        squared = source == "frequency"
        lines = level_lines(ankles, hips, values.T if swapped else values, level, squared=squared)
        limit = plane.limit_of_standing(ankles, hips)
        yield Contour(plane, *limit, lines, *_distances(plane, ankles, hips, lines))


def source_of(atlas: Atlas) -> tuple[str, float]:
    """Return the quantity that shows the limit best, and its value there."""
    for name in SIGNED:
        if name in atlas.quantities:
            return name, 0.0
    if "stable" in atlas.quantities:
        return "stable", 0.5
    raise InputError(
        f"{atlas.path} holds no verdicts and no margin (one of stable, {', '.join(SIGNED)}), "
        "so it shows no limit of standing"
    )


def level_lines(
    x: np.ndarray, y: np.ndarray, values: np.ndarray, level: float, *, squared: bool = False
) -> list[np.ndarray]:
    """Return the level lines of values (x, y) as arrays (n, 2); closed ones end where they begin.

    ``squared``: of the values' squares with their signs. Infinite values of an axis, its last, are
    left out.
    """
    x, y = planes.finite(x), planes.finite(y)
    if min(x.size, y.size) < 2:
        return []
    pieces: list[np.ndarray] = []
    rows = max(BAND_POINTS // y.size, 1)
    for first in range(0, x.size - 1, rows):
        band = slice(first, min(first + rows + 1, x.size))  # bands share the row between them
        inside = values[band, : y.size].astype(float)
        if squared:
            inside *= np.abs(inside)
        # an infinite margin is as stable as any large one
        largest = np.finfo(float).max
        np.nan_to_num(inside, copy=False, posinf=largest, neginf=-largest)
        generator = contourpy.contour_generator(y, x[band], inside)
        found: Any = generator.lines(level)
        pieces += found
    return [line[:, ::-1] for line in _joined(pieces)]


def _joined(pieces: list[np.ndarray]) -> list[np.ndarray]:
    """Join the pieces of lines that end where another begins, to the last digit."""
    begins: dict[bytes, list[int]] = {}
    for number, piece in enumerate(pieces):
        begins.setdefault(piece[0].tobytes(), []).append(number)
    after = {
        number: there.pop(0)
        for number, piece in enumerate(pieces)
        if (there := begins.get(piece[-1].tobytes()))
    }
    lines: dict[int, np.ndarray] = {}
    left = set(range(len(pieces)))
    # what has no head goes in a circle
    for head in [*sorted(left - set(after.values())), *range(len(pieces))]:
        chain: list[np.ndarray] = []
        at = head
        while at in left:
            left.remove(at)
            chain.append(pieces[at][1:] if chain else pieces[at])
            at = after.get(at, -1)
        if chain:
            lines[head] = np.concatenate(chain)
    return [lines[head] for head in sorted(lines)]


def _distances(
    plane: Plane, ankles: np.ndarray, hips: np.ndarray, lines: list[np.ndarray]
) -> tuple[float, float, float]:
    """Return the greatest and the mean distance from the closed form, and the greatest step."""
    if not lines:
        return np.nan, np.nan, np.nan
    points = np.concatenate(lines)
    ankle, hip = points.T
    exact = np.column_stack([plane.critical_ankles(hip), plane.critical_hips(ankle)])
    away = np.abs(points - exact)
    steps = np.column_stack([_step_at(ankles, ankle), _step_at(hips, hip)])
    nearer = np.arange(len(points)), np.argmin(away, axis=1)
    return float(away[nearer].max()), float(away[nearer].mean()), float(steps[nearer].max())


def _step_at(values: np.ndarray, at: np.ndarray) -> np.ndarray:
    """Return the step of an axis around each of some values."""
    grid = planes.finite(values)
    below = np.searchsorted(grid, at) - 1
    steps: np.ndarray = np.diff(grid)[np.clip(below, 0, grid.size - 2)]
    return steps
