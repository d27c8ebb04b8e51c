"""The body of one person of many: scaled by a stratum's model, or of their own segments."""

from collections.abc import Iterable, Mapping, Sequence

import numpy as np

from standfast.anthropometry.body import REFERENCE_PEOPLE, Body, body_of
from standfast.numerics.arrays import Scalar, namespace
from standfast.parameters import OWN_BODY
from standfast.population.people.records import People

# The people of one stratum, say of one sex, are scaled by one model; of each stratum its name, or
# one name for all.
Models = tuple[str, ...]


def model_of_sex(body_model: str | Mapping[str, str], sex: str) -> str:
    """Return the body model of a sex: that of all, or of ``female``, ``male`` or ``other``."""
    if isinstance(body_model, str):
        return body_model
    return body_model.get(sex, body_model["other"])


def models_of_sexes(body_model: str | Mapping[str, str], sexes: Iterable[str]) -> Models:
    """Return the model of each sex; one for all, so one program, if they do not differ."""
    models = tuple(model_of_sex(body_model, sex) for sex in sexes)
    return models if len(set(models)) > 1 else models[:1]


def scaled_body(models: Models, stratum: Scalar, height: Scalar, mass: Scalar) -> Body:
    """Return the body that height (m) and mass (kg) give in the model of a stratum, a number."""
    size = {"height": height, "mass": mass}
    names = tuple(dict.fromkeys(models))
    bodies = [body_of({"body_model": REFERENCE_PEOPLE[name], **size}) for name in names]
    chosen = bodies[0]
    for name, body in zip(names[1:], bodies[1:], strict=True):
        of_it = _is_any(stratum, [number for number, own in enumerate(models) if own == name])
        chosen = _where(of_it, body, chosen)
    return chosen


def with_own_segments(scaled: Body, given: Mapping[str, Scalar]) -> Body:
    """Return a person's own segments, or the scaled body where they were not measured (NaN)."""
    if OWN_BODY[0] not in given:
        return scaled
    measured = given[OWN_BODY[0]] == given[OWN_BODY[0]]
    return _where(measured, body_of({name: given[name] for name in OWN_BODY}), scaled)


def _is_any(stratum: Scalar, numbers: Sequence[int]) -> Scalar:
    found = stratum == numbers[0]
    for number in numbers[1:]:
        found = found | (stratum == number)
    return found


def _where(condition: Scalar, one: Body, other: Body) -> Body:
    xp = namespace(condition, *one, *other)
    return Body._make(xp.where(condition, a, b) for a, b in zip(one, other, strict=True))


def models_of(
    people: People, body_model: str | Mapping[str, str]
) -> tuple[Models, dict[str, np.ndarray]]:
    """Return the models of all, and the numbers that make each one's body."""
    sexes = tuple(dict.fromkeys(people.sex))
    models = models_of_sexes(body_model, sexes)
    numbers = {"height": people.height, "mass": people.mass}
    if len(models) > 1:
        numbers["stratum"] = np.array([sexes.index(sex) for sex in people.sex], np.float64)
    own = {name: people.measured[name] for name in OWN_BODY if name in people.measured}
    return models, {**numbers, **own}


def body_in(models: Models, given: Mapping[str, Scalar]) -> Body:
    """Return the body of one person by the numbers of :func:`models_of`."""
    scaled = scaled_body(models, given.get("stratum", 0.0), given["height"], given["mass"])
    return with_own_segments(scaled, given)
