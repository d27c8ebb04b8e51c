"""Does the person stand, and by what margin: by springs alone, with proofs."""
