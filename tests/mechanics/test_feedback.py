"""Damping and feedback as they are kept: frozen matrices, pytrees, and rows of a study."""

import jax
import numpy as np
import pytest

import standfast as sf
from standfast.mechanics import feedback
from standfast.parameters import JOINTS, PARAMETERS


def test_three_numbers_are_a_diagonal_and_a_matrix_stays():
    P = [[900.0, 0.0, 175.0], [0.0, 0.0, 0.0], [-20.0, 0.0, 300.0]]
    one = sf.Feedback((900, 0, 300), np.array([185.0, 0.0, 10.0]), delay=0.1)
    np.testing.assert_array_equal(one.proportional, np.diag([900.0, 0.0, 300.0]))
    np.testing.assert_array_equal(one.derivative, np.diag([185.0, 0.0, 10.0]))
    other = sf.Feedback(proportional=P)
    np.testing.assert_array_equal(other.proportional, P)
    np.testing.assert_array_equal(other.derivative, np.zeros((3, 3)))
    assert (one.delay, other.delay) == (0.1, 0.0)
    assert one == sf.Feedback(one.proportional, one.derivative, one.delay) != other
    for kept in (*one[:2], *other[:2], feedback.checked_damping((1.0, 2.0, 3.0))):
        assert kept.dtype == np.float64
        with pytest.raises(ValueError, match="read-only"):
            kept[0, 0] = 1.0


def test_feedback_is_a_pytree_that_can_be_mapped_and_differentiated():
    laws = [sf.Feedback((900.0 + i, 0.0, 3.0 * i), delay=0.1 * i) for i in range(3)]
    assert jax.tree.map(lambda leaf: leaf, laws[1]) == laws[1]
    batch = jax.tree.map(lambda *leaves: np.stack(leaves), *laws)

    def moment(law):
        return law.proportional[0, 0] + 2.0 * law.proportional[2, 2] + law.delay

    with jax.enable_x64(True):
        found = jax.vmap(moment)(batch)
        slope = jax.grad(lambda p: moment(sf.Feedback([p, 0.0, p], delay=0.1)))(5.0)
    np.testing.assert_allclose(found, [moment(law) for law in laws], rtol=1e-15)
    assert slope == 3.0


def test_damping_is_symmetric_and_takes_energy():
    np.testing.assert_array_equal(feedback.checked_damping(None), np.zeros((3, 3)))
    coupled = [[10.0, -3.0, 0.0], [-3.0, 5.0, 0.0], [0.0, 0.0, 0.0]]
    np.testing.assert_array_equal(feedback.checked_damping(coupled), coupled)
    # singular but for rounding: what muscles across two joints give
    arms = np.array([0.05, 0.08, 0.03])
    feedback.checked_damping(1000.0 * np.outer(arms, arms))


def test_rows_come_from_the_names_of_a_study():
    """The row is the joint that makes the moment, the column the one whose rotation is sensed."""
    given = {
        "ankle_damping": 1.0, "hip_damping": 3.0, "ankle_hip_proportional_gain": 13.0,
        "hip_ankle_proportional_gain": 31.0, "knee_derivative_gain": 22.0, "feedback_delay": 0.2,
    }  # fmt: skip
    assert feedback.damping_rows(given) == ((1.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 3.0))
    rows = ((0.0, 0.0, 13.0), (0.0, 0.0, 0.0), (31.0, 0.0, 0.0))
    assert feedback.gain_rows(given, "proportional") == rows
    assert feedback.gain_rows(given, "derivative")[1] == (0.0, 22.0, 0.0)
    assert feedback.delay_of(given) == 0.2
    assert feedback.delay_of({}) == 0.0
    left_out = feedback.gain_rows({}, "derivative")
    assert all(type(gain) is float for row in left_out for gain in row)


@pytest.mark.parametrize("kind", ["proportional", "derivative"])
def test_every_gain_has_a_row_in_the_table(kind):
    names = [feedback.gain_name(kind, moment, sensed) for moment in JOINTS for sensed in JOINTS]
    assert len(set(names)) == 9
    numbers = dict(zip(names, map(float, range(9)), strict=True))
    assert np.array(feedback.gain_rows(numbers, kind)).ravel().tolist() == list(range(9))
    for name in names:
        row = PARAMETERS[name]
        assert row.section == f"feedback.{kind}"
        assert row.unwritten
        assert row.default == 0.0


def test_a_gain_per_degree_gets_a_note():
    per_degree = {"ankle_proportional_gain": 15.0}
    assert feedback.likely_per_degree(per_degree) == (
        "ankle_proportional_gain = 15 N·m/rad is weak; if it is meant in N·m per degree, "
        "write 859.5 (57.3 times as much)"
    )
    for right in (859.5, 0.0, [10.0, 20.0], {"start": 0.0, "stop": 30.0, "num": 4}):
        assert feedback.likely_per_degree({"ankle_proportional_gain": right}) is None
    assert feedback.likely_per_degree({}) is None
