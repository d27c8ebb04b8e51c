"""Axes and fields between the values of a grid, in steps that are fine enough to draw."""

import numpy as np

# Of a side of a plane, where the limit is known between the values of the grid.
FINE = 400


def spread(values: np.ndarray, *, by_factors: bool) -> np.ndarray:
    """Return an axis between its ends, in steps fine enough to draw."""
    first, last = values[np.isfinite(values)][[0, -1]]
    spaced = np.geomspace if by_factors else np.linspace
    between = spaced(float(first), float(last), FINE + 1)[1:-1]
    # the ends themselves: rounded inwards they would cut a line off
    return np.concatenate([[first], between, [last]])


def divided(values: np.ndarray, parts: int) -> np.ndarray:
    """Divide each step along the first axis into some parts, by straight lines."""
    share = np.arange(parts).reshape(1, -1, *[1] * (values.ndim - 1)) / parts
    between = values[:-1, None] * (1.0 - share) + values[1:, None] * share
    return np.concatenate([between.reshape(-1, *values.shape[1:]), values[-1:]])


def continued(values: np.ndarray) -> np.ndarray:
    """Give what is NaN (x, y) the mean of its neighbours, those beyond them 1."""
    padded = np.pad(values, 1, constant_values=np.nan)
    rows, columns = values.shape
    around = [
        padded[i : i + rows, j : j + columns]
        for i in range(3)
        for j in range(3)
        if (i, j) != (1, 1)
    ]
    known = [~np.isnan(each) for each in around]
    total = np.sum([np.where(k, each, 0.0) for k, each in zip(known, around, strict=True)], axis=0)
    count = np.sum(known, axis=0)
    mean = np.where(count > 0, total / np.maximum(count, 1), 1.0)
    return np.where(np.isnan(values), mean, values)
