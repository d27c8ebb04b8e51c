"""What the page asks the program to compute: planes with feedback or noise, and one person's facts.

Whatever is asked goes through the border of a study first.
"""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from standfast.atlas.memory import arrays_of
from standfast.engine.delays import FEW
from standfast.errors import InputError, nearest_name, shortened
from standfast.explore.sliders import OWN, SCALED
from standfast.mechanics.feedback import delay_of, equation_of
from standfast.parameters import JOINTS, OWN_BODY, PARAMETERS
from standfast.quantities.person_facts import facts_of_sway, facts_with_feedback, person_of
from standfast.stability.delay.spectrum import roots_from_the_right, shape_at
from standfast.study.canonical import Value, from_json
from standfast.study.study import Study
from standfast.study.values import check_complete, checked_quantities, checked_value

MOST_POINTS = 401 * 401


class Live:
    """Answers what is computed as the reader asks; ``own`` are measured segments, by name."""

    def __init__(self, own: Mapping[str, float]) -> None:
        self.own = own

    def are_few(self, asked: Mapping[str, Any]) -> bool:
        """Return whether a plane has so few points that nothing is compiled for its feedback.

        Raises
        ------
        InputError
            if its axes are wrong.
        """
        (_, xs), (_, ys) = _axes(asked)
        return len(xs) * len(ys) <= FEW

    def planes(self, asked: Mapping[str, Any], go_on: Callable[[], object]) -> list[np.ndarray]:
        """Return quantities on a plane, each (len y, len x), float64.

        Parameters
        ----------
        asked
            ``quantities``: names; ``x`` and ``y``: each ``name`` and rising ``values``;
            ``parameters``: the others by name.
        go_on
            called before each part of the work; what it raises ends it.

        Raises
        ------
        InputError
            naming what is wrong.
        """
        study, x, y = self._study(asked)
        arrays = arrays_of(study, go_on=go_on)
        shape = len(study.axes[y]), len(study.axes[x])
        found = []
        for name in study.quantities:
            values = arrays[name].astype(np.float64)
            axes = study.axes_of(name)
            if axes == (y,):
                values = values[:, None]
            found.append(np.broadcast_to(values, shape))
        return found

    def person(self, parameters: Any) -> dict[str, Any]:
        """Return verdict, delays, roots, shape and sway of one person with damping and feedback.

        Returns
        -------
        dict of what :func:`.facts_with_feedback` finds, and ``roots`` (from the right, imaginary
        part ≥ 0) and ``shape`` (rotations of ankle, knee, hip at the rightmost root, those of rigid
        joints 0; None if it is not proven), numbers as real and imaginary part; and ``sway``, what
        :func:`.facts_of_sway` finds.

        Raises
        ------
        InputError
            naming what is wrong.
        """
        given = self._checked(parameters)
        check_complete(given)
        person = person_of(given)
        facts = facts_with_feedback(person)
        equation = equation_of(person.body, person.stiffness, person.gravity, person.given)
        free = np.flatnonzero(np.isfinite(np.array(person.stiffness.joints, float)))
        numbers = np.array(equation, np.float64)[:, free][:, :, free]
        delay = float(delay_of(person.given))
        first = shape = None
        if free.size and facts["rightmost_root"] is not None:
            first = complex(*facts["rightmost_root"])
            whole = np.zeros(len(JOINTS), complex)
            whole[free] = shape_at(numbers, delay, first)
            shape = _parts(whole)
        roots = roots_from_the_right(numbers, delay, rightmost=first)
        return facts | {"roots": _parts(roots), "shape": shape, "sway": facts_of_sway(person)}

    def _study(self, asked: Mapping[str, Any]) -> tuple[Study, str, str]:
        """Check what is asked; return it as a study whose first axis is y, and names of x and y."""
        _require(asked, "quantities", "parameters")
        quantities = checked_quantities({"quantities": asked["quantities"]})
        (x, xs), (y, ys) = _axes(asked)
        if x == y:
            raise InputError(f"a plane needs two axes, and {x} is given twice")
        if len(xs) * len(ys) > MOST_POINTS:
            raise InputError(
                f"a plane of {len(xs)} × {len(ys)} points is asked; at most {MOST_POINTS} are "
                "computed"
            )
        others = self._checked(asked["parameters"])
        parameters: dict[str, Value] = {
            name: value for name, value in others.items() if name not in (x, y)
        }
        for name, values in ((y, ys), (x, xs)):
            parameters[name] = checked_value(name, PARAMETERS[name], values)
        check_complete(parameters)
        return Study("", parameters, quantities), x, y

    def _checked(self, given: Any) -> dict[str, Any]:
        """Check parameters of one value; put measured segments where the page says ``own``."""
        if not isinstance(given, Mapping):
            raise InputError(f"parameters = {shortened(given)} are not values by name")
        given = dict(given)
        if self.own and given.get("body_model", OWN) == OWN:
            given = {name: value for name, value in given.items() if name not in SCALED}
            given = {**self.own, **given}
        found: dict[str, Any] = {}
        for name, value in given.items():
            row = PARAMETERS.get(name)
            if row is None:
                known = nearest_name(name, PARAMETERS)
                raise InputError(f"there is no parameter {shortened(name)}{known}")
            found[name] = checked_value(name, row, from_json(value))
            if not isinstance(found[name], float | str):
                raise InputError(f"{name} has several values, and is no axis of the plane")
        return found


def _require(asked: Mapping[str, Any], *keys: str) -> None:
    for key in keys:
        if key not in asked:
            raise InputError(f"{key} is missing in what is asked")


def _axes(asked: Mapping[str, Any]) -> list[tuple[str, Sequence[Any]]]:
    """Check names and values of the axes of a plane, x and y."""
    _require(asked, "x", "y")
    return [_axis(key, asked[key]) for key in ("x", "y")]


def _axis(key: str, given: Any) -> tuple[str, Sequence[Any]]:
    """Check name and values of an axis of a plane; each value is checked as others are."""
    if not isinstance(given, Mapping) or not {"name", "values"} <= given.keys():
        raise InputError(f"{key} = {shortened(given)} is not an axis, a name and values")
    name, values = given["name"], given["values"]
    if not isinstance(name, str) or name not in PARAMETERS or PARAMETERS[name].choices:
        raise InputError(f"{key}: {shortened(name)} is no parameter that is a number")
    if name in OWN_BODY:
        raise InputError(f"{key}: {name} is measured, and no axis of a plane that is computed")
    if not isinstance(values, list) or len(values) < 2:
        raise InputError(f"{key}: {shortened(values)} are not two values or more")
    return name, values


def _parts(values: np.ndarray) -> list[list[float]]:
    """Return complex numbers as pairs of real and imaginary part."""
    return [[float(value.real), float(value.imag)] for value in values]
