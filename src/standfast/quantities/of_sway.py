"""The rows of quantities that noise in the joints' torques decides."""

from standfast.parameters import JOINTS
from standfast.quantities.row import Quantity
from standfast.stability.sway import answers
from standfast.stability.sway.answers import ROWS

NONE = ", inf where the person falls or nothing damps it, NaN where too near to falling to say"


def _deviation(name: str, symbol: str, unit: str, meaning: str) -> Quantity:
    """Return the row of the table of a standard deviation."""
    return Quantity(
        name,
        rf"\mathrm{{SD}}({symbol})",
        unit,
        f"standard deviation of {meaning}",
        None,
        fed_back=answers.deviation(*ROWS[name]),
        crossings_of="who may stand",
        variances=ROWS[name],
    )


OF_SWAY = (
    *(
        _deviation(
            f"{joint}_sway",
            rf"\theta_{joint[0]}",
            "rad",
            f"the {joint} rotation under noise{NONE}",
        )
        for joint in JOINTS
    ),
    _deviation(
        "com_sway", r"x_\mathrm{CoM}", "m", f"the centre of mass over the ankle under noise{NONE}"
    ),
    _deviation("cop_sway", r"x_\mathrm{CoP}", "m", f"the centre of pressure under noise{NONE}"),
    _deviation(
        "cop_velocity",
        r"v_\mathrm{CoP}",
        "m/s",
        f"the velocity of the centre of pressure under noise, below 10 Hz{NONE}",
    ),
    Quantity(
        "cop_frequency",
        r"\bar f_\mathrm{CoP}",
        "Hz",
        "mean frequency of the centre of pressure's power, NaN where the person falls or is too "
        "near to falling to say",
        None,
        fed_back=answers.mean_frequency,
        crossings_of="who may stand",
        variances=ROWS["cop_frequency"],
    ),
)
