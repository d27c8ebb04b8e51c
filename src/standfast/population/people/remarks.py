"""What a user may not have meant, said of people who are used all the same."""

from collections.abc import Mapping, Sequence

import numpy as np

from standfast.population.people.joining import MOST_TOLD, on_lines

ADULT = 18
LEAST_BMI, LARGEST_BMI = 10, 100  # kg/m²; beyond, a unit is another than the column says


def remarks_on(persons: Sequence[Mapping[str, object]]) -> list[str]:
    """Return notes on persons as they were checked: their ages and sizes."""

    def column(name: str) -> np.ndarray:
        return np.array([person[name] for person in persons], np.float64)

    remarks = [*_unreadable(persons, "sex", "sexes"), *_unreadable(persons, "age", "ages")]
    if (coded := column("top_coded").astype(bool)).any():
        lowest = [f"{age:g}" for age in sorted(set(column("age")[coded].tolist()))]
        told = " and ".join(filter(None, (", ".join(lowest[:-1]), lowest[-1])))
        verb = "age such as 80+ is" if coded.sum() == 1 else "ages such as 80+ are"
        remarks.append(f"{coded.sum():,} {verb} taken as the lowest, {told}")
    bmi = column("mass") / column("height") ** 2
    odd = np.flatnonzero((bmi < LEAST_BMI) | (bmi > LARGEST_BMI))
    if odd.size:
        ids = ", ".join(str(persons[row]["id"]) for row in odd[:MOST_TOLD])
        more = ", …" if odd.size > MOST_TOLD else ""
        verb = "has" if odd.size == 1 else "have"
        remarks.append(
            f"{odd.size:,} {verb} a BMI below {LEAST_BMI} or above {LARGEST_BMI} kg/m², look at "
            f"the units (id {ids}{more})"
        )
    if children := int((column("age") < ADULT).sum()):
        verb = "is" if children == 1 else "are"
        remarks.append(
            f"{children:,} {verb} under {ADULT} years, and the body models are of adults"
        )
    return remarks


def _unreadable(persons: Sequence[Mapping[str, object]], field: str, several: str) -> list[str]:
    """Say which sexes or ages are taken as unknown: what stands there, and on which lines."""
    places: dict[str, dict[str, list[int]]] = {}  # lines by file and entry
    for person in persons:
        unreadable = person["unreadable"]
        if isinstance(unreadable, dict) and field in unreadable:
            of_file = places.setdefault(str(person["file"]), {})
            of_file.setdefault(unreadable[field], []).append(int(str(person["line"])))
    remarks = []
    for file, lines in places.items():
        count = sum(map(len, lines.values()))
        what = f"{count:,} {several} are" if count > 1 else f"one {field} is"
        words = f"{what} not read and taken as unknown: {on_lines(lines)}"
        remarks.append(f"{file}: {words}")
    return remarks
