"""Which noise and gains of a law explain a person's sway, and how far from falling that is."""
