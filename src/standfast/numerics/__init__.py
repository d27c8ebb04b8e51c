"""Numbers alone: array libraries, vectors, pairs of float64, cubics, eigenvectors."""
