"""Does the person stand, and by what margin: by springs alone, with proofs."""

from standfast.stability.springs import verdict

__all__ = ["verdict"]
