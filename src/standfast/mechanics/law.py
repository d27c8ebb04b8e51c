"""What a published law of feedback carries, and how its printed numbers become ours.

    A q̈ + B q̇ + (K − G) q = −P q(t − τ) − D q̇(t − τ)

Sources print gains in several units; a law keeps the number and the unit that stand there, and
:data:`UNITS` is the only place where they are converted.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from standfast.anthropometry.body import Body
from standfast.mechanics.feedback import Feedback
from standfast.mechanics.joints import Stiffness, checked_body
from standfast.mechanics.links import OneLink, TwoLinks
from standfast.mechanics.matrices import gravity_loads
from standfast.numerics.arrays import Array, Scalar
from standfast.parameters import (
    DAMPING_UNIT,
    DAMPINGS,
    JOINTS,
    LOOPS,
    PARAMETERS,
    STANDARD_GRAVITY,
    STIFFNESS_UNIT,
    STIFFNESSES,
    checked_number,
    gain_name,
)

PER_RADIAN = 180.0 / math.pi
# What a printed unit is in N·m/rad (N·m·s/rad) of both legs; None: the law's own load m g h.
UNITS: Mapping[str, float | None] = {
    STIFFNESS_UNIT: 1.0,
    DAMPING_UNIT: 1.0,
    "N·m/degree": PER_RADIAN,
    "N·m·s/degree": PER_RADIAN,
    "N·m/rad of one leg": 2.0,
    "N·m·s/rad of one leg": 2.0,
    "mgh": None,
    "mgh·s": None,
}
CONFIDENCES: Mapping[str, str] = {
    "seen": "gains and body stand in the source",
    "gains seen": "gains stand in the source, the body is worked out here",
    "derived": "gains are computed here from what the source defines",
    "recalled": "numbers from memory, checked by their outcome alone",
}
FREE = {OneLink: (0,), TwoLinks: (0, 2), Body: (0, 1, 2)}  # joints that are not rigid


class Printed(NamedTuple):
    """A number, one a joint, or rows of a matrix over the free joints; and its printed unit."""

    value: Any
    unit: str


class Gains(NamedTuple):
    """P, D, K and B of a law as they are printed."""

    proportional: Printed
    derivative: Printed
    stiffness: Printed = Printed(0.0, STIFFNESS_UNIT)
    damping: Printed = Printed(0.0, DAMPING_UNIT)


class Outcome(NamedTuple):
    """What a source says becomes of its law: whether it stands, and characteristic roots (1/s).

    ``of`` says of what, where that is more than the law here. Of conjugate roots the upper is kept.
    """

    stands: bool
    roots: tuple[complex, ...] = ()
    of: str = "this law"


@dataclass(frozen=True, slots=True, kw_only=True)
class Law:
    """A published law of feedback with the body that it holds up.

    ``delay`` is in s, ``gravity`` in m/s². ``note`` says what the source has that is left out here.
    ``published`` is None where the source states no outcome.
    """

    name: str
    title: str
    source: str
    confidence: str
    links: OneLink | TwoLinks | Body
    gravity: float
    printed: Gains
    delay: float
    published: Outcome | None = None
    note: str = ""

    @property
    def joints(self) -> tuple[str, ...]:
        """The joints that are not rigid."""
        return tuple(JOINTS[j] for j in FREE[type(self.links)])

    @property
    def body(self) -> Body:
        """The body, as three segments."""
        if isinstance(self.links, OneLink):
            return self.links.body(self.gravity)
        return self.links.body() if isinstance(self.links, TwoLinks) else self.links

    @property
    def load(self) -> float:
        """What topples the whole body about the ankle, m g h (N·m/rad)."""
        if isinstance(self.links, OneLink):
            return self.links.load
        return float(sum(gravity_loads(self.body, self.gravity)))

    @property
    def stiffness(self) -> Stiffness:
        """K, with the joints rigid that the law has not (N·m/rad)."""
        diagonal = self._matrix(self.printed.stiffness).diagonal()
        return Stiffness(
            *(
                float(k) if joint in self.joints else math.inf
                for joint, k in zip(JOINTS, diagonal, strict=True)
            )
        )

    @property
    def damping(self) -> Array:
        """B, (3, 3), N·m·s/rad."""
        return self._matrix(self.printed.damping)

    @property
    def feedback(self) -> Feedback:
        """P (N·m/rad), D (N·m·s/rad) and τ (s)."""
        p, d = map(self._matrix, self.printed[:2])
        return Feedback(proportional=p, derivative=d, delay=self.delay)

    @property
    def person(self) -> dict[str, Any]:
        """All arguments of a public function: ``critical_delay(**law.person)``."""
        names = ("body", "stiffness", "gravity", "damping", "feedback")
        return {name: getattr(self, name) for name in names}

    def scale(self, body: Body, gravity: Scalar = STANDARD_GRAVITY) -> float:
        """Return m g h of a body over that of the law's: what its springs and gains are scaled by.

        Bodies of the same proportions behave alike under stiffness and gains in proportion to it.

        Raises
        ------
        InputError
            if it is no body, or gravity is out of range.
        """
        checked_body(body)
        gravity = checked_number("gravity", gravity, row=PARAMETERS["gravity"])
        return float(sum(gravity_loads(body, gravity))) / self.load

    def on(self, body: Body, gravity: Scalar = STANDARD_GRAVITY) -> dict[str, Any]:
        """Return the law on another body: all arguments of a public function, as ``person``.

        Stiffness, damping and gains are scaled (:meth:`scale`), the delay is not.

        Examples
        --------
        >>> import standfast as sf
        >>> law, body = sf.LAWS["dec-2015"], sf.Body.from_height_mass(1.66, 68.0)
        >>> print(f"{law.scale(body):.3f}, {sf.critical_delay(**law.on(body)):.3f} s")
        0.952, 0.323 s
        """
        scale, (p, d, delay) = self.scale(body, gravity), self.feedback
        return {
            "body": body,
            "stiffness": Stiffness(*(scale * k for k in self.stiffness.joints)),
            "gravity": gravity,
            "damping": scale * self.damping,
            "feedback": Feedback(scale * p, scale * d, delay),
        }

    @property
    def parameters(self) -> dict[str, float]:
        """Stiffness, damping, gains and delay by the names of parameters, but what is 0."""
        nerves = {
            gain_name(kind, moment, rotation): float(
                gains[JOINTS.index(moment), JOINTS.index(rotation)]
            )
            for kind, gains in zip(("proportional", "derivative"), self.feedback, strict=False)
            for moment, rotation in LOOPS
        }
        # no law damps one joint by the motion of another
        nerves |= dict(zip(DAMPINGS, map(float, self.damping.diagonal()), strict=True))
        return {
            **dict(zip(STIFFNESSES, self.stiffness.joints, strict=True)),
            **{name: number for name, number in nerves.items() if number},
            "feedback_delay": self.delay,
        }

    def _matrix(self, printed: Printed) -> Array:
        """Return what is printed as a matrix (3, 3) of ankle, knee, hip, in our unit."""
        free = FREE[type(self.links)]
        value = np.atleast_1d(np.array(printed.value, np.float64))
        factor = UNITS[printed.unit]
        matrix = np.zeros((3, 3))
        matrix[np.ix_(free, free)] = (
            value if value.ndim == 2 else np.diag(value * np.ones(len(free)))
        )
        return matrix * (self.load if factor is None else factor)
