"""The one table of parameters and quantities: names, symbols, units, meanings, allowed ranges.

Labels of figures, attributes of files, help texts and error messages are all taken from here, so a
name or a unit is written once. The module also holds the border check: a value that a user gives
is compared with its row, and the message names the parameter, the value and what would be right.
"""

import difflib
import math
import numbers
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np


class InputError(ValueError):
    """Something a user gave is wrong; the message is one sentence that says what would be right."""


@dataclass(frozen=True, slots=True)
class Parameter:
    """A number that a study or a call is given, with the range in which it makes sense."""

    name: str
    symbol: str
    unit: str
    meaning: str
    lowest: float
    highest: float
    or_rigid: bool = False  # inf is allowed too

    @property
    def label(self) -> str:
        """Axis label of a figure: words, symbol and unit."""
        return label(self.name.replace("_", " "), self.symbol, self.unit)

    @property
    def allowed(self) -> str:
        """The allowed range in words, with the unit."""
        unit = "" if self.unit == "1" else f" {self.unit}"
        rigid = ", or inf for a rigid joint" if self.or_rigid else ""
        return f"{self.lowest:g} to {self.highest:g}{unit}{rigid}"


@dataclass(frozen=True, slots=True)
class Quantity:
    """A number that standfast computes for one person and one triple of joint stiffnesses."""

    name: str
    symbol: str
    unit: str
    meaning: str
    dtype: str = "float64"

    @property
    def label(self) -> str:
        """Axis label of a figure: words, symbol and unit."""
        return label(self.name.replace("_", " "), self.symbol, self.unit)


def label(words: str, symbol: str, unit: str) -> str:
    """Compose a figure label, for example ``Ankle stiffness $K_a$ (N·m/rad)``."""
    head = words[0].upper() + words[1:]
    parts = [head, f"${symbol}$" if symbol else "", "" if unit == "1" else f"({unit})"]
    return " ".join(part for part in parts if part)


STIFFNESS_UNIT = "N·m/rad"

# Beyond all joints; up to here every accuracy that is promised has been measured.
STIFFEST = 1e12

# Heights and masses run from small children to the tallest and heaviest adults on record; gravity
# from near weightlessness to well beyond a centrifuge. They catch centimetres and pounds in grams,
# not unusual people.
PARAMETERS = {
    row.name: row
    for row in (
        Parameter(
            "ankle_stiffness",
            "K_a",
            STIFFNESS_UNIT,
            "rotational stiffness of both ankles together",
            0.0,
            STIFFEST,
            or_rigid=True,
        ),
        Parameter(
            "knee_stiffness",
            "K_k",
            STIFFNESS_UNIT,
            "rotational stiffness of both knees together",
            0.0,
            STIFFEST,
            or_rigid=True,
        ),
        Parameter(
            "hip_stiffness",
            "K_h",
            STIFFNESS_UNIT,
            "rotational stiffness of both hips together",
            0.0,
            STIFFEST,
            or_rigid=True,
        ),
        Parameter("height", "H", "m", "standing height of the person", 0.5, 2.8),
        Parameter("mass", "m", "kg", "mass of the whole body", 2.0, 700.0),
        Parameter("bmi", "", "kg/m²", "body mass index, mass / height²", 5.0, 250.0),
        Parameter("gravity", "g", "m/s²", "gravitational acceleration", 1e-3, 1e3),
    )
}

STANDARD_GRAVITY = 9.80665

# The parts of a body that is given segment by segment: shank, thigh, upper body.
SEGMENT_PARAMETERS = {
    row.name: row
    for row in (
        Parameter("segment_mass", "m", "kg", "mass of a segment, both legs", 1e-3, 700.0),
        Parameter(
            "segment_inertia", "I", "kg·m²", "inertia about its centre of mass", 1e-6, 1000.0
        ),
        Parameter("segment_length", "h", "m", "length of shank and thigh", 1e-2, 2.0),
        Parameter("segment_com", "e", "m", "centre of mass above the lower end", 1e-3, 2.0),
    )
}

QUANTITIES = {
    row.name: row
    for row in (
        Quantity("stable", "", "1", "verdict: the person stands", "uint8"),
        Quantity(
            "stability_determinant", r"\det C", "(N·m/rad)³", "determinant of the stiffness matrix"
        ),
        Quantity(
            "critical_ankle_stiffness",
            r"K_{a,\mathrm{crit}}",
            STIFFNESS_UNIT,
            "ankle stiffness at which the person just stands, knee and hip as given",
        ),
        Quantity(
            "critical_knee_stiffness",
            r"K_{k,\mathrm{crit}}",
            STIFFNESS_UNIT,
            "knee stiffness at which the person just stands, ankle and hip as given",
        ),
        Quantity(
            "critical_hip_stiffness",
            r"K_{h,\mathrm{crit}}",
            STIFFNESS_UNIT,
            "hip stiffness at which the person just stands, ankle and knee as given",
        ),
        Quantity(
            "stiffness_reserve",
            r"\lambda_{\min}(C)",
            STIFFNESS_UNIT,
            "what every joint could lose at once before the person falls",
        ),
        Quantity(
            "safety_factor",
            "s",
            "1",
            "factor by which all stiffnesses could be divided and the person just stand",
        ),
        Quantity("eigenvalue_1", r"\lambda_1", "rad²/s²", "eigenvalue of the least stable mode"),
        Quantity("eigenvalue_2", r"\lambda_2", "rad²/s²", "eigenvalue of the second mode"),
        Quantity("eigenvalue_3", r"\lambda_3", "rad²/s²", "eigenvalue of the third mode"),
        Quantity(
            "frequency",
            "f",
            "Hz",
            "frequency of the least stable mode, negative where the person falls",
        ),
        Quantity("growth_rate", r"\sigma", "1/s", "growth rate of the fall, 0 where stable"),
        Quantity(
            "hip_ankle_ratio",
            r"\theta_h/\theta_a",
            "1",
            "hip rotation per ankle rotation in the least stable mode",
        ),
        Quantity(
            "knee_ankle_ratio",
            r"\theta_k/\theta_a",
            "1",
            "knee rotation per ankle rotation in the least stable mode",
        ),
    )
}


# Words that are not near in letters to what they mean.
SYNONYMS = {"weight": "mass", "size": "height", "length": "height", "g": "gravity"}


def nearest_name(given: object, names: Iterable[str]) -> str:
    """Return ``"; did you mean 'x'?"`` for a near miss, else an empty string."""
    names = list(names)
    if SYNONYMS.get(str(given)) in names:
        return f"; did you mean {SYNONYMS[str(given)]!r}?"
    close = difflib.get_close_matches(str(given), names, n=1, cutoff=0.5)
    return f"; did you mean {close[0]!r}?" if close else ""


def checked_number(name: str, value: Any, *, row: Parameter | None = None) -> float:
    """Return ``value`` as a float if it lies in the range of the parameter ``name``.

    ``name`` is what the message calls it; ``row`` is the table row when that differs.

    Raises
    ------
    InputError
        for text, a truth value, NaN, or a number outside the range of the table.
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


def _likely(row: Parameter, number: float) -> str:
    """Guess the slip of units behind a number out of range."""
    for factor, unit in ((100.0, "centimetres"), (1000.0, "millimetres")):
        if row.name == "height" and 1.0 <= number / factor <= row.highest:
            return f"; {number:g} looks like {unit}, write {number / factor:g}"
    if row.name == "mass" and row.lowest <= number / 1000.0 <= row.highest:
        return f"; {number:g} looks like grams, write {number / 1000.0:g}"
    return ""


def in_bytes(size: float) -> str:
    """Return a number of bytes as people read it, for example ``12.6 MB``."""
    for unit in ("bytes", "kB", "MB", "GB"):
        if size < 1000.0:
            return f"{size:.3g} {unit}"
        size /= 1000.0
    return f"{size:.3g} TB"
