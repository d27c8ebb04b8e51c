"""Atlases: computed by :mod:`.sweeping` (or :mod:`.memory`), read here without JAX."""
