"""Values of a study in words: its canonical JSON, and a few words for messages."""

import hashlib
import json
import math
from collections.abc import Mapping
from typing import Any, TypeAlias

# A value, a list or a range in canonical form.
Value: TypeAlias = float | str | list[float] | list[str] | dict[str, Any]


def json_value(value: Any) -> Any:
    """Return a value in words of JSON, which has no infinity."""
    return _replaced(value, math.inf, "inf")


def from_json(given: Any) -> Any:
    """Turn the canonical ``"inf"`` back into a number."""
    return _replaced(given, "inf", math.inf)


def _replaced(value: Any, old: object, new: object) -> Any:
    if isinstance(value, Mapping):
        return {key: _replaced(item, old, new) for key, item in value.items()}
    if isinstance(value, list):
        return [_replaced(item, old, new) for item in value]
    return new if value == old else value


def canonical_text(content: Mapping[str, Any]) -> str:
    """Return a study's one text: JSON on one line without spaces, infinity as ``"inf"``."""
    return json.dumps(
        json_value(content), ensure_ascii=False, separators=(",", ":"), allow_nan=False
    )


def fingerprint_of(text: str) -> str:
    """Return the SHA-256 of a canonical text."""
    return hashlib.sha256(text.encode()).hexdigest()


def flat(content: Mapping[str, Any], prefix: str = "") -> dict[str, Any]:
    """Return nested tables as one, keys joined by points."""
    found: dict[str, Any] = {}
    for key, value in content.items():
        if isinstance(value, Mapping):
            found |= flat(value, f"{prefix}{key}.")
        else:
            found[f"{prefix}{key}"] = value
    return found


def describe(value: Value | None) -> str:
    """Return a value, list or range in a few words."""
    if value is None:
        return "not given"
    if isinstance(value, dict):
        spacing = ", log spacing" if value["spacing"] == "log" else ""
        return f"{value['num']} values from {value['start']:g} to {value['stop']:g}{spacing}"
    if isinstance(value, list):
        words = [item if isinstance(item, str) else f"{item:g}" for item in value]
        shown = words if len(words) <= 8 else [*words[:3], "…", words[-1]]
        return f"[{', '.join(shown)}]"
    return value if isinstance(value, str) else f"{value:g}"
