"""The rows of quantities that damping and delayed feedback decide."""

from standfast.mechanics.feedback import delay_of, equation_of
from standfast.numerics.arrays import namespace
from standfast.quantities.row import NOISE, Person, Quantity
from standfast.stability.delay import answers, one_joint


def joint_of(person: Person) -> one_joint.OneJoint:
    """Return the one joint of a person that is not rigid."""
    parts = equation_of(person.body, person.stiffness, person.gravity, person.given)
    xp = namespace(*person.stiffness.joints)
    rigid = [xp.isinf(k) for k in person.stiffness.joints]
    entries = (sum(xp.where(rigid[i], 0.0, part[i][i]) for i in range(3)) for part in parts)
    return one_joint.OneJoint(*entries)


OF_FEEDBACK = (
    Quantity(
        "critical_delay",
        r"\tau_\mathrm{crit}",
        "s",
        "smallest delay at which stability is lost, 0 if unstable without delay, inf if never",
        None,
        without=("feedback_delay", NOISE),
        fed_back=answers.critical_delay,
        crossings_of="who stands at once",
        of_one_joint=lambda one: one_joint.critical_delay(joint_of(one)),
    ),
    Quantity(
        "delay_margin",
        r"\Delta\tau",
        "s",
        "critical delay less the delay of the feedback",
        None,
        without=(NOISE,),
        fed_back=answers.delay_margin,
        crossings_of="who stands at once",
        of_one_joint=lambda one: one_joint.critical_delay(joint_of(one)) - delay_of(one.given),
        limit=0.0,
    ),
    Quantity(
        "unstable_roots",
        "N",
        "1",
        "number of characteristic roots with a positive real part",
        None,
        without=(NOISE,),
        dtype="uint8",
        fed_back=answers.unstable_roots,
        of_one_joint=lambda one: one_joint.unstable_roots(joint_of(one), delay_of(one.given)),
    ),
    Quantity(
        "decay_rate",
        r"-\mathrm{Re}\,s",
        "1/s",
        "rate at which sway decays, of the rightmost root, negative where the person falls",
        None,
        without=(NOISE,),
        fed_back=answers.decay_rate,
        crossings_of="nobody",
        limit=0.0,
    ),
    Quantity(
        "sway_frequency",
        "f_s",
        "Hz",
        "frequency of the rightmost root",
        None,
        without=(NOISE,),
        fed_back=answers.sway_frequency,
        crossings_of="nobody",
        jumps=True,
    ),
    Quantity(
        "damping_ratio",
        r"\zeta",
        "1",
        "damping ratio of the rightmost root, negative where the person falls",
        None,
        without=(NOISE,),
        fed_back=answers.damping_ratio,
        crossings_of="nobody",
        jumps=True,
        limit=0.0,
    ),
)
