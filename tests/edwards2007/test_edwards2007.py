"""The comparison table: its intervals are those of all corners, its verdicts those of the notes."""

import itertools

import numpy as np
import pytest

import standfast as sf
from standfast.edwards2007 import published
from standfast.edwards2007.comparison import (
    AGREES,
    NOT_REPRODUCED,
    WITHIN_ROUNDING,
    Comparison,
    as_markdown,
    compare,
    rounding_interval,
)
from standfast.edwards2007.published import INPUT_ROUNDING, PUBLISHED

VERDICTS = {
    "731.3": WITHIN_ROUNDING,
    "179.7": NOT_REPRODUCED,
    "73.18": AGREES,
    "1.02": AGREES,
    "11.11": AGREES,
    "87.10": WITHIN_ROUNDING,
    "75.3": AGREES,
    "75.2": NOT_REPRODUCED,
    "75": AGREES,
    "just below 400": AGREES,
    "600 at the corner": AGREES,
    "0.002": WITHIN_ROUNDING,
    "0.43": AGREES,
    "1.50": NOT_REPRODUCED,
    "-2.07": NOT_REPRODUCED,
    "falls": AGREES,
}


@pytest.fixture(scope="module")
def comparisons():
    return compare()


def test_verdicts(comparisons):
    assert {row.published.printed: row.verdict for row in comparisons} == VERDICTS


@pytest.mark.parametrize(
    ("text", "low", "high", "within"),
    [
        ("731.3", 730.2, 732.1, 0.06),
        ("179.7", 179.93, 180.44, 0.006),
        ("87.10", 86.96, 87.38, 0.006),
        ("1.50", 2.7249, 2.7287, 0.6e-4),
        ("-2.07", -2.463, -2.456, 0.6e-3),
    ],
)
def test_intervals_of_input_rounding(comparisons, text, low, high, within):
    row = next(row for row in comparisons if row.published.printed == text)
    assert row.lowest == pytest.approx(low, abs=within)
    assert row.highest == pytest.approx(high, abs=within)


def test_interval_of_the_neutral_eigenvalue():
    def eigenvalue(body):
        return float(sf.modes(body, published.FIGURE_4, published.GRAVITY).eigenvalues[0])

    low, high = rounding_interval(eigenvalue, sf.Body.edwards2007())
    assert low == pytest.approx(-0.0106, abs=0.6e-4)
    assert high == pytest.approx(0.0117, abs=0.6e-4)


# The curves of figure 5 take 39 modes a corner: they are left to the slopes.
@pytest.mark.parametrize(
    "number", [row for row in PUBLISHED if row.where != "Fig. 5"], ids=lambda row: row.printed
)
def test_no_corner_of_the_box_of_inputs_lies_outside_the_interval(number):
    body = sf.Body.edwards2007()
    centre = np.concatenate(body)
    low, high = rounding_interval(number.compute, body)
    corners = [
        number.compute(
            sf.Body._make(np.split(centre + INPUT_ROUNDING * np.array(signs), [3, 6, 8]))
        )
        for signs in itertools.product((-1.0, 1.0), repeat=centre.size)
    ]
    slack = 1e-9 * abs(centre).max()
    assert low - slack <= min(corners)
    assert max(corners) <= high + slack
    assert low == pytest.approx(min(corners), abs=slack)
    assert high == pytest.approx(max(corners), abs=slack)


def test_a_number_off_by_more_than_rounding_is_not_reproduced():
    number = next(row for row in PUBLISHED if row.printed == "1.02")
    assert Comparison(number, 1.02, 1.01, 1.03).verdict == AGREES
    assert Comparison(number, 1.03, 1.02, 1.04).verdict == WITHIN_ROUNDING
    assert Comparison(number, 1.04, 1.03, 1.05).verdict == NOT_REPRODUCED


def test_the_page_says_what_is_known_of_the_numbers_that_differ(comparisons):
    page = as_markdown(comparisons)
    assert page.count("| **not reproduced** [") == 4
    for row in comparisons:
        if row.verdict == NOT_REPRODUCED:
            assert row.published.note
            assert row.published.note in page
