"""The fraction unstable of classes of people: by sex, age, both, BMI and height."""

from typing import Any

import numpy as np

from standfast.population.cohort.histograms import BMI_EDGES, HEIGHT_EDGES
from standfast.population.people.classes import BMI_CLASSES, HEIGHT_CLASSES, size_classes
from standfast.population.people.words import SEXES
from standfast.population.summary.estimators import fraction

Strata = tuple[tuple[str, str], ...]  # sex and age class of each


def fractions_of_strata(
    classes: np.ndarray, strata: Strata, ages: tuple[str, ...]
) -> dict[str, dict[str, Any]]:
    """Return share, size and fraction unstable of each class that anybody is in.

    ``classes`` are counts (replicate, stratum, height, BMI, verdict) of :class:`.Histograms`.
    """
    by_stratum = classes.sum(axis=(2, 3))  # replicate, stratum, verdict
    counts: dict[str, dict[str, np.ndarray]] = {}  # (replicate, verdict) by kind and class
    for number, (key, order) in enumerate({"sex": SEXES, "age": ages}.items()):
        of_strata = np.array([stratum[number] for stratum in strata])
        counts[key] = {
            label: by_stratum[:, of_strata == label].sum(axis=1)
            for label in sorted(set(of_strata.tolist()), key=order.index)
        }
    counts["sex_and_age"] = {
        f"{sex} {age}": by_stratum[:, number] for number, (sex, age) in enumerate(strata)
    }
    fine = {
        "bmi": (classes.sum(axis=(1, 2)), BMI_EDGES, BMI_CLASSES),
        "height": (classes.sum(axis=(1, 3)), HEIGHT_EDGES, HEIGHT_CLASSES),
    }
    for key, (by_bin, edges, limits) in fine.items():
        # the first of the fine bins is all that lies below the first edge
        cuts = [0, *(1 + int(np.argmin(abs(edges - limit))) for limit in limits)]
        sums = np.add.reduceat(by_bin, cuts, axis=1).swapaxes(0, 1)
        counts[key] = dict(zip(size_classes(limits), sums, strict=True))
    everybody = int(classes.sum())
    return {
        key: {label: _told(each, everybody) for label, each in of_key.items() if each.any()}
        for key, of_key in counts.items()
    }


def _told(counts: np.ndarray, everybody: int) -> dict[str, Any]:
    """Return size, share and risk of the persons counted (replicate, verdict)."""
    persons = counts.sum(axis=1)
    unstable = fraction(counts[:, 1], persons)
    return {
        "persons": int(persons.sum()),
        "share": float(persons.sum() / everybody),
        **unstable.told("unstable_fraction", "interval"),
    }
