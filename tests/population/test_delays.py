"""Ready delays of feedback: what they are made of, and that they say so."""

import math

import numpy as np
import pytest

from standfast.mechanics.laws import LAWS
from standfast.parameters import checked_number
from standfast.population.people.builtin import READY_DELAYS
from standfast.population.people.distributions import DISTRIBUTIONS

MILLISECOND = 5e-4  # half a unit of the last digit of the table


def test_the_young_are_the_mean_and_spread_of_published_values():
    """One value a source; the five amplitudes of tilt are one source."""
    tilts = [law.delay for name, law in LAWS.items() if name.startswith("independent-channel")]
    assert len(tilts) == 5
    values = [LAWS[name].delay for name in ("pasma-2017", "light-touch-2017", "dec-2015")]
    values += [READY_DELAYS["jner-2017"].distribution["value"], np.mean(tilts)]
    young = READY_DELAYS["young"].distribution
    assert young["mean"] == pytest.approx(np.mean(values), abs=MILLISECOND)
    assert young["sd"] == pytest.approx(np.std(values, ddof=1), abs=MILLISECOND)


def test_the_old_are_slower_by_what_is_said():
    young, old = READY_DELAYS["young"].distribution, READY_DELAYS["old"].distribution
    assert old["mean"] == pytest.approx(young["mean"] + young["sd"], rel=1e-12)
    assert old["sd"] == young["sd"]


@pytest.mark.parametrize("name", READY_DELAYS)
def test_a_delay_says_what_it_is_and_whether_it_is_assumed(name):
    delay = READY_DELAYS[name]
    numbers = dict(delay.distribution)
    kind = numbers.pop("distribution")
    assert tuple(numbers) == DISTRIBUTIONS[kind]
    for value in numbers.values():
        assert checked_number("feedback_delay", value) == value
    assert delay.source
    assert delay.assumed is bool(delay.rests_on)
    assert delay.assumed is (kind != "fixed")  # no spread between persons was seen
    if kind == "normal":  # the cut at 0 takes nearly nobody
        assert math.erfc(numbers["mean"] / numbers["sd"] / math.sqrt(2.0)) / 2.0 < 1e-4


def test_published_delays_are_those_of_the_law():
    assert READY_DELAYS["pasma-2017"].distribution["value"] == LAWS["pasma-2017"].delay
