"""A study: which parameters are fixed, which are axes, and which quantities are wanted.

Read from TOML or built in Python; checked once, here. A study has one canonical form, whose
SHA-256 is its fingerprint, and fixes by itself how its grid is cut (:mod:`.grid`).
"""

import json
import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np

from standfast.errors import InputError, shortened
from standfast.parameters import GAINS, OWN_BODY, PARAMETERS, STIFFNESSES
from standfast.quantities import QUANTITIES
from standfast.study import values
from standfast.study.canonical import Value, canonical_text, describe, fingerprint_of, from_json
from standfast.study.grid import Grid
from standfast.study.own_body import SCALED, is_own, other_body
from standfast.study.toml import read_toml

# What a study may be given as: itself, the path of its file, or its content.
GivenStudy: TypeAlias = "Study | str | Path | Mapping[str, Any]"

LARGEST_GRID = 10**13  # three hours at a billion verdicts a second


def study_given(kind: Any, given: Any, words: str) -> Any:
    """Return a study of a kind that is given as one, as its file's path, or as nested mappings.

    Raises
    ------
    InputError
        if it is none of them, in the ``words`` of its kind, or as its ``from_toml``, ``from_dict``.
    """
    if isinstance(given, kind):
        return given
    if isinstance(given, str | Path):
        return kind.from_toml(given)
    if isinstance(given, Mapping):
        return kind.from_dict(given)
    raise InputError(
        f"study = {shortened(given)} {words}, the path of a study file, or its content as a dict"
    )


@dataclass(frozen=True)
class Study:
    """A checked study; make one with :meth:`.Study.from_toml` or :meth:`.Study.from_dict`.

    Attributes
    ----------
    title : str
    parameters : mapping
        parameter name to value, list or range, in the study's order.
    quantities : tuple of str
        what is to be computed.
    """

    title: str
    parameters: Mapping[str, Value]
    quantities: tuple[str, ...]

    @classmethod
    def from_toml(cls, path: str | Path) -> "Study":
        """Read and check a study file.

        Raises
        ------
        InputError
            if the file is not readable, not TOML, or says something that makes no sense.

        Examples
        --------
        >>> import standfast as sf
        >>> sf.Study.from_toml("studies/atlas.toml").title
        'Stiffness atlas of the nominal adult'
        """
        content = read_toml(path)
        try:
            return cls.from_dict(content)
        except InputError as error:
            raise InputError(f"{path}: {error}") from None

    @classmethod
    def from_dict(cls, content: Mapping[str, Any]) -> "Study":
        """Check a study given as nested mappings, laid out as in the TOML file.

        Raises
        ------
        InputError
            naming the key, what was given and what would be right.

        Examples
        --------
        >>> import standfast as sf
        >>> study = {
        ...     "body": {"height": 1.66, "mass": 68},
        ...     "stiffness": {"ankle": [800, 900], "knee": 1500, "hip": [300, 400, 500]},
        ...     "output": {"quantities": ["stable"]},
        ... }
        >>> sf.Study.from_dict(study).points
        6
        """
        if isinstance(content, Mapping) and "population" in content:
            raise InputError("this is the study of a population; run: standfast population")
        title = values.checked_title(content) if isinstance(content, Mapping) else ""
        parameters = values.checked_parameters(content)
        study = cls(title, parameters, values.checked_quantities(content.get("output", {})))
        study.check_size()
        return study

    @classmethod
    def from_canonical(cls, text: str) -> "Study":
        """Read a study back from its canonical JSON.

        Raises
        ------
        InputError
            if the text is not such a study.
        """
        unreadable = InputError("the study inside the file cannot be read")
        try:
            content = json.loads(text)
        except (ValueError, RecursionError):
            raise unreadable from None
        if not isinstance(content, dict) or set(content) != {"title", "parameters", "quantities"}:
            raise unreadable
        given = content["parameters"]
        if not isinstance(given, dict) or not {"gravity"} <= given.keys() <= PARAMETERS.keys():
            raise unreadable
        if "body_model" not in given and not is_own(given):
            raise unreadable
        parameters = {
            name: values.checked_value(name, PARAMETERS[name], from_json(value))
            for name, value in given.items()
        }
        values.check_complete(parameters)
        names = content["quantities"]
        for name in names if isinstance(names, list) else ():
            if isinstance(name, str) and name.isidentifier() and name not in QUANTITIES:
                raise InputError(
                    f"{shortened(name)} is no quantity of standfast but one of somebody's own; "
                    "call sf.add_quantity with it first (xarray reads the file without it)"
                )
        wanted = values.checked_quantities({"quantities": names})
        study = cls(values.checked_title(content), parameters, wanted)
        study.check_size()
        return study

    @classmethod
    def of(cls, given: "GivenStudy") -> "Study":
        """Return a study that is given as one, as the path of its file, or as nested mappings.

        Raises
        ------
        InputError
            if it is none of them, or as :meth:`from_toml` and :meth:`from_dict`.

        Examples
        --------
        >>> import standfast as sf
        >>> sf.Study.of("studies/atlas.toml").quantities
        ('stable', 'critical_ankle_stiffness', 'critical_hip_stiffness', 'frequency')
        """
        words = "is no study of a sweep; give a Study"
        found: Study = study_given(cls, given, words)
        return found

    def __hash__(self) -> int:
        in_any_order = dict(sorted(self.parameters.items()))  # as two studies are compared
        return hash((self.title, canonical_text(in_any_order), self.quantities))

    @cached_property
    def canonical(self) -> str:
        """The one canonical text of this study: JSON without spaces, infinity as ``"inf"``."""
        return canonical_text(
            {"title": self.title, "parameters": self.parameters, "quantities": self.quantities}
        )

    @cached_property
    def fingerprint(self) -> str:
        """SHA-256 of the canonical text."""
        return fingerprint_of(self.canonical)

    @cached_property
    def axes(self) -> dict[str, np.ndarray]:
        """The parameters that vary, in the study's order, with their values."""
        spread = {name: values.axis_values(value) for name, value in self.parameters.items()}
        return {name: axis for name, axis in spread.items() if axis is not None}

    @cached_property
    def fixed(self) -> dict[str, float | str]:
        """The parameters that have one value."""
        given = self.parameters.items()
        return {name: value for name, value in given if isinstance(value, float | str)}

    def axes_of(self, quantity: str) -> tuple[str, ...]:
        """Return the axes that a quantity depends on, in the study's order.

        Examples
        --------
        >>> import standfast as sf
        >>> study = sf.Study.from_toml("studies/atlas.toml")
        >>> study.axes_of("critical_ankle_stiffness")
        ('knee_stiffness', 'hip_stiffness')
        """
        row = QUANTITIES[quantity]
        return tuple(
            name for name in self.axes if row.depends_on(name, study_has_gains=self.has_gains)
        )

    @cached_property
    def has_gains(self) -> bool:
        """Whether anything is fed back: a gain that varies, or is not 0."""
        return any(name in self.axes or self.fixed.get(name, 0.0) != 0.0 for name in GAINS)

    @cached_property
    def has_one_joint(self) -> bool:
        """Whether two joints are rigid throughout, and the third is never."""
        rigid = [self.fixed.get(name) == math.inf for name in STIFFNESSES]
        bends = [not np.isinf(self.axes.get(name, np.zeros(1))).any() for name in STIFFNESSES]
        return sum(rigid) == 2 and all(r or b for r, b in zip(rigid, bends, strict=True))

    @cached_property
    def grid(self) -> Grid:
        """How the grid of each quantity is cut into chunks, tiles and shards."""
        return Grid.of(
            self.axes,
            {name: self.axes_of(name) for name in self.quantities},
            {
                name: QUANTITIES[name].way(self.has_gains, one_joint=self.has_one_joint)
                for name in self.quantities
            },
        )

    @property
    def shard_count(self) -> int:
        """Number of shards, the pieces by which a run is resumed and shared."""
        return self.grid.shard_count

    @property
    def points(self) -> int:
        """Number of values to be computed, over all quantities."""
        return sum(group.points * len(group.quantities) for group in self.grid.groups)

    @property
    def raw_bytes(self) -> int:
        """Size of all values before compression."""
        groups = self.grid.groups
        return sum(group.points * len(group.quantities) * group.dtype.itemsize for group in groups)

    def check_size(self) -> None:
        """Refuse a grid that no one would live to see.

        Raises
        ------
        InputError
            naming the quantity and the lengths of its axes.
        """
        for name in self.quantities:
            counts = [len(self.axes[axis]) for axis in self.axes_of(name)]
            if math.prod(counts) > LARGEST_GRID:
                raise InputError(
                    f"the grid of {name} has {math.prod(counts):.3g} points "
                    f"({' × '.join(map(str, counts))}); at most {LARGEST_GRID:.0e} are allowed"
                )

    def difference(self, other: "Study") -> str:
        """Return in words what differs from another study, key by key; empty if nothing does."""
        changes: list[str] = []
        if self.title != other.title:
            changes.append(f"title: {other.title!r} there, {self.title!r} here")
        bodies = other_body(other.parameters, self.parameters)
        changes += [f"body: {bodies}"] if bodies else []
        told = (*OWN_BODY, *SCALED) if bodies else ()
        for name in dict.fromkeys([*other.parameters, *self.parameters]):
            if name in told:
                continue
            there, here = other.parameters.get(name), self.parameters.get(name)
            if there != here:
                changes.append(f"{name}: {describe(there)} there, {describe(here)} here")
        if self.quantities != other.quantities:
            theirs, ours = ", ".join(other.quantities), ", ".join(self.quantities)
            changes.append(f"quantities: {theirs} there, {ours} here")
        if not changes and list(self.parameters) != list(other.parameters):
            changes.append("the order of the parameters")
        return "; ".join(changes)
