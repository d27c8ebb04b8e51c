"""What a user may not have meant, said of people who are used all the same."""

from collections.abc import Mapping, Sequence

import numpy as np

from standfast.population.people.joining import MOST_TOLD

ADULT = 18
LEAST_BMI, LARGEST_BMI = 10, 100  # kg/m²; beyond, a unit is another than the column says


def remarks_on(persons: Sequence[Mapping[str, object]]) -> list[str]:
    """Return notes on persons as they were checked: their ages and sizes."""

    def column(name: str) -> np.ndarray:
        return np.array([person[name] for person in persons], np.float64)

    remarks = []
    if coded := int(column("top_coded").sum()):
        verb = "is" if coded == 1 else "are"
        what = "age such as 80+" if coded == 1 else "ages such as 80+"
        remarks.append(f"{coded:,} {what} {verb} taken as the lowest, 80")
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
