"""Populations, laws of stiffness and delays from measurements: facts with sources, no code."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True, slots=True)
class Subpopulation:
    """People of one sex and age range: height normal, BMI = shift + lognormal, correlated.

    ``share`` is the group's part of its survey's adults; lengths in m, BMI in kg/m². ``log_mean``
    and ``log_sd`` are of ln(BMI − shift), ``correlation`` is between height and ln(BMI − shift).
    """

    sex: str
    age: str
    share: float
    height_mean: float
    height_sd: float
    bmi_shift: float
    log_mean: float
    log_sd: float
    correlation: float


# NHANES 2017-2018 (US CDC, public domain): examined adults of 20 years and more with height and
# weight, without pregnant women, weighted by WTMEC2YR. The lognormals are fitted to the weighted
# moments of BMI; shares are sums of weights. Ages above 80 are coded as 80.
NHANES = (
    Subpopulation("male", "20-39", 0.18125, 1.75929, 0.07236, 7.8798, 3.00257, 0.32495, 0.0059),
    Subpopulation("male", "40-59", 0.17242, 1.75781, 0.07478, 8.4720, 3.05466, 0.27341, 0.1093),
    Subpopulation("male", "60+", 0.13258, 1.73463, 0.07185, 3.2017, 3.24657, 0.21044, 0.1676),
    Subpopulation("male", "65+", 0.09109, 1.72784, 0.06702, 5.4129, 3.14216, 0.22406, 0.1715),
    Subpopulation("male", "20+", 0.48625, 1.75204, 0.07387, 5.8913, 3.13536, 0.26348, 0.0788),
    Subpopulation("female", "20-39", 0.17581, 1.62575, 0.06714, 11.7871, 2.75703, 0.47924, 0.0123),
    Subpopulation("female", "40-59", 0.17935, 1.61411, 0.06816, 10.4678, 2.91413, 0.40645, -0.1094),
    Subpopulation("female", "60+", 0.15859, 1.58813, 0.06516, 9.6702, 2.94738, 0.32368, -0.0314),
    Subpopulation("female", "65+", 0.11156, 1.58049, 0.06468, 9.4368, 2.95345, 0.31211, -0.0365),
    Subpopulation("female", "20+", 0.51375, 1.61008, 0.06866, 10.5831, 2.88009, 0.40285, -0.0515),
)

# ANSUR II 2012 (US Army, public release): 4082 men and 1986 women of 17 to 58 years, unweighted.
ANSUR = (
    Subpopulation(
        "male", "17-58", 4082 / 6068, 1.75621, 0.06854, -4.4799, 3.46309, 0.12514, -0.0008
    ),
    Subpopulation(
        "female", "17-58", 1986 / 6068, 1.62847, 0.06418, 5.0155, 3.00515, 0.16925, 0.0569
    ),
)

POPULATIONS: Mapping[str, tuple[Subpopulation, ...]] = {
    "nhanes-2017-2018": NHANES,
    "ansur-2012": ANSUR,
}
SOURCES = {
    "nhanes-2017-2018": "NHANES 2017-2018, US CDC: BMX_J and DEMO_J, weighted, not pregnant",
    "ansur-2012": "ANSUR II 2012, US Army, public release",
}
# The groups that a population without a named age is put together from.
PARTITION = {"nhanes-2017-2018": ("20-39", "40-59", "60+"), "ansur-2012": ("17-58",)}

# Age classes of people of a file, as NHANES groups adults.
AGE_CLASSES = ((0.0, "under 20"), (20.0, "20-39"), (40.0, "40-59"), (60.0, "60+"))

# How shank and thigh scatter between people, relative to their mean share of stature: standard
# deviations and correlation. ANSUR II: lateral femoral epicondyle less malleolus height,
# trochanterion less epicondyle height; the correlation from the spread of their sum. Stature is
# kept: the upper body makes up for both (so computed its spread is 3.2 and 3.1 %, measured 3.1 and
# 3.0 %). Of both sexes together: means.
PROPORTIONS = {
    "male": (0.0347, 0.0522, 0.131),
    "female": (0.0433, 0.0460, -0.042),
    "other": (0.0390, 0.0491, 0.045),
    "unknown": (0.0390, 0.0491, 0.045),
}


@dataclass(frozen=True, slots=True)
class ReadyDelay:
    """A delay of feedback (s), as a study would say it, and where it is from.

    ``assumed``: the distribution is not one that was measured between persons; ``rests_on`` says
    what it is made of.
    """

    distribution: Mapping[str, Any]
    source: str
    assumed: bool
    rests_on: str = ""


# Delays of whole loops, from sensing to moment, of healthy standing adults. Published are means of
# groups; neither a spread between persons nor a value of old people was seen.
READY_DELAYS: Mapping[str, ReadyDelay] = {
    "pasma-2017": ReadyDelay(
        {"distribution": "fixed", "value": 0.097},
        "Pasma et al. 2017, PMC5664365, table 1",
        assumed=False,
    ),
    "jner-2017": ReadyDelay(
        {"distribution": "fixed", "value": 0.104},
        "J NeuroEng Rehabil 2017, s12984-017-0299-x, table 3",
        assumed=False,
    ),
    "young": ReadyDelay(
        {"distribution": "normal", "mean": 0.126, "sd": 0.032},
        "pasma-2017, jner-2017, and the models of PosturalControlLab/LA_toolbox",
        assumed=True,
        rests_on=(
            "mean and spread of five values for healthy adults, two identified (0.097, 0.104 s) "
            "and three that a toolbox begins with (0.106, 0.160, and 0.162 over five amplitudes of "
            "tilt); that persons differ as these do is assumed, and the adults' ages were not seen"
        ),
    ),
    "old": ReadyDelay(
        {"distribution": "normal", "mean": 0.158, "sd": 0.032},
        "Front Aging Neurosci 7 (2015) 97; J Neurophysiol 115 (2016) 1422-1435; J NeuroEng Rehabil "
        "2019, s12984-019-0574-0: abstracts, for the direction alone",
        assumed=True,
        rests_on=(
            "delays of old people are longer, in all three; by how much was not seen: one standard "
            "deviation of the young is assumed, and their spread"
        ),
    ),
}

NORMAL_OF_MGH = {"distribution": "normal", "relative_to": "mgh"}
# Ready laws, by joint, and of the delay: what was measured, as a study would say it. Stiffness is
# of both legs together.
READY_DISTRIBUTIONS: Mapping[str, Mapping[str, Mapping[str, Any]]] = {
    "ankle": {
        # intrinsic ankle stiffness in quiet standing, perturbations of about 0.055 degrees,
        # J Physiol 545 (2002) 1041-1053
        "loram-lakie-2002": {**NORMAL_OF_MGH, "mean": 0.91, "sd": 0.23},
        # the same with 1-degree steps, Gait & Posture 21 (2005) 410-424 (taken second-hand)
        "casadio-2005": {**NORMAL_OF_MGH, "mean": 0.64, "sd": 0.08},
        # passive calf, rotations below 0.2 degrees, supported upright, J Physiol 584 (2007) 661-675
        "loram-2007": {**NORMAL_OF_MGH, "mean": 0.67, "sd": 0.08},
        # muscle and stretch reflex of a model of quiet stance (80 kg, 1.80 m), derived from its
        # parameters, Biol Cybern 111 (2017) 389-403
        "reimann-schoner-2017": {"distribution": "fixed", "value": 296.0},
    },
    "knee": {"reimann-schoner-2017": {"distribution": "fixed", "value": 201.1}},
    "hip": {"reimann-schoner-2017": {"distribution": "fixed", "value": 246.2}},
    "feedback.delay": {name: delay.distribution for name, delay in READY_DELAYS.items()},
}
