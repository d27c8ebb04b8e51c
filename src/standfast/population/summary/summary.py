"""From histograms to answers: every estimate of a population, with its interval."""

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from typing import Any

import numpy as np

from standfast.parameters import JOINTS, STIFFNESS_UNIT
from standfast.population.cohort.cohort import Cohort
from standfast.population.cohort.histograms import (
    EXTREMES,
    EXTREMES_FED_BACK,
    Histograms,
    bin_edges,
    signed_bin_edges,
)
from standfast.population.people.builtin import SOURCES
from standfast.population.people.classes import STRATA
from standfast.population.people.study import PopulationStudy
from standfast.population.people.words import SEXES
from standfast.population.summary.arrays import STANDING_SHARES, ages_of
from standfast.population.summary.estimators import (
    CONFIDENCE,
    METHODS,
    NORMAL_QUANTILE,
    Distribution,
    Estimate,
    effective_size,
    fraction,
    over_replicates,
    wilson,
)
from standfast.population.summary.strata import fractions_of_strata
from standfast.population.summary.sway import SwayFound
from standfast.study.canonical import json_value

FEWEST_PEOPLE = 30  # fewer tell nothing of the population that they are a sample of
SAME = 1e-12  # a relative spread, or variance, that is rounding
# Told as one number instead of quantiles where it is the same in everybody.
TOLD_IF_SAME = ("safety_factor", "critical_delay", "delay_margin")
UNITS = {
    **{key: unit for key, (_, unit) in STRATA.items() if unit},
    "gravity": "m/s²",
    "safety_factor": "1",
    "growth_rate": "1/s",
    "stiffness": STIFFNESS_UNIT,
    "delay": "s",
}
SHARES_TOLD = (0.01, 0.05, 0.25, 0.5, 0.75, 0.95, 0.99)


class Summary:
    """All estimates of one population."""

    def __init__(
        self,
        study: PopulationStudy,
        cohort: Cohort,
        replicates: Sequence[Histograms],
        drivers: Mapping[str, Any],
    ) -> None:
        self.study, self.cohort, self.drivers = study, cohort, drivers
        self.classes = np.array([each.classes for each in replicates])
        self.rows = np.sum([each.rows for each in replicates], axis=0)
        self.load_sums = np.array([each.load_sums for each in replicates])
        self.settled = int(sum(each.settled.sum() for each in replicates))
        self.same = _same(study.is_fed_back, np.min([e.extremes for e in replicates], axis=0))
        if study.is_fed_back:
            self.critical = np.array([each.critical_delay for each in replicates])
            margins = np.array([each.delay_margin for each in replicates])
            self.margin = Distribution(
                signed_bin_edges(), margins, lowest=-math.inf, same=self.same.get("delay_margin")
            )
            self.by_springs = np.array([each.by_springs for each in replicates])
            self.left_open = int(sum(each.left_open.sum() for each in replicates))
            self.sway = SwayFound(study, cohort, replicates) if study.sway else None
            return
        edges = bin_edges()
        safety = np.array([each.safety_factor for each in replicates])
        self.safety = Distribution(edges, safety, same=self.same.get("safety_factor"))
        self.growth = Distribution(edges, np.array([each.growth_rate for each in replicates]))
        required = np.array([each.required for each in replicates])
        self.threshold, self.multiple = (
            {
                j: Distribution(edges, required[:, i, k], same=self.same.get(f"{kind}_{j}"))
                for i, j in enumerate(JOINTS)
            }
            for k, kind in enumerate(("critical", "multiple"))
        )

    def to_dict(self) -> dict[str, Any]:
        """Return all answers as one dictionary that JSON can hold."""
        study = self.study
        persons = self.classes.sum(axis=(1, 2, 3, 4))
        events = self.classes[..., 1].sum(axis=(1, 2, 3))
        unstable, draws = fraction(events, persons), effective_size(events, persons)
        return {
            "title": study.title,
            "gravity": study.gravity,
            "laws": json.loads(study.canonical)["stiffness"],
            **({"nerves": self._nerves()} if study.is_fed_back else {}),
            **unstable.told("unstable_fraction"),
            "confidence": CONFIDENCE,
            "interval_method": METHODS[study.method],
            "settled_exactly": self.settled,
            "same_for_everybody": {n: v for n, v in self.same.items() if n in TOLD_IF_SAME},
            "size": study.size,
            "seed": study.seed,
            "method": study.method,
            "effective_sample_size": draws,
            "persons_with_details": int(persons.sum()) if study.is_fed_back else self.safety.size,
            "people": self._people(unstable.value, draws),
            "strata": fractions_of_strata(self.classes, self.cohort.strata, ages_of(study)),
            "units": UNITS,
            **(self._of_delay() if study.is_fed_back else self._of_springs()),
            "drivers": self.drivers,
        }

    def _of_springs(self) -> dict[str, Any]:
        """Return what springs alone have: margins, and the stiffness that would be needed."""
        return {
            "safety_factor": _quantiles(self.safety),
            "growth_rate_of_the_unstable": _quantiles(self.growth),
            "single_joint_critical_stiffness": self._loads(self.safety.counts.sum(axis=1)),
            "required_stiffness": self._required(),
        }

    def _of_delay(self) -> dict[str, Any]:
        """Return what feedback has: who would fall without it, and which delay is borne."""
        persons = self.by_springs.sum(axis=1)
        borne: dict[str, Any] = {"all": _delays_borne(self.critical_delay())}
        orders = {"sex": SEXES, "age": ages_of(self.study)}
        for number, (key, order) in enumerate(orders.items()):
            words = {stratum[number] for stratum in self.cohort.strata}
            found = {
                word: self.critical_delay(**{key: word}) for word in sorted(words, key=order.index)
            }
            borne[key] = {word: _delays_borne(each) for word, each in found.items() if each.size}
        pairs = {f"{sex} {age}": self.critical_delay(sex, age) for sex, age in self.cohort.strata}
        borne["sex_and_age"] = {both: _delays_borne(p) for both, p in pairs.items() if p.size}
        return {
            **fraction(self.by_springs[:, 1], persons).told("unstable_by_springs_alone"),
            "left_open_by_rounding": self.left_open,
            "critical_delay": _quantiles(self.critical_delay()),
            "delay_margin": _quantiles(self.margin),
            "delay_borne": borne,
            **({} if self.sway is None else {"sway": self.sway.to_dict()}),
            "single_joint_critical_stiffness": self._loads(persons),
        }

    def critical_delay(self, sex: str | None = None, age: str | None = None) -> Distribution:
        """Return the distribution of the critical delay, of some sex and age class."""
        chosen = [(sex or s, age or a) == (s, a) for s, a in self.cohort.strata]
        counts = self.critical[:, chosen].sum(axis=1)
        return Distribution(bin_edges(), counts, same=self.same.get("critical_delay"))

    def _nerves(self) -> dict[str, Any]:
        """Return the distributions of damping, delay, gains and noise by parameter."""
        return {name: json_value(each.canonical()) for name, each in self.study.nerves}

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
            "rejected": [asdict(each) for each in people.rejected],
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
        persons = people.effective_size if spread == 0.0 else spread / variance
        return wilson(unstable * persons, persons).interval

    def _loads(self, persons: np.ndarray) -> dict[str, Any]:
        """Return mean and spread of each joint's threshold with the other two rigid."""
        found = {}
        for i, joint in enumerate(JOINTS):
            sums, squares = self.load_sums[:, 0, i], self.load_sums[:, 1, i]
            mean = sums.sum() / persons.sum()
            variance = squares.sum() / persons.sum() - mean**2
            if variance < SAME * mean**2:
                variance = 0.0
            half = NORMAL_QUANTILE * math.sqrt(variance / persons.sum())
            low, high = mean - half, mean + half
            if len(persons) > 1:
                low, high = over_replicates(sums / persons).interval
            found[joint] = {**Estimate(mean, low, high).told("mean"), "sd": math.sqrt(variance)}
        return found

    def _required(self) -> dict[str, Any]:
        """Return what each joint must have so that a share of all stands, the others as drawn."""
        found: dict[str, Any] = {}
        for joint, distribution in zip(JOINTS, self.study.distributions, strict=True):
            found[joint] = {}
            rigid = distribution.kind == "fixed" and math.isinf(distribution.numbers[0])
            for share in STANDING_SHARES:
                multiple = self.multiple[joint].quantile(share).told("multiple")
                found[joint][f"{share:g}"] = {
                    **self.threshold[joint].quantile(share).told("stiffness"),
                    **(dict.fromkeys(multiple) if rigid else multiple),
                }
        found["all"] = {}
        for share in STANDING_SHARES:
            safety = self.safety.quantile(1.0 - share)
            multiple_of_all = Estimate(*map(_inverse, (safety.value, safety.high, safety.low)))
            found["all"][f"{share:g}"] = multiple_of_all.told("multiple")
        return found


def _same(fed_back: bool, extremes: np.ndarray) -> dict[str, float]:
    """Return what is the same in everybody but for rounding, from the ends of its values."""
    found = {}
    names = EXTREMES_FED_BACK if fed_back else EXTREMES
    for name, low, high in zip(names, extremes[0], -extremes[1], strict=True):
        if math.isfinite(high) and high - low <= SAME * max(abs(low), abs(high)):
            found[name] = float(f"{0.5 * (low + high):.12g}")
    return found


def _delays_borne(critical: Distribution) -> dict[str, Any]:
    """Return up to which delay shares of all stand; 0 where fewer stand even without delay."""
    found = {f"{share:g}": critical.quantile(1.0 - share) for share in STANDING_SHARES}
    return {share: each.told("delay") for share, each in found.items()}


def _quantiles(distribution: Distribution) -> dict[str, Any] | None:
    """Return quantiles with intervals; None where nobody was counted, or all are the same."""
    if distribution.size == 0 or distribution.same is not None:
        return None
    quantiles = {f"{share:g}": distribution.quantile(share) for share in SHARES_TOLD}
    return {share: each.told("value", "interval") for share, each in quantiles.items()}


def _inverse(value: float) -> float:
    return math.inf if value == 0.0 else 1.0 / value
