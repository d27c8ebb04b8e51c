"""Small studies for the tests, as nested mappings."""

import copy
import math
from typing import Any

from standfast.study import grid

# Shards of the tests are small, so that seconds of work have several.
grid.SHARD_WORK = 16

GOOD: dict[str, Any] = {
    "title": "A small study",
    "gravity": 9.8,
    "body": {"model": "winter", "height": 1.75, "mass": 80.0},
    "stiffness": {"ankle": [0.0, 1000.0], "knee": 2000.0, "hip": 500.0},
    "output": {"quantities": ["stable"]},
}

# Every quantity on axes of different lengths, in an order of its own, with rigid knees.
UNEQUAL: dict[str, Any] = {
    "title": "Every quantity",
    "stiffness": {
        "hip": {"start": 100, "stop": 1500, "num": 7},
        "knee": [500.0, 900.0, math.inf],
        "ankle": {"start": 300, "stop": 3000, "num": 11, "spacing": "log"},
    },
    "body": {
        "model": ["de-leva-female", "winter"],
        "height": [1.5, 1.9],
        "bmi": [19.0, 24.0, 40.0],
    },
    "gravity": [1.62, 9.8],
    "output": {
        "quantities": [
            "stable",
            "stability_determinant",
            "critical_ankle_stiffness",
            "critical_knee_stiffness",
            "critical_hip_stiffness",
            "stiffness_reserve",
            "safety_factor",
            "eigenvalue_1",
            "eigenvalue_2",
            "eigenvalue_3",
            "frequency",
            "growth_rate",
            "hip_ankle_ratio",
            "knee_ankle_ratio",
        ]
    },
}


def changed(key: str, value: Any, base: dict[str, Any] = GOOD) -> dict[str, Any]:
    """Return a study with one key, written ``table.key``, set to a value; None removes it."""
    content = copy.deepcopy(base)
    *tables, last = key.split(".")
    place = content
    for table in tables:
        place = place[table]
    if value is None:
        del place[last]
    else:
        place[last] = value
    return content


def several_shards() -> dict[str, Any]:
    """A study of seconds with several shards: verdicts and three kinds of numbers."""
    return {
        "title": "Several shards",
        "body": {"height": 1.75, "bmi": [20.0, 25.0, 30.0]},
        "stiffness": {
            "ankle": {"start": 0, "stop": 2500, "num": 1100},
            "knee": [700.0, 900.0, 2000.0, math.inf],
            "hip": {"start": 0, "stop": 1500, "num": 901},
        },
        "output": {
            "quantities": [
                "stable",
                "stability_determinant",
                "critical_ankle_stiffness",
                "critical_hip_stiffness",
            ]
        },
    }


def toml_of(content: dict[str, Any]) -> str:
    """A study as a user would write it into a file."""

    def text(value: Any) -> str:
        if isinstance(value, dict):
            return "{ " + ", ".join(f"{key} = {text(item)}" for key, item in value.items()) + " }"
        if isinstance(value, list):
            return "[" + ", ".join(map(text, value)) + "]"
        return f'"{value}"' if isinstance(value, str) else str(value)

    tables = {key: value for key, value in content.items() if isinstance(value, dict)}
    lines = [f"{key} = {text(value)}" for key, value in content.items() if key not in tables]
    for name, table in tables.items():
        lines += [f"[{name}]", *(f"{key} = {text(value)}" for key, value in table.items())]
    return "\n".join(lines) + "\n"
