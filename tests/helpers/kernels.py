"""The hot kernels, compiled over a batch of points: for the tests and for benchmarks/cost.py."""

from collections.abc import Callable
from typing import Any

import jax
import numpy as np

import standfast as sf
from populations import GOOD, of
from standfast.engine.mapping import compiled
from standfast.population.cohort.cohort import cohort_of
from standfast.population.cohort.histograms import bins_of, class_of
from standfast.stability.fast import fast_eigenvalues
from standfast.stability.rounding import threshold_interval

POINTS = 4096
SLOW = ("custom-call", "while(", "scatter(", "gather(", "sort(")
BODY = sf.Body.edwards2007()


def program(function: Callable[..., Any], *arguments: Any) -> Any:
    """Compile a function of one point over a batch."""
    with jax.enable_x64(True):
        return compiled(jax.vmap(function)).lower(*arguments).compile()


def stiffnesses() -> tuple[np.ndarray, ...]:
    random = np.random.default_rng(1)
    return tuple(random.uniform(300.0, 3000.0, POINTS) for _ in range(3))


def of_stiffness(function: Callable[..., Any]) -> tuple[Callable[..., Any], Callable[[], Any]]:
    return lambda *joints: function(BODY, sf.Stiffness._make(joints), 9.8), stiffnesses


def of_person(function: Callable[..., Any]) -> tuple[Callable[..., Any], Callable[[], Any]]:
    cohort = cohort_of(of(GOOD, size=POINTS), None)

    def variates() -> tuple[np.ndarray]:
        return (np.ascontiguousarray(cohort.sampler.variates(0, 0, POINTS).T),)

    return (
        lambda column: function(cohort.model, dict(zip(cohort.names, column, strict=True)))
    ), variates


def lowest_or_nan(*person: Any) -> Any:
    """The lowest eigenvalue by the fast way, NaN where it is uncertain."""
    found, uncertain = fast_eigenvalues(*person)
    return jax.numpy.where(uncertain, jax.numpy.nan, found.eigenvalues[0])


# By name: a function of one point, and what gives its arguments.
KERNELS = {
    "fast eigenvalue": of_stiffness(lowest_or_nan),
    "safety factor": of_stiffness(sf.safety_factor),
    "threshold and its ends": of_stiffness(
        lambda body, joints, gravity: threshold_interval(body, joints.knee, joints.hip, gravity)
    ),
    "modes": of_stiffness(lambda *person: sf.modes(*person).eigenvalues),
    "class of a person": of_person(class_of),
    "all bins of a person": of_person(bins_of),
}
