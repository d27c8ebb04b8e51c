"""A file of 3,000 made-up persons as an epidemiologist gets it, seeded; run it to see the file.

Tabs, decimal commas, a byte-order mark in UTF-16, centimetres and pounds, ages such as ``80+``,
a third sex, ids twice, missing and impossible entries, own columns. What is wrong is counted, so
that a test can say how many rows of each kind there are.
"""

import sys
from collections import Counter
from pathlib import Path

import numpy as np

HEADER = (
    "Subject ID", "Sex", "Age", "Height (cm)", "Weight (lb)", "Site", "Falls last year",
    "Ankle stiffness", "Hip stiffness",
)  # fmt: skip
SIZE = 3000


def made(seed: int = 13) -> tuple[str, Counter]:
    """Return the text of the file, and how often each kind of mess is in it."""
    random = np.random.default_rng(seed)
    told: Counter = Counter()
    rows = []
    for number in range(SIZE):
        female = random.random() < 0.6
        sex = random.choice(("F", "female", "w") if female else ("M", "male", "m"))
        age = int(random.integers(20, 97))
        height = random.normal(161.0 if female else 174.0, 7.0)
        mass = random.normal(25.5, 3.5) * (height / 100.0) ** 2
        # multiples of the load that topples the body: mass (kg), height (m), g
        ankle = 0.57 * mass * 9.81 * height / 100.0 * random.normal(1.45, 0.25)
        entries = {
            "id": f"P{number:04d}",
            "sex": str(sex),
            "age": str(age),
            "height": f"{height:.1f}",
            "mass": f"{mass / 0.45359237:.1f}",
            "site": str(random.choice(("Köln", "=Ulm", "Graz; Ost"))),
            "falls": str(random.poisson(0.4)),
            "ankle": f"{max(ankle, 50.0):.1f}",
            "hip": f"{random.uniform(250.0, 900.0):.1f}",
        }
        _spoil(entries, random, age, told)
        told[f"sex {_kind_of_sex(entries['sex'])}"] += 1
        rows.append(entries)
    rows[500]["id"] = rows[499]["id"]
    rows[1500]["id"] = rows[77]["id"]
    lines = ["\t".join(HEADER), *("\t".join(row.values()).replace(".", ",") for row in rows)]
    return "\r\n".join(lines) + "\r\n", told


def _spoil(entries: dict[str, str], random: np.random.Generator, age: int, told: Counter) -> None:
    """Make of an entry what people make of it."""
    if age >= 90:
        entries["age"] = "90 and over"
    elif age >= 80:
        entries["age"] = "80+"
    told["top-coded"] += age >= 80
    chance = random.random()
    for kind, key, entry, share in (
        ("other", "sex", "divers", 0.01),
        ("no sex", "sex", "", 0.01),
        ("no age", "age", "NA", 0.01),
        ("rejected", "height", "17.0", 0.004),
        ("rejected", "mass", "n/a", 0.004),
        ("no age", "age", "old", 0.002),
        ("no hip", "hip", "", 0.02),
    ):
        if chance < share:
            told["top-coded"] -= key == "age" and age >= 80
            entries[key] = entry
            told[kind] += 1
            return
        chance -= share


def _kind_of_sex(word: str) -> str:
    return {"f": "female", "w": "female", "m": "male", "d": "other", "": "unknown"}[
        word[:1].lower()
    ]


def write(path: Path, encoding: str = "utf-16") -> Counter:
    """Write the file; return what is wrong with it."""
    text, told = made()
    path.write_bytes(text.encode(encoding))
    return told


if __name__ == "__main__":
    write(Path(sys.argv[1]))
