"""Roots z on a scan of frequencies, by eigenvalues: all delays at once, without a resultant.

(L + z F) v = 0 with L = A s² + B s + C, F = P + D s, s = iω: the eigenvalues of −L⁻¹F are 1/z. As ω
grows a root z leaves the unit circle where a root s passes to the right as the delay grows, and
enters it where one passes to the left. For large ω all z are outside. So

    z inside the circle at ω  =  crossings to the right above ω  −  crossings to the left above ω
"""

import numpy as np

ON_CIRCLE = 1e-9  # as near the circle rounding may say in or out


def inverse_roots(numbers: np.ndarray, rigid: np.ndarray, omega: np.ndarray) -> np.ndarray:
    """1/z of each person at its ω, (persons, 3); 0 for rigid joints and for z at infinity."""
    a, b, c, p, d = np.where(rigid[:, None] | rigid[None, :], 0.0, numbers)
    passive = c + np.eye(3)[..., None] * rigid - a * omega**2 + 1j * b * omega
    active = p + 1j * omega * d
    passive, active = passive.transpose(2, 0, 1), active.transpose(2, 0, 1)
    return np.linalg.eigvals(-np.linalg.solve(passive, active))


def inside(numbers: np.ndarray, rigid: np.ndarray, omega: np.ndarray) -> tuple:
    """How many z lie inside the unit circle, and whether none lies on it within rounding."""
    size = np.abs(inverse_roots(numbers, rigid, omega))
    return (size > 1.0).sum(axis=1), (abs(size - 1.0) > ON_CIRCLE).all(axis=1)


def expected_inside(table, person: np.ndarray, omega: np.ndarray) -> np.ndarray:
    """What a table of crossings says of the same."""
    order = np.lexsort((table.frequency, table.person))
    whose, frequency = table.person[order], table.frequency[order]
    sums = np.concatenate([[0.0], np.cumsum(table.direction[order])])
    ends = np.searchsorted(whose, person, side="right")
    at = np.array([
        first + np.searchsorted(frequency[first:last], each, side="right")
        for first, last, each in zip(np.searchsorted(whose, person), ends, omega, strict=True)
    ])  # fmt: skip
    return np.rint(sums[ends] - sums[at]).astype(np.int64)


def gaps(table, persons: int, highest: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Persons and an ω below, between and above their crossings, up to a bound."""
    lowest = highest.copy()
    np.minimum.at(lowest, table.person, table.frequency)
    person = np.concatenate([np.arange(persons), table.person, np.arange(persons)])
    omega = np.concatenate([1e-3 * lowest, table.frequency, 2.0 * highest])
    order = np.lexsort((omega, person))
    person, omega = person[order], omega[order]
    inner = person[1:] == person[:-1]
    return person[1:][inner], np.sqrt(omega[1:] * omega[:-1])[inner]
