"""Counts over persons, in integers: the same whatever the order in which blocks are added.

Values are counted in bins that divide each power of two evenly into 256, so a bin is found from the
leading bits of the number, without a logarithm, and is at most 0.4 % wide.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from standfast.numerics.arrays import Scalar, namespace
from standfast.parameters import JOINTS
from standfast.population.cohort.persons import CohortModel, near, outcome, person_of
from standfast.stability.springs import verdict

BITS_PER_OCTAVE = 8
LOWEST_OCTAVE, OCTAVES = -12, 36  # 0.0002 to 16 million
VALUE_BINS = OCTAVES << BITS_PER_OCTAVE
_SHIFT = 52 - BITS_PER_OCTAVE
_FIRST = (1023 + LOWEST_OCTAVE) << BITS_PER_OCTAVE
# Of a metre, rad, m/s or Hz: bins begin at 0.0002 of these. A power of two, so nothing is rounded.
SWAY_BINS_PER_UNIT = 1024.0
# Beside the bins of values: who has no sway, and of whom it is open.
NO_SWAY, OPEN_SWAY, SWAY_BINS = VALUE_BINS + 2, VALUE_BINS + 3, VALUE_BINS + 4
# What is told as one number where it is the same in everybody: of springs, and with feedback.
EXTREMES = (
    "safety_factor",
    *(f"{kind}_{joint}" for joint in JOINTS for kind in ("critical", "multiple")),
)
EXTREMES_FED_BACK = ("critical_delay", "delay_margin")
# The fine bins of the risk map.
HEIGHT_STEP, HEIGHT_BINS, HEIGHT_START = 0.025, 40, 1.2  # m
BMI_STEP, BMI_BINS, BMI_START = 0.5, 120, 10.0  # kg/m²
HEIGHT_EDGES = np.round(HEIGHT_START + HEIGHT_STEP * np.arange(HEIGHT_BINS + 1), 3)
BMI_EDGES = BMI_START + BMI_STEP * np.arange(BMI_BINS + 1)


def bin_of(value: Scalar) -> Scalar:
    """Return the bin of a value: 0 for what is too small, the last one for what is too large."""
    xp = namespace(value)
    bits = xp.asarray(value).view(xp.int64) >> _SHIFT
    return xp.clip(bits - _FIRST + 1, 0, VALUE_BINS + 1).astype(xp.int32)


def bin_edges() -> np.ndarray:
    """Return the edges of the value bins, (VALUE_BINS + 1,)."""
    bits = (np.arange(VALUE_BINS + 1, dtype=np.int64) + _FIRST) << _SHIFT
    return bits.view(np.float64)


def signed_bin_of(value: np.ndarray) -> np.ndarray:
    """Return the bin of a value of either sign: those of its size, mirrored, and one between."""
    middle = VALUE_BINS + 1
    bins: np.ndarray = np.where(value < 0.0, middle - bin_of(-value), middle + bin_of(value))
    return bins


def signed_bin_edges() -> np.ndarray:
    """Return the edges of the bins of either sign, (2 VALUE_BINS + 2,)."""
    edges = bin_edges()
    return np.concatenate([-edges[::-1], edges])


def bins_of(model: CohortModel, given: dict[str, Scalar]) -> dict[str, Scalar]:
    """Return the bins in which one person is counted, and the loads, which are added up.

    ``class`` is the bin of stratum, height, BMI and verdict, which may be in doubt (``near``);
    bins 0 and last are what lies outside. ``value_of_…`` are the numbers of EXTREMES themselves.
    """
    found = outcome(model, given)
    bins: dict[str, Any] = {
        "class": _class(found["stratum"], found["height"], found["mass"], found["stable"]),
        "near": found["near"],
        "safety_factor": bin_of(found["safety_factor"]),
        "value_of_safety_factor": found["safety_factor"],
    }
    for joint in JOINTS:
        bins[f"critical_{joint}"] = bin_of(found[f"critical_{joint}_stiffness"])
        bins[f"multiple_{joint}"] = bin_of(found[f"{joint}_multiple"])
        bins[f"load_{joint}"] = found[f"{joint}_load"]
        bins[f"value_of_critical_{joint}"] = found[f"critical_{joint}_stiffness"]
        bins[f"value_of_multiple_{joint}"] = found[f"{joint}_multiple"]
    return bins


def class_of(model: CohortModel, given: dict[str, Scalar]) -> dict[str, Scalar]:
    """Return the class of one person, as of :func:`bins_of`; its complement if it is near."""
    person = person_of(model, given)
    stands = verdict(person.body, person.stiffness, model.gravity)
    found = _class(person.stratum, person.height, person.mass, stands)
    xp = namespace(found)
    return {"class_or_near": xp.where(near(model, person), ~found, found)}


def classes_of(
    mapped: Callable[[np.ndarray], Mapping[str, np.ndarray]], numbers: np.ndarray, size: int
) -> dict[str, np.ndarray]:
    """Return ``class`` and ``near`` of the first ``size`` persons by :func:`class_of`, mapped.

    One number a person makes one loop of all: two of them take a fifth longer.
    """
    found = mapped(numbers)["class_or_near"][:size]
    is_near = np.zeros(size, bool)
    if found.min() < 0:
        is_near = found < 0
        found = np.where(is_near, ~found, found)
    return {"class": found, "near": is_near}


def _class(stratum: Scalar, height: Scalar, mass: Scalar, stable: Scalar) -> Scalar:
    xp = namespace(stratum, height, mass)

    def evenly(value: Scalar, start: float, step: float, bins: int) -> Scalar:
        # a hair is added, so that an edge itself falls into the bin above it
        number = xp.floor((value - start) * (1.0 / step) + 1e-9) + 1.0
        return xp.clip(number, 0.0, bins + 1.0)

    bmi = mass / height**2
    number = stratum * (HEIGHT_BINS + 2) + evenly(height, HEIGHT_START, HEIGHT_STEP, HEIGHT_BINS)
    number = number * (BMI_BINS + 2) + evenly(bmi, BMI_START, BMI_STEP, BMI_BINS)
    return (2.0 * number + xp.where(stable, 0.0, 1.0)).astype(xp.int32)


@dataclass
class Histograms:
    """Persons counted, in integers but for sums of loads and for extremes.

    ``classes`` is by stratum, height, BMI and verdict (0 stands, 1 falls); ``growth_rate`` of some
    of those who fall; ``required`` by joint, as threshold in N·m/rad and as multiple of its
    distribution; ``load_sums`` of the joints' loads and of their squares; ``rows`` how often each
    person of a file was sampled and stood, and was sampled and fell.

    With feedback ``critical_delay`` by stratum, ``delay_margin``, ``by_springs``, who would stand
    and fall by springs alone, and ``left_open``, persons of whom rounding leaves anything open,
    stand in the place of what springs alone decide; whatever is not asked is empty.

    ``settled`` are persons whom rounding left open by springs alone, settled in exact arithmetic;
    ``extremes`` holds the least of each of EXTREMES, and of each with the other sign.

    ``sway`` counts each quantity of sway that is asked in bins of SWAY_BINS_PER_UNIT times its
    number in SI; NO_SWAY is of who has none, because they fall or nothing damps them, OPEN_SWAY of
    whom it is open whether they fall, or how much they sway.
    """

    classes: np.ndarray  # (strata, heights + 2, BMIs + 2, 2)
    safety_factor: np.ndarray  # (VALUE_BINS + 2,)
    growth_rate: np.ndarray  # (VALUE_BINS + 2,)
    required: np.ndarray  # (3, 2, VALUE_BINS + 2)
    load_sums: np.ndarray  # (2, 3), N·m/rad
    rows: np.ndarray  # (rows, 2)
    critical_delay: np.ndarray  # (strata, VALUE_BINS + 2)
    delay_margin: np.ndarray  # (2 VALUE_BINS + 3,)
    by_springs: np.ndarray  # (2,)
    left_open: np.ndarray  # (1,)
    settled: np.ndarray  # (1,)
    extremes: np.ndarray  # (2, EXTREMES or EXTREMES_FED_BACK)
    sway: np.ndarray  # (quantities, strata, SWAY_BINS)

    @classmethod
    def empty(cls, strata: int, rows: int, fed_back: bool, sways: int) -> "Histograms":
        """Return histograms of no one."""

        def counts(*shape: int, asked: bool = True) -> np.ndarray:
            return np.zeros(shape if asked else (0,), np.int64)

        return cls(
            counts(*class_shape(strata)),
            counts(VALUE_BINS + 2, asked=not fed_back),
            counts(VALUE_BINS + 2, asked=not fed_back),
            counts(3, 2, VALUE_BINS + 2, asked=not fed_back),
            np.zeros((2, 3)),
            counts(rows, 2),
            counts(strata, VALUE_BINS + 2, asked=fed_back),
            counts(2 * VALUE_BINS + 3, asked=fed_back),
            counts(2, asked=fed_back),
            counts(1, asked=fed_back),
            counts(1),
            np.full((2, len(EXTREMES_FED_BACK if fed_back else EXTREMES)), np.inf),
            counts(sways, strata, SWAY_BINS, asked=sways > 0),
        )

    def add(self, parts: Mapping[str, np.ndarray]) -> None:
        """Add counts by name, in a fixed order because of the sums of loads."""
        for name, counts in parts.items():
            own = getattr(self, name)
            if name == "extremes":
                np.minimum(own, counts, out=own)
            else:
                own += counts

    @property
    def nbytes(self) -> int:
        """Length of :meth:`to_bytes`."""
        return sum(array.nbytes for array in vars(self).values())

    def to_bytes(self) -> bytes:
        """Return all as bytes, for a shard."""
        return b"".join(array.tobytes() for array in vars(self).values())

    @classmethod
    def from_bytes(
        cls, raw: bytes, strata: int, rows: int, fed_back: bool, sways: int
    ) -> "Histograms":
        """Read histograms of known sizes back."""
        histograms = cls.empty(strata, rows, fed_back, sways)
        start = 0
        for array in vars(histograms).values():
            array[...] = np.frombuffer(raw, array.dtype, array.size, start).reshape(array.shape)
            start += array.nbytes
        return histograms


def class_shape(strata: int) -> tuple[int, int, int, int]:
    """Return the shape of counts by stratum, height, BMI and verdict."""
    return strata, HEIGHT_BINS + 2, BMI_BINS + 2, 2


def counted(bins: np.ndarray) -> np.ndarray:
    """Return how often each bin of values occurs."""
    return np.bincount(bins, minlength=VALUE_BINS + 2)
