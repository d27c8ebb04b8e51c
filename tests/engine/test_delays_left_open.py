"""Grids of delayed feedback: what rounding leaves open is no number, and counted once."""

import math

import numpy as np
import pytest

import standfast as sf
from standfast.engine import delays as engine
from standfast.engine.grid import Evaluator
from standfast.quantities import QUANTITIES
from standfast.stability.delay.persons import all_crossings
from standfast.study import grid

# The SD of an ankle so near to its critical delay is a thousand times the usual one, with no digit.
NEAREST = 1.0 - 1e-11


def near_to_falling():
    """One person, and delays at which they stand, all but fall, and fall."""
    body = sf.Body.from_height_mass(1.7, 70.0)
    rigid = sf.Stiffness(400.0, math.inf, math.inf)
    feedback = sf.Feedback((400.0, 0, 0), (200.0, 0, 0), 0.0)
    person = {"gravity": 9.8, "damping": (30.0, 0, 0), "feedback": feedback}
    critical = sf.critical_delay(body, rigid, **person)
    late = [0.1, 0.2, NEAREST * critical, 1.1 * critical]
    content = {
        "body": {"height": 1.7, "mass": 70.0},
        "gravity": 9.8,
        "stiffness": {"ankle": 400.0, "knee": math.inf, "hip": math.inf},
        "damping": {"ankle": 30.0},
        "feedback": {"proportional": {"ankle": 400.0}, "derivative": {"ankle": 200.0}},
        "noise": {"ankle": [0.5, 1.0]},
    }
    content["feedback"]["delay"] = late
    of_delay = [
        (body, rigid, {**person, "feedback": feedback._replace(delay=delay)}) for delay in late
    ]
    return content, of_delay


SWAY = [name for name, row in QUANTITIES.items() if row.variances]


@pytest.mark.parametrize("quantities", [["ankle_sway"], ["cop_frequency"], SWAY])
def test_what_cannot_be_integrated_is_no_number_and_counted_once(quantities):
    content, of_delay = near_to_falling()
    study = sf.Study.from_dict({**content, "output": {"quantities": quantities}})
    axes = list(study.axes)
    evaluate = Evaluator(study)
    (tile,) = study.grid.shard(0)
    for name, values in zip(quantities, evaluate(tile), strict=True):
        by_delay = np.moveaxis(np.squeeze(values), axes.index("feedback_delay"), 0)
        if name not in ("knee_sway", "hip_sway"):  # rigid: of these it is sure that they are 0
            assert np.isfinite(by_delay[:2]).all(), name
            assert np.isnan(by_delay[2]).all(), name
            assert not np.isfinite(by_delay[3]).any(), name
    # the one delay at two noises, whatever is asked of them
    assert evaluate.left_open == 2
    for (body, rigid, person), wanted in zip(of_delay, ("", "", "too near", "falls"), strict=True):
        if wanted == "too near":
            with pytest.raises(ArithmeticError, match=wanted):
                sf.sway_covariance(body, rigid, **person, noise=(1.0, 0, 0))
        else:
            found = sf.sway_covariance(body, rigid, **person, noise=(1.0, 0, 0))
            assert math.isfinite(found[0, 0]) == (wanted != "falls")


def test_what_lies_beyond_the_end_of_an_axis_is_not_counted(monkeypatch):
    """Chunks at the end of an axis repeat its last value, which here is the one left open."""
    monkeypatch.setattr(grid, "FED_BACK_NUMBERS", 2)
    content, _ = near_to_falling()
    content["feedback"]["delay"] = content["feedback"]["delay"][:3]
    study = sf.Study.from_dict({**content, "output": {"quantities": ["ankle_sway"]}})
    (group,) = study.grid.groups
    assert group.chunk_shape[list(study.axes).index("feedback_delay")] == 2
    evaluate = Evaluator(study)
    for shard in range(study.grid.shard_count):
        for tile in study.grid.shard(shard):
            evaluate(tile)
    assert evaluate.left_open == 2


def test_of_whom_rounding_leaves_the_verdict_open_no_sway_is_told():
    """At the critical delay itself, and with gains that hold exactly what topples."""
    content, of_delay = near_to_falling()
    body, rigid, person = of_delay[0]
    critical = sf.critical_delay(body, rigid, **person)
    content["feedback"]["delay"] = [0.1, critical, (1.0 + 1e-9) * critical]
    content["noise"] = {"ankle": 1.0}
    load = -float(sf.stiffness_matrix(body, sf.Stiffness(0.0, math.inf, math.inf), 9.8)[0, 0])
    # of the first the gain is short of what topples, of the second it is the same
    gains = [load - 400.0 - 1.0, load - 400.0, 400.0]
    content["feedback"]["proportional"] = {"ankle": gains}
    names = ["ankle_sway", "cop_frequency"]
    study = sf.Study.from_dict({**content, "output": {"quantities": names}})
    evaluate = Evaluator(study)
    (tile,) = study.grid.shard(0)
    place = [list(study.axes).index(n) for n in ("ankle_proportional_gain", "feedback_delay")]
    sway, frequency = (np.squeeze(np.moveaxis(v, place, (0, 1))) for v in evaluate(tile))
    assert np.isinf(sway[0]).all()
    assert np.isnan(sway[1]).all()
    stands, at_critical, falls = sway[2]
    assert math.isfinite(stands)
    assert math.isnan(at_critical)
    assert math.isinf(falls)
    assert np.isfinite(frequency).sum() == 1
    # a person by its crossings, and another at one delay
    assert evaluate.left_open == 2


@pytest.mark.parametrize("quantities", [["stable"], ["ankle_sway", "decay_rate"]])
def test_a_table_that_is_found_again_is_counted_once(monkeypatch, quantities):
    """With a gain's axis after the delay's the tables go round, and none is kept."""
    monkeypatch.setattr(engine, "KEPT", 1)
    monkeypatch.setattr(grid, "FED_BACK_NUMBERS", 2)
    monkeypatch.setattr(grid, "CHUNK_BYTES", 2)
    content, _ = near_to_falling()
    body = sf.Body.from_height_mass(1.7, 70.0)
    load = -float(sf.stiffness_matrix(body, sf.Stiffness(0.0, math.inf, math.inf), 9.8)[0, 0])
    content["feedback"] = {
        "delay": [0.05, 0.1, 0.15, 0.2],
        "proportional": {"ankle": [load - 400.0, 400.0]},
        "derivative": {"ankle": 200.0},
    }
    content["noise"] = {"ankle": 1.0}
    study = sf.Study.from_dict({**content, "output": {"quantities": quantities}})
    tiles = [tile for number in range(study.grid.shard_count) for tile in study.grid.shard(number)]
    assert [tile.chunk for tile in tiles] == [(0, 0), (0, 1), (1, 0), (1, 1)]  # delays, gains
    tables = []

    def remembered(*args, **how):
        tables.append(all_crossings(*args, **how))
        return tables[-1]

    monkeypatch.setattr(engine, "all_crossings", remembered)
    evaluate = Evaluator(study)
    for tile in tiles:
        evaluate(tile)
    assert sum(int(table.uncertain.sum()) for table in tables) > 1  # found again
    assert evaluate.left_open == 1
