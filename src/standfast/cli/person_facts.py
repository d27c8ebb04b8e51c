"""What ``standfast person`` finds about one person, in plain numbers."""

import math
from typing import Any

from standfast.cli.person_text import fed_back
from standfast.parameters import JOINTS, NOISES
from standfast.quantities.person_facts import facts_of_sway, facts_with_feedback, person_of


def facts_of(given: dict[str, Any]) -> dict[str, Any]:
    """Find everything about the person; what rounding leaves open is None."""
    from standfast.mechanics.matrices import joint_gravity
    from standfast.stability.feedback import is_stable
    from standfast.stability.margins import safety_factor, stiffness_reserve
    from standfast.stability.modes import frequency_of, growth_rate_of, modes
    from standfast.stability.springs import critical_stiffness

    person = person_of(given)
    of = (person.body, person.stiffness, person.gravity)
    alone = joint_gravity(person.body, person.gravity)[0]
    found = modes(*of)
    finite = [
        (float(v), s)
        for v, s in zip(found.eigenvalues, found.shapes.T, strict=True)
        if math.isfinite(v)
    ]
    return {
        "given": given,
        "body": {name: part.tolist() for name, part in person.body._asdict().items()},
        "stands_by_springs": is_stable(*of),
        "stiffness": dict(zip(JOINTS, map(float, person.stiffness.joints), strict=True)),
        "thresholds": dict(zip(JOINTS, critical_stiffness(*of).joints, strict=True)),
        "thresholds_alone": dict(zip(JOINTS, map(float, alone), strict=True)),
        "safety_factor": float(safety_factor(*of)),
        "stiffness_reserve": float(stiffness_reserve(*of)),
        "modes": [
            {
                "eigenvalue": value,
                "frequency": float(frequency_of(value)),
                "growth_rate": float(growth_rate_of(value)),
                "rotations": dict(zip(JOINTS, (shape + 0.0).tolist(), strict=True)),
            }
            for value, shape in finite
        ],
        **_with_feedback(given),
        **({} if given.keys().isdisjoint(NOISES) else {"sway": facts_of_sway(person)}),
    }


def _with_feedback(given: dict[str, Any]) -> dict[str, Any]:
    """Find what becomes of the person with damping and feedback, if any is given."""
    if not fed_back(given):
        return {}
    facts = facts_with_feedback(person_of(given))
    return {"stands_with_feedback": facts.pop("stands"), **facts}
