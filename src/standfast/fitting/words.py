"""What a fit comes to, in a few sentences."""

from collections.abc import Mapping

from standfast.fitting.family import PROPORTIONAL
from standfast.fitting.result import Estimate, Fitted

# Ends of an interval of which one is so many times the other say little.
WIDE = 5.0
NAMES = {
    "noise": "noise",
    "proportional_gain": "proportional gain",
    "derivative_gain": "derivative gain",
    "feedback_delay": "delay",
    "sd_ap": "SD of the CoP",
    "mean_velocity_ap": "mean velocity of the CoP",
    "mean_frequency_ap": "mean frequency of the CoP",
    "sd_com": "SD of the CoM",
    "sd_ankle": "SD of the ankle",
    "sd_knee": "SD of the knee",
    "sd_hip": "SD of the hip",
}


def status_of(
    law: str,
    parameters: Mapping[str, Estimate],
    measures: Mapping[str, Fitted],
    explained: bool | None,
) -> str:
    """Return whether the law explains the measures, and what they do not tell."""
    said = [f"{law} explains the measures."]
    if explained is None:
        numbers = len(measures)
        said = [
            f"{law} can have these measures; whether it explains them cannot be tested: as many "
            f"numbers are open as measures are given ({numbers})."
        ]
    elif not explained:
        worst = max(measures, key=lambda name: _off(measures[name]))
        found = measures[worst]
        more = "more" if found.model > found.measured else "less"
        ratio = max(found.model / found.measured, found.measured / found.model)
        open_to_it = ", ".join(NAMES[name] for name in parameters)
        said = [
            f"{law} does not explain the measures, whatever its {open_to_it}: the nearest person "
            f"has {ratio:.3g} times {more} {NAMES[worst]}. Margins are those of this person, and "
            "mean little."
        ]
    for name, estimate in parameters.items():
        below, above = estimate.open
        if name == "noise" and (below or above):
            end = (
                "both ends" if below and above else ("the lower end" if below else "the upper end")
            )
            said.append(f"Of the noise {end} may be further out, at the edge of what was searched.")
        elif below and above:
            said.append(f"The {NAMES[name]} is not known from them at all.")
        elif below and name == PROPORTIONAL:
            said.append(
                f"The {NAMES[name]} may be as small as just holds a person up ({estimate.low:.4g} "
                f"{estimate.unit})."
            )
        elif below or above:
            end = "lower" if below else "upper"
            said.append(f"The {NAMES[name]} has no {end} limit from them.")
        elif estimate.high > WIDE * estimate.low:
            said.append(f"The {NAMES[name]} is hardly known from them.")
    return " ".join(said)


def _off(found: Fitted) -> float:
    """Return how far a measure is off, in standard deviations, in ratios."""
    larger = max(found.measured / found.model, found.model / found.measured)
    return (larger - 1.0) / found.spread
