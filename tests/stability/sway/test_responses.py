"""Responses of readings to noise against the densities, their derivatives against differences."""

import numpy as np
import pytest

import standfast as sf
from standfast.numerics.arrays import TURN
from standfast.parameters import STANDARD_GRAVITY
from standfast.stability.feedback import numbers_of
from standfast.stability.sway.density import COM, COP, PAIRS, densities
from standfast.stability.sway.persons import swaying_of
from standfast.stability.sway.responses import READINGS, Change, responses

ROUNDING = 1e-11  # relative; two ways through the same matrices
CENTRAL = 1e-7  # of differences of 1e-5
OMEGA = TURN * np.geomspace(1e-3, 20.0, 60)
NOISE = np.array([0.7, 0.4, 0.9])
PEOPLE = {
    "three joints": sf.LAWS["lqr-pydy"].person,
    "leg and trunk": sf.LAWS["opty-park-2004"].person,
    "ankle": sf.LAWS["dec-2015"].person,
    "rigid ankle": {
        **sf.LAWS["lqr-pydy"].person, "stiffness": sf.Stiffness(np.inf, 300.0, 200.0),
    },
}  # fmt: skip
RISING = np.array([[0.9, 0.1, 0.2], [0.3, 0.8, 0.1], [0.2, 0.4, 0.7]])
CHANGES = {
    "proportional": Change(120.0 * RISING, np.zeros((3, 3)), 0.0),
    "derivative": Change(np.zeros((3, 3)), 30.0 * RISING, 0.0),
    "delay": Change(np.zeros((3, 3)), np.zeros((3, 3)), 0.05),
}


def swaying(person, change=None, step=0.0):
    body, stiffness, feedback = person["body"], person["stiffness"], person["feedback"]
    damping = np.asarray(person["damping"])
    numbers, rigid = numbers_of(body, stiffness, STANDARD_GRAVITY, damping, feedback)
    delay = np.array([0.1])
    if change is not None:
        numbers = numbers.copy()
        numbers[3, ..., 0] += step * change.proportional
        numbers[4, ..., 0] += step * change.derivative
        delay = delay + step * change.delay
    load = -np.asarray(sf.stiffness_matrix(body, sf.Stiffness(0.0, 0.0, 0.0)))[0]
    weight = np.array([STANDARD_GRAVITY * np.sum(body.segment_mass)])
    made = swaying_of(numbers, rigid, delay, NOISE[:, None], load[:, None], weight)
    return made, rigid[:, 0]


@pytest.mark.parametrize("who", PEOPLE)
def test_the_squares_of_responses_are_the_densities(who):
    person, rigid = swaying(PEOPLE[who])
    found, _ = responses(person, rigid, OMEGA, READINGS)
    rows = densities(person, OMEGA, OMEGA * person.delay)
    for name, row in zip(
        READINGS, [PAIRS.index((j, j)) for j in range(3)] + [COM, COP], strict=True
    ):
        of_reading = (person.noise * abs(found[READINGS.index(name)]) ** 2).sum(axis=0)
        held = (
            np.zeros_like(OMEGA)
            if name in READINGS[:3] and rigid[READINGS.index(name)]
            else rows[row]
        )
        np.testing.assert_allclose(of_reading, held, rtol=ROUNDING, atol=1e-30)


@pytest.mark.parametrize("way", CHANGES)
@pytest.mark.parametrize("who", PEOPLE)
def test_derivatives_are_those_of_the_responses(who, way):
    step, change = 1e-5, CHANGES[way]
    person, rigid = swaying(PEOPLE[who])
    _, slope = responses(person, rigid, OMEGA, READINGS, [change])
    ends = [
        responses(swaying(PEOPLE[who], change, side)[0], rigid, OMEGA, READINGS)[0]
        for side in (step, -step)
    ]
    differences = (ends[0] - ends[1]) / (2.0 * step)
    size = abs(differences).max(axis=-1, keepdims=True) + 1e-30
    assert (abs(slope[0] - differences) < CENTRAL * size).all()
    # a derivative that forgot a tenth of the delay's phase would be seen
    assert not (abs(0.9 * slope[0] - differences) < CENTRAL * size).all()
