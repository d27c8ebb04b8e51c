"""From histograms to answers: every estimate of a population, with its interval."""

import itertools
import json
import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from standfast.parameters import JOINTS
from standfast.population.cohort.cohort import AGE_CLASSES, Cohort
from standfast.population.cohort.histograms import (
    BMI_CLASSES,
    HEIGHT_CLASSES,
    Histograms,
    bin_edges,
    bmi_edges,
    height_edges,
)
from standfast.population.people.builtin import ANSUR, NHANES, SOURCES
from standfast.population.people.records import SEXES
from standfast.population.people.study import PopulationStudy
from standfast.population.summary.estimators import (
    CONFIDENCE,
    NORMAL_QUANTILE,
    Distribution,
    effective_size,
    fraction,
    over_replicates,
    wilson,
)
from standfast.population.summary.sensitivity import Sensitivity

# Shares of the population that are to stand, for which the stiffness is asked.
STANDING_SHARES = (0.5, 0.9, 0.95, 0.99)
# Fewer people tell nothing of the population that they are a sample of.
FEWEST_PEOPLE = 30
SAME = 1e-12  # a relative variance that is rounding
SHARES_TOLD = (0.01, 0.05, 0.25, 0.5, 0.75, 0.95, 0.99)


class Summary:
    """All estimates of one population."""

    def __init__(
        self,
        study: PopulationStudy,
        cohort: Cohort,
        replicates: Sequence[Histograms],
        sensitivity: Sensitivity,
    ) -> None:
        self.study, self.cohort, self.sensitivity = study, cohort, sensitivity
        self.classes = np.array([each.classes for each in replicates])
        self.rows = np.sum([each.rows for each in replicates], axis=0)
        self.load_sums = np.array([each.load_sums for each in replicates])
        edges = bin_edges()
        self.safety = Distribution(edges, np.array([each.safety_factor for each in replicates]))
        self.growth = Distribution(edges, np.array([each.growth_rate for each in replicates]))
        required = np.array([each.required for each in replicates])
        self.threshold = {j: Distribution(edges, required[:, i, 0]) for i, j in enumerate(JOINTS)}
        self.multiple = {j: Distribution(edges, required[:, i, 1]) for i, j in enumerate(JOINTS)}

    def to_dict(self) -> dict[str, Any]:
        """Return all answers as one dictionary that JSON can hold."""
        study = self.study
        persons = self.classes.sum(axis=(1, 2, 3, 4))
        events = self.classes[..., 1].sum(axis=(1, 2, 3))
        unstable = fraction(events, persons)
        found: dict[str, Any] = {
            "title": study.title,
            "gravity": study.gravity,
            "laws": json.loads(study.canonical)["stiffness"],
            "unstable_fraction": unstable.value,
            "unstable_fraction_interval": unstable.interval,
            "confidence": CONFIDENCE,
            "size": study.size,
            "seed": study.seed,
            "method": study.method,
            "effective_sample_size": effective_size(events, persons),
            "persons_with_details": self.safety.size,
            "people": self._people(unstable.value, effective_size(events, persons)),
            "strata": self._strata(),
            "safety_factor": _quantiles(self.safety),
            "growth_rate_of_the_unstable": _quantiles(self.growth),
            "single_joint_critical_stiffness": self._loads(),
            "required_stiffness": self._required(),
            "drivers": self._sensitivity(),
        }
        return found

    def _people(self, unstable: float, draws: float) -> dict[str, Any]:
        people = self.cohort.people
        if people is None:
            name = str(self.study.content["population"]["builtin"])
            return {"source": SOURCES[name], "groups": [f"{s} {a}" for s, a in self.cohort.strata]}
        return {
            "source": ", ".join(self.study.content["population"]["people"]),
            "used": len(people),
            "effective_sample_size": people.effective_size,
            "survey_interval": self._survey_interval(unstable, draws),
            "not_selected": people.not_selected,
            "rejected": [
                {"file": r.file, "line": r.line, "reason": r.reason} for r in people.rejected
            ],
            "remarks": list(people.remarks),
        }

    def _survey_interval(self, unstable: float, draws: float) -> list[float] | None:
        """Return the interval that also the sample of people itself leaves open.

        By linearisation, Σ wᵢ² (pᵢ − p)² with the noise of the draws taken off, and the variance
        of the simulation added; from it the number of independent people that would tell as much,
        at most their effective number, and Wilson's interval of so many. People are taken as
        independent, without the survey's clusters.
        """
        people = self.cohort.people
        if people is None or people.effective_size < FEWEST_PEOPLE:
            return None
        weight = people.weight / people.weight.sum()
        stands, falls = self.rows.T
        times = stands + falls
        seen = times > 0
        share = falls[seen] / times[seen]
        noise = share * (1.0 - share) / np.maximum(times[seen] - 1, 1)
        squared = weight[seen] ** 2 * ((share - unstable) ** 2 - noise)
        spread = unstable * (1.0 - unstable)
        variance = max(float(squared.sum()), 0.0) + spread / draws
        # nobody or everybody falls: as many people as there are could have been otherwise
        alike = spread == 0.0
        persons = people.effective_size if alike else spread / variance
        return wilson(unstable * persons, persons).interval

    def _strata(self) -> dict[str, Any]:
        """Return the fraction unstable by sex, age, BMI and height."""
        by_stratum = self.classes.sum(axis=(2, 3))  # replicate, stratum, verdict
        found: dict[str, Any] = {}
        for number, key in enumerate(("sex", "age")):
            labels = [stratum[number] for stratum in self.cohort.strata]
            found[key] = {
                label: self._stratum(
                    by_stratum[:, [i for i, each in enumerate(labels) if each == label]].sum(axis=1)
                )
                for label in sorted(set(labels), key=_CLASS_ORDER.index)
                if by_stratum[:, [i for i, each in enumerate(labels) if each == label]].any()
            }
        fine: dict[str, tuple[np.ndarray, np.ndarray, Sequence[float]]]
        fine = {"bmi": (self.classes.sum(axis=(1, 2)), bmi_edges(), BMI_CLASSES)}
        fine["height"] = (self.classes.sum(axis=(1, 3)), height_edges(), HEIGHT_CLASSES)
        for key, (counts, edges, limits) in fine.items():
            # the first of the fine bins is all that lies below the first edge
            cuts = [0, *(1 + int(np.argmin(abs(edges - limit))) for limit in limits)]
            sums = np.add.reduceat(counts, cuts, axis=1)
            found[key] = {
                label: self._stratum(sums[:, i])
                for i, label in enumerate(_class_labels(limits))
                if sums[:, i].sum() > 0
            }
        return found

    def _stratum(self, counts: np.ndarray) -> dict[str, Any]:
        """Return share and risk of the persons counted (replicate, verdict)."""
        persons = counts.sum(axis=1)
        unstable = fraction(counts[:, 1], persons)
        return {
            "share": float(persons.sum() / self.classes.sum()),
            "unstable_fraction": unstable.value,
            "interval": unstable.interval,
        }

    def _loads(self) -> dict[str, Any]:
        """Return mean and spread of each joint's threshold with the other two rigid."""
        persons = self.safety.counts.sum(axis=1)
        found = {}
        for i, joint in enumerate(JOINTS):
            sums, squares = self.load_sums[:, 0, i], self.load_sums[:, 1, i]
            mean = sums.sum() / persons.sum()
            variance = squares.sum() / persons.sum() - mean**2
            if variance < SAME * mean**2:
                variance = 0.0
            if len(persons) > 1:
                interval = over_replicates(sums / persons).interval
            else:
                half = NORMAL_QUANTILE * math.sqrt(variance / persons.sum())
                interval = [mean - half, mean + half]
            found[joint] = {
                "mean": float(mean),
                "mean_interval": [float(end) for end in interval],
                "sd": math.sqrt(variance),
            }
        return found

    def _required(self) -> dict[str, Any]:
        """Return what each joint must have so that a share of all stands, the others as drawn."""
        found: dict[str, Any] = {}
        for joint, distribution in zip(JOINTS, self.study.distributions, strict=True):
            found[joint] = {}
            rigid = distribution.kind == "fixed" and math.isinf(distribution.numbers[0])
            for share in STANDING_SHARES:
                stiffness = self.threshold[joint].quantile(share)
                multiple = self.multiple[joint].quantile(share)
                found[joint][f"{share:g}"] = {
                    "stiffness": _finite(stiffness.value),
                    "stiffness_interval": [_finite(end) for end in stiffness.interval],
                    "multiple": None if rigid else _finite(multiple.value),
                    "multiple_interval": None
                    if rigid
                    else [_finite(end) for end in multiple.interval],
                }
        found["all"] = {}
        for share in STANDING_SHARES:
            safety = self.safety.quantile(1.0 - share)
            found["all"][f"{share:g}"] = {
                "multiple": _finite(_inverse(safety.value)),
                "multiple_interval": [_finite(_inverse(e)) for e in reversed(safety.interval)],
            }
        return found

    def _sensitivity(self) -> dict[str, Any]:
        found: dict[str, Any] = {}
        for output in ("unstable", "safety_factor"):
            if output in self.sensitivity.remarks:
                found[output] = {"remark": self.sensitivity.remarks[output]}
                continue
            indices = self.sensitivity.indices[output]
            found[output] = {
                factor: {
                    "first": first.value,
                    "first_interval": first.interval,
                    "total": total.value,
                    "total_interval": total.interval,
                }
                for factor, first, total in zip(
                    self.sensitivity.factors, indices.first, indices.total, strict=True
                )
            }
        return found


# Sexes and age classes in the order in which they are told.
_CLASS_ORDER = [*SEXES, *(name for _, name in AGE_CLASSES), *(g.age for g in (*NHANES, *ANSUR))]


def _class_labels(limits: Sequence[float]) -> list[str]:
    """Return the names of the classes between rising limits."""
    inner = [f"{low:g} to {high:g}" for low, high in itertools.pairwise(limits)]
    return [f"below {limits[0]:g}", *inner, f"{limits[-1]:g} and more"]


def _quantiles(distribution: Distribution) -> dict[str, Any] | None:
    """Return quantiles with intervals; None where nobody was counted."""
    if distribution.size == 0:
        return None
    found = {}
    for share in SHARES_TOLD:
        quantile = distribution.quantile(share)
        found[f"{share:g}"] = {
            "value": _finite(quantile.value),
            "interval": [_finite(end) for end in quantile.interval],
        }
    return found


def _finite(value: float) -> float | None:
    """Return a number, or None where JSON has none: no stiffness suffices."""
    return float(value) if math.isfinite(value) else None


def _inverse(value: float) -> float:
    return math.inf if value == 0.0 else 1.0 / value
