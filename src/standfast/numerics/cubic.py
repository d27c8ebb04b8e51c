"""The largest root of a cubic whose roots are all real, without a trigonometric function.

With q = e1² − 3 e2 and u = (2 e1³ − 9 e1 e2 + 27 e3) / 2 q^(3/2) the largest root of
x³ − e1 x² + e2 x − e3 is (e1 + 2 √q cos(arccos(u)/3))/3 (Viète). The cosine is a smooth function
of √((1 + u)/2) on [0, 1], there a short polynomial, good to some 1e-7. Each of Halley's steps
triples the digits.
"""

from standfast.numerics.arrays import Scalar, namespace

# cos(2/3 arccos s) on [0, 1] by its values in seven Chebyshev points: within 2e-7.
COSINE = (
    0.500000186,
    0.577331902,
    -0.110805471,
    0.0514747633,
    -0.0263997493,
    0.0105017536,
    -0.00210349101,
)


def largest_root(e1: Scalar, e2: Scalar, e3: Scalar, *, steps: int) -> Scalar:
    """Return the largest root of x³ − e1 x² + e2 x − e3, whose roots are real and not all equal.

    A step takes an error ε of the start, relative to the distance of the roots, to about ε³.
    """
    xp = namespace(e1, e2, e3)
    square = e1**2 - 3.0 * e2
    skew = (2.0 * e1**2 - 9.0 * e2) * e1 + 27.0 * e3
    radius = xp.sqrt(square)
    s = xp.sqrt(xp.clip(0.5 + 0.25 * skew / (square * radius), 0.0, 1.0))
    cosine = COSINE[-1]
    for coefficient in COSINE[-2::-1]:
        cosine = cosine * s + coefficient
    root = (e1 + 2.0 * radius * cosine) / 3.0
    for _ in range(steps):
        value = ((root - e1) * root + e2) * root - e3
        slope = (3.0 * root - 2.0 * e1) * root + e2
        half_curvature = 3.0 * root - e1
        root = root - value * slope / (slope**2 - value * half_curvature)
    return root
