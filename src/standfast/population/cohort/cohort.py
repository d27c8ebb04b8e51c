"""The cohort of a study: from standard variates to the numbers of each person."""

from dataclasses import dataclass, field

import numpy as np

from standfast.parameters import OWN_BODY
from standfast.population.cohort.bodies import models_of_sexes
from standfast.population.cohort.persons import CohortModel
from standfast.population.cohort.sizes import groups_of
from standfast.population.people.classes import UNKNOWN, age_class, age_classes_of
from standfast.population.people.records import People
from standfast.population.people.sampling import Sampler
from standfast.population.people.sobol import aligned
from standfast.population.people.study import PopulationStudy
from standfast.population.people.words import SEXES

GUIDE_CELLS = 64  # of the table by which a row is found from a uniform number, for each row


@dataclass(frozen=True)
class Cohort:
    """Who is sampled, made by :func:`cohort_of`."""

    model: CohortModel
    sampler: Sampler
    strata: tuple[tuple[str, str], ...]  # sex and age class of each
    people: People | None  # of a file, in rising order of the load that topples them
    stratum: np.ndarray  # of each of the people
    rows_by_weight: "WeightedRows | None" = field(repr=False)

    @property
    def rows(self) -> int:
        """Number of persons of a file; 0 if built in."""
        return 0 if self.people is None else len(self.people)

    @property
    def kept(self) -> tuple[str, ...]:
        """What is kept of every person when asked: of itself, and who it is."""
        return (*self.model.kept, "stratum", *(["row"] if self.rows else []))

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the numbers of :meth:`numbers`, row by row."""
        drawn = tuple(c.name for c in self.sampler.coordinates)
        if self.people is None:
            return drawn
        return (*drawn[1:], "height", "mass", "stratum", *self.model.measured)

    def numbers(self, variates: np.ndarray) -> np.ndarray:
        """Return the named numbers (names, n) of persons from their variates (coordinates, n)."""
        if self.people is None:
            return variates
        row = self.rows_of(variates)
        columns = [self.people.height, self.people.mass, self.stratum]
        columns += [self.people.measured[name] for name in self.model.measured]
        numbers = aligned(len(self.names), variates.shape[1])
        numbers[: len(variates) - 1] = variates[1:]
        for place, column in zip(numbers[len(variates) - 1 :], columns, strict=True):
            np.take(column, row, out=place)
        return numbers

    def rows_of(self, variates: np.ndarray) -> np.ndarray:
        """Return which person of the file each of the variates picks."""
        if self.rows_by_weight is None:
            raise ValueError("a built-in population has no rows")
        return self.rows_by_weight.at(variates[0])


def cohort_of(study: PopulationStudy, people: People | None) -> Cohort:
    """Return the cohort of a study, whose files of people have been read."""
    stratum = np.zeros(0)
    if people is None:
        strata = tuple((each.sex, each.age) for each in study.subpopulations)
    else:
        # neighbours in this order are alike, which is what quasi-Monte Carlo lives on
        people = people.at(np.lexsort((people.height, people.height * people.mass)))
        classes = age_classes_of(study.content["population"])
        told = zip(people.sex, people.age, strict=True)
        labels = [(sex, age_class(age, classes)) for sex, age in told]
        ages = [name for _, name in classes] + [UNKNOWN]
        strata = tuple((sex, age) for sex in SEXES for age in ages if (sex, age) in set(labels))
        stratum = np.array([strata.index(label) for label in labels], np.float64)
    population, sexes = study.content["population"], [sex for sex, _ in strata]
    is_scattered = population["proportions"] == "scattered"
    ankle, knee, hip = study.distributions
    model = CohortModel(
        study.gravity,
        models_of_sexes(population["body_model"], sexes),
        groups_of(study.subpopulations),
        tuple(sexes) if is_scattered else (),
        (ankle.draw, knee.draw, hip.draw),
        tuple((name, each.draw) for name, each in study.nerves) if study.is_fed_back else (),
        people is not None and OWN_BODY[0] in people.measured,
        study.sway,
    )
    sampler = Sampler(model.coordinates, study.correlation, study.method, study.seed)
    by_weight = WeightedRows.of(people.weight) if people is not None else None
    return Cohort(model, sampler, strata, people, stratum, by_weight)


@dataclass(frozen=True)
class WeightedRows:
    """Finds the row i with c_i ≤ u < c_{i+1} for cumulated weights c, in a few steps.

    A table says for each of many even cells of u the first row that can be meant. Ours, because
    SciPy's (``scipy.stats.sampling.DiscreteGuideTable``) finds the same rows in twice to three
    times the time, and its import takes 0.4 s of every population.
    """

    ends: np.ndarray
    first: np.ndarray
    steps: int

    @classmethod
    def of(cls, weights: np.ndarray) -> "WeightedRows":
        """Make the table of some weights."""
        last = np.flatnonzero(weights)[-1]
        ends = np.cumsum(weights) / weights.sum()
        ends[last:] = np.inf
        cells = GUIDE_CELLS * len(weights)
        first = np.searchsorted(ends, np.arange(cells) / cells, side="right")
        steps = int(np.diff(np.append(first, last)).max())
        return cls(ends, first, steps)

    def at(self, uniform: np.ndarray) -> np.ndarray:
        """Return the row of each uniform number."""
        row: np.ndarray = self.first[(uniform * len(self.first)).astype(np.int64)]
        for _ in range(self.steps):
            row = row + (uniform >= self.ends[row])
        return row
