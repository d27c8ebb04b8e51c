"""The rows of quantities that noise in the joints' torques decides."""

from standfast.parameters import JOINTS
from standfast.quantities.row import Quantity
from standfast.stability.sway import answers


def _of_joint(joint: str) -> Quantity:
    return Quantity(
        f"{joint}_sway",
        rf"\mathrm{{SD}}(\theta_{joint[0]})",
        "rad",
        f"standard deviation of the {joint} rotation under noise, inf where the person falls "
        "or nothing damps it",
        None,
        fed_back=answers.deviation(answers.DEVIATIONS[f"{joint}_sway"]),
    )


OF_SWAY = (
    *map(_of_joint, JOINTS),
    Quantity(
        "com_sway",
        r"\mathrm{SD}(x_\mathrm{CoM})",
        "m",
        "standard deviation of the centre of mass over the ankle under noise",
        None,
        fed_back=answers.deviation(answers.DEVIATIONS["com_sway"]),
    ),
    Quantity(
        "cop_sway",
        r"\mathrm{SD}(x_\mathrm{CoP})",
        "m",
        "standard deviation of the centre of pressure under noise",
        None,
        fed_back=answers.deviation(answers.DEVIATIONS["cop_sway"]),
    ),
    Quantity(
        "cop_velocity",
        r"\mathrm{SD}(v_\mathrm{CoP})",
        "m/s",
        "standard deviation of the velocity of the centre of pressure under noise, below 10 Hz",
        None,
        fed_back=answers.deviation(answers.DEVIATIONS["cop_velocity"]),
    ),
    Quantity(
        "cop_frequency",
        r"\bar f_\mathrm{CoP}",
        "Hz",
        "mean frequency of the centre of pressure's power, NaN where the person falls",
        None,
        fed_back=answers.mean_frequency,
    ),
)
