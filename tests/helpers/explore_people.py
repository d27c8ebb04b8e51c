"""Seeded persons as the page's slots, and what our functions find for all of them in NumPy."""

import numpy as np
import pytest

from standfast.anthropometry.body import REFERENCE_PEOPLE, Body, ReferencePerson, body_of
from standfast.explore.formulas import SLOTS
from standfast.mechanics import motion
from standfast.parameters import COUPLINGS, GAINS, OWN_BODY, SEGMENT_NUMBERS, STIFFNESSES
from standfast.quantities import QUANTITIES, Person
from standfast.stability import margins, modes
from standfast.stability.springs import critical_ankle_stiffness


def people(size: int, *, coupled: bool, seed: int) -> np.ndarray:
    """Rows of slots: all models and segments measured, free, springy, stiff and rigid joints."""
    random = np.random.default_rng(seed)
    rows = np.zeros((size, len(SLOTS)))
    models = list(REFERENCE_PEOPLE.values())
    for row, kind in zip(rows, random.integers(len(models) + 1, size=size), strict=True):
        own = kind == len(models)  # measured segments: a reference of 1 m and 1 kg
        body, height, mass = models[0] if own else models[kind]
        numbers = np.concatenate([*body]) * (random.uniform(0.9, 1.1, 11) if own else 1.0)
        row[[SLOTS[f"reference_{name}"] for name in OWN_BODY]] = numbers
        row[[SLOTS["reference_height"], SLOTS["reference_mass"]]] = (
            (1.0, 1.0) if own else (height, mass)
        )
        tall = 1.0 if own else random.uniform(1.2, 2.2)
        row[[SLOTS["height"], SLOTS["mass"]]] = tall, 1.0 if own else random.uniform(20.0, 200.0)
        row[SLOTS["bmi"]], row[SLOTS["by_bmi"]] = (
            random.uniform(14.0, 60.0),
            not own and random.random() < 0.4,
        )
    rows[:, SLOTS["gravity"]] = random.uniform(1.0, 20.0, size)
    joints = 10.0 ** random.uniform(1.0, 5.0, (size, 3))
    for special, share in ((np.inf, 0.12), (0.0, 0.02), (1e12, 0.02)):
        joints[random.random((size, 3)) < share] = special
    rows[:, [SLOTS[name] for name in STIFFNESSES]] = joints
    if coupled:
        across = random.uniform(-300.0, 300.0, (size, 3))
        across[random.random((size, 3)) < 0.2] = 0.0
        across[:, 0] += across.any(axis=1) == 0.0
        rows[:, [SLOTS[name] for name in COUPLINGS]] = across
    _put_near_threshold(rows, random, coupled=coupled)
    return rows


def one_free_joint(size: int, *, seed: int) -> np.ndarray:
    """Rows of slots with one joint that is not rigid, damping, gains and a delay."""
    random = np.random.default_rng(seed)
    rows = people(size, coupled=False, seed=seed + 1)
    joints = np.full((size, 3), np.inf)
    free = random.integers(3, size=size)
    joints[np.arange(size), free] = random.uniform(0.0, 1500.0, size)
    rows[:, [SLOTS[name] for name in STIFFNESSES]] = joints
    for name in GAINS:
        low, high = (-300.0, 1500.0) if "proportional" in name else (-20.0, 400.0)
        rows[:, SLOTS[name]] = random.uniform(low, high, size) * (random.random(size) < 0.9)
    for name in ("ankle_damping", "knee_damping", "hip_damping"):
        rows[:, SLOTS[name]] = random.uniform(0.0, 50.0, size) * (random.random(size) < 0.7)
    delays = random.uniform(0.0, 0.4, size) * (random.random(size) < 0.9)
    rows[:, SLOTS["feedback_delay"]] = delays
    return rows


def _put_near_threshold(rows: np.ndarray, random: np.random.Generator, *, coupled: bool) -> None:
    """Bring a quarter of the ankles within 1e-9 of the threshold, some onto it."""
    person = person_of(rows, coupled=coupled)
    stiff = person.stiffness
    threshold = critical_ankle_stiffness(
        person.body, stiff.knee, stiff.hip, person.gravity, stiff.couplings
    )
    near = (random.random(len(rows)) < 0.25) & np.isfinite(threshold) & (threshold >= 0.0)
    off = random.uniform(-1e-9, 1e-9, len(rows)) * (random.random(len(rows)) < 0.8)
    rows[near, SLOTS["ankle_stiffness"]] = (threshold * (1.0 + off))[near]


def person_of(rows: np.ndarray, *, coupled: bool) -> Person:
    """All persons at once, each number an array of NumPy."""
    given = {name: np.ascontiguousarray(rows[:, place]) for name, place in SLOTS.items()}
    if not coupled:
        given |= dict.fromkeys(COUPLINGS, 0.0)
    body = dict(zip(OWN_BODY, bodies_of(rows), strict=True))
    return Person.of({**given, **body})


def bodies_of(rows: np.ndarray) -> np.ndarray:
    """The bodies' numbers, (11, persons)."""
    given = {name: rows[:, place] for name, place in SLOTS.items()}
    parts = [
        np.stack([given[f"reference_{n}"] for n in names]) for names in SEGMENT_NUMBERS.values()
    ]
    model = ReferencePerson(Body._make(parts), given["reference_height"], given["reference_mass"])
    by_mass, by_bmi = (
        np.concatenate(body_of({"body_model": model, "height": given["height"], n: given[n]}))
        for n in ("mass", "bmi")
    )
    return np.where(given["by_bmi"] == 0.0, by_mass, by_bmi)


def in_numpy(rows: np.ndarray, *, coupled: bool) -> dict[str, np.ndarray]:
    """All quantities of springs, and the modes as the page has them, by our functions in NumPy."""
    person = person_of(rows, coupled=coupled)
    found = {}
    with pytest.MonkeyPatch.context() as patch, np.errstate(all="ignore"):
        for module in (margins, modes):  # one person at a time is a check at the border alone
            patch.setattr(module, "checked_person", lambda *_: np)
        patch.setattr(motion, "checked_body", lambda _: None)
        for name, row in QUANTITIES.items():
            if row.reference is None or row.own:
                continue
            result = row.reference(person)
            if isinstance(result, modes.Modes):
                result = result._replace(shapes=np.moveaxis(result.shapes, -1, 1))
                shapes = np.moveaxis(result.shapes, 1, 0).reshape(9, -1)
                found["modes"] = np.concatenate([result.eigenvalues, shapes]).T.ravel()
            found[name] = np.broadcast_to(row.pick(person, result), len(rows)).astype(float)
    return found
