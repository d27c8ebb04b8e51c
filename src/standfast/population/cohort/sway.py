"""Persons with noise in their joints' torques: how much those who stand sway."""

from collections.abc import Mapping, Sequence

import numpy as np

from standfast.engine.mapping import in_batches
from standfast.parameters import JOINTS, NOISES, STIFFNESSES
from standfast.population.cohort.nerves import ENTRIES, FEW, TOGETHER, FedBackPersons
from standfast.stability.delay.problem import Apply, directly
from standfast.stability.sway.answers import ROWS, frequency_of
from standfast.stability.sway.persons import damped, swaying_of, variances

ACCURACY = 1e-6  # of variances, relative: bins are 4e-3 wide, and what is kept has six digits


def swayed(found: FedBackPersons, names: Sequence[str]) -> tuple[dict[str, np.ndarray], np.ndarray]:
    """Return quantities of sway by their names (SI), and whether each person's are all accurate.

    Of persons with noise, (persons,) each. Who does not stand, or is not damped, has deviations of
    ``inf`` and a frequency of NaN; NaN too, and not accurate, are those of whom rounding leaves
    open whether they stand, and what cannot be integrated.
    """
    size = found.stands.size
    apply = in_batches if size > FEW else directly
    pieces, certain = [], []
    for first in range(0, size, TOGETHER):
        at = slice(first, min(first + TOGETHER, size))
        piece = {name: values[at] for name, values in found.numbers.items()}
        values, sure = _of_piece(piece, found.stands[at], found.undecided[at], names, apply)
        pieces.append(values)
        certain.append(sure)
    whole = {name: np.concatenate([each[name] for each in pieces]) for name in names}
    return whole, np.concatenate(certain)


def _of_piece(
    found: Mapping[str, np.ndarray],
    stands: np.ndarray,
    undecided: np.ndarray,
    names: Sequence[str],
    apply: Apply,
) -> tuple[dict[str, np.ndarray], np.ndarray]:
    matrices = np.stack([found[name] for name in ENTRIES]).reshape(5, 3, 3, -1)
    rigid = np.array([np.isinf(found[name]) for name in STIFFNESSES])
    delay = found["feedback_delay"]
    none = np.zeros(delay.size)
    swaying = swaying_of(
        matrices,
        rigid,
        delay,
        np.array([found.get(name, none) for name in NOISES]),
        np.array([found[f"load_{joint}"] for joint in JOINTS]),
        found["weight"],
    )
    dies_out = damped(matrices, rigid, delay)
    rows = tuple(dict.fromkeys(row for name in names for row in ROWS[name]))
    values, sure = variances(
        rows,
        swaying,
        stands & dies_out,
        undecided=undecided & dies_out,
        accuracy=ACCURACY,
        apply=apply,
    )
    of_row = dict(zip(rows, values, strict=True))
    certain: np.ndarray = np.logical_and.reduce(sure)
    return {name: _quantity(*(of_row[row] for row in ROWS[name])) for name in names}, certain


def _quantity(size: np.ndarray, times_omega: np.ndarray | None = None) -> np.ndarray:
    deviation: np.ndarray = np.sqrt(size)
    return deviation if times_omega is None else frequency_of(size, times_omega)
