"""What the columns of a recording hold, and in which units, by their names.

A name says the direction (``COP_AP``, ``CoP-X``, ``Fz``) and may say the unit after it
(``ap [cm]``, ``CoP-X (mm)``, ``time_ms``); a line of units below the names may say it too.
"""

import re
from collections.abc import Iterable, Mapping, Sequence
from typing import NamedTuple

from standfast.errors import InputError, shortened

# By the kind of a column how many SI units one of its units is; units in lower case without signs.
UNITS: Mapping[str, Mapping[str, float]] = {
    "time": {"s": 1.0, "sec": 1.0, "secs": 1.0, "seconds": 1.0, "ms": 1e-3, "msec": 1e-3},
    "length": {"m": 1.0, "cm": 1e-2, "mm": 1e-3, "um": 1e-6, "in": 0.0254, "inch": 0.0254},
    "force": {"n": 1.0, "kn": 1e3},
    "moment": {"nm": 1.0, "nmm": 1e-3, "ncm": 1e-2, "knm": 1e3},
}
# As messages write them.
WRITTEN = {"time": "s, ms", "length": "m, cm, mm", "force": "N, kN", "moment": "N·m, N·mm"}

# Which plate, or how it was put together: a word or a number before, between or after.
OF_PLATE = r"(?:net|total|combined|(?:(?:force)?plat(?:e|form)|fp)?(?P<before>\d*))"
SIDE = r"(?:(?P<side>left|right|[lr])(?:(?:force)?plate)?)?"
WITHIN, AFTER = r"(?P<within>\d?)", r"(?P<after>\d?|left|right|[lr])"
COP = r"(?:cop|cp|cent(?:er|re)ofpressure)"
AP, ML = "ap|anteroposterior|anteriorposterior", "ml|mediolateral|mediallateral"
# By what a column holds the kind of its unit, and its name in lower case without signs.
NAMES: Mapping[str, tuple[str, str]] = {
    "time": ("time", r"(?:abs|absolute|rel|relative|elapsed|mocap)?(?:time|timestamp|t|zeit)"),
    **{
        name: ("length", rf"{OF_PLATE}{SIDE}{COP}?{WITHIN}(?:{words}){COP}?{AFTER}")
        for name, words in (("ap", AP), ("ml", ML))
    },
    **{
        axis: (
            "length",
            rf"{OF_PLATE}(?:{SIDE}{COP}{WITHIN}c?{axis}{AFTER}|c?{axis}(?P<bare>\d?)|{axis}{COP})",
        )
        for axis in "xy"
    },
    **{
        f"F{axis}": (
            "force", rf"{OF_PLATE}{SIDE}(?:f|(?:force|grf)f?){WITHIN}{axis}{AFTER}"
        )
        for axis in "xyz"
    },
    **{
        f"M{axis}": (
            "moment", rf"{OF_PLATE}{SIDE}(?:m|(?:moment|torque)m?){WITHIN}{axis}{AFTER}"
        )
        for axis in "xyz"
    },
}  # fmt: skip
PATTERNS = {
    holds: re.compile(f"{pattern}(?P<unit>{'|'.join(UNITS[kind])})?")
    for holds, (kind, pattern) in NAMES.items()
}
WHERE_PLATE = ("before", "side", "within", "after", "bare")  # groups of the patterns
SIDES = {"l": "left", "r": "right"}
# Of Kistler's BioWare: the centre of pressure, where a length says that it is no acceleration.
KISTLER = re.compile(r"a([xy])(?P<after>\d?)")
# Of OpenSim, in N and m of one frame of the ground, whose y points up.
GROUND = re.compile(
    r"(?P<before>\d|left|right|[lr])?groundforce(?P<side>left|right|[lr])?(?P<within>\d?)"
    r"(?P<what>v[xyz]|p[xz])(?P<after>\d?)"
)
OF_GROUND = {"vx": "Fx", "vz": "Fy", "vy": "Fz", "px": "x", "pz": "y"}
BARE = re.compile(f"([xyz])(?:{'|'.join(UNITS['length'])})?")
LAST_WORD = re.compile(r"[\[({_ ]\s*([^\[\](){}_ ]+)\s*[\])}]?\s*$")
AGAIN = re.compile(r"\.\d+$")  # as pandas and R write a name that is there already
LAST_NUMBER = re.compile(r"(\d+)\W*$")


class Column(NamedTuple):
    """A column of a table: its place, its name, how many SI units one of it is if known, its plate.

    The plate is empty where the name says none, as of a sum of all.
    """

    place: int
    name: str
    unit: float | None
    plate: str = ""


def compact(text: str) -> str:
    """Return letters and digits in lower case: ``CoP-X (mm)`` is ``copxmm``."""
    return re.sub(r"[^a-z0-9]+", "", text.lower().replace("µ", "u").replace("μ", "u"))


def recognised(
    names: Sequence[str], units: Sequence[str], groups: Sequence[str] = ()
) -> dict[str, list[Column]]:
    """Return the columns by what they hold.

    ``units`` are those of a line below, ``groups`` what a line above says of several columns, as
    ``Plate 1 - Force``; else empty.
    """
    found: dict[str, list[Column]] = {}
    written = {name.strip() for name in names}
    for place, name in enumerate(names):
        below = units[place] if place < len(units) else ""
        once = AGAIN.sub("", name.strip())
        own_name = once if once in written else name
        group, _, own = own_name.rpartition(" - ")
        known = _held(own_name, below) or (_held(own, below) if group else None)
        if known is None:
            continue
        holds, unit, plate = known
        group = group or (groups[place] if place < len(groups) else "")
        found.setdefault(holds, []).append(
            Column(place, name.strip(), unit, plate or _plate_of(group))
        )
    if any((bare := BARE.fullmatch(compact(name))) and bare[1] == "z" for name in names):
        for axis in "xy":  # of a marker, or of anything else in space
            plain = [c for c in found.pop(axis, []) if not BARE.fullmatch(compact(c.name))]
            found |= {axis: plain} if plain else {}
    return _numbered(found)


def _numbered(found: dict[str, list[Column]]) -> dict[str, list[Column]]:
    """Return columns of the same names as of plates numbered in their order, as Kistler has it."""
    count = sum(not column.plate for column in found.get("Fz", []))
    if count < 2:
        return found
    return {
        holds: [column._replace(plate=str(n)) for n, column in enumerate(columns, 1)]
        if len(columns) == count and not any(column.plate for column in columns)
        else columns
        for holds, columns in found.items()
    }


def _held(name: str, below: str) -> tuple[str, float | None, str] | None:
    """Return what a column holds, its unit, and the plate that its own name says."""
    word = compact(name)
    if match := GROUND.fullmatch(word):
        return OF_GROUND[match["what"]], 1.0, _named(match) or "0"  # no sum of the others
    for holds, pattern in PATTERNS.items():
        if match := pattern.fullmatch(word):
            return holds, _unit(name, NAMES[holds][0], match["unit"] or "", below), _named(match)
    match = KISTLER.fullmatch(word)
    if match and compact(below) in UNITS["length"]:
        return match[1], UNITS["length"][compact(below)], _named(match)
    return None


def _named(match: re.Match[str]) -> str:
    """Return the plate by the words and numbers of a name."""
    said = next(filter(None, map(match.groupdict().get, WHERE_PLATE)), "")
    return SIDES.get(said, said)


def _plate_of(group: str) -> str:
    """Return the plate of ``Force Plate #1 - Force``: the number at its end, or all words."""
    words = group.partition(" - ")[0].strip()
    number = LAST_NUMBER.search(words)
    return number[1] if number else compact(words)


def in_ground_frame(columns: Iterable[Column]) -> bool:
    """Return whether columns are of OpenSim, in one frame whose y points up."""
    return any(GROUND.fullmatch(compact(column.name)) for column in columns)


def are_units(cells: Sequence[str]) -> bool:
    """Return whether the cells of a line are all units of some kind, or empty."""
    known = set().union(*UNITS.values())
    words = [compact(cell) for cell in cells if cell.strip()]
    return bool(words) and sum(word in known for word in words) >= 0.5 * len(words)


def chosen(
    option: str, given: str, names: Sequence[str], units: Sequence[str], kind: str
) -> Column:
    """Return the column that an option names, or counts from 1.

    Raises
    ------
    InputError
        if there is none.
    """
    wanted = given.strip().lower()
    places = [place for place, name in enumerate(names) if name.strip().lower() == wanted]
    if not places and wanted.isascii() and wanted.isdecimal() and 1 <= int(wanted) <= len(names):
        places = [int(wanted) - 1]
    if len(places) != 1:
        wrong = "names no column" if not places else f"names {len(places)} columns"
        raise InputError(
            f"{option} = {shortened(given)} {wrong}; give a name or a number from 1 to "
            f"{len(names)} {listed(names)}"
        )
    (place,) = places
    name = names[place].strip()
    last = LAST_WORD.search(name)
    told = compact(last[1]) if last else ""
    below = units[place] if place < len(units) else ""
    return Column(place, name, _unit(name, kind, told if told in UNITS[kind] else "", below))


def listed(names: Sequence[str]) -> str:
    """Say which columns a table has."""
    some = ", ".join(repr(name.strip()) for name in names[:12] if name.strip())
    return f"(columns there: {some}{', …' if len(names) > 12 else ''})"


def unit_of(option: str, given: str, kind: str) -> float:
    """Return how many SI units a unit is that a user gives.

    Raises
    ------
    InputError
        if it is none of its kind.
    """
    known = UNITS[kind]
    if not isinstance(given, str) or compact(given) not in known:
        raise InputError(f"{option} = {shortened(given)} is not one of {WRITTEN[kind]}")
    return known[compact(given)]


def _unit(name: str, kind: str, told: str, below: str) -> float | None:
    """Return the unit that the name or the line below it says."""
    known = UNITS[kind]
    if told:
        return known[told]
    if below.strip() and compact(below) not in known:
        raise InputError(
            f"the column {name.strip()!r} is in {below.strip()!r}, and {WRITTEN[kind]} are known"
        )
    return known.get(compact(below))
