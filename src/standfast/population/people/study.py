"""A study of a population: who, how stiff, how many; checked once, here."""

import json
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

from standfast.errors import InputError
from standfast.parameters import GAINS, JOINTS, STIFFNESSES
from standfast.population.people.builtin import Subpopulation
from standfast.population.people.content import checked_content
from standfast.population.people.decoding import digest
from standfast.population.people.distributions import (
    Distributions,
    ParameterDistribution,
    checked_distribution,
    measured_of,
)
from standfast.population.people.keys import (
    LARGEST_SIZE,
    checked_output,
    selection,
    subpopulations_of,
    whole_number,
)
from standfast.population.people.records import People, read_people
from standfast.population.people.sections import (
    Correlation,
    checked_nerves,
    is_noisy,
    without_choice,
)
from standfast.population.people.sobol import LARGEST_BLOCK, REPLICATES
from standfast.study.canonical import canonical_text, fingerprint_of, flat, from_json, json_value
from standfast.study.toml import read_toml

# Blocks that are written together: about a second of work, and less where every person is kept.
BLOCKS_PER_SHARD, BLOCKS_PER_SHARD_KEPT = 64, 2


@dataclass(frozen=True)
class PopulationStudy:
    """A checked study of a population; see :meth:`.PopulationStudy.from_dict`.

    ``content`` is its canonical form, ``files`` where its people are.
    """

    content: Mapping[str, Any]
    files: tuple[Path, ...]

    @classmethod
    def from_toml(cls, path: str | Path) -> "PopulationStudy":
        """Read and check a study file; files of people are relative to its folder.

        Raises
        ------
        InputError
            if the file is not readable, not TOML, or says something that makes no sense.

        Examples
        --------
        >>> import standfast as sf
        >>> sf.PopulationStudy.from_toml("studies/us-adults.toml").size
        4000000
        """
        content = read_toml(path)
        try:
            return cls.from_dict(content, folder=Path(path).parent)
        except InputError as error:
            raise InputError(f"{path}: {error}") from None

    @classmethod
    def from_dict(
        cls, content: Mapping[str, Any], *, folder: str | Path = "."
    ) -> "PopulationStudy":
        """Check a study given as nested mappings, laid out as in the TOML file, or refuse it.

        Examples
        --------
        >>> import standfast as sf
        >>> same = {"distribution": "fixed", "relative_to": "mgh", "value": 1.2}
        >>> study = {
        ...     "population": {"builtin": "ansur-2012", "size": 1000, "seed": 1},
        ...     "stiffness": {"ankle": same, "knee": same, "hip": same},
        ... }
        >>> sf.PopulationStudy.from_dict(study).seed
        1
        """
        return cls(*checked_content(content, Path(folder)))

    @classmethod
    def from_canonical(cls, text: str) -> "PopulationStudy":
        """Read a study back from its canonical JSON, or refuse; its people are not looked for."""
        study = cls({}, ())
        try:
            content = json.loads(text)
            study = cls({k: v if k == "title" else from_json(v) for k, v in content.items()}, ())
            study._check()
        except Exception:  # whatever else may be in the place of a study
            raise InputError("the study inside the file cannot be read") from None
        return study

    def _check(self) -> None:
        """Fail if a study that was read back is not such as is written."""
        whole_number("size", self.content["population"]["size"], 1, LARGEST_SIZE)
        asked = checked_output(self.content["output"], noisy=is_noisy(self.nerves))
        for name in ("title", "gravity", "seed", "method", "keeps_persons", "fingerprint"):
            getattr(self, name)
        for name in ("distributions", "nerves", "correlation", "subpopulations", "shards"):
            getattr(self, name)
        of_joints = self.content["stiffness"].keys() == {*JOINTS, "correlation"}
        if not of_joints or asked != self.content["output"]:
            raise InputError("the study has other joints or answers")

    def __hash__(self) -> int:
        return hash((self.canonical, self.files))

    @cached_property
    def canonical(self) -> str:
        """The study as one line of JSON, the same for the same study."""
        return canonical_text(self.content)

    @cached_property
    def fingerprint(self) -> str:
        """SHA-256 of the canonical text."""
        return fingerprint_of(self.canonical)

    def difference(self, other: "PopulationStudy") -> str:
        """Return in words what differs from another study, key by key."""
        here, there = flat(json_value(self.content)), flat(json_value(other.content))
        return "; ".join(
            "the file of people has changed"
            if key == "population.people_sha256"
            else f"{key}: {there.get(key, 'not given')} there, {here.get(key, 'not given')} here"
            for key in dict.fromkeys([*there, *here])
            if there.get(key) != here.get(key)
        )

    @property
    def title(self) -> str:
        """What the study is called."""
        return str(self.content["title"])

    @property
    def gravity(self) -> float:
        """Gravitational acceleration, m/s²."""
        return float(self.content["gravity"])

    @property
    def seed(self) -> int:
        """Where all random numbers come from."""
        return int(self.content["population"]["seed"])

    @property
    def method(self) -> str:
        """``monte-carlo`` or ``quasi-monte-carlo``."""
        return str(self.content["population"]["method"])

    @property
    def keeps_persons(self) -> bool:
        """Whether every person is stored."""
        return bool(self.content["output"]["persons"])

    @cached_property
    def distributions(
        self,
    ) -> tuple[ParameterDistribution, ParameterDistribution, ParameterDistribution]:
        """The distributions of the stiffness of ankle, knee and hip."""
        section = without_choice(from_json(self.content["stiffness"]))
        ankle, knee, hip = (
            checked_distribution(name, section[joint])
            for joint, name in zip(JOINTS, STIFFNESSES, strict=True)
        )
        return ankle, knee, hip

    @cached_property
    def nerves(self) -> Distributions:
        """The distributions of damping, delay and gains that the study gives."""
        return checked_nerves(without_choice(from_json(self.content)))

    @cached_property
    def is_fed_back(self) -> bool:
        """Whether anybody has a gain, or noise; without, damping and delay change nothing."""
        return bool(self.sway or any(n in GAINS and not e.is_nothing for n, e in self.nerves))

    @property
    def sway(self) -> tuple[str, ...]:
        """The quantities of sway that are asked; none without noise."""
        return tuple(self.content["output"].get("quantities", ()))

    @property
    def measured(self) -> list[str]:
        """Which parameters are measured in each person of a file."""
        springs = tuple(zip(STIFFNESSES, self.distributions, strict=True))
        return measured_of(springs + self.nerves)

    @property
    def correlation(self) -> Correlation:
        """The correlation of the joints' normal variates."""
        return tuple(tuple(row) for row in self.content["stiffness"]["correlation"])

    @cached_property
    def subpopulations(self) -> tuple[Subpopulation, ...]:
        """Those of a built-in population; empty for people of a file."""
        population = self.content["population"]
        return subpopulations_of(population) if "builtin" in population else ()

    def read_people(self, *, strict: bool = False) -> People | None:
        """Read the files of people; None for a built-in population.

        Raises
        ------
        InputError
            as :func:`.read_people`, and if the files have changed.

        Examples
        --------
        >>> import standfast as sf
        >>> study = sf.PopulationStudy.from_toml("studies/us-adults.toml")
        >>> study.read_people() is None    # they are a built-in population
        True
        """
        population = self.content["population"]
        if "people" not in population:
            return None
        if digest(self.files) != population["people_sha256"]:
            names = ", ".join(map(str, self.files))
            raise InputError(f"{names} changed while it was read; try again")
        return read_people(
            self.files,
            strict=strict,
            needed=self.measured,
            selected=selection(population.get("sex"), population.get("age")),
            selected_by=[name for name in ("sex", "age") if name in population],
        )

    @property
    def replicates(self) -> int:
        """Independent scramblings; 1 for plain Monte Carlo."""
        return 1 if self.method == "monte-carlo" else REPLICATES

    @cached_property
    def per_replicate(self) -> int:
        """Persons of one replicate; a power of two for quasi-Monte Carlo, which needs it."""
        asked = int(self.content["population"]["size"])
        if self.method == "monte-carlo":
            return asked
        return 1 << max(-(-asked // REPLICATES) - 1, 0).bit_length()

    @property
    def size(self) -> int:
        """Persons that are simulated."""
        return self.replicates * self.per_replicate

    @cached_property
    def block_size(self) -> int:
        """Persons whose variates are sampled together: a power of two."""
        return min(LARGEST_BLOCK, 1 << (self.per_replicate - 1).bit_length())

    @property
    def blocks_per_replicate(self) -> int:
        """Number of blocks of one replicate."""
        return -(-self.per_replicate // self.block_size)

    @cached_property
    def shards(self) -> tuple[tuple[int, range], ...]:
        """The replicate of each shard, and its blocks."""
        step = BLOCKS_PER_SHARD_KEPT if self.keeps_persons else BLOCKS_PER_SHARD
        return tuple(
            (replicate, range(first, min(first + step, self.blocks_per_replicate)))
            for replicate in range(self.replicates)
            for first in range(0, self.blocks_per_replicate, step)
        )

    @property
    def shard_count(self) -> int:
        """Number of shards."""
        return len(self.shards)

    def block_persons(self, block: int) -> int:
        """Return how many persons of a block belong to the population."""
        return min(self.block_size, self.per_replicate - block * self.block_size)
