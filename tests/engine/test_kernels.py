"""What the compiled hot kernels are made of: their costs are in benchmarks/cost.py."""

import jax
import numpy as np
import pytest

import standfast as sf
from kernels import KERNELS, SLOW, program, stiffnesses
from standfast.engine.grid import Evaluator


@pytest.mark.parametrize("name", KERNELS)
def test_a_kernel_has_no_lapack_no_loop_and_no_single_precision(name):
    function, arguments = KERNELS[name]
    text = program(function, *arguments()).as_text()
    assert not [word for word in SLOW if word in text]
    assert "f32[" not in text


def test_lapack_and_single_precision_would_be_noticed():
    def by_lapack(a, k, h):
        single = jax.numpy.asarray(a, jax.numpy.float32) * 2.0
        return jax.numpy.linalg.eigvalsh(jax.numpy.diag(jax.numpy.stack([single, k, h])))

    text = program(by_lapack, *stiffnesses()).as_text()
    assert [word for word in SLOW if word in text]
    assert "f32[" in text


def test_a_tile_of_equal_verdicts_is_known_without_computing_it():
    study = sf.Study.from_dict(
        {
            "body": {"height": 1.7, "mass": 70.0},
            "stiffness": {"ankle": [1.0, 2.0], "knee": [700.0, 800.0], "hip": [300.0, 400.0]},
        }
    )
    evaluate, tile = Evaluator(study), study.grid.tile(0, 0)
    assert evaluate.uniform(tile) == 0
    assert not evaluate(tile)[0].any()
    crossed = sf.Study.from_dict(
        {
            "body": {"height": 1.7, "mass": 70.0},
            "stiffness": {"ankle": [1.0, 1e6], "knee": [1e4, 1e5], "hip": [1e3, 1e4]},
        }
    )
    assert Evaluator(crossed).uniform(crossed.grid.tile(0, 0)) is None


def test_results_of_many_tiles_held_at_once_lie_in_memory_of_their_own():
    """No result is used again for another while somebody holds it, whoever counts references."""
    axis = {"start": 300.0, "stop": 3000.0, "num": 160}
    study = sf.Study.from_dict(
        {
            "body": {"height": 1.7, "mass": 70.0},
            "stiffness": {"ankle": axis, "knee": axis, "hip": axis},
            "output": {"quantities": ["stable", "frequency"]},
        }
    )
    evaluate = Evaluator(study)
    tiles = [
        study.grid.tile(group, number)
        for group in range(2)
        for number in range(study.grid.groups[group].tile_count)
    ]
    held = [evaluate(tile)[0] for tile in tiles]
    copies = [np.array(values) for values in held]
    again = [evaluate(tile)[0] for tile in tiles]
    for number, (first, copy, second) in enumerate(zip(held, copies, again, strict=True)):
        assert np.array_equal(first, copy)
        assert np.array_equal(first, second)
        assert not np.shares_memory(first, second)
        assert not any(np.shares_memory(first, other) for other in held[:number])
