"""The centre of pressure out of a C3D file: analog channels by the FORCE_PLATFORM parameters.

What the parameters mean is that of the format's guide (c3d.org). Corners 1 to 4 of a plate stand in
the quadrants (+, +), (−, +), (−, −), (+, −) of its own axes x and y, and so give these axes and the
middle of its surface in the laboratory. ORIGIN o leads from the plate's transducers to that middle,
along the plate's axes, z down. Moments M about the middle are those about the transducers less
o × F; the centre of pressure is (−My, Mx)/Fz from the middle, whichever way all forces point.

FORCE_PLATFORM:ZERO, frames in which a plate is empty so that its offset can be taken away, is not
used: who stands there all the time leaves no such frames.

notation: c corners, o origin, F force, M moment, ex, ey, ez axes of a plate in the laboratory.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from standfast.errors import InputError
from standfast.numerics.arrays import Array
from standfast.recordings.c3d_file import C3dFile, opened_c3d
from standfast.recordings.centre import Wanted
from standfast.recordings.columns import UNITS, compact, unit_of
from standfast.recordings.plates import CARRIES, Plate, median_of, names_read, person_on

# What the channels of each type of plate hold; of type 4 what comes out of its matrix.
SIX = ("force",) * 3 + ("moment",) * 3
HELD = {
    1: ("force", "force", "force", "length", "length", "moment"),
    2: SIX,
    3: ("force",) * 8,
    4: SIX,
}
LEVEL = 0.99  # cosine of the slope from which on a plate is no floor
BESIDE = 1.2  # of half the plate's diagonal: further from its middle, nothing can press on it
AXES = ("x", "y", "z")


class _Shape(NamedTuple):
    """A plate in the laboratory (m): its number, type, middle, half diagonal, axes, origin."""

    name: str
    type: int
    middle: Array
    reach: float
    axes: Array  # (3, 3), a column each
    origin: Array


def centre_in_c3d(raw: bytes, wanted: Wanted) -> tuple[tuple[Array, Array], float, list[str]]:
    """Return both directions (m), the rate (Hz), and what is to be said.

    Raises
    ------
    InputError
        if the package is missing, or the file has no plate on which somebody stands all the time.
    """
    _check_options(wanted)
    file = opened_c3d(raw)
    both, said = _person(file, wanted)
    return both, file.rate, [*file.remarks, *said]


def _check_options(wanted: Wanted) -> None:
    """Refuse options that say what a C3D file says itself."""
    if wanted.surface:
        raise InputError(f"surface={wanted.surface:g}: a C3D file says it itself (ORIGIN)")
    if wanted.choice.places is not None:
        raise InputError(
            'a C3D file says where its plates lie; name one to read alone, as plate="1"'
        )
    for name, given in (("ap", wanted.ap), ("ml", wanted.ml)):
        if given is not None and given.strip().lower() not in AXES:
            raise InputError(
                f"{name}={given}: of a C3D file give an axis of the laboratory, as {name}=x"
            )


def _person(of: C3dFile, wanted: Wanted) -> tuple[tuple[Array, Array], list[str]]:
    """Return both directions of the person on the plates, and what is to be said of them."""
    length = _length(of, wanted.unit)
    shapes = {shape.name: shape for shape in _shapes(of, length)}
    read = [shapes[name] for name in names_read(shapes, wanted.choice)]
    up = {int(np.argmax(np.abs(shape.axes[:, 2]))) for shape in read}
    if len(up) != 1 or any(np.abs(shape.axes[:, 2]).max() < LEVEL for shape in read):
        raise InputError("its force plates are not level, so what they carry is not the weight")
    floor = [axis for axis in range(3) if axis not in up]
    width = of.width("FORCE_PLATFORM:CHANNEL")
    channels = of.numbers("FORCE_PLATFORM:CHANNEL", width).astype(int) - 1
    plates = []
    for shape in read:
        own = _channels(channels, shape, len(of.analog))
        load, x, y = _about_middle(of, shape, own, length)
        place = shape.middle[:, None] * load + shape.axes[:, :1] * x + shape.axes[:, 1:2] * y
        plates.append(Plate(shape.name, load, *place[floor]))
    first, second, said = person_on(
        plates, wanted.choice, lambda at: f"at {at / of.rate:.4g} s", one_frame=True
    )
    _check_beside(plates, read, floor)
    letters = [AXES[axis] for axis in floor]
    ahead, more = _ahead(letters, wanted)
    return ((first, second) if ahead == letters[0] else (second, first)), [*more, *said]


def _ahead(letters: Sequence[str], wanted: Wanted) -> tuple[str, list[str]]:
    """Return which axis is anterior-posterior, and what is to be said of the choice."""
    ap, ml = (None if each is None else each.strip().lower() for each in wanted[:2])
    for name, given in (("ap", ap), ("ml", ml)):
        if given is not None and given not in letters:
            raise InputError(f"{name}={given}: {given} points up; give {' or '.join(letters)}")
    if ap is not None and ap == ml:
        raise InputError(f"ap={ap} and ml={ml} are the same; give one")
    if ap is None and ml is None:
        return letters[0], [
            f"{letters[0]} of the laboratory is taken as anterior-posterior and {letters[1]} as "
            f"mediolateral; if the person looks along the other write ap={letters[1]}"
        ]
    return ap or next(letter for letter in letters if letter != ml), []


def _length(of: C3dFile, unit: str | None) -> float:
    """Return how many m one unit of the file's lengths is."""
    told = next(iter(of.words("POINT:UNITS")), "")
    known = UNITS["length"].get(compact(told))
    if known is not None:
        if unit is not None and unit_of("unit", unit, "length") != known:
            raise InputError(f"unit={unit} is not what the file says (POINT:UNITS is {told})")
        return known
    if unit is None:
        raise InputError(f"its unit of lengths (POINT:UNITS) is {told!r}; say it as unit=mm")
    return unit_of("unit", unit, "length")


def _shapes(of: C3dFile, length: float) -> list[_Shape]:
    """Return the plates that a file describes."""
    count = of.numbers("FORCE_PLATFORM:USED")
    types = of.numbers("FORCE_PLATFORM:TYPE")
    corners = length * of.numbers("FORCE_PLATFORM:CORNERS", 4, 3)
    origins = length * of.numbers("FORCE_PLATFORM:ORIGIN", 3)
    described = min(map(len, (types, corners, origins)))
    if not (count.size and 1 <= count[0] <= described):  # NaN too
        used = f"{count[0]:g}" if count.size else "no"
        raise InputError(f"the C3D file describes {used} force plates, or some of them in part")
    shapes = []
    for k in range(int(count[0])):
        if types[k] not in HELD:
            raise InputError(f"force plate {k + 1} is of type {types[k]:g}; types 1 to 4 are read")
        c = corners[k]
        ex, across = c[0] - c[1], c[0] - c[3]
        ez = np.cross(ex, across)
        if not np.linalg.norm(ez) > 1e-4:  # m², NaN too
            raise InputError(f"the corners of force plate {k + 1} (CORNERS) span no plate")
        axes = np.stack([ex, np.cross(ez, ex), ez], axis=1)
        middle, o = c.mean(axis=0), origins[k]
        if o[2] > 0.0:  # from the middle to the transducers, as some programs write it
            o = -o
        reach = float(np.linalg.norm(c - middle, axis=1).max())
        axes /= np.linalg.norm(axes, axis=0)
        shapes.append(_Shape(str(k + 1), int(types[k]), middle, reach, axes, o))
    return shapes


def _channels(channels: Array, shape: _Shape, there: int) -> list[int]:
    """Return the places of a plate's channels."""
    place = int(shape.name) - 1
    count = len(HELD[shape.type])
    own = list(channels[place][:count]) if place < len(channels) else []
    if len(own) < count or not all(0 <= each < there for each in own):
        raise InputError(f"the channels of force plate {shape.name} are not all in the file")
    return own


def _about_middle(
    of: C3dFile, shape: _Shape, own: list[int], length: float
) -> tuple[Array, Array, Array]:
    """Return Fz (N) and Fz times the centre of pressure (N·m) from the plate's middle, its axes."""
    told = [compact(each) for each in of.words("ANALOG:UNITS")]
    units = [told[each] if each < len(told) else "" for each in own]
    signal = of.analog[own]
    if shape.type == 4:  # N, and N times the unit of lengths, come out of the matrix
        matrices = of.numbers("FORCE_PLATFORM:CAL_MATRIX", 6, 6)
        if len(matrices) < int(shape.name):
            raise InputError(f"force plate {shape.name} has no calibration (CAL_MATRIX)")
        signal = matrices[int(shape.name) - 1].T @ signal
        units = [""] * len(SIX)
    of_file = {"force": 1.0, "moment": length, "length": length}
    factors = [
        UNITS[kind].get(unit, of_file[kind])
        for kind, unit in zip(HELD[shape.type], units, strict=True)
    ]
    signal = np.array(factors)[:, None] * signal
    if shape.type == 1:
        return signal[2], signal[2] * signal[3], signal[2] * signal[4]
    force, moment, arm = signal[:3], signal[3:], shape.origin
    if shape.type == 3:
        force, moment, arm = _of_sensors(signal, shape.origin)
    mx, my, _ = moment - np.cross(arm, force, axis=0)
    return force[2], -my, mx


def _of_sensors(signal: Array, origin: Array) -> tuple[Array, Array, Array]:
    """Return force, moment and the way to the surface of Kistler's four transducers, at (±a, ±b).

    Fx12, Fx34, Fy14, Fy23, Fz1 to Fz4; a and b are x and y of ORIGIN, z its height. The polynomials
    that some files hold (FPCOPPOLY) move the centre of pressure by some mm, nearly the same for all
    places on which a person stands, and are not used.
    """
    a, b = np.abs(origin[:2])
    fz = signal[4:]
    mx, my = b * (fz[0] + fz[1] - fz[2] - fz[3]), a * (fz[1] + fz[2] - fz[0] - fz[3])
    force = np.stack([signal[0] + signal[1], signal[2] + signal[3], fz.sum(axis=0)])
    return force, np.stack([mx, my, np.zeros_like(mx)]), np.array([0.0, 0.0, origin[2]])


def _check_beside(plates: list[Plate], shapes: list[_Shape], floor: list[int]) -> None:
    """Refuse a centre of pressure beside the plate that carries it."""
    loads = [abs(median_of(plate.load)) for plate in plates]
    for plate, shape, load in zip(plates, shapes, loads, strict=True):
        if load < CARRIES * sum(loads):
            continue
        x, y = (
            median_of(each / plate.load) - shape.middle[axis]
            for each, axis in zip((plate.first, plate.second), floor, strict=True)
        )
        if not np.hypot(x, y) <= BESIDE * shape.reach:
            raise InputError(
                f"the centre of pressure is {np.hypot(x, y):.3g} m from the middle of force plate "
                f"{shape.name}, beside it; are the units of moments (ANALOG:UNITS) and lengths "
                "(POINT:UNITS) and the ORIGIN right?"
            )
