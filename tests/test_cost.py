"""What the compiled hot kernels do, counted, not timed: a guard against slow code coming back.

Counts are XLA's own, of operations and of bytes that a program reads and writes, a point. Bounds
are a tenth above what was counted when they were written; a change of XLA may move them, a change
of ours should have a reason. LAPACK, a loop or a scatter in a kernel would be hundreds of times
slower and is found by its name.
"""

from functools import partial

import jax
import numpy as np
import pytest

import standfast as sf
from populations import GOOD, of
from standfast.body import Body, Stiffness
from standfast.engine.mapping import Inputs, compiled, over_axes
from standfast.engine.values import _two_eigenvalues
from standfast.modes import modes, quick_eigenvalues
from standfast.population.crowd import crowd_of
from standfast.population.tally import cell, places
from standfast.stability import safety_factor, threshold_interval

STARTING_IN_SINGLE_PRECISION = {"quick eigenvalues", "safety factor"}

POINTS = 4096
SLOW = ("custom-call", "while(", "scatter(", "gather(", "sort(")


def program(function, *arguments):
    """The compiled program, its operations and its bytes a point."""
    with jax.enable_x64(True):
        done = compiled(jax.vmap(function)).lower(*arguments).compile()
    cost = done.cost_analysis()
    return done.as_text(), cost["flops"] / POINTS, cost["bytes accessed"] / POINTS


def stiffnesses():
    random = np.random.default_rng(1)
    return tuple(random.uniform(300.0, 3000.0, POINTS) for _ in range(3))


BODY = Body.edwards2007()


def lowest_unless_in_doubt(body, stiffness, gravity):
    low, _, _, doubt = quick_eigenvalues(body, stiffness, gravity)
    return jax.numpy.where(doubt, jax.numpy.nan, low)


# Function of a point, and bounds on operations and bytes, with the reason.
KERNELS = {
    # counted: 344 and 112. Coefficients, a determinant in pairs, a start in single precision, a
    # step of Halley, a quadratic, an error estimate: in one loop, with one array as its result
    "quick eigenvalues": (
        lambda a, k, h: lowest_unless_in_doubt(BODY, Stiffness._make((a, k, h)), 9.8),
        380.0,
        124.0,
    ),
    # 203 and 216: three divisions, a start in single precision, two steps of Halley, a verdict
    "safety factor": (
        lambda a, k, h: safety_factor(BODY, Stiffness._make((a, k, h)), 9.8),
        224.0,
        238.0,
    ),
    # 121 and 256: the certain ends of a threshold: the recursion and its running error
    "threshold": (lambda a, k, h: threshold_interval(BODY, k, h, 9.8), 140.0, 300.0),
    # 2063 and 2088: the accurate way, for the few points in doubt: sums of 79 bits
    "modes": (
        lambda a, k, h: modes(BODY, Stiffness._make((a, k, h)), 9.8).eigenvalues,
        2270.0,
        2300.0,
    ),
}


@pytest.mark.parametrize("name", KERNELS)
def test_a_kernel_does_no_more_than_it_did(name):
    function, operations, accessed = KERNELS[name]
    text, flops, size = program(function, *stiffnesses())
    assert flops <= operations
    assert size <= accessed
    assert not [word for word in SLOW if word in text]
    assert ("f32[" in text) == (name in STARTING_IN_SINGLE_PRECISION)


@pytest.mark.parametrize(
    ("function", "operations", "accessed"), [(cell, 80.0, 119.0), (places, 980.0, 1385.0)]
)
def test_a_person_costs_no_more_than_they_did(function, operations, accessed):
    """Drawing the numbers of a person costs about 50 ns; judging them must stay below."""
    crowd = crowd_of(of(GOOD, size=POINTS), None)
    scores = crowd.sampler.scores(0, 0, POINTS)

    def of_one(column):
        return function(crowd.model, dict(zip(crowd.names, column, strict=True)))

    text, flops, size = program(of_one, np.ascontiguousarray(scores.T))
    assert flops <= operations
    assert size <= accessed
    assert not [word for word in SLOW if word in text]


def test_eigenvalues_on_a_grid_are_one_loop():
    """XLA cuts at a division whose result is used twice; then each part computes all anew."""
    study = sf.Study.from_dict(
        {
            "body": {"height": 1.7, "mass": 70.0},
            "stiffness": {
                joint: list(np.arange(100.0, 116.0)) for joint in ("ankle", "knee", "hip")
            },
            "output": {"quantities": ["frequency"]},
        }
    )
    inputs = Inputs(study)
    at = {name: np.arange(16) for name in study.axes}
    with jax.enable_x64(True):
        mapped = over_axes(partial(_two_eigenvalues, ()), tuple(study.axes))
        text = mapped.lower(inputs.fixed, inputs.pieces(at), {}).compile().as_text()
    assert text[text.index("ENTRY") :].count("c128[16,16,16]{2,1,0} fusion(") == 1
    assert text[text.index("ENTRY") :].count("[16,16,16]{2,1,0} fusion(") == 1


def test_lapack_would_be_noticed():
    def by_lapack(a, k, h):
        return jax.numpy.linalg.eigvalsh(jax.numpy.diag(jax.numpy.stack([a, k, h])))

    text, _, _ = program(by_lapack, *stiffnesses())
    assert [word for word in SLOW if word in text]


def test_a_chunk_of_equal_verdicts_costs_nothing():
    """It is a view of one number: no bytes of a chunk are written."""
    study = sf.Study.from_dict(
        {
            "body": {"height": 1.7, "mass": 70.0},
            "stiffness": {"ankle": [1.0, 2.0], "knee": [700.0, 800.0], "hip": [300.0, 400.0]},
        }
    )
    (stable,) = sf.engine.Evaluator(study)(study.tile(0, 0))
    assert stable.strides == (0, 0, 0)
    assert not stable.any()
