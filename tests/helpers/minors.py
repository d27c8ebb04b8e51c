"""The oldest way to a verdict, written apart from the package: an oracle of the tests."""

import numpy as np


def stands_by_minors(matrices: np.ndarray) -> np.ndarray:
    """Sylvester's criterion of many C, (n, 3, 3): all leading minors are positive.

    A rigid joint, infinite on the diagonal, is taken out: its row and column are those of 1.
    """
    matrices = matrices.copy()
    for joint in range(3):
        rigid = np.isinf(matrices[:, joint, joint])
        matrices[rigid, joint, :] = matrices[rigid, :, joint] = 0.0
        matrices[rigid, joint, joint] = 1.0
    minors = (np.linalg.det(matrices[:, :n, :n]) for n in (1, 2, 3))
    return np.logical_and.reduce([minor > 0.0 for minor in minors])
