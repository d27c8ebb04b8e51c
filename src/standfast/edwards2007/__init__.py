"""Gait & Posture 25 (2007) 432-439 recomputed: its numbers, its figures, the comparison."""
