"""The one table of parameters: name, symbol, unit, range, and where a study says it.

A row carries all of a parameter: labels of figures, attributes of files, the keys of a study, its
default, and the border check, by which a value that a user gives is compared with its row; the
message names the parameter, the value and what would be right.
"""

import math
import numbers
from dataclasses import dataclass
from typing import Any

import numpy as np

from standfast.errors import InputError, nearest_name, shortened
from standfast.numerics.arrays import Scalar

JOINTS = ("ankle", "knee", "hip")
STIFFNESSES = tuple(f"{joint}_stiffness" for joint in JOINTS)


@dataclass(frozen=True, slots=True)
class Parameter:
    """A number, or one of some words, that a study or a call is given.

    ``section`` and ``key`` are its place in a study file ("" is the top level; without a key it is
    not of a study). A study that does not give it takes ``default``; None: it must be given.
    ``unwritten``: only a study that gives it names it in its canonical text and its file.
    """

    name: str
    symbol: str
    unit: str
    meaning: str
    lowest: float = -math.inf
    highest: float = math.inf
    or_rigid: bool = False  # inf is allowed too
    choices: tuple[str, ...] = ()  # one of these words, instead of a number
    section: str = ""
    key: str = ""
    default: float | str | None = None
    unwritten: bool = False

    @property
    def label(self) -> str:
        """Axis label of a figure: words, symbol and unit."""
        return label(self.name.replace("_", " "), self.symbol, self.unit)

    @property
    def place(self) -> str:
        """How messages about a study call it, for example ``stiffness.ankle``."""
        return f"{self.section}.{self.key}" if self.section else self.key

    @property
    def allowed(self) -> str:
        """The allowed range in words, with the unit."""
        unit = "" if self.unit == "1" else f" {self.unit}"
        rigid = ", or inf for a rigid joint" if self.or_rigid else ""
        return f"{self.lowest:g} to {self.highest:g}{unit}{rigid}"


def label(words: str, symbol: str, unit: str) -> str:
    """Compose a figure label, for example ``Ankle stiffness $K_a$ (N·m/rad)``."""
    head = words[0].upper() + words[1:]
    parts = [head, f"${symbol}$" if symbol else "", "" if unit == "1" else f"({unit})"]
    return " ".join(part for part in parts if part)


BODY_MODELS = ("edwards2007", "winter", "de-leva-male", "de-leva-female")
STANDARD_GRAVITY = 9.80665
STIFFNESS_UNIT = "N·m/rad"


def _stiffness(joint: str) -> Parameter:
    return Parameter(
        f"{joint}_stiffness",
        f"K_{joint[0]}",
        STIFFNESS_UNIT,
        f"rotational stiffness of both {joint}s together",
        0.0,
        1e12,  # beyond all joints; up to here every accuracy that is promised has been measured
        or_rigid=True,
        section="stiffness",
        key=joint,
    )


# Heights and masses run from small children to the tallest and heaviest adults on record; gravity
# from near weightlessness to well beyond a centrifuge. They catch centimetres and pounds in grams,
# not unusual people.
_TABLE = (
    Parameter(
        "gravity",
        "g",
        "m/s²",
        "gravitational acceleration",
        1e-3,
        1e3,
        key="gravity",
        default=STANDARD_GRAVITY,
    ),
    Parameter(
        "body_model",
        "",
        "1",
        "table of segment parameters",
        choices=BODY_MODELS,
        section="body",
        key="model",
        default="winter",
    ),
    Parameter(
        "height", "H", "m", "standing height of the person", 0.5, 2.8, section="body", key="height"
    ),
    Parameter("mass", "m", "kg", "mass of the whole body", 2.0, 700.0, section="body", key="mass"),
    Parameter(
        "bmi", "", "kg/m²", "body mass index, mass / height²", 5.0, 250.0, section="body", key="bmi"
    ),
    *map(_stiffness, JOINTS),
)
PARAMETERS = {row.name: row for row in _TABLE}

# The parts of a body that is given segment by segment: shank, thigh, upper body.
_SEGMENT_TABLE = (
    Parameter("segment_mass", "m", "kg", "mass of a segment, both legs", 1e-3, 700.0),
    Parameter("segment_inertia", "I", "kg·m²", "inertia about its centre of mass", 1e-6, 1000.0),
    Parameter("segment_length", "h", "m", "length of shank and thigh", 1e-2, 2.0),
    Parameter("segment_com", "e", "m", "centre of mass above the lower end", 1e-3, 2.0),
)
SEGMENT_PARAMETERS = {row.name: row for row in _SEGMENT_TABLE}


def checked_choice(where: str, value: Any, *, row: Parameter | None = None) -> str:
    """Return ``value`` if it is one of the words that a parameter can be.

    ``where`` and ``row`` as in :func:`checked_number`.
    """
    wrong = "known" if row is None else f"a {row.name.replace('_', ' ')}"
    row = row or PARAMETERS[where]
    if not isinstance(value, str) or value not in row.choices:
        kind = row.name.split("_")[-1]
        raise InputError(
            f"{where} = {shortened(value)} is not {wrong}{nearest_name(value, row.choices)} "
            f"({kind}s: {', '.join(row.choices)})"
        )
    return value


def checked_number(name: str, value: Any, *, row: Parameter | None = None) -> float:
    """Return ``value`` as a float if it lies in the range of the parameter ``name``.

    ``name`` is what the message calls it; ``row`` is the table row when that differs.
    """
    row = row or PARAMETERS[name]
    if isinstance(value, np.ndarray) and value.ndim == 0:
        value = value.item()
    if isinstance(value, bool | np.bool_) or not isinstance(value, numbers.Real):
        kind = "text" if isinstance(value, str) else f"of type {type(value).__name__}"
        raise InputError(f"{name} = {value!r} is {kind}; give a number, {row.allowed}")
    try:
        number = float(value)
    except OverflowError:
        raise InputError(f"{name} is an integer beyond all floats; give {row.allowed}") from None
    if math.isnan(number):
        raise InputError(f"{name} is NaN (not a number); give {row.allowed}")
    if row.or_rigid and number == math.inf:
        return number
    if not row.lowest <= number <= row.highest:
        raise InputError(
            f"{name} = {number:g} is outside the allowed range, {row.allowed}{_likely(row, number)}"
        )
    return number


def number_in(text: str) -> float:
    """Read a number in ASCII digits; ``float`` also takes ``8_0`` and the digits of all scripts.

    Raises
    ------
    ValueError
        if it is none.
    """
    if "_" in text or not text.isascii():
        raise ValueError(text)
    return float(text)


def _likely(row: Parameter, number: float) -> str:
    """Guess the slip of units behind a number out of range."""
    for factor, unit in ((100.0, "centimetres"), (1000.0, "millimetres")):
        if row.name == "height" and 1.0 <= number / factor <= row.highest:
            return f"; {number:g} looks like {unit}, write {number / factor:g}"
    if row.name == "mass" and row.lowest <= number / 1000.0 <= row.highest:
        return f"; {number:g} looks like grams, write {number / 1000.0:g}"
    return ""


def checked_scalar(name: str, value: Any) -> Scalar:
    """Check a parameter of one person: one number in its range, or one that is being traced."""
    if value is None or np.shape(value) != ():
        shape = "None" if value is None else f"an array of shape {np.shape(value)}"
        raise InputError(
            f"{name} is {shape}; give one number, {PARAMETERS[name].allowed}, "
            "or map over many with jax.vmap"
        )
    return checked_leaf(name, value)


def checked_leaf(name: str, value: Any) -> Scalar:
    """Check a parameter if it was typed in; let the leaves of a pytree pass."""
    return checked_number(name, value) if is_typed_in(value) else value


def is_typed_in(value: Any) -> bool:
    """Return whether a value is one that people write, as against one that programs hand around.

    JAX takes records apart and puts them together again with tracers, None and marks of its own.
    """
    written = (numbers.Number, np.generic, str, bytes, list, tuple, dict, set)
    return isinstance(value, written) or (isinstance(value, np.ndarray) and value.ndim == 0)
