"""The body: three segments above the feet, from published values or scaled from height and mass.

Segments are shank, thigh and upper body, in this order; both legs together. Lengths are measured
along the upright body, centres of mass from the lower end of the segment.
"""

import math
from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from standfast.anthropometry.tables import DE_LEVA, WINTER, SegmentRow, upper_body
from standfast.errors import InputError, says_its_arguments
from standfast.numerics.arrays import Array, Scalar, in_numpy, is_of_jax, is_traced, namespace
from standfast.parameters import (
    OWN_BODY,
    PARAMETERS,
    SEGMENT_NUMBERS,
    SEGMENT_PARAMETERS,
    SEGMENTS,
    check_bmi,
    checked_choice,
    checked_number,
    checked_scalar,
    is_typed_in,
    is_written,
)


class _BodyFields(NamedTuple):
    segment_mass: Array
    segment_inertia: Array
    segment_length: Array
    segment_com: Array


class Body(_BodyFields):
    """Mass and geometry of one person, as a named tuple of float64 arrays (so a JAX pytree too).

    Attributes
    ----------
    segment_mass : (3,), kg
        shank, thigh, upper body (both legs together, without the feet).
    segment_inertia : (3,), kg·m²
        about the segment's own centre of mass and the medio-lateral axis.
    segment_length : (2,), m
        shank (ankle to knee) and thigh (knee to hip).
    segment_com : (3,), m
        centre of mass above the lower end: ankle, knee, hip.

    Numbers and lists of numbers are checked. Arrays of JAX pass, because JAX keeps in bodies also
    what is none, as slopes: the functions that are given a body check them, but for values that are
    being traced. Arrays with an axis more, the bodies of a batch, pass too.

    Raises
    ------
    InputError
        for a wrong number of segments, text, NaN, or a value that no body has.

    Examples
    --------
    >>> import standfast as sf
    >>> body = sf.Body(
    ...     segment_mass=(5.6, 14.2, 46.8),
    ...     segment_inertia=(0.085, 0.24, 2.72),
    ...     segment_length=(0.385, 0.405),
    ...     segment_com=(0.22, 0.235, 0.344),
    ... )
    >>> float(body.segment_mass.sum())
    66.6
    >>> sf.is_stable(body, sf.Stiffness(900, 1500, 400))
    False
    """

    __slots__ = ()

    @says_its_arguments("from height and mass it is Body.from_height_mass(height, mass)")
    def __new__(
        cls, segment_mass: Any, segment_inertia: Any, segment_length: Any, segment_com: Any
    ) -> "Body":
        """Check every plain value and keep it as a read-only float64 array."""
        parts = (segment_mass, segment_inertia, segment_length, segment_com)
        if any(part is None for part in parts) and not any(map(is_typed_in, parts)):
            return super().__new__(cls, *parts)  # None alone is a mark of a program
        return super().__new__(cls, *map(checked_segments, cls._fields, parts, (3, 3, 2, 3)))

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Body) and all(map(np.array_equal, self, other))

    def __ne__(self, other: object) -> bool:
        return not self == other

    __hash__ = None  # type: ignore[assignment] # arrays have none either

    def _replace(self, **changes: Any) -> "Body":
        """Return a body with some values changed, checked like any other."""
        return Body(**{**self._asdict(), **changes})

    @classmethod
    def edwards2007(cls) -> "Body":
        """Return the nominal person of Gait & Posture 25 (2007) 432-439: 75.3 kg, 1.753 m.

        Values as listed in the paper's nomenclature (after Chaffin & Andersson 1984).

        Examples
        --------
        >>> import standfast as sf
        >>> sf.Body.edwards2007().segment_mass
        array([ 6.478, 15.059, 51.648])
        """
        return REFERENCE_PEOPLE["edwards2007"].body

    @classmethod
    @says_its_arguments()
    def from_height_mass(cls, height: float, mass: float, model: str = "winter") -> "Body":
        """Return a person of ``height`` (m) and ``mass`` (kg) with the proportions of ``model``.

        Masses scale with body mass, lengths with height, inertias with mass · height².

        Raises
        ------
        InputError
            for a model that is not known, or a height or mass out of range.

        Examples
        --------
        >>> import standfast as sf
        >>> body = sf.Body.from_height_mass(1.80, 80.0, model="de-leva-male")
        >>> body.segment_length.round(3)
        array([0.455, 0.436])
        """
        reference = REFERENCE_PEOPLE[checked_choice("body_model", model)]
        size = {"height": checked_scalar("height", height), "mass": checked_scalar("mass", mass)}
        if not is_traced(*size.values()):
            check_bmi("mass", **{name: float(value) for name, value in size.items()})
        return body_of({"body_model": reference, **size})


class ReferencePerson(NamedTuple):
    """A body whose height (m) and mass (kg) are known, from which others are scaled."""

    body: Body
    height: Scalar
    mass: Scalar


def body_of(given: Mapping[str, Any]) -> Body:
    """Return the body that parameters by name describe: the one way to it.

    ``given`` holds the person's own segments by the names of ``OWN_BODY``; or ``body_model``, a
    :class:`ReferencePerson`, ``height`` (m), and ``mass`` (kg) or ``bmi`` (kg/m²), of which
    mass = BMI · height². Numbers may be traced, or fractions.
    """
    if OWN_BODY[0] in given:
        parts = ([given[name] for name in names] for names in SEGMENT_NUMBERS.values())
        return Body._make(_frozen(namespace(*part).stack(part)) for part in parts)
    reference: ReferencePerson = given["body_model"]
    height = given["height"]
    mass = given["mass"] if "mass" in given else given["bmi"] * height**2
    body, taller, heavier = reference.body, height / reference.height, mass / reference.mass
    xp = namespace(*body, taller, heavier)
    taller, heavier = xp.asarray(taller), xp.asarray(heavier)
    scaled = (
        body.segment_mass * heavier,
        body.segment_inertia * (heavier * taller**2),
        body.segment_length * taller,
        body.segment_com * taller,
    )
    return Body._make(map(_frozen, scaled))


def named_body(given: Mapping[str, Any]) -> Body:
    """Return :func:`body_of` parameters as a study says them: the model, if any, by its name."""
    if "body_model" not in given:
        return body_of(given)
    return body_of({**given, "body_model": REFERENCE_PEOPLE[str(given["body_model"])]})


def implausible(given: Mapping[str, float]) -> str | None:
    """Return in words why nobody has such segments, by the names of ``OWN_BODY``; None if one may.

    The centre of mass lies within the segment, whose radius of gyration √(I/m) is shorter than it
    (of the upper body: than twice the height of its centre of mass); all weigh as much as a person.
    """
    for segment in SEGMENTS:
        words = segment.replace("_", " ")
        mass, inertia, com = (given[f"{segment}_{part}"] for part in ("mass", "inertia", "com"))
        length = given.get(f"{segment}_length", 2.0 * com)
        if not com < length:
            return (
                f"the centre of mass of the {words} lies {com:g} m above its lower end, but the "
                f"{words} is {length:g} m long"
            )
        gyration = math.sqrt(inertia / mass)
        if not gyration < length:
            return (
                f"the {words} of {mass:g} kg and {inertia:g} kg·m² has a radius of gyration of "
                f"{gyration:.3g} m, and must be below {length:.3g} m; inertia is about the "
                f"segment's own centre of mass{_in_kg_cm2(inertia, mass, length)}"
            )
    total = math.fsum(given[name] for name in SEGMENT_NUMBERS["segment_mass"])
    row = PARAMETERS["mass"]
    if not row.lowest <= total <= row.highest:
        return f"the segments weigh {total:g} kg together, and a person {row.allowed}"
    return None


def _in_kg_cm2(inertia: float, mass: float, length: float) -> str:
    """Say if an inertia that no segment has would be one's in kg·cm²."""
    likely = 0.1 * length < math.sqrt(1e-4 * inertia / mass) < length
    return f"; in kg·cm²? write {1e-4 * inertia:g}" if likely else ""


def checked_segments(name: str, values: Any, count: int) -> Array:
    """Check the numbers of one person's segments; let those of programs and of a batch pass."""
    values = values if is_of_jax(values) else in_numpy(values)
    if not is_written(values) or (isinstance(values, np.ndarray) and values.ndim > 1):
        return values
    row = SEGMENT_PARAMETERS[name]
    segments = ("shank", "thigh", "upper body")[:count]
    if not isinstance(values, list | tuple | np.ndarray) or len(values) != count:
        raise InputError(
            f"{name} = {values!r} is not {count} numbers; give {', '.join(segments)} in {row.unit}"
        )
    if any(namespace(value) is not np for value in values):
        return namespace(*values).stack(list(values))
    numbers = [
        checked_number(f"{name} of the {segment}", value, row=row)
        for segment, value in zip(segments, values, strict=True)
    ]
    return _frozen(np.array(numbers))


def _frozen(array: Array) -> Array:
    if isinstance(array, np.ndarray):
        array.flags.writeable = False
    return array


def _unit_person(
    table: Mapping[str, SegmentRow], upper: tuple[float, float, float]
) -> ReferencePerson:
    """Return a person of 1 m and 1 kg, whose values no check of a real body would pass."""
    legs = (table["shank"], table["thigh"])
    mass, com, inertia = upper
    columns = (
        [*(row.total_mass for row in legs), mass],
        [*(row.inertia for row in legs), inertia],
        [row.length for row in legs],
        [*(row.com_above_lower_end for row in legs), com],
    )
    body = Body._make(_frozen(np.array(column)) for column in columns)
    return ReferencePerson(body, height=1.0, mass=1.0)


# Each is of one of PARAMETERS["body_model"].choices.
REFERENCE_PEOPLE = {
    "edwards2007": ReferencePerson(
        height=1.753,
        mass=75.3,  # the text also says 75 and 75.2; the listed masses fit 75.3
        body=Body(
            segment_mass=(6.478, 15.059, 51.648),
            segment_inertia=(0.122, 0.291, 3.012),
            segment_length=(0.431, 0.430),
            segment_com=(0.245, 0.244, 0.356),
        ),
    ),
    "winter": _unit_person(WINTER, WINTER["upper body"].mass_com_inertia),
    **{model: _unit_person(table, upper_body(model)) for model, table in DE_LEVA.items()},
}

BODY_SOURCES = {
    "edwards2007": "Gait & Posture 25 (2007) 432-439, nomenclature, after Chaffin & Andersson 1984",
    "winter": "Dempster via Winter, Biomechanics and Motor Control of Human Movement, table 4.1",
    "de-leva-male": "de Leva, J Biomech 29 (1996) 1223-1230, table 4; upper body composed here",
    "de-leva-female": "de Leva, J Biomech 29 (1996) 1223-1230, table 4; upper body composed here",
}
