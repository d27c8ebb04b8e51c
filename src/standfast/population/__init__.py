"""Populations: who would not stand, how sure that is, and what it would take.

``people`` says who, ``cohort`` what becomes of them, ``summary`` what is answered; ``simulation``
is the way through all three.
"""
