"""The one error for what a user gave, and the nearest right name for its message."""

import difflib
from collections.abc import Iterable


class InputError(ValueError):
    """Something a user gave is wrong; the message is one sentence that says what would be right."""


class UnknownNameError(InputError, KeyError):
    """A name that a mapping of standfast does not hold; a ``KeyError`` too, as mappings promise."""

    __str__ = ValueError.__str__  # that of KeyError would put the sentence into quotation marks


# Words that are not near in letters to what they mean.
SYNONYMS = {"weight": "mass", "size": "height", "length": "height", "g": "gravity"}


def nearest_name(given: object, names: Iterable[str]) -> str:
    """Return ``"; did you mean 'x'?"`` for a near miss, else an empty string."""
    names = list(names)
    if SYNONYMS.get(str(given)) in names:
        return f"; did you mean {SYNONYMS[str(given)]!r}?"
    turned = "_".join(reversed(str(given).split("_")))  # knee_ankle for ankle_knee
    if turned in names:
        return f"; did you mean {turned!r}?"
    close = difflib.get_close_matches(str(given), names, n=1, cutoff=0.5)
    return f"; did you mean {close[0]!r}?" if close else ""


def shortened(given: object) -> str:
    """Return how Python writes a value, cut so that the message that refuses it is one line."""
    text = repr(given)
    return text if len(text) <= 60 else f"{text[:57]}…"
