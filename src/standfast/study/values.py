"""The border of a study: what a file or a dictionary may say, checked key by key.

The keys are those of the tables of parameters and quantities. Every message names the key, what was
given, and the nearest right name or the allowed range.
"""

import itertools
import math
import operator
from collections.abc import Iterable, Mapping
from decimal import Context, Decimal, localcontext
from functools import lru_cache
from typing import Any

import numpy as np

from standfast.errors import InputError, nearest_name, shortened
from standfast.numerics.arrays import in_numpy
from standfast.parameters import (
    OWN_BODY,
    PARAMETERS,
    Parameter,
    check_bmi,
    checked_choice,
    checked_number,
)
from standfast.quantities import QUANTITIES
from standfast.study.canonical import Value
from standfast.study.own_body import check_own_body, is_own, laid_out

RANGE_KEYS = ("start", "stop", "num", "spacing")
SPACINGS = ("linear", "log")
LONGEST_AXIS = 10_000_000

# Ten million multiplications leave more than 40 of them, and a float64 is rounded from 17.
DIGITS = 50


def axis_values(value: Value) -> np.ndarray | None:
    """Return the values of a list or range; None for a single value."""
    if isinstance(value, list):
        return np.array(value)
    if isinstance(value, dict):
        ends = value["start"], value["stop"], value["num"]
        if value["spacing"] == "log":
            return _log_spaced(*ends).copy()
        # a multiplication and an addition a value: the same on every machine
        return np.linspace(*ends)
    return None


@lru_cache(maxsize=8)
def _log_spaced(start: float, stop: float, num: int) -> np.ndarray:
    """Return start (stop/start)^(i/(num − 1)), rounded once: the same on every machine.

    The powers of ``numpy.geomspace`` differ in their last bit between processors.
    """
    with localcontext(Context(prec=DIGITS)):
        step = ((Decimal(stop) / Decimal(start)).ln() / (num - 1)).exp()
        steps = itertools.repeat(step, num - 2)
        values = itertools.accumulate(steps, operator.mul, initial=Decimal(start))
        return np.fromiter(itertools.chain(map(float, values), (stop,)), np.float64, num)


def known_keys(where: str, given: Any, known: Iterable[str]) -> None:
    """Refuse a table with a key that is not known."""
    if not isinstance(given, Mapping):
        raise InputError(f"{where} = {shortened(given)} is not a table of {', '.join(known)}")
    for key in given:
        if key not in known:
            raise InputError(
                f"{where} has no key {key!r}{nearest_name(key, known)} (keys: {', '.join(known)})"
            )


def checked_title(content: Mapping[str, Any]) -> str:
    """Return the title of a study; empty if it has none."""
    title = content.get("title", "")
    if not isinstance(title, str) or not title.isprintable():
        raise InputError(f"title = {title!r} is not one line of text")
    return title


def checked_parameters(content: Mapping[str, Any]) -> dict[str, Value]:
    """Check all parameters of a study under their full names, in its order; add the defaults."""
    apart = ("title", "output")
    known_keys("study", content, ("title", *_keys_of(""), "output"))
    given = {key: value for key, value in content.items() if key not in apart}
    if "body" in given:
        given["body"] = laid_out(given["body"])
    parameters = _in_table("", given)
    own = is_own(parameters)
    for row in PARAMETERS.values():
        if row.default is not None and not row.unwritten and not (own and row.section == "body"):
            parameters.setdefault(row.name, row.default)
    check_complete(parameters)
    return parameters


def _keys_of(section: str) -> dict[str, Parameter | str]:
    """Return the keys of a section: of a parameter its row, of a section within its full name."""
    keys: dict[str, Parameter | str] = {}
    within: dict[str, Parameter | str] = {}
    head = f"{section}." if section else ""
    for row in PARAMETERS.values():
        if row.key and row.section == section:
            keys[row.key] = row
        elif row.key and row.section.startswith(head):
            key = row.section.removeprefix(head).partition(".")[0]
            within[key] = f"{head}{key}"
    return {**keys, **within}


def _in_table(section: str, given: Any) -> dict[str, Value]:
    """Check the parameters in one table of a study, and in the tables within it, in its order."""
    keys = _keys_of(section)
    if section:
        known_keys(f"[{section}]", given, keys)
    found: dict[str, Value] = {}
    for key, value in given.items():
        place = keys[key]
        if isinstance(place, str):
            found.update(_in_table(place, value))
        else:
            found[place.name] = checked_value(place.place, place, value)
    return found


def checked_value(where: str, row: Parameter, given: Any) -> Value:
    """Check a value, a list or a range of one parameter and return it in canonical form."""
    if isinstance(given, Mapping):
        if row.choices:
            raise InputError(f"{where} is a table; give a model or a list of models")
        return _range(where, row, given)
    given = in_numpy(given)  # what has an array of numbers: of JAX, a series of pandas
    if isinstance(given, np.ndarray):
        given = given.tolist()
    if isinstance(given, range):
        given = list(given[: LONGEST_AXIS + 1])
    if not isinstance(given, list | tuple):
        single: float | str = _single(where, row, given)
        return single
    if not given:
        raise InputError(f"{where} is an empty list; give at least one value")
    if len(given) > LONGEST_AXIS:
        raise InputError(f"{where} has {len(given)} values; at most {LONGEST_AXIS} are allowed")
    values = [_single(f"{where}[{number}]", row, item) for number, item in enumerate(given)]
    if row.choices:
        if len(set(values)) < len(values):
            raise InputError(f"{where} names a model twice: {', '.join(map(str, values))}")
        return values
    for number, (before, after) in enumerate(itertools.pairwise(values)):
        if not before < after:
            fault = "repeats" if before == after else "falls below"
            raise InputError(
                f"{where}[{number + 1}] = {after:g} {fault} the value before it; "
                "the values of an axis must rise"
            )
    return values


def _single(where: str, row: Parameter, given: Any) -> Any:
    if row.choices:
        return checked_choice(where, given, row=row)
    if isinstance(given, list | tuple | dict):
        raise InputError(f"{where} = {shortened(given)} is not a number")
    return checked_number(where, _short_text(given), row=row) + 0.0


def _range(where: str, row: Parameter, given: Mapping[str, Any]) -> dict[str, Any]:
    if "step" in given:
        raise InputError(
            f"{where} has a step; a range has the number of its values instead: "
            "{ start = …, stop = …, num = … }"
        )
    known_keys(where, given, RANGE_KEYS)
    for key in ("start", "stop", "num"):
        if key not in given:
            raise InputError(f"{where} lacks {key}; a range is {{ start = …, stop = …, num = … }}")
    start = checked_number(f"{where}.start", _short_text(given["start"]), row=row) + 0.0
    stop = checked_number(f"{where}.stop", _short_text(given["stop"]), row=row) + 0.0
    num = given["num"]
    num = int(num) if isinstance(num, np.integer) else num
    if isinstance(num, bool) or not isinstance(num, int) or not 2 <= num <= LONGEST_AXIS:
        raise InputError(
            f"{where}.num = {shortened(num)} is not a whole number of values, 2 to {LONGEST_AXIS}"
        )
    spacing = given.get("spacing", "linear")
    if spacing not in SPACINGS:
        raise InputError(
            f"{where}.spacing = {shortened(spacing)} is not known"
            f"{nearest_name(spacing, SPACINGS)} (spacings: {', '.join(SPACINGS)})"
        )
    if math.isinf(stop) or math.isinf(start):
        raise InputError(
            f"{where} reaches inf; put inf into a list instead, for example [800, inf]"
        )
    if start >= stop:
        raise InputError(f"{where} goes from {start:g} to {stop:g}; stop must be above start")
    if spacing == "log" and start == 0.0:
        raise InputError(f"{where}.start = 0 has no logarithm; start a log range above 0")
    canonical = {"start": start, "stop": stop, "num": num, "spacing": spacing}
    values = axis_values(canonical)
    if values is None or not (np.diff(values) > 0.0).all():
        raise InputError(
            f"{where} has {num} values between {start:.17g} and {stop:.17g}, "
            "more than there are numbers; take fewer"
        )
    return canonical


def check_complete(parameters: Mapping[str, Value]) -> None:
    """Refuse parameters of which one is missing, or that make a person of no mass at all."""
    own = is_own(parameters)
    of_body = {"mass", "bmi", *OWN_BODY, *(["height"] if own else [])}
    for row in PARAMETERS.values():
        needed = row.key and row.default is None and row.name not in of_body
        if needed and row.name not in parameters:
            raise InputError(f"{row.place} is missing")
    if own:
        check_own_body(parameters, _ends)
    else:
        _check_mass(parameters)


def _check_mass(parameters: Mapping[str, Value]) -> None:
    """Refuse a body with none or both of mass and BMI, or of no mass at all."""
    if ("mass" in parameters) == ("bmi" in parameters):
        have = "both are given" if "mass" in parameters else "neither is given"
        raise InputError(f"body needs mass or bmi, one of them; {have}")
    heights = _ends(parameters["height"])
    if "mass" in parameters:
        for mass, height in itertools.product(_ends(parameters["mass"]), heights):
            check_bmi("body.mass", height, mass)
    if "bmi" in parameters:
        row = PARAMETERS["mass"]
        for bmi, height in itertools.product(_ends(parameters["bmi"]), heights):
            mass = bmi * height**2
            if not row.lowest <= mass <= row.highest:
                raise InputError(
                    f"body.bmi = {bmi:g} at a height of {height:g} m is a mass of {mass:g} kg, "
                    f"outside the allowed range, {row.allowed}"
                )


def _ends(value: Value) -> tuple[float, ...]:
    values = axis_values(value)
    return (float(values[0]), float(values[-1])) if values is not None else (value,)  # type: ignore[return-value] # heights and bmi are numbers


def checked_quantities(given: Any) -> tuple[str, ...]:
    """Check the table of outputs; return the names of the quantities."""
    known_keys("[output]", given, ("quantities",))
    names = given.get("quantities", ["stable"])
    if not isinstance(names, list | tuple):
        raise InputError(f"output.quantities = {shortened(names)} is not a list of quantities")
    if not names:
        raise InputError("output.quantities is an empty list; give at least one quantity")
    for name in names:
        if not isinstance(name, str) or name not in QUANTITIES:
            raise InputError(
                f"output.quantities has no {shortened(name)}{nearest_name(name, QUANTITIES)} "
                f"(quantities: {', '.join(QUANTITIES)})"
            )
        if list(names).count(name) > 1:
            raise InputError(f"output.quantities names {name} twice")
    return tuple(names)


def _short_text(given: Any) -> Any:
    """Cut a long text, so that the message that refuses it stays one line."""
    return f"{given[:57]}…" if isinstance(given, str) and len(given) > 60 else given
