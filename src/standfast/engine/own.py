"""Quantities of a user's own are tried before anything of a study is computed or stored."""

from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from standfast.engine.mapping import Inputs
from standfast.errors import InputError
from standfast.quantities import QUANTITIES, Person, Quantity
from standfast.study.study import Study


def own_quantities(study: Study) -> list[str]:
    """Return the names of a study's quantities that a user added."""
    return [name for name in study.quantities if QUANTITIES[name].own]


def check_own(study: Study) -> None:
    """Trace each function of a user's own for one person of a study, and see what it returns.

    Raises
    ------
    InputError
        naming the quantity, if the function cannot be traced, or returns anything but one number
        that its dtype can hold.
    """
    for name in own_quantities(study):
        row = QUANTITIES[name]
        inputs = Inputs(study)
        first = inputs.pieces({axis: np.array(0) for axis in study.axes_of(name)})
        left_out = [axis for axis in study.axes if axis not in first]
        try:
            with jax.enable_x64(True):
                jax.eval_shape(lambda given, row=row: _tried(row, given), {**inputs.fixed, **first})
        except InputError as error:
            raise InputError(f"{name}: {error}") from None
        except jax.errors.JAXTypeError:
            raise InputError(
                f"the function of {name} asks for the value of a traced number (by float, if, or "
                "a function of NumPy); use jax.numpy, and jnp.where for if"
            ) from None
        except Exception as error:  # whatever a user's function raises
            what = " ".join(str(error).split())[:200]
            hint = (
                f"; it is given no {', '.join(left_out)}, which without names" if left_out else ""
            )
            raise InputError(
                f"the function of {name} raises {type(error).__name__}: {what}{hint}"
            ) from None


def _tried(row: Quantity, given: dict[str, Any]) -> Any:
    found = row.at_point(Person.of(given))
    wanted = "it must return one number"
    if not isinstance(found, bool | int | float | complex | np.generic | np.ndarray | jax.Array):
        raise InputError(f"its function returns {type(found).__name__}; {wanted}")
    if isinstance(found, np.ndarray | np.generic) and found.dtype.kind not in "biufc":
        raise InputError(f"its function returns an array of {found.dtype}; {wanted}")
    value = jnp.asarray(found)
    if value.shape != ():
        raise InputError(f"its function returns an array of shape {value.shape}; {wanted}")
    if value.dtype.kind == "c":
        raise InputError(f"its function returns a complex number; {wanted}, as by jnp.real")
    if row.dtype == "uint8" and value.dtype not in (np.bool_, np.uint8):
        raise InputError(
            f"its function returns {value.dtype}, and dtype uint8 is for a truth value; return "
            "one, or a number .astype('uint8'), or choose float64"
        )
    return value
