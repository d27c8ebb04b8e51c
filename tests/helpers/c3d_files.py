"""C3D files of a made-up person on force plates, written by ezc3d, which the reader does not use.

What each plate measures follows from where it lies: the person's force at a point of the floor has,
about the plate's transducers, the moment (p − O) × F, and its axes are those of the plate.
"""

from typing import NamedTuple

import numpy as np
import pytest

from recordings import sway

PER_FRAME = 10  # analog samples a frame of the cameras


class Plate(NamedTuple):
    """A plate in the laboratory: type, middle of the surface (m), turn about the vertical, sides.

    Its z points down, and its transducers lie ``depth`` below the middle of its surface, and
    ``aside`` of it along its x and y.
    """

    type: int = 2
    middle: tuple[float, float, float] = (0.0, 0.0, 0.0)
    turned: float = 0.0  # rad
    sides: tuple[float, float] = (0.4, 0.6)
    depth: float = 0.04
    aside: tuple[float, float] = (0.0, 0.0)
    y_up: bool = False

    @property
    def axes(self):
        """Columns: the plate's axes in the laboratory."""
        c, s = np.cos(self.turned), np.sin(self.turned)
        level = np.array([[s, c, 0.0], [c, -s, 0.0], [0.0, 0.0, -1.0]])
        return UP_Y @ level if self.y_up else level

    @property
    def corners(self):
        """(4, 3), m: +x +y, −x +y, −x −y, +x −y of the plate."""
        half = 0.5 * np.array(self.sides)
        signs = np.array([[1, 1], [-1, 1], [-1, -1], [1, -1]])
        own = np.column_stack([signs * half, np.zeros(4)])
        return np.array(self.middle) + own @ self.axes.T

    @property
    def origin(self):
        """From the transducers to the middle, the plate's axes (m)."""
        return np.array([*self.aside, -self.depth])


# z of the laboratory to y, y to −z: a turn, so that hands stay as they are
UP_Y = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]])
SENSORS = (0.15, 0.25)  # m, of Kistler's: half of their distances
random = np.random.default_rng(11)
MATRIX = np.diag([1.4, 1.5, 5.6, 0.6, 0.4, 0.3]) + 0.01 * random.normal(size=(6, 6))


def person(rate=1000.0, seconds=12.0, load=700.0):
    """Times, the force (3, n) N of a person on the floor, and where it acts (3, n) m, z up."""
    time, x, y = sway(rate=rate, seconds=seconds)
    force = np.stack([5.0 * np.sin(time), 4.0 * np.cos(1.7 * time), -load + 3.0 * np.sin(9 * time)])
    return time, force, np.stack([x, y, 0.0 * x])


def wrench(plate, force, point):
    """Force (3, n) and moment (3, n) about a plate's transducers, in its axes."""
    arm = point - (np.array(plate.middle) - plate.axes @ plate.origin)[:, None]
    return plate.axes.T @ force, plate.axes.T @ np.cross(arm, force, axis=0)


def channels(plate, force, point, length):
    """What a plate's channels hold, with moments in N times ``length`` (m)."""
    own, moment = wrench(plate, force, point)
    if plate.type == 1:
        at = plate.axes.T @ (point - np.array(plate.middle)[:, None])
        return [*own, at[0] / length, at[1] / length, 0.0 * at[0]]
    if plate.type == 3:
        (a, b), (fx, fy, fz), (mx, my, _) = SENSORS, own, moment
        quarters = [
            fz / 4 + sy * mx / (4 * b) - sx * my / (4 * a)
            for sx, sy in ((1, 1), (-1, 1), (-1, -1), (1, -1))
        ]
        return [0.3 * fx, 0.7 * fx, 0.4 * fy, 0.6 * fy, *quarters]
    six = np.concatenate([own, moment / length])
    return list(np.linalg.solve(MATRIX, six) if plate.type == 4 else six)


def write_c3d(path, plates, parts, *, unit="mm", units=None, rate=1000.0, sign=1.0, **changed):
    """Write what plates measure of the parts (force, point) of a person; ``changed`` parameters."""
    ezc3d = pytest.importorskip("ezc3d")
    length = {"mm": 1e-3, "m": 1.0}[unit]
    signal = [
        sign * each if plate.type != 1 or k < 3 else each
        for plate, part in zip(plates, parts, strict=True)
        for k, each in enumerate(channels(plate, *part, length))
    ]
    count = signal[0].size // PER_FRAME
    file = ezc3d.c3d()
    named = file["parameters"]
    named["POINT"]["RATE"]["value"] = [rate / PER_FRAME]
    named["POINT"]["UNITS"]["value"] = [unit]
    named["POINT"]["LABELS"]["value"] = ("HEAD",)
    file["data"]["points"] = np.ones((4, 1, count))
    named["ANALOG"]["RATE"]["value"] = [rate]
    named["ANALOG"]["LABELS"]["value"] = tuple(f"C{k}" for k in range(len(signal)))
    widths = [8 if plate.type == 3 else 6 for plate in plates]
    known = {1: ["N"] * 3 + [unit] * 2 + [f"N{unit}"], 2: ["N"] * 3 + [f"N{unit}"] * 3}
    own = [known.get(plate.type, ["V"] * 8)[: widths[k]] for k, plate in enumerate(plates)]
    named["ANALOG"]["UNITS"]["value"] = tuple(units or [each for some in own for each in some])
    file["data"]["analogs"] = np.array(signal)[None, :, : count * PER_FRAME]
    starts = np.cumsum([1, *widths])
    numbers = np.zeros((max(widths), len(plates)), dtype=int)
    for k, width in enumerate(widths):
        numbers[:width, k] = starts[k] + np.arange(width)
    origins = [[*SENSORS, -plate.depth] if plate.type == 3 else plate.origin for plate in plates]
    parameters = {
        "USED": np.array([len(plates)]),
        "TYPE": np.array([plate.type for plate in plates]),
        "ZERO": np.array([1, 10]),
        "CORNERS": np.stack([plate.corners.T / length for plate in plates], axis=-1),
        "ORIGIN": np.array(origins).T / length,
        "CHANNEL": numbers,
        "CAL_MATRIX": np.stack([MATRIX] * len(plates), axis=-1),
    }
    for name, value in {**parameters, **changed}.items():
        if value is not None:
            parameter = ezc3d.ezc3d.Parameter(name, "")
            flat = value.ravel(order="F").tolist()
            whole = value.dtype.kind == "i"
            parameter.set(ezc3d.ezc3d.VecInt(flat) if whole else flat, value.shape)
            named.add_parameter("FORCE_PLATFORM", parameter)
    file.write(str(path))
    return path
