"""The crowd of a study: from scores to the numbers of each person that the model takes."""

from dataclasses import dataclass, field

import numpy as np

from standfast.population.draws import Sampler, aligned
from standfast.population.laws import JOINTS
from standfast.population.people import SEXES, People
from standfast.population.persons import Model
from standfast.population.study import PopulationStudy

# Age classes of people of a file, as NHANES groups adults.
AGE_CLASSES = ((0.0, "under 20"), (20.0, "20-39"), (40.0, "40-59"), (60.0, "60+"))

# Cells of the guide table by which a row is found from a uniform number, for each row.
GUIDE_CELLS = 64


@dataclass(frozen=True)
class Crowd:
    """Who is drawn from, made by :func:`crowd_of`.

    Attributes
    ----------
    strata
        sex and age class of each stratum.
    people
        the persons of a file, in rising order of the load that topples them; None if built in.
    stratum
        of each of these persons.
    """

    model: Model
    sampler: Sampler
    strata: tuple[tuple[str, str], ...]
    people: People | None
    stratum: np.ndarray
    _guide: "_Guide | None" = field(repr=False)

    @property
    def rows(self) -> int:
        """Number of persons of a file; 0 if built in."""
        return 0 if self.people is None else len(self.people)

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the numbers of :meth:`numbers`, row by row."""
        drawn = tuple(c.name for c in self.sampler.coordinates)
        if self.people is None:
            return drawn
        measured = [
            f"{joint}_stiffness"
            for joint, law in zip(JOINTS, self.model.laws, strict=True)
            if law.distribution == "measured"
        ]
        return (*drawn[1:], "height", "mass", "stratum", *measured)

    def numbers(self, scores: np.ndarray) -> np.ndarray:
        """Return the named numbers (names, n) of persons from their scores (coordinates, n)."""
        if self.people is None or self._guide is None:
            return scores
        row = self.rows_of(scores)
        columns = [self.people.height, self.people.mass, self.stratum]
        columns += [
            self.people.stiffness[name] for name in self.names if name.endswith("_stiffness")
        ]
        numbers = aligned(len(self.names), scores.shape[1])
        numbers[: len(scores) - 1] = scores[1:]
        for place, column in zip(numbers[len(scores) - 1 :], columns, strict=True):
            np.take(column, row, out=place)
        return numbers

    def rows_of(self, scores: np.ndarray) -> np.ndarray:
        """Return which person of the file each of the scores draws."""
        if self._guide is None:
            raise ValueError("a built-in population has no rows")
        return self._guide.rows(scores[0])


def crowd_of(study: PopulationStudy, people: People | None) -> Crowd:
    """Return the crowd of a study, whose files of people have been read."""
    stratum = np.zeros(0)
    guide = None
    if people is None:
        strata = tuple((group.sex, group.age) for group in study.groups)
    else:
        # neighbours in this order are alike, which is what quasi-Monte Carlo lives on
        people = people.at(np.lexsort((people.height, people.height * people.mass)))
        labels = [(sex, _age_class(age)) for sex, age in zip(people.sex, people.age, strict=True)]
        ages = [name for _, name in AGE_CLASSES] + ["unknown"]
        strata = tuple((sex, age) for sex in SEXES for age in ages if (sex, age) in set(labels))
        stratum = np.array([strata.index(label) for label in labels], np.float64)
        guide = _Guide.of(people.weight)
    model = Model(
        study.gravity,
        str(study.content["population"]["body_model"]),
        study.groups,
        tuple(sex for sex, _ in strata),
        study.content["population"]["proportions"] == "scattered",
        study.laws,
    )
    sampler = Sampler(model.coordinates, study.correlation, study.method, study.seed)
    return Crowd(model, sampler, strata, people, stratum, guide)


def _age_class(age: float) -> str:
    if np.isnan(age):
        return "unknown"
    return next(name for start, name in reversed(AGE_CLASSES) if age >= start)


@dataclass(frozen=True)
class _Guide:
    """Finds the row i with c_i ≤ u < c_{i+1} for cumulated weights c, in a few steps.

    A table says for each of many even cells of u the first row that can be meant.
    """

    ends: np.ndarray
    first: np.ndarray
    steps: int

    @classmethod
    def of(cls, weights: np.ndarray) -> "_Guide":
        ends = np.cumsum(weights) / weights.sum()
        ends[np.flatnonzero(weights)[-1] :] = np.inf
        cells = GUIDE_CELLS * len(weights)
        first = np.searchsorted(ends, np.arange(cells) / cells, side="right")
        last = np.flatnonzero(weights)[-1]
        steps = int(np.diff(np.append(first, last)).max())
        return cls(ends, first, steps)

    def rows(self, uniform: np.ndarray) -> np.ndarray:
        row: np.ndarray = self.first[(uniform * len(self.first)).astype(np.int64)]
        for _ in range(self.steps):
            row = row + (uniform >= self.ends[row])
        return row
