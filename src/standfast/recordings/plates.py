"""Force plates on which one person stands: which of them, where they lie, and the person's centre.

Of plates k with the vertical force F_k and the centre of pressure c_k, all in one frame,

c = Σ F_k c_k / Σ F_k.

Where plates lie to each other no table of a force plate says. What a laboratory has at hand is the
distance between their origins along the axes that they share, so that is what is asked for: a
place by the plate's name, ``{"2": (0, 0.6)}``, from the plate that is not named. A name alone takes
this plate and no other, which is what remains to be said.
"""

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from standfast.errors import InputError, nearest_name, shortened
from standfast.numerics.arrays import Array
from standfast.recordings.recording import POSSIBLE, USUAL

OFF_PLATE = 0.2  # of the median load
LIGHTEST = 50.0  # N
CARRIES = 0.05  # of the whole load: with less at all times, a plate is stood on by nobody
AT_ALL_TIMES = 0.99  # of the samples: what a single one shows may be a knock
FURTHEST = 5.0  # m
SIDES = ("left", "right")


class Plate(NamedTuple):
    """What a plate measured, (n,) each, NaN where a sample is missing.

    Attributes
    ----------
    name
        a number, or a word; empty for the sum of all plates.
    load : N
        the vertical force, of either sign.
    first, second : N·m
        the load times the centre of pressure along each axis of the floor, from the plate's origin.
    """

    name: str
    load: Array
    first: Array
    second: Array


@dataclass(frozen=True)
class Choice:
    """Which plate is read, or where plates lie (m), as the user says; neither if both are empty."""

    alone: str = ""
    places: Mapping[str, tuple[float, float]] | None = None


def checked_choice(given: Any) -> Choice:
    """Return what is given as ``plate``.

    Raises
    ------
    InputError
        if it is neither the name of a plate nor a mapping of names to places.
    """
    if given is None:
        return Choice()
    if isinstance(given, str) and given.strip():
        return Choice(alone=given.strip().lower())
    if not isinstance(given, Mapping) or not given:
        raise InputError(
            f'plate = {shortened(given)}; give the name of a plate, as plate="1", or where plates '
            'lie (m), as plate={"2": (0, 0.6)}'
        )
    return Choice(places={str(k).strip().lower(): _place(str(k), v) for k, v in given.items()})


def _place(name: str, given: Any) -> tuple[float, float]:
    try:
        first, second = (float(each) for each in given)
    except (TypeError, ValueError):
        first = second = math.nan
    if not max(abs(first), abs(second)) <= FURTHEST:  # NaN too
        far = abs(first) < 1e3 * FURTHEST and abs(second) < 1e3 * FURTHEST
        raise InputError(
            f"plate = {name}: {shortened(given)} is not two numbers of m, each up to {FURTHEST:g}"
            f"{', is it in mm?' if far else ''}"
        )
    return first, second


def names_read(there: Iterable[str], choice: Choice) -> list[str]:
    """Return which of the plates in a file are read: all, the sum of all, or as the choice says.

    Raises
    ------
    InputError
        if the choice names one that is not there, or only a left or right one is there.
    """
    names = sorted(set(there))
    plates = [name for name in names if name]
    for named in filter(None, (choice.alone, *(choice.places or {}))):
        if named not in plates:
            known = f"; its plates are {', '.join(plates)}" if plates else "; it names none"
            raise InputError(
                f"plate = {named!r} is not in the file{nearest_name(named, plates)}{known}"
            )
    if choice.alone:
        return [choice.alone]
    if choice.places is None and "" in names:
        return [""]
    if len(plates) == 1 and plates[0] in SIDES:
        raise InputError(
            f"only what is under the {plates[0]} foot is there, which is not the person's centre "
            f'of pressure; to read it nevertheless write plate="{plates[0]}"'
        )
    return plates


def person_on(
    plates: Sequence[Plate],
    choice: Choice,
    where: Callable[[int], str],
    *,
    one_frame: bool = False,
) -> tuple[Array, Array, list[str]]:
    """Return the person's centre of pressure (m) along both axes, and what is to be said of it.

    Parameters
    ----------
    where
        says in words at which place of the file a sample stands.
    one_frame
        whether all centres of pressure are in one frame already.

    Raises
    ------
    InputError
        if nobody stands there, or somebody not all the time, or it is not known where plates lie.
    """
    median = {plate.name: median_of(plate.load) for plate in plates}
    carrying = _carrying(plates)
    said = []
    if left := [plate.name for plate in plates if plate not in carrying]:
        sizes = ", ".join(f"{abs(median[name]):.3g} N on {name}" for name in left)
        said.append(f"plates on which nobody stands are left out ({sizes} in the median)")
    places = _places([plate.name for plate in carrying], choice, one_frame=one_frame)
    # a plate that is stood on for a short time has a median of noise
    mean = {plate.name: _mean_of(plate.load) for plate in carrying}
    signs = [math.copysign(1.0, mean[plate.name]) for plate in carrying]
    load = sum(sign * plate.load for sign, plate in zip(signs, carrying, strict=True))
    first, second = (
        sum(
            sign * (getattr(plate, axis) + places[plate.name][k] * plate.load)
            for sign, plate in zip(signs, carrying, strict=True)
        )
        for k, axis in enumerate(("first", "second"))
    )
    load = np.where(load == 0.0, np.nan, load)  # exactly: nothing was measured
    _check_load(load, where)
    if len(carrying) > 1:
        said += _of_each(carrying)
        parts = " and ".join(
            f"{plate.name} ({abs(mean[plate.name]):.3g} N"
            + ("" if one_frame else ", at {:g}, {:g} m".format(*places[plate.name]))
            + ")"
            for plate in carrying
        )
        said.append(f"the centre of pressure is that of all that stands on plates {parts}")
    return first / load, second / load, said


def _carrying(plates: Sequence[Plate]) -> list[Plate]:
    """Return the plates that carry a part of the person, be it for a short time."""
    whole = median_of(np.nansum([np.abs(plate.load) for plate in plates], axis=0))
    return [
        plate for plate in plates
        if _quantile(np.abs(plate.load), AT_ALL_TIMES) >= CARRIES * whole
    ]  # fmt: skip


def median_of(load: Array) -> float:
    """Return the median of what is there, 0 of nothing."""
    return _quantile(load, 0.5)


def _mean_of(load: Array) -> float:
    return float(np.mean(load[np.isfinite(load)])) if np.isfinite(load).any() else 0.0


def _quantile(load: Array, share: float) -> float:
    there = load[np.isfinite(load)]
    return float(np.quantile(there, share)) if there.size else 0.0


def _places(
    names: Sequence[str], choice: Choice, *, one_frame: bool
) -> dict[str, tuple[float, float]]:
    """Return where the plates that carry the person lie; one that is not named is at 0, 0."""
    given = dict(choice.places or {})
    open_ones = [name for name in names if name not in given]
    if one_frame and any(given[name] != (0.0, 0.0) for name in given):
        raise InputError(
            "plate=… says where plates lie, and this file has all of them in one frame; leave it "
            'away, or name one to read alone, as plate="1"'
        )
    if one_frame or len(names) < 2 or (given and len(open_ones) < 2):
        return {name: given.get(name, (0.0, 0.0)) for name in names}
    first, last = open_ones[0], open_ones[-1]
    raise InputError(
        f"the person stands on plates {' and '.join(names)}, and where they lie to each other is "
        f"not in the file; write where the origin of {last} lies from that of {first} along the "
        f'axes of the plates (m), as plate={{"{last}": (0, 0.6)}}, or (0, 0) if all columns are in '
        f'one frame; plate="{first}" reads one alone'
    )


def _of_each(plates: Sequence[Plate]) -> list[str]:
    """Say on which plates little moves, which the weight going from foot to foot would hide.

    Raises
    ------
    InputError
        if nothing moves there.
    """
    said = []
    for plate in plates:
        on = np.abs(plate.load) > OFF_PLATE * _quantile(np.abs(plate.load), AT_ALL_TIMES)
        on &= np.isfinite(plate.first + plate.second)
        if not on.any():  # no sample is left then, which is said of the person
            continue
        x, y = (each[on] / plate.load[on] for each in (plate.first, plate.second))
        size = float(np.hypot(x.std(), y.std()))
        sentence = (
            f"on plate {plate.name} alone the centre of pressure moves by {1e3 * size:.3g} mm "
            "about its mean, and under a foot by some millimetres; is the unit of its lengths or "
            "moments right?"
        )
        if size < POSSIBLE[0]:
            raise InputError(sentence)
        if size < USUAL[0]:
            said.append(sentence)
    return said


def _check_load(load: Array, where: Callable[[int], str]) -> None:
    """Refuse a recording on which nobody stands all the time."""
    there = np.isfinite(load)
    size = np.abs(load[there])
    median = float(np.median(size)) if size.size else 0.0
    if median < LIGHTEST:
        raise InputError(
            f"Fz is {median:.3g} N in the median, so nobody stands on the plate, or it is not in "
            "N, or z is not upright"
        )
    if size.min() < OFF_PLATE * median:
        at = int(np.flatnonzero(there)[np.argmax(size < OFF_PLATE * median)])
        raise InputError(
            f"Fz falls from {median:.4g} to {abs(load[at]):.3g} N {where(at)}: the person is not "
            "on the plate all the time; cut the recording before or after"
        )
