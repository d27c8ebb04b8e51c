"""Compiled calls of the functions of delayed feedback: what is handed in as ``apply``."""

from functools import cache

import jax
import numpy as np

COLUMNS = 2048  # persons, cells or crossings in one call


def apply(function, problem, *arrays):
    """Call a function of the package compiled, in chunks; the last one is filled up."""
    with jax.enable_x64(True):
        parts = [
            _of_chunk(function, problem, [array[..., start : start + COLUMNS] for array in arrays])
            for start in range(0, max(arrays[-1].shape[-1], 1), COLUMNS)
        ]
    if isinstance(parts[0], tuple):
        return tuple(np.concatenate(each, axis=-1) for each in zip(*parts, strict=True))
    return np.concatenate(parts, axis=-1)


@cache
def _compiled(function, problem):
    return jax.jit(
        lambda *arrays: function(problem, *arrays),
        compiler_options={"xla_cpu_prefer_vector_width": 512},
    )


def _of_chunk(function, problem, arrays):
    count = arrays[-1].shape[-1]
    filled = [
        np.concatenate([a, np.repeat(a[..., -1:], COLUMNS - count, axis=-1)], axis=-1)
        if count
        else np.ones((*a.shape[:-1], COLUMNS))
        for a in arrays
    ]
    found = _compiled(function, problem)(*filled)
    if isinstance(found, tuple):
        return tuple(np.asarray(each)[..., :count] for each in found)
    return np.asarray(found)[..., :count]
