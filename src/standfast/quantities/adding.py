"""A quantity of a user's own: one more row of the table, for the running program."""

from collections.abc import Callable, Sequence

import numpy as np

from standfast.errors import InputError, nearest_name, shortened
from standfast.numerics.arrays import Scalar
from standfast.parameters import PARAMETERS
from standfast.quantities.row import Person, Quantity
from standfast.quantities.table import QUANTITIES

# Names that were added, and may be replaced.
_ADDED: set[str] = set()
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

    It is computed, stored and drawn as those of standfast; adding it again replaces it. A file with
    it opens where it has been added. Workers of an executor do not know it.

    Parameters
    ----------
    name
        as a study asks for it.
    function
        of one :class:`Person`: ``body``, ``stiffness``, ``gravity`` and all parameters by name in
        ``given``; pure, and traced by JAX, so with ``jax.numpy`` or the functions of standfast.
    unit, meaning, symbol
        for labels and files; "1" is no unit, a symbol is TeX without dollars.
    dtype
        float64, float32 or uint8.
    without
        parameters, or whole sections of them, on which it does not depend, and so gets no axis of:
        ``("ankle_stiffness", "feedback")``.

    Returns
    -------
    The row of the table.

    Raises
    ------
    InputError
        if the name is taken or no name, or something is of another kind.
    """
    _check_name(name)
    if not callable(function):
        raise InputError(f"function = {shortened(function)} is not a function of a person")
    for key, text in (("unit", unit), ("meaning", meaning), ("symbol", symbol)):
        if not isinstance(text, str) or not text.isprintable():
            raise InputError(f"{key} = {shortened(text)} is not one line of text")
    if dtype not in DTYPES:
        raise InputError(f"dtype = {shortened(dtype)} is not one of {', '.join(DTYPES)}")
    _check_without(without)
    row = Quantity(
        name, symbol, unit, meaning, function, dtype=np.dtype(dtype).name, without=tuple(without)
    )
    QUANTITIES[name] = row
    _ADDED.add(name)
    return row


def _check_name(name: object) -> None:
    if not isinstance(name, str) or not (name.isidentifier() and name.isascii()):
        raise InputError(
            f"name = {shortened(name)} is not a name of a quantity; give lower-case words with "
            "underscores, as hip_moment"
        )
    if name in PARAMETERS:
        raise InputError(f"{name} is a parameter; give the quantity another name")
    if name in QUANTITIES and name not in _ADDED:
        raise InputError(f"{name} is a quantity of standfast already; choose another name")


def _check_without(without: Sequence[str]) -> None:
    known = {*PARAMETERS, *(row.section for row in PARAMETERS.values() if row.section)}
    for parameter in without:
        if parameter not in known:
            raise InputError(
                f"without has {shortened(parameter)}, which is no parameter or section of them"
                f"{nearest_name(parameter, known)}"
            )
