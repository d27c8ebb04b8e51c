"""The rows of quantities that noise in the joints' torques decides."""

from standfast.parameters import JOINTS
from standfast.quantities.row import Quantity
from standfast.stability.sway import answers
from standfast.stability.sway.density import (
    COM,
    COP,
    COP_TIMES_OMEGA,
    COP_VELOCITY,
    PAIRS,
)


def _deviation(name: str, symbol: str, unit: str, meaning: str, row: int) -> Quantity:
    """Return the row of the table of a standard deviation, whose variance is a ``row`` of sway."""
    return Quantity(
        name,
        rf"\mathrm{{SD}}({symbol})",
        unit,
        f"standard deviation of {meaning}",
        None,
        fed_back=answers.deviation(row),
        crossings_of="who may stand",
        variances=(row,),
    )


OF_SWAY = (
    *(
        _deviation(
            f"{joint}_sway",
            rf"\theta_{joint[0]}",
            "rad",
            f"the {joint} rotation under noise, inf where the person falls or nothing damps it",
            PAIRS.index((place, place)),
        )
        for place, joint in enumerate(JOINTS)
    ),
    _deviation(
        "com_sway",
        r"x_\mathrm{CoM}",
        "m",
        "the centre of mass over the ankle under noise",
        COM,
    ),
    _deviation("cop_sway", r"x_\mathrm{CoP}", "m", "the centre of pressure under noise", COP),
    _deviation(
        "cop_velocity",
        r"v_\mathrm{CoP}",
        "m/s",
        "the velocity of the centre of pressure under noise, below 10 Hz",
        COP_VELOCITY,
    ),
    Quantity(
        "cop_frequency",
        r"\bar f_\mathrm{CoP}",
        "Hz",
        "mean frequency of the centre of pressure's power, NaN where the person falls",
        None,
        fed_back=answers.mean_frequency,
        crossings_of="who may stand",
        variances=(COP, COP_TIMES_OMEGA),
    ),
)
