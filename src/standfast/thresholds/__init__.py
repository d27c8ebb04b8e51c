"""Thresholds of standing: critical surfaces in closed form, contours out of a stored atlas.

On a plane of ankle × hip stiffness the limit of standing is one falling curve. Closed form gives it
exactly for any study; an atlas gives it again from what it stores.
"""
