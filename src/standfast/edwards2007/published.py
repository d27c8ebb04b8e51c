"""Every number that the paper prints about its model, and how each is computed here.

A printed number stands for an interval: 731.3 for 731.25 to 731.35. A statement ("just below
400") stands for the interval in which it would be true. Settings of the paper's calculations
(joint stiffness, gravity, height, body mass index) are taken as exact; its listed segment masses,
inertias, lengths and centres of mass as rounded to the last printed digit.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np

from standfast.anthropometry.body import REFERENCE_PEOPLE, Body, body_of
from standfast.mechanics.joints import Stiffness
from standfast.mechanics.matrices import inertia_matrix
from standfast.stability import springs
from standfast.stability.modes import frequency_of, modes

GRAVITY = 9.8  # m/s²
RIGID = math.inf

FIGURE_2_ANKLE, FIGURE_2_KNEE = 1118.0, 2000.0
FIGURE_2_HIPS = np.arange(1000.0, 99.0, -100.0)
FIGURE_3_KNEES = (600.0, 700.0, 800.0, 1000.0, 2000.0, RIGID)
FIGURE_3_LIMITS = (0.0, 2000.0)
FIGURE_4 = Stiffness(ankle=950.0, knee=2000.0, hip=738.0)
FIGURE_5 = Stiffness(ankle=1170.0, knee=1200.0, hip=700.0)
FIGURE_5_HEIGHTS = (1.611, 1.753, 1.895)  # m
FIGURE_5_BMI = np.arange(18.0, 31.0, 3.0)  # kg/m²; the figure itself is drawn finer

# Half of the last printed digit of every listed segment value (kg, kg·m², m).
INPUT_ROUNDING = 0.0005


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
    what: str, where: str, unit: str, text: str, compute: Callable[[Body], float], note: str = ""
) -> PublishedNumber:
    """Make a row of a printed number, which stands for half a unit of its last digit each way."""
    half = 0.5 * 10.0 ** -len(text.partition(".")[2])
    value = float(text)
    return PublishedNumber(what, where, unit, text, value - half, value + half, compute, note)


def mass_above_ankle(body: Body) -> float:
    """Return the mass of the three segments (kg)."""
    return float(np.sum(body.segment_mass))


def body_mass(body: Body) -> float:
    """Return the mass of the segments and of the feet, which they leave out (kg)."""
    feet = 0.028  # share in body mass (Chaffin & Andersson 1984)
    return mass_above_ankle(body) / (1.0 - feet)


def centre_of_mass(body: Body) -> float:
    """Return the height of the common centre of mass above the ankle (m)."""
    shank, thigh = body.segment_length
    heights = np.array([0.0, shank, shank + thigh]) + body.segment_com
    return float(body.segment_mass @ heights) / mass_above_ankle(body)


def inertia_about_ankle(body: Body) -> float:
    """Return the inertia of the whole body turning about the ankle, A11 (kg·m²)."""
    return float(inertia_matrix(body)[0, 0])


def inertia_about_com(body: Body) -> float:
    """Return the inertia about the common centre of mass (kg·m²), by the parallel-axis theorem."""
    return inertia_about_ankle(body) - mass_above_ankle(body) * centre_of_mass(body) ** 2


def ankle_alone(body: Body) -> float:
    """Return the ankle stiffness at which a person rigid elsewhere just stands (N·m/rad)."""
    return float(springs.critical_ankle_stiffness(body, RIGID, RIGID, GRAVITY))


def hip_alone(body: Body) -> float:
    """Return the hip stiffness at which a person rigid elsewhere just stands (N·m/rad)."""
    return float(springs.critical_hip_stiffness(body, RIGID, RIGID, GRAVITY))


def angular_frequency(body: Body, stiffness: Stiffness, mode: int = 0) -> float:
    """Return ω of a mode in rad/s, negative for minus the growth rate of a fall."""
    return math.tau * float(frequency_of(modes(body, stiffness, GRAVITY).eigenvalues[mode]))


def person(body: Body, height: float, bmi: float) -> Body:
    """Return the nominal body scaled to another height (m) and body mass index (kg/m²)."""
    nominal = REFERENCE_PEOPLE["edwards2007"]._replace(body=body)
    return body_of({"body_model": nominal, "height": height, "bmi": bmi})


def figure_5(body: Body, bmi: np.ndarray = FIGURE_5_BMI) -> np.ndarray:
    """Return the curves of figure 5: ω (rad/s) over height and body mass index."""
    people = [[person(body, height, value) for value in bmi] for height in FIGURE_5_HEIGHTS]
    return np.array([[angular_frequency(one, FIGURE_5) for one in row] for row in people])


def falling(what: str, axis: int) -> PublishedNumber:
    """Make a row of a statement that ω falls along an axis of the curves of figure 5."""

    def largest_step(body: Body) -> float:
        return float(np.diff(figure_5(body), axis=axis).max())

    return PublishedNumber(what, "Fig. 5", "rad/s", "falls", -math.inf, 0.0, largest_step)


def frequency_in_hertz(body: Body, mode: int) -> float:
    """Return the frequency of a mode of figure 4, negative where the person falls."""
    return angular_frequency(body, FIGURE_4, mode) / math.tau


def hip_ankle_ratio(body: Body, mode: int) -> float:
    """Return the ratio of hip to ankle rotation in a mode of figure 4."""
    return float(modes(body, FIGURE_4, GRAVITY).shapes[2, mode])


def of_mode(
    mode: int, hertz: str, ratio: str, hertz_note: str, ratio_note: str = ""
) -> tuple[PublishedNumber, PublishedNumber]:
    """Make the rows of a mode of figure 4: its frequency, and how hip and ankle turn in it."""
    which, where = ("first", "Fig. 4a") if mode == 0 else ("second", "Fig. 4b")
    in_hertz = partial(frequency_in_hertz, mode=mode)
    turning = partial(hip_ankle_ratio, mode=mode)
    return (
        printed(f"frequency of the {which} mode", where, "Hz", hertz, in_hertz, hertz_note),
        printed(f"hip/ankle rotation of the {which} mode", where, "1", ratio, turning, ratio_note),
    )


HIP_ALONE = (
    "This threshold is g mb eb; the listed values give 0.27 % more than printed, beyond "
    "their rounding."
)
WITH_FEET = "With feet of 2.8 % (Chaffin & Andersson 1984), not part of the listed values."
THREE_MASSES = (
    "The paper gives 75, 75.2 and 75.3 kg in different places; the listed masses fit 75.3."
)
ON_THRESHOLD = "On the threshold: rounding of the inputs decides whether the person sways or falls."
SECOND_MODE = (
    "Cannot come from the listed parameters: two independent multibody programs give the value "
    "computed here. An upper-body inertia of 15 to 16 kg·m² in place of 3.012 would come close "
    "and leave every threshold as it is, but contradicts the paper's own 11.11 kg·m²."
)

PUBLISHED = (
    printed("ankle threshold, knee and hip rigid", "Results", "N·m/rad", "731.3", ankle_alone),
    printed(
        "hip threshold, ankle and knee rigid", "Results", "N·m/rad", "179.7", hip_alone, HIP_ALONE
    ),
    printed("mass above the ankle", "Methods", "kg", "73.18", mass_above_ankle),
    printed("centre of mass above the ankle", "Methods", "m", "1.02", centre_of_mass),
    printed("inertia about the centre of mass", "Methods", "kg·m²", "11.11", inertia_about_com),
    printed("inertia about the ankle", "Methods", "kg·m²", "87.10", inertia_about_ankle),
    printed("body mass", "Nomenclature", "kg", "75.3", body_mass, WITH_FEET),
    printed("body mass", "Methods, Fig. 3", "kg", "75.2", body_mass, THREE_MASSES),
    printed("body mass", "Abstract", "kg", "75", body_mass),
    PublishedNumber(
        "critical hip stiffness at Ka 1118, Kk 2000",
        "Fig. 2",
        "N·m/rad",
        "just below 400",
        399.0,
        400.0,
        lambda body: float(
            springs.critical_hip_stiffness(body, FIGURE_2_ANKLE, FIGURE_2_KNEE, GRAVITY)
        ),
    ),
    PublishedNumber(
        "critical knee stiffness at Ka = Kh = 2000",
        "Fig. 3",
        "N·m/rad",
        "600 at the corner",
        550.0,
        650.0,
        lambda body: float(springs.critical_knee_stiffness(body, 2000.0, 2000.0, GRAVITY)),
        "Agrees to the plot, read to within 50 N·m/rad: 600 itself is just unstable.",
    ),
    *of_mode(0, "0.002", "0.43", ON_THRESHOLD),
    *of_mode(1, "1.50", "-2.07", SECOND_MODE, SECOND_MODE),
    falling("change of ω per 3 units of body mass index, the least of any curve", axis=1),
    falling("change of ω from one height to the next taller, the least anywhere", axis=0),
)
