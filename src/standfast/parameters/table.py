"""The one table of parameters: name, symbol, unit, range, and where a study says it.

A row carries all of a parameter: labels of figures, attributes of files, the keys of a study, its
default, and the range with which :mod:`.border` compares what a user gives.
"""

import math
from dataclasses import dataclass, replace

JOINTS = ("ankle", "knee", "hip")
STIFFNESSES = tuple(f"{joint}_stiffness" for joint in JOINTS)
SEGMENTS = ("shank", "thigh", "upper_body")
# Of two joints together, by muscles that span both.
COUPLED_JOINTS = (("ankle", "knee"), ("knee", "hip"), ("ankle", "hip"))
COUPLINGS = tuple(f"{one}_{other}_stiffness" for one, other in COUPLED_JOINTS)
DAMPINGS = tuple(f"{joint}_damping" for joint in JOINTS)
NOISES = tuple(f"{joint}_noise" for joint in JOINTS)
# Of feedback: the joint that makes the moment, the joint whose rotation is sensed.
LOOPS = tuple((moment, rotation) for moment in JOINTS for rotation in JOINTS)


@dataclass(frozen=True, slots=True)
class Parameter:
    """A number, or one of some words, that a study or a call is given.

    ``section`` and ``key`` are its place in a study file ("" is the top level; without a key it is
    not of a study). A study that does not give it takes ``default``; None: it must be given, but
    for a body, which has either height and mass or all of its own segments.
    ``unwritten``: only a study that gives it names it in its canonical text and its file.
    """

    name: str
    symbol: str
    unit: str
    meaning: str
    lowest: float = -math.inf
    highest: float = math.inf
    or_rigid: bool = False  # inf is allowed too
    choices: tuple[str, ...] = ()  # one of these words, instead of a number
    section: str = ""
    key: str = ""
    default: float | str | None = None
    unwritten: bool = False

    @property
    def label(self) -> str:
        """Axis label of a figure: words, symbol and unit."""
        return label(self.words, self.symbol, self.unit)

    @property
    def words(self) -> str:
        """What it is called."""
        return "BMI" if self.name == "bmi" else self.name.replace("_", " ")

    @property
    def place(self) -> str:
        """How messages about a study call it, for example ``stiffness.ankle``."""
        return f"{self.section}.{self.key}" if self.section else self.key

    @property
    def allowed(self) -> str:
        """The allowed range in words, with the unit."""
        unit = "" if self.unit == "1" else f" {self.unit}"
        rigid = ", or inf for a rigid joint" if self.or_rigid else ""
        return f"{self.lowest:g} to {self.highest:g}{unit}{rigid}"


def label(words: str, symbol: str, unit: str) -> str:
    """Compose a figure label, for example ``Ankle stiffness $K_a$ (N·m/rad)``."""
    head = words[0].upper() + words[1:]
    parts = [head, f"${symbol}$" if symbol else "", "" if unit == "1" else f"({unit})"]
    return " ".join(part for part in parts if part)


BODY_MODELS = ("edwards2007", "winter", "de-leva-male", "de-leva-female")
STANDARD_GRAVITY = 9.80665
STIFFNESS_UNIT = "N·m/rad"
DAMPING_UNIT = "N·m·s/rad"


def _stiffness(joint: str) -> Parameter:
    return Parameter(
        f"{joint}_stiffness",
        f"K_{joint[0]}",
        STIFFNESS_UNIT,
        f"rotational stiffness of both {joint}s together",
        0.0,
        1e12,  # beyond all joints; up to here every accuracy that is promised has been measured
        or_rigid=True,
        section="stiffness",
        key=joint,
    )


def _coupling(one: str, other: str) -> Parameter:
    return Parameter(
        f"{one}_{other}_stiffness",
        f"K_{{{one[0]}{other[0]}}}",
        STIFFNESS_UNIT,
        f"stiffness that couples {one} and {other}, as muscles across both do",
        -1e5,  # up to here every accuracy that is promised has been measured
        1e5,
        section="stiffness",
        key=f"{one}_{other}",
        default=0.0,
        unwritten=True,
    )


def _damping(joint: str) -> Parameter:
    return Parameter(
        f"{joint}_damping",
        f"B_{joint[0]}",
        DAMPING_UNIT,
        f"damping of both {joint}s together",
        0.0,
        1e5,
        section="damping",
        key=joint,
        default=0.0,
        unwritten=True,
    )


def _noise(joint: str) -> Parameter:
    return Parameter(
        f"{joint}_noise",
        rf"\sigma_{joint[0]}",
        "N·m·√s",
        f"white noise of the torque at the {joint}: root of its two-sided spectral density",
        0.0,
        1e4,
        section="noise",
        key=joint,
        default=0.0,
        unwritten=True,
    )


def gain_name(kind: str, moment: str, rotation: str) -> str:
    """Return what the gain of feedback is called from a joint's rotation to a joint's moment."""
    return f"{_pair(moment, rotation)}_{kind}_gain"


def _pair(moment: str, rotation: str) -> str:
    return moment if moment == rotation else f"{moment}_{rotation}"


GAINS = tuple(gain_name(kind, *loop) for kind in ("proportional", "derivative") for loop in LOOPS)


def _gain(kind: str, symbol: str, unit: str, moment: str, rotation: str) -> Parameter:
    pair = _pair(moment, rotation)
    sensed = "rotation" if kind == "proportional" else "rate of rotation"
    return Parameter(
        gain_name(kind, moment, rotation),
        f"{symbol}_{{{''.join(joint[0] for joint in pair.split('_'))}}}",
        unit,
        f"feedback: moment at the {moment} per {sensed} of the {rotation}",
        -1e5,
        1e5,
        section=f"feedback.{kind}",
        key=pair,
        default=0.0,
        unwritten=True,
    )


# The parts of a body that is given segment by segment, as ``Body`` has them. A body of a study or a
# file of people has a number for each segment: ``shank_mass`` and so on.
_PARTS = (
    Parameter("segment_mass", "m", "kg", "mass", 1e-3, 700.0),
    Parameter("segment_inertia", "I", "kg·m²", "inertia about its centre of mass", 1e-6, 1000.0),
    Parameter("segment_length", "h", "m", "length", 1e-2, 2.0),
    Parameter("segment_com", "e", "m", "centre of mass above the lower end", 1e-3, 2.0),
)
SEGMENT_PARAMETERS = {row.name: row for row in _PARTS}


def _of_segment(part: Parameter, segment: str) -> Parameter:
    both = part.name in ("segment_mass", "segment_inertia") and segment != "upper_body"
    return replace(
        part,
        name=f"{segment}_{part.name.removeprefix('segment_')}",
        symbol=f"{part.symbol}_{'b' if segment == 'upper_body' else segment[0]}",
        meaning=f"{segment.replace('_', ' ')}{', both legs' if both else ''}: {part.meaning}",
        section=f"body.{part.name}",
        key=segment,
    )


_SEGMENT_ROWS = {
    part.name: [
        _of_segment(part, segment)
        for segment in (SEGMENTS[:2] if part.name == "segment_length" else SEGMENTS)
    ]
    for part in _PARTS
}
# The numbers of each part of a body, in the order of ``Body``, and all of them.
SEGMENT_NUMBERS = {part: tuple(row.name for row in rows) for part, rows in _SEGMENT_ROWS.items()}
OWN_BODY = tuple(name for names in SEGMENT_NUMBERS.values() for name in names)


# Heights, masses and BMI run from small children to the tallest and heaviest adults on record
# (635 kg; 204 kg/m²); gravity from near weightlessness to 20 g, what centrifuges for people reach.
# They catch centimetres, grams and a lost decimal point, not unusual people.
_TABLE = (
    Parameter(
        "gravity",
        "g",
        "m/s²",
        "gravitational acceleration",
        1e-3,
        200.0,
        key="gravity",
        default=STANDARD_GRAVITY,
    ),
    Parameter(
        "body_model",
        "",
        "1",
        "table of segment parameters",
        choices=BODY_MODELS,
        section="body",
        key="model",
        default="winter",
    ),
    Parameter(
        "height", "H", "m", "standing height of the person", 0.5, 2.8, section="body", key="height"
    ),
    Parameter("mass", "m", "kg", "mass of the whole body", 2.0, 650.0, section="body", key="mass"),
    Parameter(
        "bmi", "", "kg/m²", "body mass index, mass / height²", 5.0, 210.0, section="body", key="bmi"
    ),
    *(row for rows in _SEGMENT_ROWS.values() for row in rows),
    *map(_stiffness, JOINTS),
    *(_coupling(*pair) for pair in COUPLED_JOINTS),
    *map(_damping, JOINTS),
    Parameter(
        "feedback_delay",
        r"\tau",
        "s",
        "delay of the feedback, from sensing to moment",
        0.0,
        10.0,  # beyond all nerves; catches milliseconds
        section="feedback",
        key="delay",
        default=0.0,
        unwritten=True,
    ),
    *(_gain("proportional", "P", STIFFNESS_UNIT, *pair) for pair in LOOPS),
    *(_gain("derivative", "D", DAMPING_UNIT, *pair) for pair in LOOPS),
    *map(_noise, JOINTS),
)
PARAMETERS = {row.name: row for row in _TABLE}
