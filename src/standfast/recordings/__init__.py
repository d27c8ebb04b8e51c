"""Recordings of force plates: read, checked, and the measures that are published of them."""
