"""Persons whose stiffness lies within rounding of its threshold, settled in exact arithmetic.

Stiffness that is said as a multiple of a load, as 1.0 of mgh, may lie right at the threshold in
everybody; floating point would then throw dice for each. The kernels say who is near a threshold;
of these alone rounding is bounded, and who is in doubt is asked again, here. The body is taken as
drawn, float by float, and the multiple as the law has it; a person right at the threshold falls.
"""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from standfast.anthropometry.body import Body
from standfast.engine.mapping import map_over_batch
from standfast.numerics.arrays import Scalar, namespace
from standfast.parameters import JOINTS, STIFFNESSES
from standfast.population.cohort.cohort import Cohort
from standfast.population.cohort.histograms import bin_of
from standfast.population.cohort.persons import CohortModel, in_doubt, person_of
from standfast.stability.exact import stands_exactly

# Persons whose bodies are computed again at once.
TOGETHER = 4096
# Beside a safety factor, or a multiple, of 1: at it a person falls. In bins what is not above 1 is
# below the edge between two of them.
ABOVE_1, BELOW_1 = np.nextafter(1.0, 2.0), np.nextafter(1.0, 0.0)
PARTS = tuple((name, n) for name, n in zip(Body._fields, (3, 3, 2, 3), strict=True))


class Settled(NamedTuple):
    """Persons who were in doubt: where they stand in a block, and what became of them."""

    rows: np.ndarray
    stand: np.ndarray  # by exact arithmetic
    rigid: np.ndarray  # (3, rows): ankle, knee, hip


def settled(cohort: Cohort, numbers: np.ndarray, near: np.ndarray) -> Settled:
    """Settle those persons of a block whom rounding could decide, all of whom are ``near``.

    ``numbers`` (names, persons) are those of :meth:`.Cohort.numbers`; ``near`` are of these persons
    or of the first of them.
    """
    candidates = np.flatnonzero(near)
    drawn = map_over_batch(_as_drawn, cohort.model, cohort.names)
    loads = [
        _load_of(joint, each.relative_to)
        for joint, each in zip(JOINTS, cohort.model.stiffness, strict=True)
    ]
    pieces = []
    for first in range(0, candidates.size, TOGETHER):
        rows = candidates[first : first + TOGETHER]
        found = drawn(numbers[:, rows])
        doubted = np.flatnonzero(found["in_doubt"])
        found = {name: values[doubted] for name, values in found.items()}
        parts = ([found[f"{name}{i}"] for i in range(count)] for name, count in PARTS)
        multiples = np.array([found[name] for name in STIFFNESSES])
        body = Body._make(map(np.array, parts))
        stand = stands_exactly(body, cohort.model.gravity, multiples, loads)
        pieces.append((rows[doubted], stand, np.isinf(multiples)))
    rows, stand, rigid = (np.concatenate(each, axis=-1) for each in zip(*pieces, strict=True))
    return Settled(rows, stand, rigid)


def settle_persons(cohort: Cohort, numbers: np.ndarray, found: dict[str, np.ndarray]) -> None:
    """Put into ``found`` the exact verdicts ``stable``, and safety factors that agree with them."""
    if not found["near"].any():
        return
    rows, stand, _ = settled(cohort, numbers, found["near"])
    found["stable"] = found["stable"].copy()
    found["stable"][rows] = stand
    found["safety_factor"] = _on_its_side(found["safety_factor"], rows, stand)


def settle_bins(cohort: Cohort, numbers: np.ndarray, found: dict[str, np.ndarray]) -> np.ndarray:
    """Put exact verdicts into classes of ``found``, and bins that agree with them; return how many.

    Who stands has a safety factor above 1, and needs of no joint as much as it has.
    """
    if not found["near"].any():
        return np.zeros(1, np.int64)
    rows, stand, rigid = settled(cohort, numbers, found["near"])
    classes = found["class"] = found["class"].copy()
    classes[rows] += (~stand).astype(classes.dtype) - (classes[rows] & 1)
    if "safety_factor" in found:
        values = "value_of_safety_factor"
        found[values] = _on_its_side(found[values], rows, stand)
        found["safety_factor"] = found["safety_factor"].copy()
        found["safety_factor"][rows] = bin_of(found[values][rows])
        for joint, is_rigid in zip(JOINTS, rigid, strict=True):
            values = f"value_of_multiple_{joint}"
            needed = _on_its_side(found[values], rows, ~stand)
            needed[rows] = np.where(is_rigid, np.where(stand, 0.0, np.inf), needed[rows])
            found[values] = needed
            found[f"multiple_{joint}"] = found[f"multiple_{joint}"].copy()
            found[f"multiple_{joint}"][rows] = bin_of(needed[rows])
    return np.array([rows.size])


def _on_its_side(values: np.ndarray, rows: np.ndarray, above: np.ndarray) -> np.ndarray:
    """Return values of which those of ``rows`` are above 1, or not above it."""
    moved = values.copy()
    moved[rows] = np.where(
        above, np.maximum(moved[rows], ABOVE_1), np.minimum(moved[rows], BELOW_1)
    )
    return moved


def _load_of(joint: str, relative_to: str) -> int | None:
    """Return which joint's load a stiffness is a multiple of."""
    if relative_to == "absolute":
        return None
    return 0 if relative_to == "mgh" else JOINTS.index(joint)


def _as_drawn(model: CohortModel, given: Mapping[str, Scalar]) -> dict[str, Scalar]:
    """Return a person's body entry by entry, its stiffnesses as their laws have them, any doubt."""
    person = person_of(model, given)
    body = person.body
    xp = namespace(*body)
    entries = {f"{name}{i}": getattr(body, name)[i] for name, count in PARTS for i in range(count)}
    numbers = {
        name: xp.asarray(each.value(given.get(joint), given.get(name), 1.0), xp.float64)
        for joint, name, each in zip(JOINTS, STIFFNESSES, model.stiffness, strict=True)
    }
    return {**entries, **numbers, "in_doubt": in_doubt(model, person)}
