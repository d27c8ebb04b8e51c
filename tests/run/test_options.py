"""What says how a run is done is checked before anything is written."""

import pytest

import standfast as sf
from studies import GOOD


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        ({"threads": -1}, "threads = -1 is not a number of threads"),
        ({"threads": True}, "threads = True is not a number of threads"),
        ({"progress": 3}, "progress = 3 is not a function"),
        ({"estimate": "x"}, "estimate = 'x' is not a function"),
        ({"part": (True, 3)}, r"part = \(True, 3\) is not a share"),
    ],
)
def test_a_wrong_option_leaves_nothing(tmp_path, options, sentence):
    with pytest.raises(sf.InputError, match=sentence):
        sf.sweep(GOOD, tmp_path / "a.h5", **options)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("threads", [-1, 0, 1.5, True, "2"])
def test_a_grid_in_memory_wants_a_number_of_threads(threads):
    with pytest.raises(sf.InputError, match=r"threads = .* is not a number of threads"):
        sf.compute(GOOD, threads=threads)


def test_longest_delay_is_called_by_its_name():
    feedback = sf.Feedback((600.0, 0.0, 0.0), delay=0.1)
    person = sf.Body.edwards2007(), sf.Stiffness(500.0, 2000.0, 700.0)
    with pytest.raises(sf.InputError, match="longest = -1 is outside the allowed range"):
        sf.delay_crossings(*person, feedback=feedback, longest=-1.0)
