"""Functions of one person mapped over axes, over points, over persons: all ``jit`` and ``vmap``."""

import math
from collections.abc import Callable, Hashable, Mapping
from functools import lru_cache, partial
from typing import Any

import jax
import numpy as np

from standfast.anthropometry.body import REFERENCE_PEOPLE
from standfast.numerics.arrays import Scalar
from standfast.parameters import PARAMETERS
from standfast.study.study import Study

OfOne = Callable[[dict[str, Any]], Any]
OfModelAndOne = Callable[[Any, dict[str, Scalar]], dict[str, Scalar]]

# Without it XLA uses half of the vector registers that many processors have.
COMPILER_OPTIONS = {"xla_cpu_prefer_vector_width": 512}
VECTOR = 8  # float64 in such a register


def map_over_grid(function: OfOne, axes: tuple[str, ...]) -> Callable[..., Any]:
    """Compile a function of one person's parameters over the grid of some of them.

    The result takes the parameters that are fixed and the pieces of the axes, by name; the last
    axis is fastest. It is mapped one axis at a time, so that each intermediate result is computed
    on its own axes alone: gravity loads on those of the body, and so on.
    """

    def of_all(fixed: dict[str, Any], varying: dict[str, Any]) -> Any:
        return function({**fixed, **varying})

    for mapped in reversed(axes):
        along = {name: 0 if name == mapped else None for name in axes}
        of_all = jax.vmap(of_all, in_axes=(None, along))
    return compiled(of_all)


def map_over_points(function: OfOne) -> Callable[..., Any]:
    """Compile a function of one person's parameters over points, whose parameters all vary."""
    return compiled(
        jax.vmap(lambda fixed, varying: function({**fixed, **varying}), in_axes=(None, 0))
    )


# Persons that are handed to a compiled function at once: small enough for the processor's cache.
BATCH = 4096
# So many, the blocks of long runs, are handed over as they come: in batches they take longer.
WHOLE = 2**17


def map_over_batch(
    function: OfModelAndOne, model: Any, names: tuple[str, ...]
) -> Callable[[np.ndarray], dict[str, np.ndarray]]:
    """Map a function of a model and one person's named numbers over many persons.

    Takes the numbers as an array (names, persons) and gives an array of persons a result. A model
    is made of tuples. Its finite floats are arguments of the program; words and ``inf``, with which
    a program is simpler, are part of it. So another mean or gravity compiles nothing: compiled
    once for each function and structure of a model, for batches, and for each length from WHOLE on.
    """
    leaves, made = jax.tree.flatten(model)
    structure = tuple(None if _is_argument(leaf) else leaf for leaf in leaves)
    arguments = np.array([leaf for leaf in leaves if _is_argument(leaf)], np.float64)
    mapped = _of_structure(function, made, structure, names)

    def evaluate(numbers: np.ndarray) -> dict[str, np.ndarray]:
        run = partial(mapped, arguments)
        with jax.enable_x64(True):
            is_whole = numbers.shape[1] >= WHOLE
            found = run(numbers) if is_whole else _batch_by_batch(run, numbers)
            return {name: np.asarray(values) for name, values in found.items()}

    return evaluate


def _is_argument(leaf: Any) -> bool:
    return isinstance(leaf, float) and math.isfinite(leaf)


@lru_cache(maxsize=128)
def _of_structure(
    function: OfModelAndOne, made: Hashable, structure: tuple[Hashable, ...], names: tuple[str, ...]
) -> Callable[..., Any]:
    """Compile a function for models made in one way, whose arguments are None in ``structure``."""

    def of_one(arguments: Scalar, column: Scalar) -> dict[str, Scalar]:
        given = iter(arguments)
        model = jax.tree.unflatten(made, [next(given) if s is None else s for s in structure])
        return function(model, {name: column[row] for row, name in enumerate(names)})

    return compiled(jax.vmap(of_one, in_axes=(None, 1)))


def in_batches(function: Callable[..., Any], problem: Hashable, *arrays: np.ndarray) -> Any:
    """Apply a pure function of a problem and arrays, persons last, compiled, batch by batch.

    What :mod:`standfast.stability.delay` hands its functions to as ``apply``. Every batch has one
    length, so that each function compiles once a problem.
    """
    with jax.enable_x64(True):
        return _batch_by_batch(_of_batch(function, problem), *arrays)


def _batch_by_batch(run: Callable[..., Any], *arrays: np.ndarray) -> Any:
    """Return what a compiled function gives of arrays, persons last, of any number of persons."""
    count = arrays[-1].shape[-1]
    pieces = []
    for first in range(0, max(count, 1), BATCH):
        batch = [array[..., first : first + BATCH] for array in arrays]
        size = batch[-1].shape[-1]
        if size < BATCH:
            # beyond the end the last person again; of nobody ones, which are thrown away
            batch = [_filled_up(array) for array in batch]
        found = run(*batch)
        pieces.append(jax.tree.map(lambda part, size=size: np.asarray(part)[..., :size], found))
    return jax.tree.map(lambda *parts: np.concatenate(parts, axis=-1), *pieces)


def _filled_up(array: np.ndarray) -> np.ndarray:
    missing = BATCH - array.shape[-1]
    if not array.shape[-1]:
        return np.ones((*array.shape[:-1], BATCH))
    return np.concatenate([array, np.repeat(array[..., -1:], missing, axis=-1)], axis=-1)


@lru_cache(maxsize=128)
def _of_batch(function: Callable[..., Any], problem: Hashable) -> Callable[..., Any]:
    return compiled(lambda *arrays: function(problem, *arrays))


def compiled(function: Callable[..., Any]) -> Callable[..., Any]:
    """Compile a function with what this machine's processor likes."""
    options = COMPILER_OPTIONS if jax.default_backend() == "cpu" else None
    return jax.jit(function, compiler_options=options)


class Inputs:
    """The parameters of a study as functions of a person take them: fixed, and along the axes.

    ``plainly`` holds those that are fixed as the study says them. What may be left out and is, or
    is given its default, is none of them: a program without it is simpler, and the same for all.
    """

    def __init__(self, study: Study) -> None:
        self.along = {name: _along(name, values) for name, values in study.axes.items()}
        self.plainly = {name: v for name, v in study.fixed.items() if not _is_left_out(name, v)}
        self.fixed = {
            name: jax.tree.map(lambda leaf: leaf[0], _along(name, np.array([value])))
            for name, value in self.plainly.items()
        }

    @property
    def given(self) -> set[str]:
        """The names of all parameters that a program takes."""
        return self.fixed.keys() | self.along.keys()

    def pieces(self, places: Mapping[str, np.ndarray]) -> dict[str, Any]:
        """Return what lies at some places of each axis."""
        return {
            name: jax.tree.map(lambda leaf, at=at: leaf[at], self.along[name])
            for name, at in places.items()
        }


def _is_left_out(name: str, value: float | str) -> bool:
    row = PARAMETERS[name]
    return row.unwritten and value == row.default


def _along(name: str, values: np.ndarray) -> Any:
    """Return the inputs of an axis: its values, or for body models their reference people."""
    if name != "body_model":
        return values
    people = [REFERENCE_PEOPLE[model] for model in values]
    return jax.tree.map(lambda *leaves: np.stack(leaves), *people)


def along_axis(start: int, length: int, count: int) -> np.ndarray:
    """Return the places of a chunk on an axis, repeating the last one beyond the axis's end."""
    return np.minimum(np.arange(start, start + length), count - 1)


def in_whole_vectors(shape: tuple[int, ...]) -> tuple[int, ...]:
    """Return the shape on which a chunk is computed: its last axis in whole vectors.

    What does not fill a vector of the processor is computed number by number, as slowly as
    several vectors.
    """
    if not shape or shape[-1] <= VECTOR // 2:
        return shape
    return (*shape[:-1], VECTOR * -(-shape[-1] // VECTOR))
