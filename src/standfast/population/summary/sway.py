"""How much the persons of a population sway: quantiles of all and by sex and age, in SI.

They are of those who stand and whom something damps; who has no sway is counted beside them, and so
is who is too near to falling to say how much.
"""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from standfast.population.cohort.cohort import Cohort
from standfast.population.cohort.histograms import (
    NO_SWAY,
    OPEN_SWAY,
    SWAY_BINS_PER_UNIT,
    Histograms,
    bin_edges,
)
from standfast.population.people.study import PopulationStudy
from standfast.population.people.words import SEXES
from standfast.population.summary.arrays import ages_of
from standfast.population.summary.estimators import Distribution
from standfast.quantities import QUANTITIES

SHARES_TOLD = (0.025, 0.25, 0.5, 0.75, 0.975)


class SwayFound:
    """The distributions of the quantities of sway that a study asks."""

    def __init__(
        self, study: PopulationStudy, cohort: Cohort, replicates: Sequence[Histograms]
    ) -> None:
        self.names, self.strata, self.ages = study.sway, cohort.strata, ages_of(study)
        # by replicate, quantity, stratum and bin
        self.counts = np.array([each.sway for each in replicates])

    def distribution(
        self, name: str, sex: str | None = None, age: str | None = None
    ) -> Distribution:
        """Return the distribution of a quantity, of some sex and age class."""
        counts = self._counts(name, sex, age)[:, :NO_SWAY]
        if (counts.sum(axis=1) == 0).any():  # of a class that not every replicate has
            counts = counts.sum(axis=0, keepdims=True)
        return Distribution(bin_edges() / SWAY_BINS_PER_UNIT, counts)

    def to_dict(self) -> dict[str, Any]:
        """Return quantiles with intervals by quantity, of all and by class."""
        orders = {"sex": SEXES, "age": self.ages}
        found: dict[str, Any] = {}
        for name in self.names:
            of_name: dict[str, Any] = {"unit": QUANTITIES[name].unit, "all": self._told(name)}
            for number, (key, order) in enumerate(orders.items()):
                words = sorted({stratum[number] for stratum in self.strata}, key=order.index)
                of_name[key] = {word: self._told(name, **{key: word}) for word in words}
            of_name["sex_and_age"] = {
                f"{sex} {age}": self._told(name, sex, age) for sex, age in self.strata
            }
            found[name] = {key: _of_somebody(value) for key, value in of_name.items()}
        return found

    def _told(self, name: str, sex: str | None = None, age: str | None = None) -> dict[str, Any]:
        distribution = self.distribution(name, sex, age)
        quantiles = None
        if distribution.size:
            each = {f"{share:g}": distribution.quantile(share) for share in SHARES_TOLD}
            quantiles = {share: one.told("value", "interval") for share, one in each.items()}
        counts = self._counts(name, sex, age)
        return {
            "persons": int(counts.sum()),
            "swaying": distribution.size,
            "left_open": int(counts[:, OPEN_SWAY].sum()),
            "quantiles": quantiles,
        }

    def _counts(self, name: str, sex: str | None, age: str | None) -> np.ndarray:
        chosen = [(sex or s, age or a) == (s, a) for s, a in self.strata]
        counts: np.ndarray = self.counts[:, self.names.index(name)][:, chosen].sum(axis=1)
        return counts


def _of_somebody(value: Any) -> Any:
    """Leave out the classes in which nobody is."""
    if isinstance(value, Mapping) and "persons" not in value:
        return {label: each for label, each in value.items() if each["persons"]}
    return value
