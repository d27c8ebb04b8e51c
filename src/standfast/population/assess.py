"""Single persons, one by one: how stiff they would have to be, and how far they are from it."""

import math
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from standfast.engine.mapping import map_over_batch
from standfast.files import column_name
from standfast.mechanics.joints import Stiffness
from standfast.mechanics.matrices import joint_gravity
from standfast.numerics.arrays import Scalar
from standfast.parameters import (
    GAINS,
    JOINTS,
    NOISES,
    PARAMETERS,
    STANDARD_GRAVITY,
    STIFFNESSES,
    checked_number,
)
from standfast.population.assessed import Assessment
from standfast.population.assessed_sway import columns_of_sway
from standfast.population.cohort.bodies import Models, body_in, models_of
from standfast.population.cohort.nerves import entries_of, judged
from standfast.population.cohort.persons import load_of
from standfast.population.known import fixed_nerves, stiffness_of_each
from standfast.population.people.distributions import Distributions, ParameterDistribution
from standfast.population.people.keys import checked_body_model
from standfast.population.people.records import People, read_people
from standfast.population.people.sections import NERVES
from standfast.stability.margins import safety_factor, stiffness_reserve
from standfast.stability.modes import frequency_of, modes, ratio_to_ankle
from standfast.stability.springs import critical_stiffness, verdict

DELAY = "feedback_delay"
PIECE = 2**14  # persons between two steps of the progress bar: 5 ms by springs


def assess(
    people: People | str | Path | Sequence[str | Path],
    *,
    body_model: str | Mapping[str, str] = "winter",
    gravity: float = STANDARD_GRAVITY,
    otherwise: Mapping[str, float | str] | None = None,
    nerves: Distributions | Mapping[str, Any] = (),
    progress: Callable[[int, int], None] | None = None,
) -> Assessment:
    """Assess persons one by one: thresholds, margins, and the least gain with which each stands.

    Found are thresholds of each joint alone (the other two rigid) and with the other two as they
    are, safety factor, reserve, frequency, strategy, and what each joint would have to gain: all of
    springs alone. With gains, which people have or ``nerves`` fixes where they have none, follow
    the verdict, critical delay and delay margin with feedback; with noise how much each sways.

    Parameters
    ----------
    people
        of :func:`.read_people`, or the files that it is to read, whose own columns are kept.
    body_model, gravity
        proportions of everybody, or of ``female``, ``male``, ``other`` (not of own segments); m/s².
    otherwise
        stiffness (N·m/rad, ``inf`` is rigid) by joint, where it is not known of a person, or a
        multiple of the load that topples the person's body about the ankle, as ``"0.67mgh"``.
    nerves
        damping, delay, gains and noise where they are not known: the tables ``damping``,
        ``feedback`` and ``noise`` of a population's study, each a number or a ``fixed``
        distribution.
    progress
        called with the persons done and all of them, again and again.

    Returns
    -------
    Assessment: ``columns`` by name, (persons,) each, and ``strata()``.

    Raises
    ------
    InputError
        for a model or joint that is not known, a number out of range, or as :func:`.read_people`.

    Examples
    --------
    >>> import math
    >>> import standfast as sf
    >>> found = sf.assess("people.csv", otherwise={"ankle": 900, "knee": math.inf, "hip": 400})
    >>> found.columns["safety_factor"].round(2)
    array([1.48, 0.96, 1.28])
    """
    if not isinstance(people, People):
        people = read_people(people, keep_own=True)
    models = checked_body_model("body_model", body_model)
    columns = _assessed(people, models, gravity, otherwise or {}, fixed_nerves(nerves), progress)
    return Assessment(people, columns, models)


def _assessed(
    people: People,
    models: str | Mapping[str, str],
    gravity: float,
    otherwise: Mapping[str, float | str],
    fixed: Mapping[str, ParameterDistribution],
    progress: Callable[[int, int], None] | None,
) -> dict[str, np.ndarray]:
    """Return the columns of :func:`assess`."""
    of_each, size = models_of(people, models)
    # gravity is a number like others, so that a program serves on every planet
    size["gravity"] = np.full(len(people), checked_number("gravity", gravity))
    bodies = np.array([*size.values()])

    def toppling_load() -> np.ndarray:
        return _in_pieces(_loads, of_each, tuple(size), bodies)["ankle"]

    known = stiffness_of_each(people, otherwise, toppling_load)
    fed_back = any(name in fixed or name in people.measured for name in (*GAINS, *NOISES))
    step = _Steps(progress, len(people) * (1 + fed_back))
    names = (*size, *STIFFNESSES)
    given = np.array([*size.values(), *known.values()])
    found = _in_pieces(_of_one, of_each, names, given, step)
    columns = _columns(people, known, found)
    if fed_back:
        everything = columns["stands"] != ""
        columns |= _with_feedback(of_each, names, given, people, fixed, everything, step)
    return columns


class _Steps:
    """Tells how far persons have come, over several passes."""

    def __init__(self, progress: Callable[[int, int], None] | None, total: int) -> None:
        self.progress, self.total, self.done = progress, total, 0

    def __call__(self, persons: int) -> None:
        """Count persons who are done."""
        self.done += persons
        if self.progress is not None:
            self.progress(self.done, self.total)


def _in_pieces(
    function: Callable[[Any, Any], dict[str, Scalar]],
    models: Models,
    names: tuple[str, ...],
    numbers: np.ndarray,
    step: Callable[[int], None] = lambda _persons: None,
) -> dict[str, np.ndarray]:
    """Map a function of one person over all; whom a person comes with changes no bit."""
    mapped = map_over_batch(function, models, names)
    count = numbers.shape[1]
    pieces = []
    for first in range(0, count, PIECE):
        piece = numbers[:, first : first + PIECE]
        pieces.append(mapped(piece))
        step(piece.shape[1])
    return {name: np.concatenate([each[name] for each in pieces]) for name in pieces[0]}


def _columns(
    people: People, known: Mapping[str, np.ndarray], found: Mapping[str, np.ndarray]
) -> dict[str, np.ndarray]:
    """Return what springs alone decide, by the names of columns."""
    told = {joint: ~np.isnan(values) for joint, values in known.items()}
    everything = np.all([*told.values()], axis=0)
    columns: dict[str, np.ndarray] = {
        "id": np.array(people.id, object),
        "height_m": people.height,
        "mass_kg": people.mass,
        "sex": np.array([sex if sex != "unknown" else "" for sex in people.sex], object),
        "age": people.age,
        **{f"{joint}_stiffness_Nm_rad": values for joint, values in known.items()},
        **{f"{joint}_threshold_alone_Nm_rad": found[f"{joint}_alone"] for joint in JOINTS},
    }
    for joint in JOINTS:
        others = np.all([told[other] for other in JOINTS if other != joint], axis=0)
        threshold = np.where(others, found[f"critical_{joint}_stiffness"], math.nan)
        columns[f"{joint}_threshold_Nm_rad"] = threshold
    columns["stands"] = np.where(everything, np.where(found["stable"], "yes", "no"), "")
    for name, unit in (
        ("safety_factor", ""),
        ("stiffness_reserve", "_Nm_rad"),
        ("frequency", "_Hz"),
    ):
        columns[name + unit] = np.where(everything, found[name], math.nan)
    hips_turn_more = np.abs(found["hip_ankle_ratio"]) > 1.0
    columns["strategy"] = np.where(everything, np.where(hips_turn_more, "hip", "ankle"), "")
    return columns | _gains(known, columns)


def _with_feedback(
    models: Models,
    of_springs: tuple[str, ...],
    given: np.ndarray,
    people: People,
    fixed: Mapping[str, ParameterDistribution],
    everything: np.ndarray,
    step: Callable[[int], None],
) -> dict[str, np.ndarray]:
    """Return damping, delay and gains of each person, and what becomes of them with these.

    A parameter that neither people nor ``fixed`` have is 0; but a delay is then not known.
    """
    names = tuple(name for name in NERVES if name in fixed or name in people.measured)
    size = of_springs[: -len(STIFFNESSES)]
    by_joint = _in_pieces(_loads, models, size, given[: len(size)])
    loads = (by_joint["ankle"], by_joint["knee"], by_joint["hip"])
    values = {}
    for name in names:
        own = people.measured.get(name, np.full(len(people), math.nan))
        instead: Any = math.nan
        if name in fixed:
            instead = fixed[name].numbers[0] * load_of(name, fixed[name].relative_to, loads)
        values[name] = np.where(np.isnan(own), instead, own)
    there = {name: ~np.isnan(each) for name, each in values.items()}
    told = np.all([everything, *(there[n] for n in names if n not in (DELAY, *NOISES))], axis=0)
    timed = told & ~np.isnan(values.get(DELAY, np.full(len(people), math.nan)))
    # what is not known is computed with zeros, and not told
    numbers = np.array([*given, *(np.nan_to_num(each) for each in values.values())])
    known = np.where(told, numbers, np.where(np.isnan(numbers), 0.0, numbers))
    known[: len(size)] = given[: len(size)]  # own segments that are not known are scaled
    of_one = (*of_springs, *names)
    pieces = []
    for first in range(0, len(people), PIECE):
        piece = known[:, first : first + PIECE]
        pieces.append(judged(_in_pieces(_entries_of_one, models, of_one, piece)))
        step(piece.shape[1])
    stands, critical, margin = (
        np.concatenate([getattr(each, name) for each in pieces])
        for name in ("stands", "critical_delay", "delay_margin")
    )
    return {
        **{column_name(name, PARAMETERS[name].unit): each for name, each in values.items()},
        "stands_with_feedback": np.where(timed, np.where(stands, "yes", "no"), ""),
        "critical_delay_s": np.where(told, critical, math.nan),
        "delay_margin_s": np.where(timed, margin, math.nan),
        **columns_of_sway(pieces, (told if not {*GAINS} & {*names} else timed), there),
    }


def _loads(models: Models, given: Mapping[str, Scalar]) -> dict[str, Scalar]:
    loads = joint_gravity(body_in(models, given), given["gravity"])[0]
    return dict(zip(JOINTS, loads, strict=True))


def _entries_of_one(models: Models, given: Mapping[str, Scalar]) -> dict[str, Scalar]:
    stiffness = Stiffness._make(given[name] for name in STIFFNESSES)
    nerves = {name: given[name] for name in NERVES if name in given}
    return entries_of(body_in(models, given), stiffness, given["gravity"], nerves)


def _gains(
    known: Mapping[str, np.ndarray], columns: Mapping[str, np.ndarray]
) -> dict[str, np.ndarray]:
    """Return what each joint would have to gain so that the person stands, and the least of it."""
    falls, stands = columns["stands"] == "no", columns["stands"] == "yes"
    gains = {}
    for joint, own in known.items():
        # what is rigid cannot gain, and where no stiffness suffices no gain does
        with np.errstate(invalid="ignore"):
            missing = columns[f"{joint}_threshold_Nm_rad"] - own
        gain = np.where(np.isinf(own), math.inf, missing)
        gains[joint] = np.where(falls, gain, np.where(stands, 0.0, math.nan))
    every = np.array(list(gains.values()))
    possible = falls & np.isfinite(every).any(axis=0)
    best = np.argmin(np.where(np.isnan(every), np.inf, every), axis=0)
    return {
        **{f"{joint}_gain_needed_Nm_rad": gain for joint, gain in gains.items()},
        "least_gain_at": np.where(possible, np.array(JOINTS)[best], ""),
    }


def _of_one(models: Models, given: Mapping[str, Scalar]) -> dict[str, Scalar]:
    """Return everything about one person; what depends on an unknown stiffness is without sense."""
    body, gravity = body_in(models, given), given["gravity"]
    stiffness = Stiffness._make(given[name] for name in STIFFNESSES)
    person = (body, stiffness, gravity)
    alone, _, _ = joint_gravity(body, gravity)
    of_modes = modes(*person)
    thresholds = critical_stiffness(*person).joints
    return {
        **{f"{joint}_alone": load for joint, load in zip(JOINTS, alone, strict=True)},
        **{f"critical_{joint}_stiffness": k for joint, k in zip(JOINTS, thresholds, strict=True)},
        "stable": verdict(*person),
        "safety_factor": safety_factor(*person),
        "stiffness_reserve": stiffness_reserve(*person),
        "frequency": frequency_of(of_modes.eigenvalues[0]),
        "hip_ankle_ratio": ratio_to_ankle("hip", stiffness, of_modes),
    }
