"""Every number that the paper prints about its model, and how each is computed here.

A printed number stands for an interval: 731.3 for 731.25 to 731.35. A statement ("just below
400") stands for the interval in which it would be true. Settings of the paper's calculations
(joint stiffness, gravity, height, body mass index) are taken as exact; its listed segment masses,
inertias, lengths and centres of mass as rounded to the last printed digit.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from standfast.anthropometry.body import REFERENCE_PEOPLE, Body, body_of
from standfast.mechanics.joints import Stiffness
from standfast.mechanics.matrices import inertia_matrix
from standfast.stability.modes import frequency, modes
from standfast.stability.springs import (
    critical_ankle_stiffness,
    critical_hip_stiffness,
    critical_knee_stiffness,
)

GRAVITY = 9.8  # m/s²
RIGID = math.inf

FIGURE_2_ANKLE, FIGURE_2_KNEE = 1118.0, 2000.0
FIGURE_2_HIPS = np.arange(1000.0, 99.0, -100.0)
FIGURE_3_KNEES = (600.0, 700.0, 800.0, 1000.0, 2000.0, RIGID)
FIGURE_3_LIMITS = (0.0, 2000.0)
FIGURE_4 = Stiffness(ankle=950.0, knee=2000.0, hip=738.0)
FIGURE_4_ANKLE_ROTATION = math.radians(10.0)
FIGURE_5 = Stiffness(ankle=1170.0, knee=1200.0, hip=700.0)
FIGURE_5_HEIGHTS = (1.611, 1.753, 1.895)  # m
FIGURE_5_BMI = np.arange(18.0, 31.0, 3.0)  # kg/m²; the figure itself is drawn finer

# Half of the last printed digit of every listed segment value (kg, kg·m², m).
INPUT_ROUNDING = 0.0005

# Share of the feet in body mass (Chaffin & Andersson 1984), which the segment masses leave out.
FEET = 0.028


@dataclass(frozen=True, slots=True)
class PublishedNumber:
    """One number or statement of the paper; ``lowest`` to ``highest`` is what it stands for."""

    what: str
    where: str
    unit: str
    printed: str
    lowest: float
    highest: float
    compute: Callable[[Body], float]
    note: str = ""


def printed(
    what: str,
    where: str,
    unit: str,
    text: str,
    compute: Callable[[Body], float],
    note: str = "",
) -> PublishedNumber:
    """Make a row of a printed number, which stands for half a unit of its last digit each way."""
    decimals = len(text.partition(".")[2])
    half = 0.5 * 10.0**-decimals
    value = float(text)
    return PublishedNumber(what, where, unit, text, value - half, value + half, compute, note)


def mass_above_ankle(body: Body) -> float:
    """Return the mass of the three segments (kg)."""
    return float(np.sum(body.segment_mass))


def centre_of_mass(body: Body) -> float:
    """Return the height of the common centre of mass above the ankle (m)."""
    return float(body.segment_mass @ com_heights(body)) / mass_above_ankle(body)


def com_heights(body: Body) -> np.ndarray:
    """Return the height of each segment's centre of mass above the ankle (m)."""
    shank, thigh = body.segment_length
    heights: np.ndarray = np.array([0.0, shank, shank + thigh]) + body.segment_com
    return heights


def inertia_about_ankle(body: Body) -> float:
    """Return the inertia of the whole body turning about the ankle, A11 (kg·m²)."""
    return float(inertia_matrix(body)[0, 0])


def inertia_about_com(body: Body) -> float:
    """Return the inertia about the common centre of mass (kg·m²), by the parallel-axis theorem."""
    return inertia_about_ankle(body) - mass_above_ankle(body) * centre_of_mass(body) ** 2


def angular_frequency(body: Body, stiffness: Stiffness, mode: int = 0) -> float:
    """Return ω of a mode in rad/s, negative for minus the growth rate of a fall."""
    return math.tau * float(frequency(modes(body, stiffness, GRAVITY).eigenvalues[mode]))


def person(body: Body, height: float, bmi: float) -> Body:
    """Return the nominal body scaled to another height (m) and body mass index (kg/m²)."""
    nominal = REFERENCE_PEOPLE["edwards2007"]._replace(body=body)
    return body_of({"body_model": nominal, "height": height, "bmi": bmi})


def figure_5(body: Body, bmi: np.ndarray = FIGURE_5_BMI) -> np.ndarray:
    """Return the curves of figure 5: ω (rad/s) over height and body mass index."""
    return np.array(
        [
            [angular_frequency(person(body, height, value), FIGURE_5) for value in bmi]
            for height in FIGURE_5_HEIGHTS
        ]
    )


def hip_ankle_ratio(body: Body, mode: int) -> float:
    """Return the ratio of hip to ankle rotation in a mode of figure 4."""
    return float(modes(body, FIGURE_4, GRAVITY).shapes[2, mode])


SECOND_MODE = (
    "Cannot come from the listed parameters: two independent multibody programs give the value "
    "computed here. An upper-body inertia of 15 to 16 kg·m² in place of 3.012 would come close "
    "and leave every threshold as it is, but contradicts the paper's own 11.11 kg·m²."
)

PUBLISHED = (
    printed(
        "ankle threshold, knee and hip rigid",
        "Results",
        "N·m/rad",
        "731.3",
        lambda body: float(critical_ankle_stiffness(body, RIGID, RIGID, GRAVITY)),
    ),
    printed(
        "hip threshold, ankle and knee rigid",
        "Results",
        "N·m/rad",
        "179.7",
        lambda body: float(critical_hip_stiffness(body, RIGID, RIGID, GRAVITY)),
        "This threshold is g mb eb; the listed values give 0.27 % more than printed, beyond "
        "their rounding.",
    ),
    printed("mass above the ankle", "Methods", "kg", "73.18", mass_above_ankle),
    printed("centre of mass above the ankle", "Methods", "m", "1.02", centre_of_mass),
    printed("inertia about the centre of mass", "Methods", "kg·m²", "11.11", inertia_about_com),
    printed("inertia about the ankle", "Methods", "kg·m²", "87.10", inertia_about_ankle),
    printed(
        "body mass",
        "Nomenclature",
        "kg",
        "75.3",
        lambda body: mass_above_ankle(body) / (1.0 - FEET),
        "With feet of 2.8 % (Chaffin & Andersson 1984), not part of the listed values.",
    ),
    printed(
        "body mass",
        "Methods, Fig. 3",
        "kg",
        "75.2",
        lambda body: mass_above_ankle(body) / (1.0 - FEET),
        "The paper gives 75, 75.2 and 75.3 kg in different places; the listed masses fit 75.3.",
    ),
    printed(
        "body mass",
        "Abstract",
        "kg",
        "75",
        lambda body: mass_above_ankle(body) / (1.0 - FEET),
    ),
    PublishedNumber(
        "critical hip stiffness at Ka 1118, Kk 2000",
        "Fig. 2",
        "N·m/rad",
        "just below 400",
        399.0,
        400.0,
        lambda body: float(critical_hip_stiffness(body, FIGURE_2_ANKLE, FIGURE_2_KNEE, GRAVITY)),
    ),
    PublishedNumber(
        "critical knee stiffness at Ka = Kh = 2000",
        "Fig. 3",
        "N·m/rad",
        "600 at the corner",
        550.0,
        650.0,
        lambda body: float(critical_knee_stiffness(body, 2000.0, 2000.0, GRAVITY)),
        "Agrees to the plot, read to within 50 N·m/rad: 600 itself is just unstable.",
    ),
    printed(
        "frequency of the first mode",
        "Fig. 4a",
        "Hz",
        "0.002",
        lambda body: angular_frequency(body, FIGURE_4) / math.tau,
        "On the threshold: rounding of the inputs decides whether the person sways or falls.",
    ),
    printed(
        "hip/ankle rotation of the first mode",
        "Fig. 4a",
        "1",
        "0.43",
        lambda body: hip_ankle_ratio(body, 0),
    ),
    printed(
        "frequency of the second mode",
        "Fig. 4b",
        "Hz",
        "1.50",
        lambda body: angular_frequency(body, FIGURE_4, mode=1) / math.tau,
        SECOND_MODE,
    ),
    printed(
        "hip/ankle rotation of the second mode",
        "Fig. 4b",
        "1",
        "-2.07",
        lambda body: hip_ankle_ratio(body, 1),
        SECOND_MODE,
    ),
    PublishedNumber(
        "change of ω per 3 units of body mass index, the least of any curve",
        "Fig. 5",
        "rad/s",
        "falls",
        -math.inf,
        0.0,
        lambda body: float(np.diff(figure_5(body), axis=1).max()),
    ),
    PublishedNumber(
        "change of ω from one height to the next taller, the least anywhere",
        "Fig. 5",
        "rad/s",
        "falls",
        -math.inf,
        0.0,
        lambda body: float(np.diff(figure_5(body), axis=0).max()),
    ),
)
