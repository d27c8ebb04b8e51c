"""A C3D file as numbers: its analog channels and the parameters that say what they are."""

import io
import warnings
from dataclasses import dataclass
from typing import Any

import numpy as np

from standfast.errors import InputError, shortened
from standfast.numerics.arrays import Array

NEEDS = 'it is a C3D file, which needs the package c3d: pip install "standfast[c3d]"'


def is_c3d(raw: bytes) -> bool:
    """Return whether bytes begin as a C3D file."""
    return raw[1:2] == b"\x50" and len(raw) >= 512 and b"\0" in raw[:512]


def opened_c3d(raw: bytes) -> "C3dFile":
    """Return what is in a C3D file.

    Raises
    ------
    InputError
        if the package that reads it is missing, or it cannot be read, or has no force plate.
    """
    try:
        import c3d  # noqa: PLC0415 # an extra
    except ImportError:
        raise InputError(NEEDS) from None
    try:
        with warnings.catch_warnings():  # of what is odd in a file and does not matter here
            warnings.simplefilter("ignore")
            reader = c3d.Reader(io.BytesIO(raw))
            # frames without samples would be read for as long as a broken file says
            sampled = reader.analog_used * reader.analog_per_frame > 0
            some = reader.read_frames(copy=False, check_nan=False) if sampled else ()
            frames = [analog for _, _, analog in some]
            groups = {name: reader.get(name) for name in ("POINT", "ANALOG", "FORCE_PLATFORM")}
            rate, expected = float(reader.analog_rate), int(reader.frame_count)
    except Exception as error:  # whatever a broken file makes of the package
        why = shortened(" ".join(str(error).split()))
        raise InputError(f"it is a C3D file that cannot be read: {why}") from None
    if groups["FORCE_PLATFORM"] is None or not frames:
        raise InputError("the C3D file has no force plate (FORCE_PLATFORM), or no analog channels")
    said = []
    if len(frames) < expected:
        said.append(f"the file is cut off after {len(frames):,} of {expected:,} frames")
    return C3dFile(np.concatenate(frames, axis=1), rate, said, groups)


@dataclass(frozen=True, eq=False)
class C3dFile:
    """What is read of a C3D file.

    Attributes
    ----------
    analog : (channels, n), scaled as the file says
    rate : Hz, of the analog channels
    remarks
        what is to be said of how it was read.
    groups
        of parameters, by name, as the package has them.
    """

    analog: Array
    rate: float
    remarks: list[str]
    groups: dict[str, Any]

    def _there(self, name: str) -> Any:
        group, _, own = name.partition(":")
        return None if self.groups[group] is None else self.groups[group].get(own)

    def words(self, name: str) -> list[str]:
        """Return words, none if the parameter is missing."""
        found = self._there(name)
        return [] if found is None else [str(each).strip() for each in found.string_array.ravel()]

    def numbers(self, name: str, *shape: int) -> Array:
        """Return numbers of some shape, the format's last index first, which are to be there."""
        found = self._there(name)
        try:
            size = {4: "float", 2: "int16", 1: "int8"}[found.bytes_per_element]
            each = getattr(found, f"{size}_{'array' if found.dimensions else 'value'}")
            numbers: Array = np.asarray(each, float).ravel().reshape(-1, *shape)
        except (AttributeError, KeyError, TypeError, ValueError):
            raise InputError(f"the C3D file has no {name} that can be read") from None
        return numbers

    def width(self, name: str) -> int:
        """Return the first dimension of a parameter."""
        found = self._there(name)
        return int(found.dimensions[0]) if found is not None and found.dimensions else 1
