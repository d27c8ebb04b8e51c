"""A population by plain NumPy, written apart from the package: no code of it is used.

Its own random numbers, its own body proportions (Winter's table, from the reference), and the
verdict from the leading minors of C.
"""

import numpy as np

from minors import stands_by_minors

# Winter: masses of both legs' segments of body mass, lengths and centres of mass of stature.
MASS = np.array([0.093, 0.200, 0.678])
LENGTH = np.array([0.246, 0.245])
CENTRE = np.array([0.567 * 0.246, 0.567 * 0.245, 0.626 * 0.288])


def loads(height, mass, gravity):
    """Gravity part of C: G1, G2, G3 of every person."""
    shank, thigh, upper = (mass * share for share in MASS)
    low = gravity * (shank * CENTRE[0] + (thigh + upper) * LENGTH[0]) * height
    middle = gravity * (thigh * CENTRE[1] + upper * LENGTH[1]) * height
    top = gravity * upper * CENTRE[2] * height
    return low + middle + top, middle + top, top


def falls(height, mass, gravity, ankle, knee, hip):
    """Whether C is not positive definite, by Sylvester's minors; inf is rigid."""
    g1, g2, g3 = loads(height, mass, gravity)
    matrix = np.empty((len(height), 3, 3))
    matrix[:, 0, 0], matrix[:, 1, 1], matrix[:, 2, 2] = ankle - g1, knee - g2, hip - g3
    matrix[:, 0, 1] = matrix[:, 1, 0] = -g2
    matrix[:, 0, 2] = matrix[:, 2, 0] = -g3
    matrix[:, 1, 2] = matrix[:, 2, 1] = -g3
    return ~stands_by_minors(matrix)


def drawn_group(random, size, mean, sd, shift, log_mean, log_sd, correlation):
    """Heights (m) and masses (kg) of one group."""
    both = random.multivariate_normal([0, 0], [[1, correlation], [correlation, 1]], size)
    height = mean + sd * both[:, 0]
    bmi = shift + np.exp(log_mean + log_sd * both[:, 1])
    return height, bmi * height**2


def truncated_normal(random, size, mean, sd):
    """Normal numbers, those below 0 drawn again."""
    values = random.normal(mean, sd, size)
    while (values < 0.0).any():
        below = values < 0.0
        values[below] = random.normal(mean, sd, below.sum())
    return values


def lognormal(random, size, mean, sd):
    """Lognormal numbers with this mean and sd."""
    sigma = np.sqrt(np.log(1.0 + (sd / mean) ** 2))
    return random.lognormal(np.log(mean) - sigma**2 / 2.0, sigma, size)


# Radii of gyration about the centre of mass, of stature.
GYRATION = np.array([0.302 * 0.246, 0.323 * 0.245, 0.496 * 0.288])


def inertia(height, mass):
    """Inertia of every person about the ankle, knee and hip straight and rigid."""
    distance = np.array([CENTRE[0], LENGTH[0] + CENTRE[1], LENGTH[0] + LENGTH[1] + CENTRE[2]])
    return (MASS @ (GYRATION**2 + distance**2)) * mass * height**2


def critical_delay_of_a_faller(j, b, c, p, d):
    """Critical delay of one joint whose springs alone fail (c < 0): 0 if feedback does not hold it.

    J s² + B s + C + (P + D s) e^(−sτ) with s = iω: ω from the moduli, then τ from the angle, the
    principal one alone, as the root crosses once where |P| > |C|.
    """
    holds = (c + p > 0.0) & (b + d > 0.0)
    half = (d**2 - b**2 + 2.0 * j * c) / 2.0
    root = np.sqrt(np.where(holds, half**2 + j**2 * (p**2 - c**2), 1.0))
    omega = np.sqrt(np.where(holds, (half + root) / j**2, 1.0))
    late = (j * omega**2 - c - 1j * b * omega) / (p + 1j * d * omega)
    return np.where(holds, (-np.angle(late) % (2.0 * np.pi)) / omega, 0.0)
