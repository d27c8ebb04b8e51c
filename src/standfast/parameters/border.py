"""The border check: a value that a user gives, compared with its row of the table.

The message names the parameter, the value and what would be right.
"""

import math
import numbers
import re
from typing import Any

import numpy as np

from standfast.errors import InputError, nearest_name, shortened
from standfast.numerics.arrays import Scalar, in_numpy, is_traced
from standfast.parameters.table import PARAMETERS, Parameter

DECIMAL_COMMA = re.compile(r"[-+]?\d+,\d+")
# Units in which a number out of range may be given by a slip, of a parameter or else of all in a
# unit (of segments): how many make ours, and from where to where people then are.
SLIPS = {
    "height": (("centimetres", 100.0, 1.0, 2.8), ("millimetres", 1000.0, 1.0, 2.8)),
    "mass": (("grams", 1000.0, 2.0, 650.0),),
    "gravity": (("cm/s²", 100.0, 1.0, 200.0),),
    "feedback_delay": (("milliseconds", 1000.0, 0.01, 10.0),),
    "m": (("centimetres", 100.0, 0.1, 1.0), ("millimetres", 1000.0, 0.1, 1.0)),
    "kg": (("grams", 1000.0, 0.7, 650.0),),
    "kg·m²": (("kg·cm²", 1e4, 0.1, 100.0),),
}


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
        raise InputError(
            f"{name} = {value!r} is {kind}; give a number, {row.allowed}{_point(value)}"
        )
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


def check_bmi(where: str, height: float, mass: float) -> None:
    """Refuse a mass (kg), called ``where``, that nobody of a height (m) has."""
    row = PARAMETERS["bmi"]
    bmi = mass / height**2
    if not row.lowest <= bmi <= row.highest:
        raise InputError(
            f"{where} = {mass:g} at a height of {height:g} m is a BMI of {bmi:.4g}, outside the "
            f"allowed range, {row.allowed}"
        )


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


def _point(value: Any) -> str:
    """Guess the decimal comma in a text that is no number."""
    if not isinstance(value, str) or not DECIMAL_COMMA.fullmatch(value.strip()):
        return ""
    return f"; decimals have a point, write {value.strip().replace(',', '.')}"


def _likely(row: Parameter, number: float) -> str:
    """Guess the slip of units behind a number out of range."""
    if row.name == "feedback_delay" and row.lowest < -number <= row.highest:
        return f"; feedback comes after what it senses, write {-number:g}"
    if row.name == "mass" and row.highest < number < 2.0 * row.highest:
        return f"; is a decimal point missing, {number / 10.0:g}?"
    for unit, size, least, most in SLIPS.get(row.name) or SLIPS.get(row.unit) or ():
        if least <= number / size <= most:
            return f"; {number:g} looks like {unit}, write {number / size:g}"
    return ""


def checked_scalar(name: str, value: Any) -> Scalar:
    """Check a parameter of one person: one number in its range, or one that is being traced.

    An array of JAX that has its number is checked like a float, and comes back as it is.
    """
    if value is None or np.shape(value) != ():
        shape = "None" if value is None else f"an array of shape {np.shape(value)}"
        raise InputError(
            f"{name} is {shape}; give one number, {PARAMETERS[name].allowed}, "
            "or map over many with jax.vmap"
        )
    if is_traced(value):
        return value
    plain = in_numpy(value)
    if not is_typed_in(plain) and not hasattr(plain, "__next__"):  # a symbol, a mark
        return value
    number = checked_number(name, plain)
    return number if plain is value else value


def checked_leaf(name: str, value: Any) -> Scalar:
    """Check a parameter if it was typed in; let the leaves of a pytree pass."""
    return checked_number(name, value) if is_typed_in(value) else value


def is_written(values: Any) -> bool:
    """Return whether what should be several numbers is of a person, as against of a program."""
    one_by_one = values is None or hasattr(values, "__next__")
    return one_by_one or is_typed_in(values) or isinstance(values, np.ndarray)


def is_typed_in(value: Any) -> bool:
    """Return whether a value is one that people write, as against one that programs hand around.

    JAX takes records apart and puts them together again with tracers, None and marks of its own.
    """
    written = (numbers.Number, np.generic, str, bytes, list, tuple, dict, set)
    return isinstance(value, written) or (isinstance(value, np.ndarray) and value.ndim == 0)
