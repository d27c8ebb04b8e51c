"""Vectors and matrices of three, written out: tuples of scalars, which trace and fuse well."""

from standfast.numerics.arrays import Matrix, Scalar, Vector


def dot(a: Vector, b: Vector) -> Scalar:
    """Scalar product a · b."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a: Vector, b: Vector) -> Vector:
    """Vector product a × b."""
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def matvec(matrix: Matrix, a: Vector) -> Vector:
    """Matrix, given by its rows, times vector."""
    return (dot(matrix[0], a), dot(matrix[1], a), dot(matrix[2], a))
