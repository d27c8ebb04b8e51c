"""A study: which parameters are fixed, which are axes, and which quantities are wanted.

Read from TOML or built in Python; checked once, here. A study has one canonical form, whose
SHA-256 is its fingerprint, and fixes by itself how its grids are cut into chunks, tiles and shards:
nothing about the machine enters, so the same study always gives the same file.
"""

import hashlib
import json
import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from standfast.quantities import PARAMETERS, QUANTITIES, STANDARD_GRAVITY, InputError
from standfast.study.toml import read_toml
from standfast.study.values import (
    BODY_KEYS,
    STIFFNESS_KEYS,
    TOP_KEYS,
    Value,
    axis_values,
    check_body,
    checked_quantities,
    checked_section,
    checked_value,
    describe,
    from_json,
    json_value,
    known_keys,
)

# A chunk is the unit of compression and of reading: 2 MiB before compression. A shard, the unit of
# resuming and of sharing among machines, is a run of chunks: a gigabyte of verdicts, half of
# numbers, some seconds of work. Each costs a sync, and all but the last are written twice.
CHUNK_BYTES = 2 * 2**20
SHARD_WORK = 512
CHUNK_WORK = {1: 1, 8: 2}  # by bytes of a value
LARGEST_GRID = 10**13  # three hours at a billion verdicts a second

# The parameters on which each quantity depends, besides those of the body.
BODY_PARAMETERS = ("body_model", "height", "mass", "bmi", "gravity")
JOINTS = ("ankle_stiffness", "knee_stiffness", "hip_stiffness")


def parameters_of(quantity: str) -> tuple[str, ...]:
    """Return the names of the parameters that a quantity depends on."""
    solved_for = quantity.removeprefix("critical_")
    return BODY_PARAMETERS + tuple(joint for joint in JOINTS if joint != solved_for)


@dataclass(frozen=True, slots=True)
class Tile:
    """One chunk of the grid of every quantity of a group; the unit of computing."""

    group: int
    chunk: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class Group:
    """Quantities on the same axes and of the same size in memory; they share chunks."""

    quantities: tuple[str, ...]
    axes: tuple[str, ...]
    shape: tuple[int, ...]
    chunk_shape: tuple[int, ...]

    @property
    def chunks(self) -> tuple[int, ...]:
        """Number of chunks along each axis."""
        return tuple(-(-n // c) for n, c in zip(self.shape, self.chunk_shape, strict=True))

    @property
    def tile_count(self) -> int:
        """Number of tiles."""
        return math.prod(self.chunks)

    @property
    def tile_work(self) -> int:
        """What a tile counts in a shard."""
        size = np.dtype(QUANTITIES[self.quantities[0]].dtype).itemsize
        return CHUNK_WORK[size] * len(self.quantities)

    @property
    def points(self) -> int:
        """Number of grid points of one quantity."""
        return math.prod(self.shape)

    def start(self, tile: Tile) -> tuple[int, ...]:
        """Return the first index of a tile along each axis."""
        return tuple(i * c for i, c in zip(tile.chunk, self.chunk_shape, strict=True))


@dataclass(frozen=True)
class Study:
    """A checked study; make one with :meth:`from_toml` or :meth:`from_dict`.

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
        """
        if isinstance(content, Mapping) and "population" in content:
            raise InputError("this is the study of a population; run: standfast population")
        known_keys("study", content, TOP_KEYS)
        title = content.get("title", "")
        if not isinstance(title, str) or not title.isprintable():
            raise InputError(f"title = {title!r} is not one line of text")
        parameters: dict[str, Value] = {}
        for key, given in content.items():
            if key == "gravity":
                parameters["gravity"] = checked_value("gravity", "gravity", given)
            elif key == "body":
                parameters |= checked_section("body", given, BODY_KEYS)
            elif key == "stiffness":
                parameters |= checked_section("stiffness", given, STIFFNESS_KEYS)
        parameters.setdefault("gravity", STANDARD_GRAVITY)
        parameters.setdefault("body_model", "winter")
        check_body(parameters)
        study = cls(title, parameters, checked_quantities(content.get("output", {})))
        _check_size(study)
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
        if not isinstance(content["parameters"], dict):
            raise unreadable
        parameters: dict[str, Value] = {}
        for name, given in content["parameters"].items():
            if name != "body_model" and name not in PARAMETERS:
                raise unreadable
            parameters[name] = checked_value(name, name, from_json(given))
        if not {"body_model", "gravity"} <= set(parameters):
            raise unreadable
        check_body(parameters)
        study = cls(
            str(content["title"]),
            parameters,
            checked_quantities({"quantities": content["quantities"]}),
        )
        _check_size(study)
        return study

    @cached_property
    def canonical(self) -> str:
        """The one canonical text of this study: JSON without spaces, infinity as ``"inf"``."""
        content = {
            "title": self.title,
            "parameters": {name: json_value(value) for name, value in self.parameters.items()},
            "quantities": list(self.quantities),
        }
        return json.dumps(content, ensure_ascii=False, separators=(",", ":"), allow_nan=False)

    @cached_property
    def fingerprint(self) -> str:
        """SHA-256 of the canonical text."""
        return hashlib.sha256(self.canonical.encode()).hexdigest()

    @cached_property
    def axes(self) -> dict[str, np.ndarray]:
        """The parameters that vary, in the study's order, with their values."""
        return {
            name: values
            for name, value in self.parameters.items()
            if (values := axis_values(value)) is not None
        }

    @cached_property
    def fixed(self) -> dict[str, float | str]:
        """The parameters that have one value."""
        return {
            name: value for name, value in self.parameters.items() if isinstance(value, float | str)
        }

    def axes_of(self, quantity: str) -> tuple[str, ...]:
        """Return the axes that a quantity depends on, in the study's order."""
        needed = parameters_of(quantity)
        return tuple(name for name in self.axes if name in needed)

    @cached_property
    def groups(self) -> tuple[Group, ...]:
        """The quantities in groups that share axes, item size and therefore chunks."""
        members: dict[tuple[tuple[str, ...], int], list[str]] = {}
        for quantity in self.quantities:
            size = np.dtype(QUANTITIES[quantity].dtype).itemsize
            members.setdefault((self.axes_of(quantity), size), []).append(quantity)
        groups = []
        for (axes, size), quantities in members.items():
            shape = tuple(len(self.axes[name]) for name in axes)
            groups.append(
                Group(tuple(quantities), axes, shape, chunk_shape(shape, CHUNK_BYTES // size))
            )
        return tuple(groups)

    @property
    def points(self) -> int:
        """Number of values to be computed, over all quantities."""
        return sum(group.points * len(group.quantities) for group in self.groups)

    @property
    def raw_bytes(self) -> int:
        """Size of all values before compression."""
        return sum(
            group.points * np.dtype(QUANTITIES[quantity].dtype).itemsize
            for group in self.groups
            for quantity in group.quantities
        )

    @cached_property
    def shards(self) -> tuple[tuple[tuple[int, range], ...], ...]:
        """Of each shard the groups in it, and the numbers of its tiles within each group."""
        shards: list[list[tuple[int, range]]] = [[]]
        room = SHARD_WORK
        for index, group in enumerate(self.groups):
            first = 0
            while first < group.tile_count:
                least = 0 if shards[-1] else 1  # a tile larger than a shard is one
                fitting = max(room // group.tile_work, least)
                if fitting:
                    count = min(fitting, group.tile_count - first)
                    shards[-1].append((index, range(first, first + count)))
                    first += count
                    room -= count * group.tile_work
                else:
                    shards.append([])
                    room = SHARD_WORK
        return tuple(map(tuple, shards))

    @property
    def shard_count(self) -> int:
        """Number of shards."""
        return len(self.shards)

    def shard(self, number: int) -> list[Tile]:
        """Return the tiles of a shard, in canonical order: the last axis fastest."""
        return [self.tile(index, flat) for index, tiles in self.shards[number] for flat in tiles]

    def tile(self, group: int, number: int) -> Tile:
        """Return a tile by its number within its group."""
        place: list[int] = []
        for count in reversed(self.groups[group].chunks):
            number, index = divmod(number, count)
            place.insert(0, index)
        return Tile(group, tuple(place))

    def difference(self, other: "Study") -> str:
        """Return in words what differs from another study, key by key; empty if nothing does."""
        changes: list[str] = []
        if self.title != other.title:
            changes.append(f"title: {other.title!r} there, {self.title!r} here")
        names = list(dict.fromkeys([*other.parameters, *self.parameters]))
        pairs = {name: (other.parameters.get(name), self.parameters.get(name)) for name in names}
        changes += [
            f"{name}: {describe(there)} there, {describe(here)} here"
            for name, (there, here) in pairs.items()
            if there != here
        ]
        if self.quantities != other.quantities:
            changes.append(
                f"quantities: {', '.join(other.quantities)} there, "
                f"{', '.join(self.quantities)} here"
            )
        if not changes and list(self.parameters) != list(other.parameters):
            changes.append("the order of the parameters")
        return "; ".join(changes)


def chunk_shape(shape: tuple[int, ...], limit: int) -> tuple[int, ...]:
    """Cut a grid into chunks of at most ``limit`` points, as cubic and as even as possible.

    The longest side is cut into one piece more until the chunk fits.
    """
    pieces = [1] * len(shape)
    sides = list(shape)
    while math.prod(sides) > limit:
        axis = sides.index(max(sides))
        pieces[axis] += 1
        sides[axis] = -(-shape[axis] // pieces[axis])
    return tuple(sides)


def _check_size(study: Study) -> None:
    for name in study.quantities:
        counts = [len(study.axes[axis]) for axis in study.axes_of(name)]
        if math.prod(counts) > LARGEST_GRID:
            raise InputError(
                f"the grid of {name} has {math.prod(counts):.3g} points "
                f"({' × '.join(map(str, counts))}); at most {LARGEST_GRID:.0e} are allowed"
            )
