"""Published laws of feedback: facts with their sources, no code.

In: laws whose gains stood before us in their source, whose body did too or follows surely, and
which are of the form of :mod:`.law`; and gains that a source defines by what they minimise. Out,
with the reason, :data:`LEFT_OUT`. One law from memory is kept, and says so, because it is the
field's standard example of what a delay does and its published outcome comes out.
"""

from collections.abc import Mapping
from typing import Any

from standfast.anthropometry.body import Body
from standfast.errors import UnknownNameError, nearest_name
from standfast.mechanics.law import Gains, Law, Outcome, Printed
from standfast.mechanics.links import OneLink, TwoLinks
from standfast.parameters import DAMPING_UNIT, STIFFNESS_UNIT

G = 9.81


def _per_radian(
    proportional: Any, derivative: Any, stiffness: Any = 0.0, damping: Any = 0.0
) -> Gains:
    return Gains(
        Printed(proportional, STIFFNESS_UNIT),
        Printed(derivative, DAMPING_UNIT),
        Printed(stiffness, STIFFNESS_UNIT),
        Printed(damping, DAMPING_UNIT),
    )


# Which mass and inertia belong to which link is inferred; all four sets of eigenvalues confirm it.
_WANG_BODY = TwoLinks(
    mass=(22.699, 48.429), inertia=(1.71647, 3.29194), com=(0.46647, 0.32905), leg=0.84353
)


def _wang(name: str, title: str, p: Any, d: Any, published: Outcome) -> Law:
    return Law(
        name=name,
        title=title,
        source=(
            "Wang & van den Bogert, stochastic trajectory optimization of standing, author's "
            "manuscript (HuaweiWang.github.io-src, content/pdfs/StochasticPaper_Manuscript.pdf), "
            "appendix, tables 1-4; body: HuaweiWang/Stochastic_Paper, Para_Winter_Subj05.txt"
        ),
        confidence="seen",
        links=_WANG_BODY,
        gravity=G,
        printed=_per_radian(p, d),
        delay=0.0,
        published=published,
    )


_WANG = (
    _wang(
        "wang-pd-det",
        "gains of ankle and hip apart, optimised without noise",
        (883.80, 222.05),
        (18.33, 8.99),
        Outcome(stands=False, roots=(-2.344 + 8.717j, -0.987, 0.715)),
    ),
    _wang(
        "wang-pd-sto3",
        "gains of ankle and hip apart, optimised under noise",
        (972.25, 236.58),
        (29.68, 10.57),
        Outcome(stands=True, roots=(-2.940 + 9.115j, -0.181 + 0.046j)),
    ),
    _wang(
        "wang-fpd-det",
        "gains of both joints to both, optimised without noise",
        ((341.49, 412.23), (-105.74, 364.04)),
        ((68.84, 47.65), (19.93, 23.44)),
        Outcome(stands=True, roots=(-2.097 + 8.550j, -1.020, -0.053)),
    ),
    _wang(
        "wang-fpd-sto3",
        "gains of both joints to both, optimised under noise",
        ((454.75, 318.62), (-74.46, 334.14)),
        ((55.29, 50.18), (16.15, 24.50)),
        Outcome(stands=True, roots=(-2.091 + 8.535j, -0.981, -0.061)),
    ),
)

# 69 kg and 1.70 m with Winter's segments, as the toolbox has them by default.
_TOOLBOX = "PosturalControlLab/LA_toolbox, BalanceSysID/ModelFits/getDefaultPar.m"
_TOOLBOX_BODY = OneLink(mass=69.0, inertia=70.57, load=633.65)


def _tilt(amplitude: str, per_degree: float, delay: float) -> Law:
    return Law(
        name=f"independent-channel-{amplitude}deg",
        title=f"independent channels, eyes closed, surface tilted by {amplitude} degrees",
        source=f"{_TOOLBOX} (its model file names Peterka 2003)",
        confidence="gains seen",
        links=_TOOLBOX_BODY,
        gravity=G,
        printed=Gains(Printed(per_degree, "N·m/degree"), Printed(5.0, "N·m·s/degree")),
        delay=delay,
        published=Outcome(stands=True, of="the whole model, of healthy standing"),
        note="positive feedback of ankle torque, 0.1 degrees/N·m with a time constant of 18 s",
    )


_ANKLE = (
    Law(
        name="pasma-2017",
        title="healthy standing, from the response to disturbances",
        source="Pasma et al. 2017, PMC5664365, table 1",
        confidence="seen",
        links=OneLink(mass=75.0, inertia=66.0, load=610.7),
        gravity=G,
        printed=_per_radian(943.9, 313.5, stiffness=40.5, damping=68.8),
        delay=0.097,
        published=Outcome(stands=True, of="the whole model, of healthy standing"),
        note=(
            "activation of second order (16.8 rad/s, damping 0.99) and force feedback "
            "(0.0018 rad/N·m, 17.4 s); sensory weights of 0.8"
        ),
    ),
    _tilt("0.5", 17.0, 0.20),
    _tilt("1", 18.0, 0.19),
    _tilt("2", 19.0, 0.18),
    _tilt("4", 20.0, 0.13),
    _tilt("8", 21.0, 0.11),
    Law(
        name="light-touch-2017",
        title="standing with light touch, where its fit begins",
        source=f"{_TOOLBOX}, case LT_p2017 (that gains are multiples of mgh is read from its code)",
        confidence="gains seen",
        links=_TOOLBOX_BODY,
        gravity=G,
        printed=Gains(Printed(1.1883, "mgh"), Printed(0.2967, "mgh·s")),
        delay=0.10592,
        published=Outcome(stands=True, of="the whole model"),
    ),
    Law(
        name="dec-2015",
        title="disturbance estimation and compensation, eyes closed",
        source=f"{_TOOLBOX}, case DEC_p2015",
        confidence="gains seen",
        links=_TOOLBOX_BODY,
        gravity=G,
        printed=Gains(
            proportional=Printed(1.0, "mgh"),
            derivative=Printed(0.3, "mgh·s"),
            stiffness=Printed(0.15, "mgh"),
            damping=Printed(0.045, "mgh·s"),
        ),
        delay=0.16,
        published=Outcome(stands=True, of="the whole model, with the loops left out here"),
        note=(
            "an overall gain of 0.85, with which K + P = mgh and the law alone just does not "
            "stand, and the loops that estimate gravity and field; 0.15 s with eyes open"
        ),
    ),
    Law(
        name="asai-2009",
        title="small gains all the time: what intermittent control is held against",
        source=(
            "Asai et al. 2009, PLOS ONE 4:e6169; K and B also in public code of Suzuki et al. "
            "2020, Chaos 30:113140"
        ),
        confidence="recalled",
        links=OneLink(mass=60.0, inertia=60.0, load=588.6),
        gravity=G,
        printed=Gains(
            proportional=Printed(0.25, "mgh"),
            derivative=Printed(10.0, DAMPING_UNIT),
            stiffness=Printed(0.8, "mgh"),
            damping=Printed(4.0, DAMPING_UNIT),
        ),
        delay=0.2,
        published=Outcome(stands=False, of="this law, never switched off"),
        note="switching, which holds this body up",
    ),
)

_STATE_FEEDBACK = (
    Law(
        name="opty-park-2004",
        title="two links, every rotation to every joint; simulated without delay",
        source=(
            "csu-hmc/opty, examples-gallery/advanced/model_park2004.py; that the gains are those "
            "of Park, Horak & Kuo 2004, Exp Brain Res 154:417, is a guess of its comment"
        ),
        confidence="gains seen",
        links=TwoLinks(
            mass=(32.126, 48.831), inertia=(1.7992, 2.4812), com=(0.5716, 0.3145), leg=0.878
        ),
        gravity=G,
        printed=_per_radian(((950.0, 175.0), (45.0, 290.0)), ((185.0, 50.0), (60.0, 26.0))),
        delay=0.0,
    ),
    Law(
        name="lqr-pydy",
        title="linear-quadratic regulator of three links, weights 1",
        source=(
            "pydy/pydy-tutorial-human-standing, notebooks/solution: body and weights; gains "
            "computed here, for joint angles of one sense of rotation"
        ),
        confidence="derived",
        links=Body(
            (6.769, 17.010, 32.440), (0.101, 0.282, 1.485), (0.611, 0.424), (0.387, 0.193, 0.305)
        ),
        gravity=G,
        printed=_per_radian(
            ((1054.37, 426.90, 153.86), (707.67, 610.18, 251.28), (12.13, 43.67, 132.47)),
            ((365.78, 173.58, 67.28), (263.84, 158.58, 72.18), (11.61, 16.45, 19.12)),
        ),
        delay=0.0,
    ),
    Law(
        name="lqr-edwards2007",
        title="the same regulator of the nominal adult",
        source="computed here, for the body of Gait & Posture 25 (2007) 432-439; not published",
        confidence="derived",
        links=Body.edwards2007(),
        gravity=9.8,
        printed=_per_radian(
            ((1082.01, 536.97, 206.43), (1221.94, 1060.64, 484.58), (74.93, 106.72, 243.93)),
            ((367.02, 220.58, 94.11), (437.23, 299.13, 147.41), (37.99, 38.19, 38.52)),
        ),
        delay=0.0,
    ),
)


class _Laws(dict[str, Law]):
    def __missing__(self, name: object) -> Law:
        if isinstance(name, str) and name in LEFT_OUT:
            raise UnknownNameError(f"{name} is not among the laws: {LEFT_OUT[name]}")
        raise UnknownNameError(
            f"{name} is not a law{nearest_name(name, self)} (standfast laws lists them)"
        )


LAWS: Mapping[str, Law] = _Laws({law.name: law for law in (*_ANKLE, *_WANG, *_STATE_FEEDBACK)})

_SECOND_HAND = "its gains or body were not seen in the source"
# What one may look for, and why it is not among them.
LEFT_OUT: Mapping[str, str] = {
    "jner-2017": (
        "its acceleration gain, 89.1, is above its inertia, 80.8 kg·m²: with any delay and no "
        "filter that is unstable, and without acceleration it is not the law that was identified"
    ),
    "asai-2009-intermittent": "it switches, and is not linear",
    "suzuki-2020": "it switches, and its gains are prior ranges",
    "reimann-schoner-2017": "it has two delays, 30 ms of reflexes and 120 ms of balance",
    "jiang-2016": "70 muscles; of the gains only the delay, 120 ms, was seen",
    "peterka-2002": _SECOND_HAND,
    "maurer-peterka-2005": _SECOND_HAND,
    "masani-2006": _SECOND_HAND,
}
