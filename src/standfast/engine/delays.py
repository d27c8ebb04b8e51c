"""Quantities of delayed feedback: a table of crossings a person, then a comparison a delay.

Along the axis of the delay the number of unstable roots changes only at a few places. So what all
delays share is found once on the other axes; tiles that differ in the delay alone share it too.
"""

import math
import threading
from collections.abc import Mapping
from functools import lru_cache
from typing import Any

import jax.numpy as jnp
import numpy as np

from standfast.engine.mapping import Inputs, along_axis, in_batches, map_over_grid
from standfast.mechanics.feedback import equation_of
from standfast.mechanics.matrices import joint_gravity
from standfast.numerics.arrays import Array
from standfast.parameters import NOISES
from standfast.quantities import QUANTITIES, Person
from standfast.stability.delay.answers import FedBack
from standfast.stability.delay.persons import all_crossings, all_rightmost
from standfast.stability.delay.problem import Apply, directly, most_of
from standfast.stability.delay.table import Crossings
from standfast.stability.exact import exact_threshold
from standfast.stability.sway.persons import damped, swaying_of, variances
from standfast.study.grid import Group, Tile
from standfast.study.study import Study

DELAY = "feedback_delay"
# Points that are found before anything is compiled: 41 × 41 take half a second at most, and
# compiling takes ten.
FEW = 2000
KEPT = 16  # tables that are kept between tiles
# Accuracy of variances that is asked. Of 1,855 random persons who stand with delayed feedback the
# worst came out at 2e-7 where 1e-7 was asked, and at 3e-6 where 1e-6 was.
OF_GRIDS = 2e-7


class Delays:
    """Computes the tiles of a group of quantities of delayed feedback."""

    def __init__(self, study: Study, group: Group, inputs: Inputs) -> None:
        self.study, self.group, self.inputs = study, group, inputs
        self.others = tuple(name for name in group.axes if name != DELAY)
        self.place = group.axes.index(DELAY) if DELAY in group.axes else None
        self.fixed_delay = np.array([float(study.fixed.get(DELAY, 0.0))])
        quantities = [QUANTITIES[name] for name in group.quantities]
        self.answers = [quantity.fed_back for quantity in quantities]
        self.of = most_of(quantity.crossings_of for quantity in quantities)
        self.rows = tuple(sorted({row for quantity in quantities for row in quantity.variances}))
        points = math.prod(group.shape)
        self.apply: Apply = in_batches if points > FEW else directly
        self.left_open = 0
        self._lock = threading.Lock()
        self._counted: set[tuple[int, ...]] = set()
        # tiles of one table, which differ in the delay, come one after the other or in threads
        self.people = lru_cache(maxsize=KEPT)(self._people)
        self.tables = lru_cache(maxsize=KEPT)(self._table)

    def __call__(self, tile: Tile) -> tuple[np.ndarray, ...]:
        """Compute one tile."""
        chunk, delays, inside = tile.chunk, self.fixed_delay, 1
        sides = self.group.chunk_shape
        if self.place is not None:
            length = sides[self.place]
            values = self.study.axes[DELAY]
            start = length * chunk[self.place]
            delays = values[along_axis(start, length, len(values))]
            inside = min(length, len(values) - start)
            chunk = chunk[: self.place] + chunk[self.place + 1 :]
            sides = sides[: self.place] + sides[self.place + 1 :]
        left_open = np.zeros((math.prod(sides), delays.size), bool)
        asked = FedBack(
            delays,
            lambda: self.tables(chunk),
            lambda: self._roots(chunk, delays, left_open),
            lambda: self._variances(chunk, asked.crossings, delays, left_open),
        )
        found = []
        for name, answer in zip(self.group.quantities, self.answers, strict=True):
            if answer is None:
                raise ValueError(f"{name} is none of delayed feedback")
            values = answer(asked).astype(QUANTITIES[name].dtype)
            if self.place is None:
                found.append(values.reshape(sides))
            else:
                spread = values.reshape(*sides, delays.size)
                found.append(np.ascontiguousarray(np.moveaxis(spread, -1, self.place)))
        if self.of != "nobody":  # whom crossings leave open was counted with them
            left_open[asked.crossings.uncertain] = False
        self._count(chunk, left_open[:, :inside])
        return tuple(found)

    def _people(self, chunk: tuple[int, ...]) -> tuple[np.ndarray, np.ndarray]:
        """Return matrices and rigid joints on a chunk of the other axes."""
        *_, at = self._places(chunk)
        entries = _matrices(self.others)(self.inputs.fixed, self.inputs.pieces(at))
        numbers = np.stack([np.asarray(entry).ravel() for entry in entries]).reshape(5, 3, 3, -1)
        return numbers, np.isinf(numbers[2].diagonal()).T

    def _table(self, chunk: tuple[int, ...]) -> Crossings:
        """Return the crossings on a chunk of the other axes."""
        sides, *_, at = self._places(chunk)
        numbers, rigid = self.people(chunk)
        table = all_crossings(numbers, rigid, of=self.of, apply=self.apply)
        for person in np.flatnonzero(table.by_springs & table.uncertain):
            place = np.unravel_index(person, sides)
            varying = {
                name: self.study.axes[name][at[name][i]]
                for name, i in zip(self.others, place, strict=True)
            }
            table.settle(int(person), stands=_stands_exactly({**self.inputs.plainly, **varying}))
        with self._lock:  # a table may be found again, in another thread or once it was dropped
            again = chunk in self._counted
            self._counted.add(chunk)
        if not again:
            self._count(chunk, table.uncertain[:, None])
        return table

    def _places(
        self, chunk: tuple[int, ...]
    ) -> tuple[list[int], list[int], list[int], dict[str, np.ndarray]]:
        """Return sides and starts of a chunk of the other axes, their lengths, and its places."""
        sides = [
            side
            for name, side in zip(self.group.axes, self.group.chunk_shape, strict=True)
            if name != DELAY
        ]
        counts = [len(self.study.axes[name]) for name in self.others]
        starts = [number * side for number, side in zip(chunk, sides, strict=True)]
        at = dict(zip(self.others, map(along_axis, starts, sides, counts), strict=True))
        return sides, starts, counts, at

    def _variances(
        self,
        chunk: tuple[int, ...],
        table: Crossings,
        delays: np.ndarray,
        left_open: np.ndarray,
    ) -> dict[int, np.ndarray]:
        """Return the integrals of the rows that are asked, of each person at each delay.

        They are NaN, and noted in ``left_open``, where rounding leaves open whether the person
        stands, and where they could not be integrated that accurately.
        """
        numbers, rigid = self.people(chunk)
        *_, at = self._places(chunk)
        moved = _moved(self.others)(self.inputs.fixed, self.inputs.pieces(at))
        more = np.stack([np.asarray(entry).ravel() for entry in moved])
        persons = rigid.shape[1]

        def each(values: np.ndarray) -> np.ndarray:
            return np.repeat(values, delays.size, axis=-1)

        of_each = each(numbers), each(rigid), np.tile(delays, persons)
        dies_out = damped(*of_each)
        swaying = swaying_of(
            *of_each, each(more[:3]), each(more[3:6]), each(more[6]),
        )  # fmt: skip
        found, sure = variances(
            self.rows,
            swaying,
            table.stable_at(delays).ravel() & dies_out,
            undecided=table.open_at(delays).ravel() & dies_out,
            accuracy=OF_GRIDS,
            apply=self.apply,
        )
        # a point is left open once, however many of its rows are
        left_open |= (~sure).any(axis=0).reshape(persons, -1)
        return dict(zip(self.rows, found.reshape(-1, persons, delays.size), strict=True))

    def _roots(
        self, chunk: tuple[int, ...], delays: np.ndarray, left_open: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Return the rightmost root of each person at each delay, and whether it is proven.

        Where it is not is noted in ``left_open``.
        """
        numbers, rigid = self.people(chunk)
        persons = rigid.shape[1]
        root, proven = all_rightmost(
            np.repeat(numbers, delays.size, axis=-1),
            np.repeat(rigid, delays.size, axis=-1),
            np.tile(delays, persons),
            apply=self.apply,
        )
        proven = proven.reshape(persons, -1)
        left_open |= ~proven
        return root.reshape(persons, -1), proven

    def _count(self, chunk: tuple[int, ...], left_open: np.ndarray) -> None:
        """Count what is left open of (persons, delays), but not beyond the ends of axes."""
        sides, starts, counts, _ = self._places(chunk)
        inside = tuple(
            slice(min(side, count - start))
            for side, count, start in zip(sides, counts, starts, strict=True)
        )
        number = int(left_open.reshape(*sides, -1)[inside].sum())
        with self._lock:
            self.left_open += number


@lru_cache(maxsize=64)
def _matrices(axes: tuple[str, ...]) -> Any:
    """Compile the entries of A, B, C, P and D over some axes."""

    def of_one(given: dict[str, Any]) -> tuple[Array, ...]:
        person = Person.of(given)
        parts = equation_of(person.body, person.stiffness, person.gravity, person.given)
        entries = (entry for part in parts for row in part for entry in row)
        return tuple(jnp.asarray(entry, jnp.float64) for entry in entries)

    return map_over_grid(of_one, axes)


@lru_cache(maxsize=64)
def _moved(axes: tuple[str, ...]) -> Any:
    """Compile what sway needs beside the matrices: noises, the loads at the ankle, the weight."""

    def of_one(given: dict[str, Any]) -> tuple[Array, ...]:
        person = Person.of(given)
        noises = (person.given[name] for name in NOISES)
        loads, _, _ = joint_gravity(person.body, person.gravity)
        weight = person.gravity * sum(person.body.segment_mass)
        return tuple(jnp.asarray(entry, jnp.float64) for entry in (*noises, *loads, weight))

    return map_over_grid(of_one, axes)


def _stands_exactly(given: Mapping[str, Any]) -> bool:
    """Return the verdict of springs in exact arithmetic, of parameters by name."""
    threshold = exact_threshold(given)
    return threshold is not None and float(given["ankle_stiffness"]) > threshold
