"""Populations: who would not stand, how sure that is, and what it would take."""
