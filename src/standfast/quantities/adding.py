"""A quantity of a user's own: one more row of the table, for the running program."""

import inspect
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from standfast.errors import InputError, nearest_name, shortened
from standfast.numerics.arrays import Scalar
from standfast.parameters import PARAMETERS
from standfast.quantities.row import Person, Quantity
from standfast.quantities.table import QUANTITIES

DTYPES = ("float64", "float32", "uint8")


def add_quantity(
    name: str,
    function: Callable[[Person], Scalar],
    *,
    unit: str,
    meaning: str,
    symbol: str = "",
    dtype: str = "float64",
    without: Sequence[str] = (),
) -> Quantity:
    """Add a quantity of one's own to the table, for sweeps of this program.

    It is computed, stored and drawn as those of standfast. A file with it opens where it has been
    added; it holds the name, not the function, so a function that was changed needs another name,
    or another file. Workers of an executor do not know it.

    Parameters
    ----------
    name
        as a study asks for it.
    function
        of one :class:`Person`: ``body``, ``stiffness``, ``gravity`` and all parameters by name in
        ``given``; pure, and traced by JAX, so with ``jax.numpy`` or the functions of standfast. It
        returns one number, and is tried before anything is computed.
    unit, meaning, symbol
        for labels and files; "1" is no unit, a symbol is TeX without dollars.
    dtype
        float64, float32, or uint8 for a truth value.
    without
        parameters, or whole sections of them, on which it does not depend, and so gets no axis of:
        ``("ankle_stiffness", "feedback")``.

    Returns
    -------
    The row of the table.

    Raises
    ------
    InputError
        if the name is no name or taken, by one's own too, or something is of another kind.

    Examples
    --------
    >>> import standfast as sf
    >>> weight = lambda person: person.gravity * person.body.segment_mass.sum()
    >>> sf.add_quantity("weight", weight, unit="N", meaning="weight above the ankles").label
    'Weight (N)'
    """
    _check_name(name)
    _check_function(name, function)
    _check_texts(unit=unit, meaning=meaning, symbol=symbol)
    if dtype not in DTYPES:
        raise InputError(f"dtype = {shortened(dtype)} is not one of {', '.join(DTYPES)}")
    _check_without(without)
    row = Quantity(
        name, symbol, unit, meaning, function, dtype=np.dtype(dtype).name, without=tuple(without),
        own=True,
    )  # fmt: skip
    QUANTITIES[name] = row
    return row


def _check_texts(**texts: object) -> None:
    for key, text in texts.items():
        if not isinstance(text, str) or not text.isprintable():
            raise InputError(f"{key} = {shortened(text)} is not one line of text")


def _check_name(name: object) -> None:
    if not isinstance(name, str) or not (name.isidentifier() and name.isascii()):
        raise InputError(
            f"name = {shortened(name)} is not a name of a quantity; give lower-case words with "
            "underscores, as hip_moment"
        )
    if name in PARAMETERS:
        raise InputError(f"{name} is a parameter; give the quantity another name")
    if name in QUANTITIES and not QUANTITIES[name].own:
        raise InputError(f"{name} is a quantity of standfast already; choose another name")


def _check_function(name: str, function: Any) -> None:
    if not callable(function):
        raise InputError(f"function = {shortened(function)} is not a function of a person")
    try:
        inspect.signature(function).bind(None)
    except TypeError as error:
        raise InputError(
            f"the function of {name} cannot be called with a person alone ({error}); "
            "give a function of one argument"
        ) from None
    except ValueError:  # a function of C that does not say what it takes
        pass
    if name in QUANTITIES and not _same(QUANTITIES[name].reference, function):
        raise InputError(
            f"{name} has been added with another function; choose another name, because files "
            "that hold it would not tell the two apart"
        )


def _same(one: Any, other: Any) -> bool:
    """Return whether two functions are one, or the same lines run again, as in a notebook."""
    if one is other:
        return True
    code = getattr(one, "__code__", None)
    held = (getattr(f, key, None) for key in ("__closure__", "__self__") for f in (one, other))
    return (
        code is not None
        and code == getattr(other, "__code__", None)
        and one.__defaults__ == other.__defaults__
        and all(each is None for each in held)
    )


def _check_without(without: Sequence[str]) -> None:
    if isinstance(without, str):
        raise InputError(f"without = {shortened(without)} is text; write ({without!r},)")
    known = {*PARAMETERS, *(row.section for row in PARAMETERS.values() if row.section)}
    for parameter in without:
        if parameter not in known:
            raise InputError(
                f"without has {shortened(parameter)}, which is no parameter or section of them"
                f"{nearest_name(parameter, known)}"
            )
        row = PARAMETERS.get(parameter)
        if parameter in ("body", "gravity") or (row is not None and row.section == "body"):
            raise InputError(
                f"without has {parameter}, and every person has body and gravity; leave it out"
            )
