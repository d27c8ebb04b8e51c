"""Standing with delayed feedback: at which delays roots cross the axis, and where they lie."""
