"""One row of a file of people becomes a person, or is refused."""

import math
from collections.abc import Callable, Collection, Container, Mapping
from typing import NamedTuple

from standfast.errors import InputError
from standfast.parameters import PARAMETERS, Parameter, checked_number, number_in
from standfast.population.people.csv_table import MEASURABLE
from standfast.population.people.entries import WEIGHT
from standfast.population.people.own_segments import check_body
from standfast.population.people.words import age_of, is_nothing, is_top_coded, sex_of


class Wanted(NamedTuple):
    """Who is wanted of a file, and what must be known of them.

    ``needed`` are measured parameters; ``selected`` tells from sex and age whether a person is
    wanted; ``readable`` are those of sex and age without which a row is refused if it says
    something that cannot be read.
    """

    needed: Collection[str] = ()
    selected: Callable[[str, float], bool] | None = None
    readable: Collection[str] = ()


def checked_person(
    row: Mapping[str, str], columns: Container[str], wanted: Wanted
) -> dict[str, object] | None:
    """Check one person; None if not of those selected.

    ``unreadable`` holds what stands there for a sex or an age that is taken as unknown.
    """
    sex, age, unreadable = _sex_and_age(row, wanted.readable)
    if wanted.selected is not None and not wanted.selected(sex, age):
        return None
    top_coded = is_top_coded(row.get("age", "")) and not math.isnan(age)
    person: dict[str, object] = {"sex": sex, "age": age, "top_coded": top_coded}
    person["unreadable"] = unreadable
    for field in ("height", "mass"):
        if is_nothing(row[field]):
            raise InputError(f"no {field}")
        person[field] = _number(row[field], field, PARAMETERS[field])
    if row.get("pregnant", "") in ("1", "1.0"):
        raise InputError("pregnant, for which no body model holds")
    weight = row.get("weight")
    if "weight" in columns and weight is None:
        raise InputError("no weight: the id is in no file of weights")
    person["weight"] = 1.0 if weight is None else _number(weight, "weight", WEIGHT)
    for name in MEASURABLE:
        if name in columns:
            entry = row.get(name, "")
            if name in wanted.needed and is_nothing(entry):
                raise InputError(f"no {name}")
            person[name] = math.nan if is_nothing(entry) else _number(entry, name, PARAMETERS[name])
    check_body(person)
    return person


def _sex_and_age(
    row: Mapping[str, str], readable: Collection[str]
) -> tuple[str, float, dict[str, str]]:
    """Return sex and age, unknown where they cannot be read, and what stands there then."""
    sex, age = "unknown", math.nan
    unreadable = {}
    try:
        sex = sex_of(row.get("sex", ""))
    except InputError:
        if "sex" in readable:
            raise
        unreadable["sex"] = row["sex"]
    try:
        age = age_of(row.get("age", ""))
    except InputError:
        if "age" in readable:
            raise
        unreadable["age"] = row["age"]
    return sex, age, unreadable


def _number(entry: str, name: str, row: Parameter) -> float:
    try:
        number: float | str = number_in(entry)
    except ValueError:
        number = entry
    return checked_number(name, number, row=row)
